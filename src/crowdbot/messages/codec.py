"""Codec: conversion of a class of readings to messages and back, including arrays without a standard message."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Pose, SpatialPose

if TYPE_CHECKING:
    from .message_store import Messages


MOST = 1 << 27
"""Maximum number of elements of an array, a protection against damaged files."""


class MeasuredReading(NamedTuple):
    """A reading with its sensor.

    Fields:
        reading: the reading, E = 1.
        sensor: the sensor.
        robot: name of the robot.
        topic: ``robot/sensor``, also the name of its frame.
        labelled: whether the standard messages say which agent each beam or sector met.
    """

    reading: Any
    sensor: Any
    robot: str
    topic: str
    labelled: bool = True

    @property
    def nanoseconds(self) -> int:
        """Time of the measurement [ns]."""
        return round(float(self.reading.time) * 1e9)

    def header(self, make: Messages, ending: str = "") -> Any:
        """Return the header of its messages; ``ending`` is appended to the frame."""
        return make.header(self.nanoseconds, self.topic + ending)


Rows = list[tuple[str, Any]]


def _no_frames(robot: str, topic: str) -> list[tuple[str, str, SpatialPose]]:
    return []


@dataclass(frozen=True)
class Codec:
    """Conversion of a class of readings to messages and back.

    Fields:
        types: types of the standard messages by suffix of the topic.
        about: what the messages hold beyond their type, for the reference page.
        write: returns standard messages with the suffixes of their topics.
        read: returns the fields in standard messages by suffix; receives the remaining fields, too.
        rest: fields that the standard messages do not contain.
        short: fields of ``rest`` that are stored in 32 bits.
        frames: static frames of the messages by robot and topic: parent, child, and pose of the child.
    """

    types: Mapping[str, str]
    about: str
    write: Callable[[Messages, MeasuredReading], Rows]
    read: Callable[[Mapping[str, Any], Mapping[str, Any]], dict[str, Any]]
    rest: tuple[str, ...] = ()
    short: tuple[str, ...] = ()
    frames: Callable[[str, str], list[tuple[str, str, SpatialPose]]] = _no_frames


def pack_arrays(
    fields: Mapping[str, Any], short: Sequence[str] = ()
) -> Iterator[tuple[str, str, NDArray[np.uint32], NDArray[np.uint8]]]:
    """Yield name, type, shape and bytes of arrays and poses; a constant array is stored as one number.

    >>> [(name, kind, len(data)) for name, kind, _, data in pack_arrays({"part": np.full((1, 360), -1)})]
    [('part', '<i8', 8)]
    """
    for name, value in fields.items():
        if isinstance(value, SpatialPose):
            yield from pack_arrays({f"{name}.position": value.position, f"{name}.rotation": value.rotation})
        elif isinstance(value, Pose):
            yield from pack_arrays({f"{name}.position": value.position, f"{name}.heading": value.heading})
        else:
            array = np.ascontiguousarray(value, dtype=np.float32 if name in short else None)
            flat = array.reshape(-1)
            same = flat.size > 1 and flat[:1].tobytes() * flat.size == flat.tobytes()
            data = np.frombuffer((flat[:1] if same else flat).tobytes(), dtype=np.uint8)
            yield name, array.dtype.str, np.array(array.shape, dtype=np.uint32), data


def unpack_arrays(fields: Iterable[Any]) -> dict[str, Any]:
    """Return the arrays and poses of ``crowdbot_msgs/Array`` messages by name.

    Raises:
        ValueError: an array does not match its description.
    """
    result: dict[str, Any] = {}
    for field in fields:
        kind = np.dtype(field.dtype)
        shape = tuple(int(size) for size in field.shape)
        if kind.kind not in "fiub" or math.prod(shape) > MOST:
            raise ValueError(f"{field.name} has an invalid type {field.dtype} or shape {shape}")
        flat = np.frombuffer(bytes(field.data), dtype=kind)
        if kind.kind == "f":
            flat = flat.astype(np.float64)
        many = len(flat) != 1 or math.prod(shape) == 1
        result[field.name] = flat.reshape(shape) if many else np.broadcast_to(flat[0], shape)
    for name in [name.removesuffix(".position") for name in result if name.endswith(".position")]:
        place = result.pop(f"{name}.position")
        turn, heading = result.pop(f"{name}.rotation", None), result.pop(f"{name}.heading", None)
        result[name] = Pose(place, heading) if turn is None else SpatialPose(place, turn)
    return result


def mount_pose(robot: Any, mount: Any) -> SpatialPose:
    """Return the pose of a sensor on its robot; a mount may define it."""
    if hasattr(robot, "sensor_pose"):
        x, y, z, roll, pitch, yaw = robot.sensor_pose(mount)
        return SpatialPose.of((x, y, z), roll, pitch, yaw)
    return SpatialPose.of((mount.x, mount.y, 0.0), yaw=mount.heading)
