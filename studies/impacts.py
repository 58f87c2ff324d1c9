"""Print impacts of robots and people against the two-body model: ``python studies/impacts.py [regions|robots|people]``.

``regions``: a beam of 60 kg at the height of each body region of a standing person. ``robots``: driven and mirrored
robots against a standing person, at three time steps of the engine. ``people``: walking people against a robot at rest.
The two-body model is that of ISO/TS 15066 at the speed of the body, not of a swinging limb.
"""

from __future__ import annotations

import argparse
import itertools
import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from crowdbot.core import Scene, Twist
from crowdbot.humans import People
from crowdbot.models import ORCA
from crowdbot.simulation import AvatarOrder, Order, RobotPoseOrder, Simulation, SimulationRun, VelocityOrder
from crowdbot.trials import parse_trial
from crowdbot.world import BodyContactEvent, Omnidirectional, PhysicsWorld, Robot, read_urdf, two_body_force

GAP, AHEAD, STEP = 1.4, 2.0, 0.05
TRIAL = """<trial name="impact" duration="30" step="{step}" world="physics" physics-step="{engine}"><stage/>
<crowd type="orca"/>{person}
<robot name="robot" type="{kind}" x="0" y="0" heading="{heading}" visible="false" default-sensors="false">
<goal x="9" y="0"/>{pose}<navigator type="external"/></robot><end collision="false" goal="false"/></trial>"""


class Meeting(NamedTuple):
    """A robot at a speed [m/s], driven or mirrored, and a person who stands, walks or is tracked at another one."""

    kind: str
    speed: float = 0.0
    mirrored: bool = False
    person: str = "stands"
    walking: float = 0.0
    engine: float = 0.005
    heading: float = 0.0

    def orders(self, time: float) -> Iterator[Order]:
        """Yield the orders for a time [s]."""
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        x = self.speed * time
        if self.mirrored:
            yield RobotPoseOrder(robot="robot", time=time, x=x * cos, y=x * sin, heading=self.heading)
        else:
            yield VelocityOrder(robot="robot", forward=self.speed)
        if self.person == "is tracked":
            x = GAP + AHEAD - self.walking * time
            yield AvatarOrder(avatar="person", time=time, x=x * cos, y=x * sin, heading=self.heading + math.pi)

    def trial(self) -> str:
        """Return the trial."""
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        away = GAP + (AHEAD if self.walking else 0.0)
        place = f'x="{away * cos}" y="{away * sin}" heading="{self.heading + math.pi}" body="man-36"'
        goal = f'goal="{-9 * cos},{-9 * sin}" speed="{self.walking}"' if self.walking else ""
        tracked = self.person == "is tracked"
        person = f'<avatar name="person" source="external" {place}/>' if tracked else f"<agent {place} {goal}/>"
        pose = '<pose source="external"/>' if self.mirrored else ""
        return TRIAL.format(
            step=STEP, engine=self.engine, person=person, kind=self.kind, heading=self.heading, pose=pose
        )

    def meet(self, after: float = 1.5) -> tuple[Any, tuple[BodyContactEvent, ...], float]:
        """Return world, contact events until some seconds after the first, and closing speed of the bodies [m/s]."""
        run = SimulationRun(Simulation(parse_trial(self.trial())))
        closing, end = 0.0, math.inf
        for tick in range(1, 500):
            before = run.simulation.world.scene.velocity[0].copy()
            run.step(list(self.orders(tick * STEP)))
            world: Any = run.simulation.world
            if world.contact_events and math.isinf(end):
                robot = next(iter(world.robot_bodies))
                difference = before[robot] - before[1 - robot]
                closing = float(difference[0] * math.cos(self.heading) + difference[1] * math.sin(self.heading))
                end = tick * STEP + after
            if tick * STEP >= end:
                break
        return world, world.contact_events, closing


def show(title: str, event: BodyContactEvent, formula: float) -> None:
    """Print a row."""
    print(
        f"{title:44} {event.region:10} {event.impact_speed:6.2f} m/s {event.peak_force:6.0f} N {formula:6.0f} N"
        f" {event.peak_force / formula:5.2f} {event.simulated_peak / formula:5.2f}",
        flush=True,
    )


def ram(mass: float, height: float) -> Robot:
    """Return a robot that is a beam at a height [m], pulled along the floor."""
    text = (
        f"<robot name='ram'><link name='base'><inertial><origin xyz='0 0 {height}'/><mass value='{mass}'/>"
        "<inertia ixx='5' iyy='5' izz='5' ixy='0' ixz='0' iyz='0'/></inertial>"
        f"<collision><origin xyz='0.3 0 {height}'/><geometry><box size='0.1 0.6 0.1'/></geometry></collision></link>"
        "</robot>"
    )
    drive = Omnidirectional(max_speed=5.0, max_turn_rate=1.0, max_acceleration=100.0, max_turn_acceleration=10.0)
    return Robot("ram", read_urdf(text), drive, base="planar")


def regions() -> None:
    """Strike each region of a standing person from ahead and from behind."""
    heights = (0.25, 0.65, 1.05, 1.3, 1.6)
    for speed, height, heading in itertools.product((0.25, 0.5, 1.0), heights, (math.pi, 0.0)):
        place = [[0.0, 0.0], [1.0, 0.0]]
        scene = Scene.of(
            place, goal=place, heading=[0.0, heading], external=[True, False], radius=[0.3, 0.25], max_speed=[1.0, 0.0],
            preferred_speed=[1.0, 0.0],
        )  # fmt: skip
        world = PhysicsWorld(scene, ORCA(), {0: ram(60.0, height)}, 0.02, people=People.of(["man-20"]))
        for _ in range(200):
            world.step({0: Twist(speed)})
        event = world.contact_events[0]
        side = "from ahead" if heading else "from behind"
        formula = two_body_force(speed, 60.0, event.region, float(world.people.people.mass[0]))
        show(f"beam at {height:g} m, {side}, {speed:g} m/s", event, formula)


def meetings(rows: list[Meeting]) -> None:
    """Print the hardest contact of each meeting."""
    for row in rows:
        world, events, closing = row.meet()
        robot = next(iter(world.robot_bodies.values()))
        event = max(events, key=lambda event: event.peak_force)
        formula = two_body_force(closing, robot.mass, event.region, float(world.people.people.mass[0]))
        how = "mirrored" if row.mirrored else "driven"
        who = f"person {row.person}" + (f" at {row.walking:g}" if row.walking else "")
        show(f"{row.kind} {how} at {row.speed:g}, {who}, {row.engine * 1e3:g} ms", event, formula)


def main() -> None:
    """Print the tables."""
    tables = ["regions", "robots", "people"]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "tables", nargs="*", choices=tables, metavar="TABLE", help=f"{', '.join(tables)} (default: all)"
    )
    chosen = parser.parse_args().tables or tables
    print(f"{'impact':44} {'region':10} {'surface':>10} {'peak':>8} {'formula':>8} {'ratio':>5} engine")
    if "regions" in chosen:
        regions()
    if "robots" in chosen:
        kinds = itertools.product(("pepper", "wheelchair", "cuybot", "qolo"), (0.5, 1.0), (False, True))
        rows = [Meeting(kind, speed, mirrored) for kind, speed, mirrored in kinds]
        meetings(rows + [Meeting("pepper", 1.0, True, engine=step, heading=0.7) for step in (0.002, 0.005, 0.01)])
    if "people" in chosen:
        walks = itertools.product(("pepper", "cuybot", "turtlebot2"), ("walks", "is tracked"), (0.7, 1.0, 1.3))
        meetings([Meeting(kind, person=person, walking=speed) for kind, person, speed in walks])


if __name__ == "__main__":
    main()
