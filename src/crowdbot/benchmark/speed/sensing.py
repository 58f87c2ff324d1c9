"""Workloads of sensors and perception: rays at limbs and skins, posing and skinning, tracking and future scans."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from crowdbot.core import Bodies, Pose, Scene, Skins, SpatialPose, Walls, import_optional, stream
from crowdbot.perception import (
    Detector,
    GlobalNearestNeighbor,
    InteractingMultipleModel,
    JointProbabilisticDataAssociation,
    LidarClusters,
    ScanNetwork,
    TrackedScene,
    Tracker,
)
from crowdbot.sensors import Gaussian, Lidar2D, Lidar3D, Scan, triangles_one_by_one, unit_vectors

from .measurement import Measurement

LIMBS = 15
"""Capsules of a person."""
POSED, OFTEN, ALLOWED = 100, 100, 0.01
"""Number of people who are posed, repeats per work, and reference time of one repeat [s]."""
PEOPLE, SCANS, BEAMS, PERIOD = 20, 20, 1080, 0.1
LIMIT = 0.005
"""Time for a scan [s], the reference."""
FUTURE, FORECAST_LIMIT = 10, 0.02
"""Number of future scans, and the time for them [s], the reference."""
TRACKING_PAIRS: dict[str, tuple[type[Detector], type[Tracker]]] = {
    "track-1080": (LidarClusters, GlobalNearestNeighbor),
    "track-1080-multiple": (LidarClusters, InteractingMultipleModel),
    "track-1080-joint": (LidarClusters, JointProbabilisticDataAssociation),
    "track-1080-network": (ScanNetwork, GlobalNearestNeighbor),
    "track-1080-network-multiple": (ScanNetwork, InteractingMultipleModel),
    "track-1080-network-joint": (ScanNetwork, JointProbabilisticDataAssociation),
}
"""Detectors and trackers by the name of their row."""


def rays_of_limbs(rings: int = 0) -> Measurement:
    """Compare scans among 50 people with 15 limbs with MuJoCo rays on the same capsules, walls and floor."""
    scene, pose = _people_with_limbs(50), Pose.of((5.0, 5.0), 0.3).to_spatial()
    sensor: Any = Lidar3D(columns=1800) if rings else Lidar2D(rays=1080, field_of_view=1.5 * np.pi, range_max=30.0)
    theirs = _mujoco_rays(scene, sensor, pose)
    words = "mj_multiRay of MuJoCo with the same 750 capsules, 4 walls and the floor"
    ours, others = (40, 1) if rings else (300, 10)  # similar durations, so that changes of the load affect both
    return Measurement(
        "scans/s", ours, lambda: [sensor.read(scene, pose) for _ in range(ours)], words,
        other=lambda: [theirs() for _ in range(others)], other_amount=others,
    )  # fmt: skip


def _people_with_limbs(people: int) -> Scene:
    """Return people at 0.5 per square metre in a room, each with 15 capsules from 0.1 to 1.6 m above the floor."""
    random = stream(0, "limbs")
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


def _mujoco_rays(scene: Scene, sensor: Any, pose: SpatialPose) -> Callable[[], Any]:
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


def posing_and_skinning() -> Measurement:
    """Return the work of posing 100 walkers and deforming their skins at the lowest level of detail.

    >>> posing_and_skinning().reference
    10000.0
    """
    from crowdbot import humans

    work = humans.posing_and_skinning(POSED, level=2)
    words = f"{POSED} people in {1000 * ALLOWED:.0f} ms"
    return Measurement("people/s", POSED * OFTEN, lambda: [work() for _ in range(OFTEN)], words, POSED / ALLOWED)


def rays_of_skins(level: int) -> Measurement:
    """Compare scans of 16 x 1800 beams at the skins of 50 people with tests of their triangles one by one.

    A scan takes the vertices of another instant each time, so that the boxes of the tree have to follow.

    >>> rays_of_skins(2).unit
    'scans/s'
    """
    lidar, pose, scenes = Lidar3D(columns=1800, skins=True), SpatialPose.of((5.0, 5.0, 1.0), yaw=0.3), _dressed(level)
    words = f"their triangles one by one in one thread, 50 people at level of detail {level}"
    return Measurement(
        "scans/s", 4 * len(scenes), lambda: [lidar.read(scene, pose) for scene in 4 * scenes], words,
        other=triangles_one_by_one(lidar, scenes[0], pose), other_amount=1.0,
    )  # fmt: skip


def _dressed(level: int) -> list[Scene]:
    """Return five instants of walking people at 0.5 per square metre in a room, as skins."""
    from crowdbot.humans import Gait, People

    people, random = 50, stream(0, "skins")
    side = math.sqrt(people / 0.5)
    place, heading = random.uniform(0.0, side, (people, 2)), random.uniform(-math.pi, math.pi, people)
    who = People.sample(people, random)
    gait, worn = Gait(who, 0), who.clothing_mask(level)
    velocity = 1.3 * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    state, scenes, owner = gait.start(place, heading, velocity), [], np.repeat(np.arange(people), worn.sum(axis=1))
    room, first = [[(-2, -2), (-2, side + 2), (side + 2, side + 2), (side + 2, -2)]], None
    for _ in range(5):
        points = gait.skin(state, level=level)
        if first is None:
            faces = np.concatenate([who.faces(level)[own] + k * points.shape[1] for k, own in enumerate(worn)])
            first = Skins.of(points.reshape(1, -1, 3), faces, owner)
        skins = Skins(points.reshape(1, -1, 3), first.faces, first.owner, first.part)
        scenes.append(Scene.of(place, walls=room, bodies=Bodies.of(skins=skins)))
        place = place + 0.1 * velocity
        state = gait.step(state, place, velocity, heading, 0.1)
    return scenes


def tracking(detects: type[Detector], tracks_by: type[Tracker]) -> Measurement:
    """Detect and track 20 people who walk around a scanner of 1080 beams at 10 Hz, inside a room of known walls."""
    scans, walls = _scans()
    detector, tracker = detects(), tracks_by()

    def follow() -> int:
        state: Any = tracker.begin()
        for k, scan in enumerate(scans):
            tracks, state = tracker.update(detector.detect(scan, walls), PERIOD * k, state)
        return len(tracks)

    found = follow()
    words = f"5 ms for a scan (one core, {found} of {PEOPLE} people tracked)"
    return Measurement("scans/s", SCANS, follow, words, 1.0 / LIMIT)


def scan_prediction() -> Measurement:
    """Predict 10 future scans of 1080 beams from the scans of 20 people, without a map."""
    predictor, state = TrackedScene(), TrackedScene().begin()
    for scan in _scans()[0]:
        state = predictor.update(scan, state)
    ahead = PERIOD * np.arange(1.0, FUTURE + 1.0)

    def look_ahead() -> int:
        return len(predictor.forecast(state, ahead).ranges[0])

    look_ahead()
    words = f"20 ms for {FUTURE} future scans (one core, {len(state.tracks)} people tracked)"
    return Measurement("predictions/s", 1, look_ahead, words, 1.0 / FORECAST_LIMIT)


def _scans() -> tuple[list[Scan], Walls]:
    """Return scans of people who walk around the scanner in a room, and the walls of the room."""
    lidar, rng = Lidar2D(rays=BEAMS, range_max=20.0, noise=Gaussian(0.01)), np.random.default_rng(0)
    angle = np.linspace(0.0, 2.0 * np.pi, PEOPLE, endpoint=False)
    radius = np.where(np.arange(PEOPLE) % 2, 3.0, 5.5)
    scans = []
    for k in range(SCANS):
        turn = angle + 1.2 * PERIOD * k / radius
        place = radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        room = [[(-8.0, -8.0), (-8.0, 8.0), (8.0, 8.0), (8.0, -8.0), (-8.0, -8.0)]]
        scene = Scene.of(place, radius=0.25, walls=room).replace(time=PERIOD * k)
        scans.append(lidar.read(scene, Pose.of((0.0, 0.0), 0.0), rng))
    return scans, scene.walls
