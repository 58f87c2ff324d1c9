"""Transports by their name on the command line: ``rosbridge:9090`` is the transport ``rosbridge`` with ``9090``."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Mapping
from typing import Any

from crowdbot.core import InputError, did_you_mean

from .transport import Transport

TRANSPORTS: dict[str, tuple[str, str]] = {
    "rosbridge": ("rosbridge.server:RosbridgeServer.of", "rosbridge[:PORT], a server for roslibpy and roslib.js"),
    "rosbridge-client": ("rosbridge.client:RosbridgeClient.of", "rosbridge-client:ws://HOST:PORT, joins a server"),
    "ros1": ("ros1.node:Ros1Node.of", "ros1[:http://HOST:PORT], a ROS 1 node at a master"),
    "ros2": ("ros2.node:Ros2Node.of", "ros2[:DOMAIN], a ROS 2 node (rclpy)"),
    "naoqi": ("naoqi.bridge:NaoqiBridge.of", "naoqi:HOST[:PORT], virtual sensors in the memory of a Pepper (qi)"),
    "simulated": ("join.simulated_robot:SimulatedRobot.of", "simulated, a base in place of a real robot (join)"),
    "foxglove": ("foxglove.server:FoxgloveServer.of", "foxglove[:PORT], a live server for the Foxglove app"),
    "tcp": ("tcp.challenge_server:ChallengeServer.of", "tcp[:PORT], the server of the challenge of ICRA 2021"),
}
"""Module and function of each transport, relative to this room, and a line for people.

The function takes the text after the name, and options of the command line by name (``host``, ``token``, ``topics``).
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
    found: Transport = made(address, **(options or {}))
    return found
