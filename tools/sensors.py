"""Draw the rays of every range sensor in a populated scene: ``python tools/sensors.py docs/gallery/sensors``."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np

import crowdbot as cb
from crowdbot.core import Bodies, SpatialPose, stream
from crowdbot.sensors import DepthCamera, Infrared, Lidar2D, Lidar3D, Ultrasound
from crowdbot.sensors.beams import cone_directions
from crowdbot.sensors.range_finders import teardrop

PARTS = ("head", "trunk", "arm", "leg")
ROOM = [(-6.0, -5.0), (-6.0, 5.0), (6.0, 5.0), (6.0, -5.0)]
COLOURS = {"person": "tab:red", "wall": "0.25", "floor": "tab:olive", "prop": "tab:blue"}


def person(
    x: float, y: float, heading: float, stride: float
) -> list[tuple[tuple[float, ...], tuple[float, ...], float, int]]:
    """Return limbs of a standing or striding figure: start, end, radius, part."""
    ahead, left = (
        np.array([math.cos(heading), math.sin(heading), 0.0]),
        np.array([-math.sin(heading), math.cos(heading), 0.0]),
    )
    here = np.array([x, y, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    found = [(here + 1.0 * up, here + 1.35 * up, 0.15, 1), (here + 1.62 * up, here + 1.66 * up, 0.11, 0)]
    for side, swing in ((1.0, stride), (-1.0, -stride)):
        hip, shoulder = here + side * 0.1 * left + 0.9 * up, here + side * 0.22 * left + 1.38 * up
        knee, foot = hip + 0.5 * swing * ahead - 0.42 * up, hip + swing * ahead - 0.82 * up
        hand = shoulder - 0.6 * swing * ahead - 0.55 * up
        found += [
            (hip, knee, 0.08, 3),
            (knee, foot, 0.06, 3),
            (foot, foot + 0.16 * ahead, 0.05, 3),
            (shoulder, hand, 0.05, 2),
        ]
    return [(tuple(a), tuple(b), r, p) for a, b, r, p in found]


def scene() -> cb.Scene:
    """Return people, a table, a post and a low wall in a room."""
    rng = stream(3, "picture")
    place = np.array(
        [[2.2, 0.4], [3.4, -1.4], [1.0, 2.4], [-2.0, 1.6], [-2.6, -2.2], [4.3, 2.2], [0.8, -2.6], [2.9, 3.4]]
    )
    heading = rng.uniform(-math.pi, math.pi, len(place))
    limbs = [(*limb, a) for a, (x, y) in enumerate(place) for limb in person(x, y, heading[a], rng.uniform(0.05, 0.35))]
    start, end, radius, part, owner = zip(*limbs, strict=True)
    bodies = Bodies.of(
        start=start, end=end, radius=radius, part=part, owner=owner, parts=PARTS,
        box_centre=[[4.6, -3.4, 0.375]], box_half=[[0.6, 0.4, 0.375]],
        box_turn=[[math.cos(0.2), 0.0, 0.0, math.sin(0.2)]],
        post_foot=[[-4.0, 3.0, 0.0]], post_radius=[0.2], post_height=[2.5],
    )  # fmt: skip
    return cb.Scene.of(
        place, heading=heading, walls=[ROOM, [(-1.0, -3.6), (1.5, -3.6)]], wall_height=2.5, bodies=bodies
    )


def colours(hit: np.ndarray) -> np.ndarray:
    """Return a colour for everything that was hit."""
    names = np.select([hit >= 0, hit == -2, hit == -3], ["person", "wall", "floor"], "prop")
    return np.array([matplotlib.colors.to_rgba(COLOURS[name]) for name in names.ravel()])


def plan(axes: plt.Axes, world: cb.Scene, pose: SpatialPose) -> None:
    """Draw the scene from above."""
    for x, y, to_x, to_y in world.walls.segments():
        axes.plot([x, to_x], [y, to_y], color="0.25", lw=2)
    bodies = world.bodies
    for a, b, r in zip(bodies.start[0], bodies.end[0], bodies.radius[0], strict=True):
        for t in np.linspace(0.0, 1.0, 6):
            axes.add_patch(plt.Circle((a + t * (b - a))[:2], r, color="0.8", zorder=0))
    axes.add_patch(plt.Circle(bodies.post_foot[0, 0, :2], bodies.post_radius[0, 0], color="tab:blue", alpha=0.4))
    turn = SpatialPose(np.zeros((1, 3)), bodies.box_turn[0]).matrix[0][:2, :2]
    half = bodies.box_half[0, 0, :2]
    ring = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half @ turn.T + bodies.box_centre[0, 0, :2]
    axes.add_patch(plt.Polygon(ring, color="tab:blue", alpha=0.4))
    axes.plot(*pose.position[0, :2], "k^", ms=8)
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")


def saved(figure: plt.Figure, path: Path) -> None:
    """Write a picture."""
    figure.tight_layout()
    figure.savefig(path, dpi=80)
    plt.close(figure)


def lidar2d(world: cb.Scene, folder: Path) -> None:
    """Level at the height of legs, and tilted towards the floor."""
    figure, both = plt.subplots(1, 2, figsize=(13, 5.6))
    lidar = Lidar2D(rays=361, field_of_view=math.radians(270.0), range_max=8.0)
    for axes, (title, pitch, z) in zip(
        both, (("level, 0.4 m high", 0.0, 0.4), ("tilted by 12 deg, 0.9 m high", 0.21, 0.9)), strict=True
    ):
        pose = SpatialPose.of((-0.3, -0.2, z), pitch=pitch, yaw=0.2)
        scan = lidar.read(world, pose)
        plan(axes, world, pose)
        ends, finite = scan.points()[0], np.isfinite(scan.ranges[0])
        for end in ends[finite]:
            axes.plot([pose.position[0, 0], end[0]], [pose.position[0, 1], end[1]], color="tab:orange", lw=0.3)
        axes.scatter(*ends[finite, :2].T, c=colours(scan.hit[0][finite]), s=7, zorder=3)
        axes.set_title(f"Lidar2D, {title}: {finite.sum()} of {len(finite)} beams return")
    saved(figure, folder / "lidar2d.png")


def space(axes: plt.Axes, points: np.ndarray, hit: np.ndarray, size: float) -> None:
    """Draw points in space."""
    axes.scatter(*points.T, c=colours(hit), s=size, depthshade=False)
    axes.set_box_aspect((12, 10, 3), zoom=1.5)
    axes.set_xlim(-6, 6)
    axes.set_ylim(-5, 5)
    axes.set_zlim(0, 3)
    axes.view_init(32, -75)


def lidar3d(world: cb.Scene, folder: Path) -> None:
    """All points of a turn."""
    figure = plt.figure(figsize=(12, 7))
    axes = figure.add_subplot(projection="3d")
    pose = SpatialPose.of((-0.3, -0.2, 1.1), yaw=0.2)
    sensor = Lidar3D(columns=900, elevations=tuple(np.radians(np.linspace(-25, 15, 24))))
    cloud = sensor.read(world, pose)
    finite = np.isfinite(cloud.ranges[0])
    space(axes, cloud.points(in_world=True)[0][finite], cloud.hit[0][finite], 1.2)
    axes.plot(*pose.position.T, "k^", ms=8)
    axes.set_title(
        f"Lidar3D, 24 rings of 900 beams: {finite.sum()} return (red people, grey walls, green floor, blue props)"
    )
    saved(figure, folder / "lidar3d.png")


def echoes(world: cb.Scene, folder: Path) -> None:
    """Zones of ultrasound and infrared, and what they found."""
    figure, both = plt.subplots(1, 2, figsize=(13, 5.6))
    sonar = Ultrasound(radius=0.94, range_max=2.5, rays=1500, max_incidence=math.radians(50.0))
    infrared = Infrared(dispersion=math.radians(8.0), range_max=1.5, rays=400)
    for axes, sensor in zip(both, (sonar, infrared), strict=True):
        plan(axes, world, SpatialPose.of((0.0, 0.0, 1.0)))
        for yaw in np.radians([8.0, 60.0, 120.0, 180.0, 235.0, 300.0]):
            pose = SpatialPose.of((0.8 + 0.2 * math.cos(yaw), 0.2 + 0.2 * math.sin(yaw), 0.6), yaw=yaw)
            angle = np.linspace(-1.0, 1.0, 301) * getattr(sensor, "half_angle", math.radians(8.0)) * 0.99999
            reach = (
                teardrop(angle, sensor.radius, sensor.range_max) if sensor is sonar else np.full(301, sensor.range_max)
            )
            edge = pose.position[0, :2] + reach[:, None] * np.column_stack([np.cos(yaw + angle), np.sin(yaw + angle)])
            axes.add_patch(plt.Polygon(np.vstack([pose.position[0, :2], edge]), fill=False, color="tab:orange", lw=1))
            echo = sensor.read(world, pose)
            if np.isfinite(echo.ranges[0]):
                end = pose.position[0] + echo.ranges[0] * pose.matrix[0] @ echo.direction[0]
                axes.plot([pose.position[0, 0], end[0]], [pose.position[0, 1], end[1]], color="tab:orange", lw=1.5)
                axes.scatter(*end[:2], c=colours(echo.hit), s=40, zorder=3)
                axes.annotate(f"{echo.ranges[0]:.2f} m", end[:2], fontsize=9, xytext=(4, 4), textcoords="offset points")
        axes.set_xlim(-3, 4.5)
        axes.set_ylim(-3.5, 3.5)
        axes.set_title(f"{type(sensor).__name__}: zones at a height of 0.6 m and the nearest return")
    saved(figure, folder / "echoes.png")


def cones(folder: Path) -> None:
    """How rays fill a zone."""
    figure, (axes, front) = plt.subplots(1, 2, figsize=(12, 4.5))
    sonar = Ultrasound(radius=0.94, range_max=2.5)
    directions = cone_directions(sonar.half_angle, 400)
    off = np.arctan2(np.hypot(directions[:, 1], directions[:, 2]), directions[:, 0])
    ends = directions * teardrop(np.minimum(off, sonar.half_angle), sonar.radius, sonar.range_max)[:, None]
    axes.scatter(ends[:, 0], ends[:, 1], s=5)
    u = np.linspace(0.0, 1.0, 400)
    rho = sonar.radius * 16 / (3 * math.sqrt(3)) * u * np.sqrt(u * (1 - u))
    axes.plot(u * 2.5, rho, "k", u * 2.5, -rho, "k", lw=1)
    axes.set_title("ends of 400 rays and the teardrop, from the side")
    axes.set_aspect("equal")
    front.scatter(directions[:, 1], directions[:, 2], s=5)
    front.set_title("their directions, seen along the axis")
    front.set_aspect("equal")
    saved(figure, folder / "teardrop.png")


def depth(world: cb.Scene, folder: Path) -> None:
    """Depth and labels of a camera, with and without the error of stereo."""
    figure, three = plt.subplots(1, 3, figsize=(17, 4.2))
    pose = SpatialPose.of((-2.0, -0.6, 1.1), pitch=0.12, yaw=0.15)
    plain = DepthCamera(width=424, height=240, field_of_view=math.radians(90.0))
    noisy = DepthCamera(width=424, height=240, field_of_view=math.radians(90.0), baseline=0.05, disparity_noise=0.08,
                        disparity_step=1 / 32)  # fmt: skip
    image, error = plain.read(world, pose), noisy.read(world, pose, stream(1))
    shown = three[0].imshow(np.where(np.isfinite(image.depth[0]), image.depth[0], np.nan), cmap="viridis_r")
    figure.colorbar(shown, ax=three[0], label="depth [m]")
    label = np.where(image.hit[0] >= 0, 4 + image.part[0], -image.hit[0])
    three[1].imshow(label, cmap="tab10", interpolation="nearest")
    both = np.isfinite(error.depth[0]) & np.isfinite(image.depth[0])
    wrong = np.full(both.shape, np.nan)
    wrong[both] = error.depth[0][both] - image.depth[0][both]
    shown = three[2].imshow(wrong, cmap="coolwarm", vmin=-0.3, vmax=0.3)
    figure.colorbar(shown, ax=three[2], label="error of stereo [m]")
    for axes, title in zip(
        three, ("depth by rays", "what the pixels show, people by part", "error, 50 mm, 0.08 pixels"), strict=True
    ):
        axes.set_title(title)
    saved(figure, folder / "depth.png")


def main(folder: Path) -> None:
    """Draw everything."""
    folder.mkdir(parents=True, exist_ok=True)
    world = scene()
    lidar2d(world, folder)
    lidar3d(world, folder)
    echoes(world, folder)
    cones(folder)
    depth(world, folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
