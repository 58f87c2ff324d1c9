"""Draw the pictures of the physics world: ``python tools/physics.py docs/physics``."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.image import imsave

from crowdbot.core import Scene, Twist, stream
from crowdbot.models import ORCA
from crowdbot.world import Robot, builtin_robots
from crowdbot.world.physics import Camera, Cube, PhysicsStage, PhysicsWorld, Table, Tree


def crowd(robot: Robot, people: int) -> PhysicsWorld:
    """Return people on a square with a robot in the middle, the last agent."""
    draw = stream(0, "pictures")
    side = math.ceil(math.sqrt(people))
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)[:people]
    place = (grid + 0.5) / side * 10.0 - 5.0 + draw.uniform(-0.3, 0.3, (people, 2))
    goal = draw.uniform(-5.0, 5.0, (people, 2))
    scene = Scene.of(
        np.vstack([place, [0.0, 0.0]]), goal=np.vstack([goal, [0.0, 0.0]]), max_speed=1.8,
        radius=np.append(np.full(people, 0.25), robot.radius), external=np.append(np.zeros(people, dtype=bool), True),
        active=np.append(np.hypot(*place.T) > robot.radius + 0.5, True), walls=[[(-7.0, 7.0), (7.0, 7.0)]],
    )  # fmt: skip
    props = (Table(4.0, 5.8), Tree(-5.5, 5.0, height=4.0, crown=1.1), Cube(2.0, -3.5), Cube(2.3, -4.4, size=0.3))
    world = PhysicsWorld(scene, ORCA(), {people: robot}, 0.1, stage=PhysicsStage(props=props))
    for _ in range(20):
        world.step({people: Twist(0.3, 0.1)})
    return world


def robots(folder: Path) -> None:
    """Draw every robot that ships beside a person."""
    figure = Figure(figsize=(12, 7), layout="constrained")
    for axes, name in zip(figure.subplots(2, 3).flat, builtin_robots(), strict=True):
        robot = Robot.load(name)
        place = [[0.0, 0.0], [-0.3, 1.1]]
        scene = Scene.of(place, goal=place, heading=[0.0, 0.0], external=[True, False], radius=[robot.radius, 0.25])
        world = PhysicsWorld(scene, ORCA(), {0: robot}, 0.1)
        world.step({0: Twist()})
        camera = Camera((2.6, -1.6, 1.5), (0.0, 0.35, 0.75), 560, 480, detail=0, shadows=True, view=0.85)
        axes.imshow(world.render(camera).rgb)
        axes.set_title(name)
        axes.axis("off")
    figure.savefig(folder / "robots.png", dpi=80)


def cameras(folder: Path) -> None:
    """Draw a populated stage: from outside, and colours, depth and segmentation from the robot."""
    world = crowd(Robot.load("pepper"), 40)
    outside = Camera((-7.0, -8.0, 3.5), (0.0, 0.5, 0.6), 1000, 560, detail=1, shadows=True, view=0.75)
    imsave(folder / "stage.png", world.render(outside).rgb)
    robot = max(world.chassis)
    seen = world.render(Camera((0.1, 0.0, 1.15), (2.0, 0.0, 1.0), robot=robot, detail=0), depth=True, segmentation=True)
    figure = Figure(figsize=(13, 3.6), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    left.imshow(seen.rgb)
    shown = middle.imshow(np.where(np.isinf(seen.depth), np.nan, seen.depth), vmax=12.0, cmap="viridis_r")
    figure.colorbar(shown, ax=middle, label="depth [m]")
    right.imshow(np.where(seen.segmentation >= 0, seen.segmentation * 7 % 20, np.nan), cmap="tab20")
    for axes, title in ((left, "RGB"), (middle, "depth"), (right, "who is where")):
        axes.set_title(title)
        axes.axis("off")
    figure.savefig(folder / "cameras.png", dpi=80)


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/physics")
    target.mkdir(parents=True, exist_ok=True)
    robots(target)
    cameras(target)
