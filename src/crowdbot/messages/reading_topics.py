"""Message types on the topics of a sensor, known before its first reading, and their reference table."""

from __future__ import annotations

import re

from crowdbot import sensors
from crowdbot.core import builtin_classes
from crowdbot.sensors import Sensor

from .reading_codecs import CODECS, KIND, REST


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
