"""MountedSensor: a sensor on a robot with its schedule, latency and state."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, SpatialPose, stream
from crowdbot.sensors import Reading, SensorSchedule, SensorView, TrackedPeople
from crowdbot.trials import Mount, RobotSpec
from crowdbot.world import MountPlacement, World

from .world_view import WorldView

__all__ = ["DeliveredReading", "MountedSensor", "mounted_sensors", "name_by_id", "spatial"]

Ints = NDArray[np.int64]
LEVEL = 1e-9


class DeliveredReading(NamedTuple):
    """A reading with person ids, and the ids of visible people; None for sensors that do not detect people."""

    reading: Reading
    seen: Ints | None


@dataclass
class MountedSensor:
    """A sensor of a running simulation.

    Fields:
        mount: the sensor and its mounting pose.
        placed: x, y, z [m], roll, pitch, yaw [rad] on the robot in its posture.
        schedule: sampling times and latency.
        rng: random number generator.
        space: whether it senses bodies in space; otherwise discs in the plane.
        state: state of the sensor, from its ``begin`` or its last measurement.
        waiting: readings not yet delivered, with their tick of arrival.
    """

    mount: Mount
    placed: tuple[float, float, float, float, float, float]
    schedule: SensorSchedule
    rng: np.random.Generator
    space: bool
    state: Any
    waiting: list[tuple[int, DeliveredReading]] = field(default_factory=list)

    def work(self, tick: int, agent: int, around: WorldView, ids: Ints) -> list[DeliveredReading]:
        """Measure if due, and return the readings that arrive now, oldest first."""
        if self.schedule.measures(tick):
            reading = self._measure(agent, around)
            told = name_by_id(reading, ids)
            self.waiting.append((self.schedule.arrives(tick), DeliveredReading(told, visible_ids(told))))
        ready = [told for due, told in self.waiting if due <= tick]
        self.waiting = [row for row in self.waiting if row[0] > tick]
        return ready

    def _measure(self, agent: int, around: WorldView) -> Reading:
        scene = (around.space if self.space else around.flat).without(agent)
        answer: Any = self.mount.sensor.measure(
            SensorView(scene, self.pose(agent, around), around), self.state, self.rng
        )
        if not (isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[0], Reading)):
            raise InputError(
                f"sensor {type(self.mount.sensor).__name__} {self.mount.name!r}: measure returned a"
                f" {type(answer).__name__}; it must return (reading, state)"
            )
        reading: Reading = answer[0]
        self.state = answer[1]
        return reading

    def pose(self, agent: int, around: WorldView) -> Pose | SpatialPose:
        """Return the pose of the sensor, in the plane or in space."""
        mount = MountPlacement(self.mount.link, self.mount.origin, self.placed)
        return around.world.sensor_pose(agent, mount, self.space)


def spatial(robot: RobotSpec, mount: Mount, bodies: str) -> bool:
    """Return whether a sensor senses bodies in space."""
    _, _, _, roll, pitch, _ = robot.sensor_pose(mount)
    tilted = max(abs(roll), abs(pitch)) > LEVEL
    return bodies != "discs" or tilted or mount.sensor.spatial or mount.sensor.sees_skins


def mounted_sensors(
    trial: Any, robot: RobotSpec, world: World, seed: int, known: Mapping[str, MountedSensor] | None = None
) -> tuple[MountedSensor, ...]:
    """Return the sensors of a robot; those in ``known`` keep their random state and pending readings."""
    bodies = trial.bodies or world.people_shape
    found = []
    for mount in robot.sensors:
        sensor = mount.sensor
        probe = MountedSensor(
            dataclasses.replace(mount, sensor=sensor.with_skins()) if bodies == "skins" else mount,
            robot.sensor_pose(mount),
            robot.schedule(mount, world.clock),
            stream(seed, "sensor", robot.name, mount.name),
            spatial(robot, mount, bodies),
            sensor.begin(),
        )
        old = (known or {}).get(mount.name)
        if old is not None:
            same = type(old.mount.sensor) is type(sensor)
            probe = dataclasses.replace(
                probe, rng=old.rng, state=old.state if same else probe.state, waiting=old.waiting if same else []
            )
        found.append(probe)
    return tuple(found)


def name_by_id(reading: Reading, ids: Ints) -> Reading:
    """Return a reading with person ids instead of agent indices."""
    if np.array_equal(ids, np.arange(len(ids))):
        return reading
    if isinstance(reading, TrackedPeople):
        return _tracked(reading, ids)
    hit = getattr(reading, "hit", None)
    if hit is None:
        return reading
    return dataclasses.replace(reading, hit=np.where(hit >= 0, ids[np.maximum(hit, 0)], hit))  # type: ignore[call-arg]


def _tracked(reading: TrackedPeople, ids: Ints) -> TrackedPeople:
    """Return the rows ordered by id: row k belongs to person k."""
    there = np.flatnonzero(ids >= 0)
    count = int(ids.max(initial=-1)) + 1
    rows: dict[str, Any] = {}
    for part in ("present", "position", "velocity", "radius", "heading"):
        value = getattr(reading, part)
        wide = np.full((len(value), count, *value.shape[2:]), False if part == "present" else np.nan)
        wide[:, ids[there]] = value[:, there]
        rows[part] = wide
    return dataclasses.replace(reading, **rows)


def visible_ids(reading: Reading) -> Ints | None:
    """Return the ids of visible people; None for sensors that do not detect people."""
    if isinstance(reading, TrackedPeople):
        return np.flatnonzero(reading.present[0])
    hit = getattr(reading, "hit", None)
    if hit is None or not hasattr(reading, "visible_agents"):
        return None
    return np.asarray(np.unique(hit[hit >= 0]))
