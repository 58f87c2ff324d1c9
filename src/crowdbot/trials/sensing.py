"""Sensing: what the sensors of a robot measure, when, and when it is handed over."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, Pose, SpatialPose, stream
from crowdbot.sensors import (
    DepthCamera,
    Infrared,
    Lidar3D,
    Reading,
    RGBCamera,
    Schedule,
    Sensor,
    Tracked,
    Ultrasound,
)
from crowdbot.world.urdf.transforms import quaternion

from .robot import Mount, Robot
from .surroundings import Surroundings

__all__ = ["Probe", "Told", "bodies_for", "named", "probes_of", "spatial"]

Ints = NDArray[np.int64]
SPATIAL = (DepthCamera, Infrared, Lidar3D, RGBCamera, Ultrasound)
"""Sensors that look through space, whatever people are otherwise."""
LEVEL = 1e-9


class Told(NamedTuple):
    """A reading that names people by their ids, and the ids of those whom it shows; None: it shows nobody."""

    reading: Reading
    seen: Ints | None


@dataclass
class Probe:
    """A sensor at work.

    Fields:
        mount: what measures, and where it sits.
        placed: x, y, z [m], roll, pitch, yaw [rad] of it on the robot in its posture.
        schedule: when it measures, and how late its readings arrive.
        rng: its randomness.
        space: whether it looks through space, at bodies; otherwise from above, at discs.
        last: what it measured last, for sensors that remember.
        waiting: tick of arrival of what is on its way.
    """

    mount: Mount
    placed: tuple[float, float, float, float, float, float]
    schedule: Schedule
    rng: np.random.Generator
    space: bool
    last: Reading | None = None
    waiting: list[tuple[int, Told]] = field(default_factory=list)

    def work(self, tick: int, agent: int, around: Surroundings, ids: Ints) -> list[Told]:
        """Measure when it is due, and return what arrives now, oldest first."""
        if self.schedule.measures(tick):
            reading = self._measured(agent, around)
            if self.mount.sensor.remembers:
                self.last = reading
            told = named(reading, ids)
            self.waiting.append((self.schedule.arrives(tick), Told(told, shown(told))))
        ready = [told for due, told in self.waiting if due <= tick]
        self.waiting = [row for row in self.waiting if row[0] > tick]
        return ready

    def _measured(self, agent: int, around: Surroundings) -> Reading:
        sensor: Any = self.mount.sensor
        more: dict[str, Any] = {"last": self.last} if sensor.remembers else {}
        if getattr(sensor, "draws", False):
            more["source"] = around.studio
        scene = (around.space if self.space else around.flat).without(agent)
        reading: Reading = sensor.measure(scene, self.pose(agent, around), self.rng, **more)
        return reading

    def pose(self, agent: int, around: Surroundings) -> Pose | SpatialPose:
        """Return where the sensor is: in the plane when it looks from above, otherwise in space."""
        link, chassis = self.mount.link, around.chassis(agent)
        if chassis is None or (not self.space and not link):
            base = around.pose(agent)
            x, y, z, roll, pitch, yaw = self.placed
            return base.to_spatial(0.0).mounted(x, y, z, roll, pitch, yaw) if self.space else base.mounted(x, y, yaw)
        matrix = chassis.frame(link or chassis.robot.model.root) @ self.mount.origin
        found = SpatialPose(matrix[None, :3, 3].copy(), quaternion(matrix[:3, :3])[None])
        return found if self.space else found.planar


def bodies_for(trial: Any) -> str:
    """Return what people are to sensors: ``discs``, ``limbs`` or ``skins``."""
    return trial.bodies or ("limbs" if trial.world == "physics" else "discs")


def spatial(robot: Robot, mount: Mount, bodies: str) -> bool:
    """Return whether a sensor looks through space."""
    _, _, _, roll, pitch, _ = robot.placed(mount)
    tilted = max(abs(roll), abs(pitch)) > LEVEL
    return bodies != "discs" or tilted or isinstance(mount.sensor, SPATIAL) or _skinned(mount.sensor)


def _skinned(sensor: Sensor) -> bool:
    return bool(getattr(sensor, "skins", False))


def probes_of(
    trial: Any, robot: Robot, clock: Clock, seed: int, known: Mapping[str, Probe] | None = None
) -> tuple[Probe, ...]:
    """Return the sensors of a robot at work; those of ``known`` go on with their chance and what is on its way."""
    bodies = bodies_for(trial)
    found = []
    for mount in robot.sensors:
        sensor = mount.sensor
        more: Any = {"skins": True} if bodies == "skins" and hasattr(sensor, "skins") else {}
        probe = Probe(
            dataclasses.replace(mount, sensor=dataclasses.replace(sensor, **more)) if more else mount,
            robot.placed(mount),
            robot.schedule(mount, clock),
            stream(seed, "sensor", robot.name, mount.name),
            spatial(robot, mount, bodies),
        )
        old = (known or {}).get(mount.name)
        if old is not None:
            same = type(old.mount.sensor) is type(sensor)
            probe = dataclasses.replace(
                probe, rng=old.rng, last=old.last if same else None, waiting=old.waiting if same else []
            )
        found.append(probe)
    return tuple(found)


def named(reading: Reading, ids: Ints) -> Reading:
    """Return a reading in which people are named by who they are, not by their places among the agents."""
    if np.array_equal(ids, np.arange(len(ids))):
        return reading
    if isinstance(reading, Tracked):
        return _tracked(reading, ids)
    hit = getattr(reading, "hit", None)
    if hit is None:
        return reading
    return dataclasses.replace(reading, hit=np.where(hit >= 0, ids[np.maximum(hit, 0)], hit))  # type: ignore[call-arg]


def _tracked(reading: Tracked, ids: Ints) -> Tracked:
    """Return the rows by ids: row k is that of person k."""
    there = np.flatnonzero(ids >= 0)
    count = int(ids.max(initial=-1)) + 1
    rows: dict[str, Any] = {}
    for part in ("present", "position", "velocity", "radius", "heading"):
        value = getattr(reading, part)
        wide = np.full((len(value), count, *value.shape[2:]), False if part == "present" else np.nan)
        wide[:, ids[there]] = value[:, there]
        rows[part] = wide
    return dataclasses.replace(reading, **rows)


def shown(reading: Reading) -> Ints | None:
    """Return the ids of those whom a reading shows; None for readings that cannot show anybody."""
    if isinstance(reading, Tracked):
        return np.flatnonzero(reading.present[0])
    hit = getattr(reading, "hit", None)
    if hit is None or not hasattr(reading, "seen"):
        return None
    return np.asarray(np.unique(hit[hit >= 0]))
