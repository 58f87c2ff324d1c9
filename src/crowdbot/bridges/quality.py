"""QualityOfService: how a topic is delivered, in the words of ROS 2."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class QualityOfService:
    """Delivery of a topic.

    Fields:
        name: name of the class in tables.
        reliable: whether lost messages are sent again; a reliable subscriber does not match a best-effort topic.
        latched: whether a late subscriber gets the latest message (``transient local`` in ROS 2).
        depth: number of messages that are kept for a subscriber.

    >>> SENSOR.reliable, LATCHED.latched
    (False, True)
    """

    name: str
    reliable: bool
    latched: bool
    depth: int


SENSOR = QualityOfService("sensor", False, False, 5)
"""Readings, as ``rmw_qos_profile_sensor_data``."""
CLOCK = QualityOfService("clock", True, False, 1)
"""The clock: reliable, so that both kinds of subscribers match."""
TF = QualityOfService("tf", True, False, 100)
"""Transforms that move."""
LATCHED = QualityOfService("latched", True, True, 1)
"""What is sent once: the map, fixed transforms, descriptions of robots."""
STATE = QualityOfService("state", True, False, 10)
"""Odometry, joints, people, contacts, orders."""
COMMAND = QualityOfService("command", True, False, 10)
"""Commands to the robot; a best-effort publisher does not match. The newest counts, but none is lost on the way."""
QUALITIES = (SENSOR, CLOCK, TF, LATCHED, STATE, COMMAND)
