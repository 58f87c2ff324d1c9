"""State frames of a running simulation: everything that moves, as arrays."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.sensors import Infrared, Lidar2D, Lidar3D, Ultrasound
from crowdbot.simulation import RobotControl, Simulation
from crowdbot.web.state_frame import StateFrame
from crowdbot.world import PeopleMotion, worlds_of

from .quaternions import quaternions
from .robot_links import link_poses
from .scene_revision import scene_revision
from .sensor_arrays import cloud_array, range_array, scan_array

__all__ = ["LAYERS", "scene_frame"]

Floats = NDArray[np.float64]
Arrays = dict[str, NDArray[Any]]
LAYERS = {
    "scans": "Laser returns",
    "clouds": "Points of laser scanners in space",
    "ranges": "Sonar and infrared cones",
    "forces": "Contact forces",
    "goals": "Goals of people and robots",
}
"""Layers that are computed only when asked for: names and titles."""
BONE_UNIT = 32767.0
"""Quaternions are sent in units of ``1 / BONE_UNIT``."""


def scene_frame(simulation: Simulation, layers: Collection[str] = (), people: PeopleMotion | None = None) -> StateFrame:
    """Return what moves in the first environment of a simulation, channel ``scene``.

    Arrays, N people and R robots that are present: ``revision`` of the description that fits; ``who`` [N] row of a
    person in the description; ``ids`` [N]; ``place`` [N, 5] x, y [m], heading [rad] and velocity [m/s]; ``pelvis``
    [N, 3] [m] position of the first bone; ``bones`` [N, 112] quaternions w, x, y, z of the 28 bones in the world,
    relative to the rest shape, in units of 1/32767; ``bots`` [R] row of a robot in the description; ``botplace``
    [R, 5]; ``links`` [L, 7] position and quaternion of the links with shapes of these robots, one robot after the
    other; ``doors`` [D]; ``props`` [P, 7] pose of movable props, and ``propnum`` [P] their numbers. Layers add:
    ``scanK`` and ``poseK`` for scanner K of the description; ``cloudK`` [M, 3]; ``cones``; ``forces`` [F, 6] point [m]
    and vector [N]; ``goals`` [N, 2].

    Args:
        simulation: the simulation; ``posed=True``, unless ``people`` is given.
        layers: names of :data:`LAYERS`.
        people: bodies and gaits, for a simulation without them.

    Raises:
        InputError: the simulation has no bodies of people, or a layer is unknown.

    >>> from crowdbot.trials import load_trial
    >>> simulation = Simulation(load_trial("frontal"), posed=True)
    >>> simulation.advance()
    >>> frame = scene_frame(simulation, ["scans"])
    >>> frame.arrays["bones"].shape, frame.arrays["links"].shape[1]
    ((1, 112), 7)
    """
    unknown = [name for name in layers if name not in LAYERS]
    if unknown:
        raise InputError(f"layer {unknown[0]!r} of a scene does not exist; layers are {', '.join(LAYERS)}")
    motion = people or _motion(simulation)
    scene = simulation.world.environment_scene(0)
    active = scene.active[0]
    rows = np.flatnonzero(active[motion.agents])
    agents = motion.agents[rows]
    posture = motion.posture()
    bones = np.round(BONE_UNIT * quaternions(posture.rotation[rows]))
    arrays: Arrays = {
        "revision": np.array([scene_revision(simulation, motion)], dtype=np.uint32),
        "who": rows.astype(np.uint16),
        "ids": simulation.world.ids[0, agents].astype(np.int32),
        "place": _places(scene, agents),
        "pelvis": posture.position[rows, 0].astype(np.float32),
        "bones": bones.astype(np.int16).reshape(len(rows), 4 * posture.rotation.shape[1]),
    }
    arrays |= _robots(simulation, scene) | _things(simulation)
    for layer in layers:
        arrays |= MAKERS[layer](simulation, scene, agents)
    return StateFrame("scene", float(simulation.world.times[0]), arrays)


def _motion(simulation: Simulation) -> PeopleMotion:
    motion = worlds_of(simulation.world)[0].people
    if motion is None:
        raise InputError("the simulation has no bodies of people: make it with posed=True")
    found: PeopleMotion = motion
    return found


def _places(scene: Any, agents: NDArray[np.int64]) -> NDArray[np.float32]:
    heading = scene.heading[0, agents, None]
    return np.concatenate([scene.position[0, agents], heading, scene.velocity[0, agents]], axis=1).astype(np.float32)


def _robots(simulation: Simulation, scene: Any) -> Arrays:
    present = [(k, one) for k, one in enumerate(simulation.robots) if scene.active[0, one.agent]]
    agents = np.array([one.agent for _, one in present], dtype=np.int64)
    links = [link_poses(simulation, scene, one) for _, one in present]
    return {
        "bots": np.array([k for k, _ in present], dtype=np.uint16),
        "botplace": _places(scene, agents),
        "links": np.concatenate([np.zeros((0, 7)), *links]).astype(np.float32),
    }


def _things(simulation: Simulation) -> Arrays:
    """Return the arrays of doors and movable props."""
    world, found = worlds_of(simulation.world)[0], Arrays()
    if world.doors is not None:
        found["doors"] = world.doors.signed_share.astype(np.float32)
    props = world.stage.props if world.walls_fixed else ()
    moved = [k for k, prop in enumerate(props) if prop.movable]
    if moved:
        frames = np.stack([world.prop(k) for k in moved])
        poses = np.concatenate([frames[:, :3, 3], quaternions(frames[:, :3, :3])], axis=1)
        found |= {"props": poses.astype(np.float32), "propnum": np.array(moved, dtype=np.uint16)}
    return found


def _sensors(simulation: Simulation, kinds: tuple[type, ...]) -> list[tuple[int, RobotControl, Any]]:
    """Return number, robot and sensor of the sensors of some kinds; numbers are those of the description."""
    every = [(robot, sensor) for robot in simulation.robots for sensor in robot.sensors]
    return [(k, robot, one) for k, (robot, one) in enumerate(every) if isinstance(one.mount.sensor, kinds)]


def _scans(simulation: Simulation, scene: Any, agents: Any) -> Arrays:
    found = Arrays()
    for number, robot, sensor in _sensors(simulation, (Lidar2D,)):
        reading = sensor.reading(0)
        if reading is not None and scene.active[0, robot.agent]:
            found |= scan_array(number, reading, sensor)
    return found


def _clouds(simulation: Simulation, scene: Any, agents: Any) -> Arrays:
    found = Arrays()
    for number, robot, sensor in _sensors(simulation, (Lidar3D,)):
        reading = sensor.reading(0)
        if reading is not None and scene.active[0, robot.agent]:
            found |= cloud_array(number, reading)
    return found


def _ranges(simulation: Simulation, scene: Any, agents: Any) -> Arrays:
    rows = [
        range_array(number, sensor)
        for number, robot, sensor in _sensors(simulation, (Ultrasound, Infrared))
        if sensor.reading(0) is not None and scene.active[0, robot.agent]
    ]
    return {"cones": np.array(rows, dtype=np.float32).reshape(-1, 9)}


def _forces(simulation: Simulation, scene: Any, agents: Any) -> Arrays:
    rows = [(*one.point, *one.vector) for one in simulation.world.forces_of(0)]
    return {"forces": np.array(rows, dtype=np.float32).reshape(-1, 6)}


def _goals(simulation: Simulation, scene: Any, agents: NDArray[np.int64]) -> Arrays:
    return {"goals": scene.goal[0, agents].astype(np.float32)}


MAKERS: dict[str, Callable[[Simulation, Any, NDArray[np.int64]], Arrays]] = {
    "scans": _scans,
    "clouds": _clouds, "ranges": _ranges, "forces": _forces, "goals": _goals,
}  # fmt: skip
