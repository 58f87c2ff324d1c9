"""Transport: the contract of what carries a robot port to other programs, and transports by name."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

from crowdbot.core import InputError, did_you_mean
from crowdbot.recording import StepMessage

from .inbox import Inbox
from .interface import RobotInterface


class Transport(Protocol):
    """Carries the topics and services of a port over one kind of connection.

    Every method is called in the thread of the simulation. A transport with threads of its own gives what it receives
    to the inbox, which all threads can use. Nothing may block: a slow or dead peer loses old messages.

    Attributes:
        name: short name, such as ``rosbridge``; it is the ``source`` of the orders.
    """

    name: str

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Open the connection and announce the topics and services.

        It is called again for another trial, without :meth:`stop` in between; clients then stay connected.

        Raises:
            InputError: the connection cannot be opened, with the reason.
        """

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Send the messages of a step. Those of latched topics must also reach later subscribers."""

    def poll(self) -> None:
        """Give to the inbox what has arrived; called at least every 20 ms. Without own threads only."""

    def report(self, level: str, text: str) -> None:
        """Tell the other programs about a problem; the level is ``info``, ``warning`` or ``error``."""

    def wants(self, topic: str) -> bool:
        """Return whether anybody receives a topic; others are not converted.

        A topic that ends in ``/`` stands for all topics that start with it, with or without the slash.
        """

    def stop(self) -> None:
        """Close the connection; called once."""


def is_among(topic: str, names: Iterable[str]) -> bool:
    """Return whether a topic is one of some names; one that ends in ``/`` if any of them starts with it.

    >>> [is_among(topic, ["/robot/scan"]) for topic in ("/robot/", "/robot/scan/", "/robot/scan", "/robot")]
    [True, True, True, False]
    """
    if not topic.endswith("/"):
        return topic in names
    return any(name == topic[:-1] or name.startswith(topic) for name in names)


@runtime_checkable
class RemarkSource(Protocol):
    """A transport that has something to tell people after a run."""

    def remark(self) -> str:
        """Return a line, empty for none; called after :meth:`Transport.stop`."""


TRANSPORTS: dict[str, tuple[str, str]] = {
    "rosbridge": ("rosbridge.server:RosbridgeServer.of", "rosbridge[:PORT], a server for roslibpy and roslib.js"),
    "rosbridge-client": ("rosbridge.client:RosbridgeClient.of", "rosbridge-client:ws://HOST:PORT, joins a server"),
    "ros1": ("ros1.node:Ros1Node.of", "ros1[:http://HOST:PORT], a ROS 1 node at a master"),
    "ros2": ("ros2.node:Ros2Node.of", "ros2[:DOMAIN], a ROS 2 node (rclpy)"),
    "naoqi": ("naoqi.bridge:NaoqiBridge.of", "naoqi:HOST[:PORT], virtual sensors in the memory of a Pepper (qi)"),
    "simulated": ("join.real_robot_link:SimulatedRobot.of", "simulated, a base in place of a real robot (join)"),
    "foxglove": ("foxglove.server:FoxgloveServer.of", "foxglove[:PORT], a live server for the Foxglove app"),
    "tcp": ("challenge_server:ChallengeServer.of", "tcp[:PORT], the server of the challenge of ICRA 2021"),
}
"""Module and function of each transport, relative to this room, and a line for people.

The function takes the text after the name, and options of the command line by name (``host``, ``token``, ``topics``,
``origins``).
"""


def open_transport(text: str, options: Mapping[str, Any] | None = None) -> Transport:
    """Return a transport by its name and address.

    Raises:
        InputError: there is no such transport, or its address is not allowed.

    >>> open_transport("rosbridge:9091").name
    'rosbridge'
    """
    name, _, address = text.partition(":")
    if name not in TRANSPORTS:
        raise InputError(
            f"there is no bridge {name!r}{did_you_mean(name, TRANSPORTS)}; bridges are {', '.join(TRANSPORTS)}"
        )
    module, _, path = TRANSPORTS[name][0].partition(":")
    made: Any = importlib.import_module(f"crowdbot.bridges.{module}")
    for word in path.split("."):
        made = getattr(made, word)
    try:
        inspect.signature(made).bind(address, **(options or {}))
    except TypeError:
        raise InputError(f"bridge {name!r} does not take {', '.join(options or {})}") from None
    transport: Transport = made(address, **(options or {}))
    return transport
