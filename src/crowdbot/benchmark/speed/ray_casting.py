"""Scenes for timing rays at people with limbs, and MuJoCo rays at the same shapes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from crowdbot.core import Bodies, Scene, SpatialPose, import_optional, stream
from crowdbot.sensors.beams import unit_vectors

LIMBS = 15


def people_with_limbs(people: int, seed: int = 0) -> Scene:
    """Return people at 0.5 per square metre in a room, each with 15 capsules from 0.1 to 1.6 m above the floor."""
    random = stream(seed, "limbs")
    side = math.sqrt(people / 0.5)
    place = random.uniform(0.0, side, (people, 2))
    flat = np.repeat(place, LIMBS, axis=0) + random.uniform(-0.2, 0.2, (people * LIMBS, 2))
    start = np.column_stack([flat, np.tile(np.linspace(0.1, 1.6, LIMBS), people)])
    way = random.normal(size=start.shape)
    end = start + way / np.linalg.norm(way, axis=1, keepdims=True) * random.uniform(0.15, 0.4, (len(start), 1))
    end[:, 2] = np.clip(end[:, 2], 0.06, 1.8)
    radius = random.uniform(0.04, 0.12, len(start))
    bodies = Bodies.of(start=start, end=end, radius=radius, owner=np.repeat(np.arange(people), LIMBS))
    return Scene.of(place, walls=[[(-2, -2), (-2, side + 2), (side + 2, side + 2), (side + 2, -2)]], bodies=bodies)


def mujoco_rays(scene: Scene, sensor: Any, pose: SpatialPose) -> Callable[[], Any]:
    """Return a function that casts the beams of the sensor with ``mj_multiRay``: distances, normals and geometries.

    Raises:
        MissingExtra: MuJoCo is not installed.
    """
    mujoco = import_optional("mujoco", "the comparison with MuJoCo", "sim")
    spec = mujoco.MjSpec()
    spec.memory = 64 * 2**20
    world, shapes = spec.worldbody, mujoco.mjtGeom
    world.add_geom(type=shapes.mjGEOM_PLANE, size=[0, 0, 1])
    half = 0.5 * scene.wall_height
    for x, y, to_x, to_y in scene.walls.segments():
        angle, middle = 0.5 * math.atan2(to_y - y, to_x - x), [0.5 * (x + to_x), 0.5 * (y + to_y), half]
        turn, size = [math.cos(angle), 0, 0, math.sin(angle)], [0.5 * math.hypot(to_x - x, to_y - y), 1e-6, half]
        world.add_geom(type=shapes.mjGEOM_BOX, size=size, pos=middle, quat=turn)
    bodies = scene.bodies or Bodies.of()
    for start, end, radius in zip(bodies.start[0], bodies.end[0], bodies.radius[0], strict=True):
        limb = world.add_body(mocap=True)  # limbs move independently
        limb.add_geom(type=shapes.mjGEOM_CAPSULE, fromto=[*start, *end], size=[radius, 0, 0])
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    elevations = np.array(getattr(sensor, "elevations", (0.0,)))
    azimuth = sensor.azimuth if hasattr(sensor, "azimuth") else sensor.angles
    rays = np.ascontiguousarray(unit_vectors(azimuth, elevations[:, None]).reshape(-1, 3) @ pose.matrix[0].T).ravel()
    count = len(rays) // 3
    which, distance, normal = np.zeros(count, np.int32), np.zeros(count), np.zeros(3 * count)

    def cast() -> Any:
        mujoco.mj_multiRay(
            model, data, pose.position[0], rays, None, 1, -1, which, distance, normal, count, sensor.range_max
        )
        return distance

    return cast
