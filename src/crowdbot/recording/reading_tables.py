"""Tables of sensor readings for :func:`crowdbot.recording.export`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from crowdbot.sensors import (
    BumperReading,
    DepthImage,
    ImuReading,
    Odometry,
    PointCloud,
    RangeReading,
    Reading,
    RgbImage,
    TrackedPeople,
    spatial_pose,
)

from .metadata import TWIST
from .step_records import RecordedStep

Columns = dict[str, Any]
PLACE = ("x", "y", "z", "heading")


def _points(reading: Any) -> Columns:
    there = np.isfinite(reading.ranges[0])
    ends = reading.points(in_world=True)[0][there]
    ring = np.broadcast_to(np.arange(len(reading.elevation))[:, None], there.shape)
    return {
        **{f"point_{axis}": ends[:, k] for k, axis in enumerate("xyz")},
        "range": reading.ranges[0][there],
        "intensity": reading.cos_incidence[0][there],
        "ring": ring[there],
        "hit": reading.hit[0][there],
    }


def _ranges(reading: Any) -> Columns:
    return {"range": reading.ranges, "hit": reading.hit}


def _images(reading: Any) -> Columns:
    near = np.where(np.isfinite(reading.depth[0]), reading.depth[0], np.inf).min()
    seen = np.unique(reading.hit[0][reading.hit[0] >= 0])
    return {
        "width": np.array([reading.lens.width]),
        "height": np.array([reading.lens.height]),
        "nearest": np.array([near]),
        "seen": np.array([" ".join(map(str, seen.tolist()))], dtype=object),
    }


def _pictures(reading: Any) -> Columns:
    seen = np.zeros(0, np.int64) if reading.hit is None else np.unique(reading.hit[0][reading.hit[0] >= 0])
    lens = {name: np.array([getattr(reading.lens, name)]) for name in ("width", "height", "fx", "fy", "cx", "cy")}
    return lens | {"seen": np.array([" ".join(map(str, seen.tolist()))], dtype=object)}


def _inertial(reading: Any) -> Columns:
    force = {f"acceleration_{axis}": reading.acceleration[:, k] for k, axis in enumerate("xyz")}
    return force | {f"turn_rate_{axis}": reading.turn_rate[:, k] for k, axis in enumerate("xyz")}


def _odometry(reading: Any) -> Columns:
    estimate = reading.estimate
    return {
        "estimate_x": estimate.position[:, 0],
        "estimate_y": estimate.position[:, 1],
        "estimate_heading": estimate.heading,
        **{word: reading.twist[:, k] for k, word in enumerate(TWIST)},
    }


def _bumpers(reading: Any) -> Columns:
    pressed = np.flatnonzero(reading.pressed[0])
    return {"sector": pressed, "depth": reading.depth[0, pressed], "hit": reading.hit[0, pressed]}


def _tracked(reading: Any) -> Columns:
    who = np.flatnonzero(reading.present[0])
    return {
        "id": who,
        "ahead": reading.position[0, who, 0],
        "left": reading.position[0, who, 1],
        "ahead_speed": reading.velocity[0, who, 0],
        "left_speed": reading.velocity[0, who, 1],
        "person_heading": reading.heading[0, who],
        "radius": reading.radius[0, who],
    }


WHOLE = ("ring", "hit", "width", "height", "sector", "id")
TEXT = ("seen",)
TABLES: dict[str, tuple[type[Reading], Callable[[Any], Columns], tuple[str, ...]]] = {
    "points": (PointCloud, _points, ("point_x", "point_y", "point_z", "range", "intensity", "ring", "hit")),
    "ranges": (RangeReading, _ranges, ("range", "hit")),
    "images": (DepthImage, _images, ("width", "height", "nearest", "seen")),
    "pictures": (RgbImage, _pictures, ("width", "height", "fx", "fy", "cx", "cy", "seen")),
    "inertial": (
        ImuReading,
        _inertial,
        (*(f"acceleration_{axis}" for axis in "xyz"), *(f"turn_rate_{axis}" for axis in "xyz")),
    ),
    "odometry": (
        Odometry,
        _odometry,
        ("estimate_x", "estimate_y", "estimate_heading", *TWIST),
    ),
    "bumpers": (BumperReading, _bumpers, ("sector", "depth", "hit")),
    "tracked": (
        TrackedPeople,
        _tracked,
        ("id", "ahead", "left", "ahead_speed", "left_speed", "person_heading", "radius"),
    ),
}


def _kind(name: str) -> Any:
    return object if name in TEXT else np.int64 if name in WHOLE else np.float64


def _table(kind: type[Reading], rows: Callable[[Any], Columns], names: tuple[str, ...]) -> Callable[..., Columns]:
    """Return a function that creates the rows of a step from all readings of a class."""

    def columns(moment: RecordedStep, bodies: Mapping[str, tuple[int, float]]) -> Columns:
        found: dict[str, list[Any]] = {name: [] for name in ("time", "sensor", *PLACE, *names)}
        for topic, reading in moment.readings.items():
            if not isinstance(reading, kind):
                continue
            values = rows(reading)
            count = len(values[names[0]])
            pose = spatial_pose(reading.pose)
            where = (*pose.position[0].tolist(), float(pose.heading[0]))
            found["time"].append(np.full(count, reading.time))
            found["sensor"].append(np.array([topic] * count, dtype=object))
            for word, value in zip(PLACE, where, strict=True):
                found[word].append(np.full(count, value))
            for name in names:
                found[name].append(values[name])
        kinds = {"sensor": object}
        return {
            name: np.concatenate([np.zeros(0, kinds.get(name, _kind(name))), *parts]).astype(
                kinds.get(name, _kind(name))
            )
            for name, parts in found.items()
        }

    return columns


READING_TABLES: dict[str, Callable[..., Columns]] = {name: _table(*row) for name, row in TABLES.items()}
"""Functions that create the columns of a step, by table name."""
