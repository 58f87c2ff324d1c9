"""State frames of a running simulation: everything that moves, as arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, kernel
from crowdbot.sensors import Infrared, Lidar2D, Lidar3D, Ultrasound
from crowdbot.simulation import Simulation
from crowdbot.typing import Floats
from crowdbot.web.state_frame import StateFrame
from crowdbot.world import PeopleMotion, worlds_of

from .crowd_layers import collision_lines, density_field
from .quaternions import quaternions
from .scene_instant import SceneInstant
from .scene_revision import scene_revision
from .sensor_arrays import cloud_array, range_array, scan_array

BONE_UNIT = 32767.0
"""Quaternions are sent in units of ``1 / BONE_UNIT``."""


@kernel
def _pack(rotation: Floats, rows: NDArray[np.int64], out: NDArray[np.int16]) -> None:
    """Write the quaternions w, x, y, z of the bones of some people; the largest of the four is positive."""
    for n in range(len(rows)):
        for b in range(rotation.shape[1]):
            r = rotation[rows[n], b]
            s, x, y, z = r[0, 0] + r[1, 1] + r[2, 2], r[0, 0], r[1, 1], r[2, 2]
            if s >= x and s >= y and s >= z:
                q = 1.0 + s, r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
            elif x >= y and x >= z:
                q = r[2, 1] - r[1, 2], 1.0 + x - y - z, r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]
            elif y >= z:
                q = r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], 1.0 - x + y - z, r[1, 2] + r[2, 1]
            else:
                q = r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], 1.0 - x - y + z
            unit = 32767.0 / math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
            for k in range(4):
                out[n, 4 * b + k] = np.int16(math.floor(q[k] * unit + 0.5))


def pack_bones(rotation: Floats, rows: NDArray[np.int64]) -> NDArray[np.int16]:
    """Return quaternions w, x, y, z ``[N, 4 B]`` in units of 1/32767, the largest part of each positive.

    Args:
        rotation: rotations ``[P, B, 3, 3]`` of the bones of all people.
        rows: people ``[N]`` whose bones are returned.

    >>> pack_bones(np.eye(3)[None, None], np.array([0])).tolist()
    [[32767, 0, 0, 0]]
    """
    result = np.empty((len(rows), 4 * rotation.shape[1]), dtype=np.int16)
    _pack(rotation, rows, result)
    return result


Arrays = dict[str, NDArray[Any]]
LAYERS = {
    "scans": "Laser returns",
    "clouds": "Points of laser scanners in space",
    "ranges": "Sonar and infrared cones",
    "forces": "Contact forces",
    "goals": "Goals of people and robots",
    "paths": "Predicted paths, 4.8 s",
    "density": "Density of people [1/m²]",
    "ttc": "Time to collision below 3 s",
}
"""Layers that are computed only when asked for: names and titles."""


def scene_frame(simulation: Simulation, layers: Collection[str] = (), people: PeopleMotion | None = None) -> StateFrame:
    """Return what moves in the first environment of a simulation, channel ``scene``.

    Arrays, N people and R robots that are present: ``revision`` of the description that fits; ``who`` [N] row of a
    person in the description; ``ids`` [N]; ``place`` [N, 5] x, y [m], heading [rad] and velocity [m/s]; ``pelvis``
    [N, 3] [m] position of the first bone; ``bones`` [N, 112] quaternions w, x, y, z of the 28 bones in the world,
    relative to the rest shape, in units of 1/32767; ``bots`` [R] row of a robot in the description; ``botplace``
    [R, 5]; ``links`` [L, 7] position and quaternion of the links with shapes of these robots, one robot after the
    other; ``doors`` [D]; ``props`` [P, 7] pose of movable props, and ``propnum`` [P] their numbers. Layers add:
    ``scanK`` and ``poseK`` for scanner K of the description; ``cloudK`` [M, 3]; ``cones``; ``forces`` [F, 6] point [m]
    and vector [N]; ``goals`` [N, 2]; ``paths`` [P, 2 (S + 1)] and their step, see :class:`PredictedPaths`; ``density``
    [H, W] and ``densbox`` [3], see :func:`density_field`; ``ttc`` [C, 5], see :func:`collision_lines`.

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
    return instant_frame(SceneInstant.of(simulation, people), layers)


def instant_frame(instant: SceneInstant, layers: Collection[str] = ()) -> StateFrame:
    """Return the frame of an instant, see :func:`scene_frame`.

    Raises:
        InputError: a layer is unknown.
    """
    unknown = [name for name in layers if name not in LAYERS]
    if unknown:
        raise InputError(f"layer {unknown[0]!r} of a scene does not exist; layers are {', '.join(LAYERS)}")
    motion, scene = instant.motion, instant.scene
    rows = np.flatnonzero(scene.active[0][motion.agents])
    agents = motion.agents[rows]
    posture = motion.posture()
    arrays: Arrays = {
        "revision": np.array([scene_revision(instant.simulation, motion)], dtype=np.uint32),
        "who": rows.astype(np.uint16),
        "ids": instant.ids[agents].astype(np.int32),
        "place": _places(scene, agents),
        "pelvis": posture.position[rows, 0].astype(np.float32),
        "bones": pack_bones(posture.rotation, rows),
    }
    arrays |= _robots(instant) | _things(instant.simulation)
    for layer in layers:
        arrays |= MAKERS[layer](instant, agents)
    return StateFrame("scene", instant.time, arrays)


def _places(scene: Any, agents: NDArray[np.int64]) -> NDArray[np.float32]:
    heading = scene.heading[0, agents, None]
    return np.concatenate([scene.position[0, agents], heading, scene.velocity[0, agents]], axis=1).astype(np.float32)


def _robots(instant: SceneInstant) -> Arrays:
    present = [(k, robot) for k, robot in enumerate(instant.simulation.robots) if instant.scene.active[0, robot.agent]]
    agents = np.array([item.agent for _, item in present], dtype=np.int64)
    links = [instant.links(item) for _, item in present]
    return {
        "bots": np.array([k for k, _ in present], dtype=np.uint16),
        "botplace": _places(instant.scene, agents),
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


def _readings(instant: SceneInstant, kinds: tuple[type, ...]) -> list[tuple[int, Any, Any]]:
    """Return number, sensor and reading of the sensors of some kinds; numbers are those of the description."""
    every = [(robot, sensor) for robot in instant.simulation.robots for sensor in robot.sensors]
    found = [
        (k, sensor, instant.reading(robot, sensor))
        for k, (robot, sensor) in enumerate(every)
        if isinstance(sensor.mount.sensor, kinds) and instant.scene.active[0, robot.agent]
    ]
    return [row for row in found if row[2] is not None]


def _scans(instant: SceneInstant, agents: Any) -> Arrays:
    found = Arrays()
    for number, sensor, reading in _readings(instant, (Lidar2D,)):
        found |= scan_array(number, reading, sensor)
    return found


def _clouds(instant: SceneInstant, agents: Any) -> Arrays:
    found = Arrays()
    for number, _, reading in _readings(instant, (Lidar3D,)):
        found |= cloud_array(number, reading)
    return found


def _ranges(instant: SceneInstant, agents: Any) -> Arrays:
    rows = [range_array(reading, sensor) for _, sensor, reading in _readings(instant, (Ultrasound, Infrared))]
    return {"cones": np.array(rows, dtype=np.float32).reshape(-1, 9)}


def _forces(instant: SceneInstant, agents: Any) -> Arrays:
    return {"forces": np.array(instant.forces(), dtype=np.float32).reshape(-1, 6)}


def _goals(instant: SceneInstant, agents: NDArray[np.int64]) -> Arrays:
    return {"goals": instant.scene.goal[0, agents].astype(np.float32)} if instant.goals_known else {}


def _paths(instant: SceneInstant, agents: Any) -> Arrays:
    return {"paths": instant.paths()}


def _density(instant: SceneInstant, agents: NDArray[np.int64]) -> Arrays:
    field, place = density_field(instant.scene.position[0, agents])
    return {"density": field, "densbox": place}


def _ttc(instant: SceneInstant, agents: Any) -> Arrays:
    return {"ttc": collision_lines(instant.scene)}


MAKERS: dict[str, Callable[[SceneInstant, NDArray[np.int64]], Arrays]] = {
    "scans": _scans,
    "clouds": _clouds, "ranges": _ranges, "forces": _forces, "goals": _goals, "paths": _paths,
    "density": _density, "ttc": _ttc,
}  # fmt: skip
