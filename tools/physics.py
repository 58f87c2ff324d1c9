"""Draw the pictures of the physics world: ``python tools/physics.py docs/gallery/physics``."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.image import imsave

from crowdbot.core import Scene, Twist, stream
from crowdbot.models import ORCA
from crowdbot.world import Cube, PhysicsStage, PhysicsWorld, Robot, SceneCamera, Table, Tree, builtin_robots


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
    props = (
        Table(4.0, 5.8),
        Tree(-5.5, 5.0, height=4.0, crown=1.1),
        Cube(2.0, -3.5),
        Cube(2.3, -4.4, size=0.3),
    )
    world = PhysicsWorld(scene, ORCA(), {people: robot}, 0.1, stage=PhysicsStage(props=props))
    for _ in range(20):
        world.step({people: Twist(0.3, 0.1)})
    return world


def robots(folder: Path) -> None:
    """Draw every robot that ships beside a person."""
    figure = Figure(figsize=(12, 7), layout="constrained")
    for axes, name in zip(figure.subplots(2, 4).flat, builtin_robots(), strict=True):
        robot = Robot.load(name)
        place = [[0.0, 0.0], [-0.3, 1.1]]
        scene = Scene.of(place, goal=place, heading=[0.0, 0.0], external=[True, False], radius=[robot.radius, 0.25])
        world = PhysicsWorld(scene, ORCA(), {0: robot}, 0.1, riders=[0] if name.endswith("rider") else [])
        world.step({0: Twist()})
        camera = SceneCamera((2.6, -1.6, 1.5), (0.0, 0.35, 0.75), 560, 480, detail=0, shadows=True, view=0.85)
        axes.imshow(world.render(camera).rgb)
        axes.set_title(name)
        axes.axis("off")
    figure.savefig(folder / "robots.png", dpi=80)


def cameras(folder: Path) -> None:
    """Draw a populated stage: from outside, and colours, depth and segmentation from the robot."""
    world = crowd(Robot.load("pepper"), 28)
    outside = SceneCamera((-6.4, -4.0, 2.9), (-0.9, 0.7, 0.7), 1000, 560, detail=0, shadows=True, view=0.66)
    imsave(folder / "stage.png", world.render(outside).rgb)
    robot = max(world.robot_bodies)
    seen = world.render(
        SceneCamera((0.1, 0.0, 1.15), (2.0, 0.0, 1.0), robot=robot, detail=0), depth=True, segmentation=True
    )
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


def rays(folder: Path) -> None:
    """Draw what a laser of a robot meets among limbs, from above, and where one LiDAR meets the world, in space."""
    world = crowd(Robot.load("qolo"), 28)
    robot = max(world.robot_bodies)
    robot_body, seen = world.robot_body(robot), world.body_scene()
    figure = Figure(figsize=(12, 5.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    scan = robot_body.robot.mount("lidar_front").sensor.read(
        seen.without(robot), robot_body.sensor_pose("lidar_front"), stream(0, "scan")
    )
    ends, hit = scan.points()[0], scan.hit[0]
    start = robot_body.sensor_pose("lidar_front").position[0]
    for end in ends[np.isfinite(ends[:, 0]) & (np.hypot(*(ends - start).T[:2]) < 9.0)]:
        left.plot([start[0], end[0]], [start[1], end[1]], color="0.85", linewidth=0.6, zorder=1)
    limbs = world.limbs()
    here = limbs.radius[0] > 0.0
    left.plot(
        *np.stack([limbs.start[0, here], limbs.end[0, here]])[..., :2].transpose(2, 0, 1),
        color="0.6",
        linewidth=1.2,
        zorder=0,
    )
    left.scatter(*ends[hit >= 0].T[:2], c="tab:red", s=6, zorder=3, label="people")
    left.scatter(*ends[hit < 0].T[:2], c="tab:blue", s=6, zorder=2, label="walls and props")
    left.set(xlim=(-6, 6), ylim=(-5, 7.5), aspect="equal", xlabel="x [m]", ylabel="y [m]")
    left.set_title("lidar_front of Qolo, 160 degrees")
    left.legend(loc="lower left")
    cloud = robot_body.robot.mount("velodyne_front").sensor.read(
        seen.without(robot), robot_body.sensor_pose("velodyne_front")
    )
    points, who = cloud.points(in_world=True)[0].reshape(-1, 3), cloud.hit[0].ravel()
    near = np.isfinite(points[:, 0]) & (np.abs(points[:, 0]) < 8.0) & (np.abs(points[:, 1]) < 8.0)
    view = np.array([0.77, 0.64]) @ points[near, :2].T
    right.scatter(view, points[near, 2] + 0.12 * (np.array([-0.64, 0.77]) @ points[near, :2].T), s=0.5,
                  c=np.where(who[near] >= 0, who[near] * 7 % 20 + 1, 0), cmap="tab20")  # fmt: skip
    right.set(aspect="equal", title="velodyne_front: VLP-16, people by colour")
    right.axis("off")
    figure.savefig(folder / "rays.png", dpi=80)


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/gallery/physics")
    target.mkdir(parents=True, exist_ok=True)
    robots(target)
    cameras(target)
    rays(target)
