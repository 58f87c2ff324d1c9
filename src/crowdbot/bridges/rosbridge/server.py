"""RosbridgeServer: a rosbridge v2 server for roslibpy, roslib.js, Foxglove and other clients."""

from __future__ import annotations

from collections.abc import Sequence

from crowdbot.bridges.socket_transport import SocketTransport
from crowdbot.recording import StepMessage

from .frames import OutgoingMessage
from .graph import RosGraph
from .session import ClientSession


class RosbridgeServer(SocketTransport[ClientSession]):
    """A server of the protocol rosbridge v2.

    >>> RosbridgeServer(port=0).host
    '127.0.0.1'
    """

    name, usual_port = "rosbridge", 9090
    graph, session = RosGraph, ClientSession

    def outgoing(self, messages: Sequence[StepMessage]) -> list[OutgoingMessage]:
        return [OutgoingMessage.of(message) for message in messages]
