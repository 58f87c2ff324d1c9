"""Images: depth and colour as ``sensor_msgs/Image`` with ``sensor_msgs/CameraInfo``, and back.

An image is on ``<robot>/<sensor>/image``, its intrinsics on ``camera_info`` and the agent of each pixel on ``labels``.
All are in the optical frame of REP-103 (z forward, x right, y down), a child of the frame of the sensor. Colours are
raw rgb8, which all viewers support; chunks of the file are compressed without loss.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import SpatialPose
from crowdbot.sensors import Lens

from .codec import Codec, MeasuredReading

if TYPE_CHECKING:
    from .message_store import Messages


OPTICAL = "_optical"
KINDS = {"32FC1": ("<f4", 1), "32SC1": ("<i4", 1), "rgb8": ("|u1", 3)}
"""Type and number of channels of the encodings."""


def _image(make: Messages, told: MeasuredReading, encoding: str, pixels: NDArray[Any]) -> Any:
    kind, channels = KINDS[encoding]
    rows = np.ascontiguousarray(pixels, dtype=kind)
    return make.make(
        "sensor_msgs/msg/Image",
        header=told.header(make, OPTICAL),
        height=rows.shape[0],
        width=rows.shape[1],
        encoding=encoding,
        is_bigendian=0,
        step=rows.shape[1] * channels * rows.dtype.itemsize,
        data=np.frombuffer(rows.tobytes(), dtype=np.uint8),
    )


def image_in(message: Any) -> NDArray[Any]:
    """Return the pixels ``[H, W]`` or ``[H, W, 3]`` of a ``sensor_msgs/Image``.

    Raises:
        KeyError, ValueError: the encoding is not supported, or the size of the data is wrong.
    """
    kind, channels = KINDS[message.encoding]
    shape = (message.height, message.width) if channels == 1 else (message.height, message.width, channels)
    return np.frombuffer(bytes(message.data), dtype=kind).reshape(shape)


def _camera_info(make: Messages, told: MeasuredReading, lens: Lens) -> Any:
    k = np.array([lens.fx, 0.0, lens.cx, 0.0, lens.fy, lens.cy, 0.0, 0.0, 1.0])
    region = make.make("sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
    return make.make(
        "sensor_msgs/msg/CameraInfo",
        header=told.header(make, OPTICAL),
        height=int(lens.height),
        width=int(lens.width),
        distortion_model="plumb_bob",
        d=np.array(lens.distortion, dtype=np.float64),
        k=k,
        r=np.eye(3).ravel(),
        p=np.column_stack([k.reshape(3, 3), np.zeros(3)]).ravel(),
        binning_x=0,
        binning_y=0,
        roi=region,
    )


def lens_in(message: Any) -> Lens:
    """Return the lens of a ``sensor_msgs/CameraInfo``."""
    fx, _, cx, _, fy, cy = (float(value) for value in message.k[:6])
    return Lens(message.width, message.height, fx, fy, cx, cy, tuple(float(value) for value in message.d))  # type: ignore[arg-type]


def _labels(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    hit = getattr(told.reading, "hit", None)
    return [] if hit is None else [("/labels", _image(make, told, "32SC1", hit[0]))]


def _write_depth(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    return [
        ("/image", _image(make, told, "32FC1", told.reading.depth[0])),
        *_labels(make, told),
        ("/camera_info", _camera_info(make, told, told.reading.lens)),
    ]


def _read_depth(others: Mapping[str, Any], rest: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "depth": image_in(others["/image"])[None],
        "hit": image_in(others["/labels"])[None],
        "lens": lens_in(others["/camera_info"]),
    }


def _write_picture(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    return [
        ("/image", _image(make, told, "rgb8", told.reading.rgb[0])),
        *_labels(make, told),
        ("/camera_info", _camera_info(make, told, told.reading.lens)),
    ]


def _read_picture(others: Mapping[str, Any], rest: Mapping[str, Any]) -> dict[str, Any]:
    labels = others.get("/labels")
    return {
        "rgb": image_in(others["/image"])[None],
        "hit": None if labels is None else image_in(labels)[None],
        "lens": lens_in(others["/camera_info"]),
    }


def _frames(robot: str, topic: str) -> list[tuple[str, str, SpatialPose]]:
    """Return the optical frame: its z axis is the x axis of the sensor, its x axis points right."""
    return [(topic, topic + OPTICAL, SpatialPose.of((0.0, 0.0, 0.0), -0.5 * math.pi, 0.0, -0.5 * math.pi))]


IMAGES = {
    "/image": "sensor_msgs/msg/Image",
    "/labels": "sensor_msgs/msg/Image",
    "/camera_info": "sensor_msgs/msg/CameraInfo",
}
depth_codec = Codec(
    IMAGES, "`image` is 32FC1, `labels` 32SC1 with agent ids", _write_depth, _read_depth, rest=("part",), frames=_frames
)
picture_codec = Codec(
    IMAGES, "`image` is rgb8, `labels` 32SC1 with agent ids", _write_picture, _read_picture, frames=_frames
)
"""Codec of readings with ``rgb`` ``[E, H, W, 3]`` uint8 and a ``lens``; ``hit`` is ``[E, H, W]`` or None."""
