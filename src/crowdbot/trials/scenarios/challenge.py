"""Challenge: the 21 scenarios of the challenge "Crowd against the machine" of the CrowdBot project (ICRA 2021).

A corridor of 50 m by 10 m, empty or with one of five flows of 50, 100, 200 or 350 people (0.1 to 0.7 people/m2), who
enter at one end or side after leaving at the other. The robot goes 40 m along the middle. Parameters are those of the
public scenario files: preferred speeds of 1.33 +- 0.30 m/s, bodies of 0.33 m, and a Turtlebot that is a disc of 0.5 m
for the crowd. It is that disc in the planar world, and has the body of a TurtleBot 2 in the physics world. As in the
challenge, a contact does not end the trial; the goal or 180 s do.
Accelerations are limited to 5 m/s2 by default, as in the examples of UMANS; the files have 0.8 m/s2.
"""

from __future__ import annotations

import functools
import math

from crowdbot.trials.builtin_names import FLOWS, SIZES, TITLES
from crowdbot.trials.crowd import Limits
from crowdbot.trials.journey import Journey
from crowdbot.trials.people import Spawner
from crowdbot.trials.stage import Stage
from crowdbot.trials.trial import End, RobotSpec, Trial
from crowdbot.world import ContactModel, Portal, Zone

from .crowds import DEEP, ends
from .parts import box, corridor, number, robot, scenario, uniform
from .preset import Preset, PresetOption

__all__ = ["CHALLENGE", "FLOWS", "SIZES"]

LENGTH, WIDTH = 50.0, 10.0
FAR = LENGTH / 2.0 + 5.0
JOURNEYS = {
    "east": Zone(box(FAR, -4.5, FAR + 1.0, 4.5), aim="random"),
    "west": Zone(box(-FAR - 1.0, -4.5, -FAR, 4.5), aim="random"),
    "south": Zone(box(-24.0, -11.0, 24.0, -10.0), aim="nearest"),
    "north": Zone(box(-24.0, 10.0, 24.0, 11.0), aim="nearest"),
}
"""Goals of people, beyond the portals, so nobody reaches them."""


def turtlebot() -> RobotSpec:
    """Return the robot: as in the challenge it follows commands at once; it has the laser scanner of all presets."""
    plain = robot((-20.0, 0.0), (20.0, 0.0), 0.65, radius=0.5)
    return RobotSpec(
        type="turtlebot2",
        x=plain.x,
        y=plain.y,
        radius=plain.radius,
        latency=0.0,
        default_sensors=False,
        goal=plain.goal,
        drive=plain.drive,
        navigator=plain.navigator,
        sensors=plain.sensors,
    )


def challenge(kind: str, people: int, acceleration: float) -> Trial:
    """Return one scenario."""
    ways = FLOWS[kind][2] if kind else ()
    crossing = kind.startswith("cross")
    zone = box(-24.5, -4.25, 24.5, 4.25)
    sizes = [people // 2, people - people // 2] if len(ways) == 2 else [people]
    top = LENGTH / 2.0
    sides = (
        Portal(name="low", zone=box(-top, -5.0 - DEEP, top, -5.0), dy=WIDTH),
        Portal(name="high", zone=box(-top, 5.0, top, 5.0 + DEEP), dy=-WIDTH),
    )
    return scenario(
        f"challenge-{kind}-{people}" if kind else "challenge-alone",
        180.0,
        Stage() if crossing else corridor(LENGTH + 12.0, WIDTH),
        contact=ContactModel(),
        limits=Limits(max_speed=3.0, max_acceleration=acceleration if math.isfinite(acceleration) else None),
        journeys=[Journey(name=way, then="stay", stops=(JOURNEYS[way],)) for way in ways],
        spawners=[
            Spawner(name=way, count=count, zone=zone, journey=way, speed=uniform(1.03, 1.63), radius=number(0.33))
            for way, count in zip(ways, sizes, strict=False)
            if count
        ],
        portals=() if not ways else sides if crossing else ends(LENGTH, WIDTH),
        robots=[turtlebot()],
        end=End(collision=False),
    )


def _presets() -> tuple[Preset, ...]:
    braking = PresetOption(5.0, "maximum acceleration of people", "m/s2", 0.1, 100.0)
    found = [
        Preset(
            "challenge-alone",
            TITLES["challenge-alone"],
            functools.partial(challenge, "", 0),
            {"acceleration": braking},
            model="orca",
        )
    ]
    for kind in FLOWS:
        found += [
            Preset(
                f"challenge-{kind}-{size}",
                TITLES[f"challenge-{kind}-{size}"],
                functools.partial(challenge, kind),
                {"people": PresetOption(size, "people", "", 0, 600), "acceleration": braking},
                model="orca",
            )
            for size in SIZES
        ]
    return tuple(found)


CHALLENGE = _presets()
