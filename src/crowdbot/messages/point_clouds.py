"""Point clouds of laser scanners and bumpers as ``sensor_msgs/PointCloud2``, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .codec import Codec, MeasuredReading

if TYPE_CHECKING:
    from .message_store import Messages


NUMBERS = {"<i1": 1, "|i1": 1, "|u1": 2, "<i2": 3, "<u2": 4, "<i4": 5, "<u4": 6, "<f4": 7, "<f8": 8}
"""Types of ``sensor_msgs/PointField``."""
CLOUD = np.dtype(
    {
        "names": ["x", "y", "z", "intensity", "range", "label", "ring"],
        "formats": ["<f4", "<f4", "<f4", "<f4", "<f4", "<i4", "<u2"],
        "offsets": [0, 4, 8, 12, 16, 20, 24],
        "itemsize": 28,
    }
)
LABEL = "label"
"""Field with the id of the agent that was met."""
SECTORS = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("depth", "<f4"), ("label", "<i4"), ("sector", "<u4")])


def _message(make: Messages, told: MeasuredReading, rows: NDArray[Any]) -> Any:
    """Return a cloud of ``[H, W]`` structured rows; without labels the others stay at their places."""
    height, width = rows.shape
    if not told.labelled:
        rows = _without_labels(rows)
    places = rows.dtype.fields
    assert places is not None
    fields = [
        make.make("sensor_msgs/msg/PointField", name=name, offset=place[1], datatype=NUMBERS[place[0].str], count=1)
        for name, place in places.items()
    ]
    size = rows.dtype.itemsize
    return make.make(
        "sensor_msgs/msg/PointCloud2",
        header=told.header(make),
        height=height,
        width=width,
        fields=fields,
        is_bigendian=False,
        point_step=size,
        row_step=size * width,
        data=np.frombuffer(rows.tobytes(), dtype=np.uint8),
        is_dense=bool(np.isfinite(rows["x"]).all()),
    )


def points_in(message: Any) -> NDArray[Any]:
    """Return the points ``[H, W]`` of a ``sensor_msgs/PointCloud2`` as structured rows.

    Raises:
        ValueError: the size of the data is wrong.
    """
    kinds = {number: kind for kind, number in NUMBERS.items()}
    kind = np.dtype(
        {
            "names": [field.name for field in message.fields],
            "formats": [kinds[field.datatype] for field in message.fields],
            "offsets": [field.offset for field in message.fields],
            "itemsize": message.point_step,
        }
    )
    return np.frombuffer(bytes(message.data), dtype=kind).reshape(message.height, message.width)


def _without_labels(rows: NDArray[Any]) -> NDArray[Any]:
    """Return rows of the same size in which the bytes of the label are 0 and no field."""
    rows = rows.copy()
    rows[LABEL] = 0
    assert rows.dtype.names is not None
    return rows[[name for name in rows.dtype.names if name != LABEL]]


def _write_cloud(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    reading = told.reading
    rows = np.zeros(reading.ranges.shape[1:], dtype=CLOUD)
    ends = reading.points()[0]
    for k, axis in enumerate("xyz"):
        rows[axis] = ends[..., k]
    rows["intensity"], rows["range"], rows["label"] = reading.cos_incidence[0], reading.ranges[0], reading.hit[0]
    rows["ring"] = np.arange(len(rows))[:, None]
    return [("", _message(make, told, rows))]


def _read_cloud(others: Mapping[str, Any], rest: Mapping[str, Any]) -> dict[str, Any]:
    rows = points_in(others[""])
    return {
        name: np.ascontiguousarray(rows[column])[None]
        for name, column in (("ranges", "range"), ("hit", "label"), ("cos_incidence", "intensity"))
    }


def _write_touch(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    reading, sensor = told.reading, told.sensor
    count = reading.pressed.shape[1]
    rows = np.zeros((1, count), dtype=SECTORS)
    angle = float(getattr(sensor, "first", 0.0)) + (np.arange(count) + 0.5) * 2.0 * math.pi / count
    radius = np.where(reading.pressed[0], float(getattr(sensor, "radius", 0.0)), np.nan)
    rows["x"], rows["y"] = radius * np.cos(angle), radius * np.sin(angle)
    rows["z"] = np.where(reading.pressed[0], 0.0, np.nan)
    rows["depth"], rows["label"], rows["sector"] = reading.depth[0], reading.hit[0], np.arange(count)
    return [("", _message(make, told, rows))]


def _read_touch(others: Mapping[str, Any], rest: Mapping[str, Any]) -> dict[str, Any]:
    rows = points_in(others[""])
    return {
        "pressed": np.isfinite(rows["x"]),
        "depth": rows["depth"].astype(np.float64),
        "hit": rows["label"].astype(np.int64),
    }


POINT_CLOUD = {"": "sensor_msgs/msg/PointCloud2"}
cloud_codec = Codec(
    POINT_CLOUD,
    "x, y, z, intensity (cosine of incidence), range, label (agent hit), ring",
    _write_cloud,
    _read_cloud,
    rest=("elevation", "azimuth", "part"),
)
touch_codec = Codec(
    POINT_CLOUD,
    "one point per sector, NaN without contact, as `kobuki_bumper2pc` writes it",
    _write_touch,
    _read_touch,
)
