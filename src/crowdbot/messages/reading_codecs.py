"""Codecs of sensor readings, the message types of the topics of a sensor, and their reference table.

A reading is stored as messages of standard ROS types and one ``crowdbot_msgs/Reading`` with its class, the exact pose
and fields that the standard types do not contain (labels of body parts, biases, true velocities). Fields that a
standard type stores in 32 bits have that precision when read back.

Add a class of readings with one row in :data:`CODECS`. The table in ``docs/reference/recording.md``, the types on the
topics of a sensor and the bridges use this row.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot import sensors
from crowdbot.core import EpisodeError, builtin_classes
from crowdbot.sensors import (
    BumperReading,
    DepthImage,
    ImuReading,
    Infrared,
    Odometry,
    PointCloud,
    PulsedScan,
    RangeReading,
    Reading,
    RgbImage,
    Scan,
    Sensor,
    TrackedPeople,
)

from .codec import Codec, MeasuredReading, pack_arrays, unpack_arrays
from .images import depth_codec, picture_codec
from .point_clouds import cloud_codec, touch_codec

if TYPE_CHECKING:
    from .message_store import Messages


KIND = "crowdbot_msgs/msg/Reading"
REST = "/reading"
"""Suffix of the topic of the message with the remaining fields."""


KIND_NAMES = {
    "BumperReading": "Touch",
    "ImuReading": "Inertial",
    "PointCloud": "Cloud",
    "RangeReading": "Echo",
    "RgbImage": "Picture",
    "TrackedPeople": "Tracked",
}
"""Class names in recordings, where they differ from Python."""
FIELD_NAMES = {"cos_incidence": "facing"}
"""Field names in recordings, where they differ from Python."""


def recorded_name(kind: type[Reading]) -> str:
    """Return the name of a class of readings in recordings."""
    return KIND_NAMES.get(kind.__name__, kind.__name__)


def encode_reading(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    """Return the messages of a reading with the suffixes of their topics.

    Raises:
        EpisodeError: the class of the reading is not in the table.
    """
    codec = codec_of(type(told.reading), told.topic)
    reading = told.reading
    rest = {"pose": reading.pose} | {FIELD_NAMES.get(name, name): getattr(reading, name) for name in codec.rest}
    rest = {name: value for name, value in rest.items() if value is not None}
    fields = [
        make.make("crowdbot_msgs/msg/Array", name=name, dtype=kind, shape=shape, data=data)
        for name, kind, shape, data in pack_arrays(rest, codec.short)
    ]
    kind = next(cls for cls in type(reading).__mro__ if cls in CODECS)
    whole = make.make(KIND, header=told.header(make), kind=recorded_name(kind), fields=fields)
    return [*codec.write(make, told), (REST, whole)]


def codec_of(kind: type[Reading], topic: str = "") -> Codec:
    """Return the codec of a class of readings, or of its nearest parent class in the table.

    Raises:
        EpisodeError: there is no codec.
    """
    for cls in kind.__mro__:
        if cls in CODECS:
            return CODECS[cls]
    known = ", ".join(cls.__name__ for cls in CODECS)
    raise EpisodeError(
        f"sensor {topic!r} returns a {kind.__name__}, which has no ROS message; return one of {known}, or run"
        " without out"
    )


def decode_reading(whole: Any, others: Mapping[str, Any]) -> Reading:
    """Return the reading from messages.

    Args:
        whole: ``crowdbot_msgs/Reading``.
        others: standard messages by suffix of their topic.

    Raises:
        KeyError, ValueError: the messages do not match.
    """
    kind = next(cls for cls in CODECS if recorded_name(cls) == whole.kind)
    names = {recorded: name for name, recorded in FIELD_NAMES.items()}
    rest = {names.get(name, name): value for name, value in unpack_arrays(whole.fields).items()}
    pose = rest.pop("pose")
    stamp = whole.header.stamp
    fields = CODECS[kind].read(others, rest) | rest
    made: Reading = kind((stamp.sec * 1_000_000_000 + stamp.nanosec) / 1e9, pose, **fields)
    return made


def _write_scan(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    reading, sensor = told.reading, told.sensor
    angles = reading.angles
    step = getattr(sensor, "step", float(angles[1] - angles[0]) if len(angles) > 1 else 0.0)
    scan = make.make(
        "sensor_msgs/msg/LaserScan",
        header=told.header(make),
        angle_min=float(angles[0]),
        angle_max=float(angles[-1]),
        angle_increment=float(step),
        time_increment=0.0,
        scan_time=1.0 / float(sensor.rate),
        range_min=float(getattr(sensor, "range_min", 0.0)),
        range_max=float(getattr(sensor, "range_max", math.inf)),
        ranges=reading.ranges[0].astype(np.float32),
        intensities=reading.hit[0].astype(np.float32) if told.labelled else np.zeros(0, dtype=np.float32),
    )
    return [("", scan)]


def _read_scan(others: Mapping[str, Any], rest: Mapping[str, Any]) -> dict[str, Any]:
    scan = others[""]
    return {
        "ranges": scan.ranges.astype(np.float64)[None],
        "angles": scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges)),
        "hit": scan.intensities.astype(np.int64)[None],
    }


def _write_pulses(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    """Return the scan with the time between beams, and with received powers as intensities."""
    ((name, scan),) = _write_scan(make, told)
    times = told.reading.beam_time
    scan.time_increment = float(times[1] - times[0]) if len(times) > 1 else 0.0
    scan.intensities = told.reading.intensity[0].astype(np.float32)
    return [(name, scan)]


def _read_pulses(others: Mapping[str, Any], rest: Mapping[str, Any]) -> dict[str, Any]:
    found = _read_scan(others, rest)
    del found["hit"]
    return found | {"intensity": others[""].intensities.astype(np.float64)[None]}


def _write_echo(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    sensor = told.sensor
    infrared = isinstance(sensor, Infrared)
    half = getattr(sensor, "dispersion" if infrared else "half_angle", 0.0)
    echo = make.make(
        "sensor_msgs/msg/Range",
        header=told.header(make),
        radiation_type=int(infrared),
        field_of_view=2.0 * float(half),
        min_range=float(getattr(sensor, "range_min", 0.0)),
        max_range=float(getattr(sensor, "range_max", math.inf)),
        range=float(told.reading.ranges[0]),
    )
    return [("", echo)]


def _read_echo(others: Mapping[str, Any], rest: Mapping[str, Any]) -> dict[str, Any]:
    return {"ranges": np.array([others[""].range], dtype=np.float64)}


def _write_inertial(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    reading, sensor = told.reading, told.sensor
    unknown = np.zeros(9)
    unknown[0] = -1.0  # the message type defines -1 as: no estimate of the orientation
    imu = make.make(
        "sensor_msgs/msg/Imu",
        header=told.header(make),
        orientation=make.quaternion(0.0),
        orientation_covariance=unknown,
        angular_velocity=make.vector(*reading.turn_rate[0].tolist()),
        angular_velocity_covariance=_variance(sensor, "turn_noise"),
        linear_acceleration=make.vector(*reading.acceleration[0].tolist()),
        linear_acceleration_covariance=_variance(sensor, "acceleration_noise"),
    )
    return [("", imu)]


def _variance(sensor: Any, density: str) -> Any:
    """Return the variance of white noise of a density at the rate of the sensor."""
    return (np.eye(3) * float(getattr(sensor, density, 0.0)) ** 2 * float(sensor.rate)).ravel()


def _read_inertial(others: Mapping[str, Any], rest: Mapping[str, Any]) -> dict[str, Any]:
    force, turn = others[""].linear_acceleration, others[""].angular_velocity
    return {
        "acceleration": np.array([[force.x, force.y, force.z]]),
        "turn_rate": np.array([[turn.x, turn.y, turn.z]]),
    }


def _write_odometry(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    reading = told.reading
    (x, y), heading = reading.estimate.position[0].tolist(), float(reading.estimate.heading[0])
    place, twist = (told.nanoseconds, told.robot, x, y, heading), reading.twist[0]
    return [("", make.odometry(*place, twist, f"{told.robot}/odom", covariances=reading.covariances(0)))]


def _read_odometry(others: Mapping[str, Any], rest: Mapping[str, Any]) -> dict[str, Any]:
    twist = others[""].twist.twist
    return {"twist": np.array([[twist.linear.x, twist.angular.z, twist.linear.y]])}


def _write_tracked(make: Messages, told: MeasuredReading) -> list[tuple[str, Any]]:
    reading = told.reading
    people = []
    for who in np.flatnonzero(reading.present[0]).tolist():
        (x, y), (vx, vy) = reading.position[0, who].tolist(), reading.velocity[0, who].tolist()
        people.append(
            make.make(
                "people_msgs/msg/Person",
                name=str(who),
                position=make.point(x, y),
                velocity=make.point(vx, vy),
                reliability=1.0,
                tagnames=["radius", "heading"],
                tags=[repr(float(reading.radius[0, who])), repr(float(reading.heading[0, who]))],
            )
        )
    return [("", make.make("people_msgs/msg/People", header=told.header(make), people=people))]


def _read_tracked(others: Mapping[str, Any], rest: Mapping[str, Any]) -> dict[str, Any]:
    shape = rest["present"].shape
    flat = np.full((*shape, 6), np.nan)
    for person in others[""].people:
        place, moving = person.position, person.velocity
        flat[0, int(person.name)] = place.x, place.y, moving.x, moving.y, *map(float, person.tags)
    return {
        "position": flat[..., 0:2],
        "velocity": flat[..., 2:4],
        "radius": flat[..., 4],
        "heading": flat[..., 5],
    }


LASER_SCAN = {"": "sensor_msgs/msg/LaserScan"}
CODECS: dict[type[Reading], Codec] = {
    Scan: Codec(
        LASER_SCAN, "intensities hold the agent hit", _write_scan, _read_scan, ("cos_incidence", "part"), ("facing",)
    ),
    PointCloud: cloud_codec,
    RangeReading: Codec({"": "sensor_msgs/msg/Range"}, "", _write_echo, _read_echo, rest=("hit", "part", "direction")),
    DepthImage: depth_codec,
    ImuReading: Codec(
        {"": "sensor_msgs/msg/Imu"},
        "no orientation",
        _write_inertial,
        _read_inertial,
        rest=("velocity", "acceleration_bias", "turn_bias"),
    ),
    Odometry: Codec(
        {"": "nav_msgs/msg/Odometry"},
        "in the frame `<robot>/odom`, with the covariance of slip and noise",
        _write_odometry,
        _read_odometry,
        rest=("estimate", "travelled", "ticks", "covariance", "twist_covariance"),
    ),
    RgbImage: picture_codec,
    BumperReading: touch_codec,
    PulsedScan: Codec(
        LASER_SCAN,
        "intensities hold the received power",
        _write_pulses,
        _read_pulses,
        rest=("hit", "cos_incidence", "part", "beam_time", "echoes"),
    ),
    TrackedPeople: Codec(
        {"": "people_msgs/msg/People"}, "in the frame of the sensor", _write_tracked, _read_tracked, rest=("present",)
    ),
}
"""Codecs by class of readings; a subclass uses the codec of its parent."""


def reading_topics(sensor: Sensor) -> dict[str, str]:
    """Return the message types of a sensor by suffix of its topic; empty if ``measure`` names no known reading.

    >>> from crowdbot.sensors import Lidar2D
    >>> reading_topics(Lidar2D())
    {'': 'sensor_msgs/msg/LaserScan', '/reading': 'crowdbot_msgs/msg/Reading'}
    """
    name = _reading_class(type(sensor))
    return next(({**codec.types, REST: KIND} for cls, codec in CODECS.items() if cls.__name__ == name), {})


def _reading_class(sensor: type[Sensor]) -> str:
    """Return the class of readings that the annotation of ``measure`` names, or an empty text."""
    known = {cls.__name__ for cls in CODECS}
    for kind in sensor.__mro__:
        measure = vars(kind).get("measure")
        words: list[str] = re.findall(r"\w+", str(getattr(measure, "__annotations__", {}).get("return", "")))
        for word in words:
            if word in known:
                return word
    return ""


def reading_table() -> str:
    """Return the messages of each class of readings and the sensors that return it, as a table in Markdown.

    >>> reading_table().splitlines()[2]
    '| `Scan` | lidar2d | sensor_msgs/LaserScan | intensities hold the agent hit |'
    """
    names: dict[str, list[str]] = {}
    for name, kind in builtin_classes(sensors, Sensor).items():
        names.setdefault(_reading_class(kind), []).append(name)
    rows = ["| reading | sensor | type | content |", "|---|---|---|---|"]
    for cls, codec in CODECS.items():
        types = ", ".join(
            kind.replace("/msg/", "/") + (f" on `{suffix[1:]}`" if suffix else "")
            for suffix, kind in codec.types.items()
        )
        kinds = ", ".join(sorted(names.get(cls.__name__, [])))
        rows.append(f"| `{cls.__name__}` | {kinds} | {types} | {codec.about} |")
    return "\n".join(rows) + "\n"
