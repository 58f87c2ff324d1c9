"""Run the physics world for long and print what became of it: ``python tools/endurance.py [MINUTES] [PEOPLE]``.

People walk to and fro in a closed room with tables and a cube, a robot drives about among them. Printed are the speed
against real time, the memory at quarters of the run, what collided, and whether everything is still in the room.
"""

from __future__ import annotations

import re
import sys
import time
from pathlib import Path

import numpy as np

from crowdbot.core import Scene, Twist, stream
from crowdbot.models import ORCA
from crowdbot.world import ContactModel, Cube, PhysicsStage, PhysicsWorld, Robot, Table

HALF, DT = 12.0, 0.1


def made(people: int) -> tuple[PhysicsWorld, int]:
    """Return the world and the agent that is the robot."""
    robot = Robot.load("cuybot")
    side = int(np.ceil(np.sqrt(people)))
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)[:people]
    place = (grid + 0.5) / side * 2.0 * (HALF - 1.0) - (HALF - 1.0)
    place[np.hypot(*place.T) < 1.5] += 1.0
    room = [(-HALF, -HALF), (-HALF, HALF), (HALF, HALF), (HALF, -HALF)]
    scene = Scene.of(
        np.vstack([place, [0.0, 0.0]]),
        radius=np.append(np.full(people, 0.25), robot.radius),
        external=np.append(np.zeros(people, dtype=bool), True),
        goal=np.vstack([place, [0.0, 0.0]]),
        max_speed=1.8,
        walls=[room],
    )
    stage = PhysicsStage(props=(Cube(3.0, 2.0, mass=15.0), Table(-6.0, 5.0), Table(6.0, -6.0, heading=1.0)))
    return PhysicsWorld(
        scene, ORCA(), {people: robot}, DT, stage=stage, contact=ContactModel(), heading_jitter=1e-3
    ), people


def sent_on(scene: Scene, draw: np.random.Generator) -> Scene:
    """Return the scene in which everyone who has arrived has another goal."""
    arrived = np.hypot(*np.moveaxis(scene.goal - scene.position, -1, 0)) < 1.0
    goal = draw.uniform(1.0 - HALF, HALF - 1.0, scene.goal.shape)
    return scene.replace(goal=np.where((arrived & ~scene.external)[..., None], goal, scene.goal))


def memory() -> float:
    """Return the memory of this process [MB]."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024


def run(minutes: float, people: int) -> None:
    """Run, and print."""
    world, robot = made(people)
    steps, used, farthest = round(minutes * 60.0 / DT), [], 0.0
    draw = stream(0, "goals")
    begin = time.perf_counter()
    for k in range(steps):
        world.scene = sent_on(world.scene, draw)
        x, y = world.scene.position[0, robot]
        heading = float(world.scene.heading[0, robot])
        home = np.arctan2(-y, -x) - heading
        far = max(abs(x), abs(y)) > HALF - 2.5
        turn = float(np.arctan2(np.sin(home), np.cos(home))) if far else 0.6 * np.sin(0.05 * k)
        scene = world.step({robot: Twist(0.5, turn)})
        here = scene.position[scene.active]
        assert np.all(np.isfinite(here))
        assert np.all(np.isfinite(world.data.qpos))
        farthest = max(farthest, float(np.abs(here).max()), float(np.abs(world.prop(0)[:2, 3]).max()))
        if (k + 1) % max(1, steps // 4) == 0:
            used.append(round(memory(), 1))
    took = time.perf_counter() - begin
    events = [event for event in world.contact_events if event.second.kind == "person"]
    print(f"{minutes:g} simulated minutes, {people} people: {minutes * 60.0 / took:.1f} times real time")
    print(f"memory at quarters of the run [MB]: {used}")
    print(
        f"farthest from the middle: {farthest:.2f} m of {HALF} m; robot tilt {world.robot_bodies[robot].tilt:.4f} rad"
    )
    print(
        f"{len(world.contact_events)} contact events, {len(events)} with people;"
        f" {world.skipped_people} people without a body at the end"
    )
    for kind in ("robot", "prop"):
        some = [event for event in events if event.first.kind == kind]
        for name in ("impact_speed", "peak_force", "steady_force", "simulated_peak", "severity") if some else ():
            shares = np.percentile([getattr(event, name) for event in some], (50, 90, 100))
            middle, most, worst = shares.round(2)
            print(f"{len(some)} with a {kind}: {name} median {middle}, 90 % {most}, largest {worst}")


if __name__ == "__main__":
    given = [float(word) for word in sys.argv[1:]]
    run(given[0] if given else 10.0, int(given[1]) if len(given) > 1 else 100)
