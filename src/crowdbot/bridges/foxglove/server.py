"""FoxgloveServer: a live WebSocket server for the Foxglove app, and a layout of the app."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.bridges.socket_server import SocketServer, access_of, port_of
from crowdbot.recording import StepMessage
from crowdbot.trials import Trial

from .session import FoxgloveGraph, FoxgloveSession

PORT = 8765
PROTOCOL = "foxglove.sdk.v1"
MOST_STEPS = 200
"""Largest number of steps whose messages wait for the thread of the server."""


class FoxgloveServer:
    """A server of the Foxglove WebSocket protocol, with the messages of the recorder as CDR.

    Clients can publish commands (JSON or CDR), call the services (CDR), pause and play. A slow client gets the newest
    messages. It listens on the loopback interface; on another one it needs a token or a list of allowed topics. A page
    in a browser needs the token, or its origin must be allowed.

    Args:
        port: TCP port; 0: any free one, see :attr:`port` after :meth:`start`.
        host: address of the interface.
        token: clients must send it as ``?token=...`` in the URL, or as ``Authorization: Bearer ...``.
        topics: patterns of topics and services that clients may use, such as ``/robot/*``; None: all.
        origins: pages that may connect without the token, such as ``https://app.foxglove.dev``.

    Raises:
        InputError: the port is not allowed, or the server would be open to everybody.

    >>> FoxgloveServer(port=0).host
    '127.0.0.1'
    """

    name = "foxglove"

    def __init__(
        self,
        port: int = PORT,
        host: str = "127.0.0.1",
        token: str = "",
        topics: Sequence[str] | None = None,
        origins: Sequence[str] = (),
    ) -> None:
        access = access_of(self.name, host, token, topics, origins)
        self.host = host
        self.topics = None if topics is None else tuple(topics)
        self._graph: FoxgloveGraph | None = None
        self._server = SocketServer(self.name, host, port, access, self._session, PROTOCOL)
        self._steps: deque[Sequence[StepMessage]] = deque(maxlen=MOST_STEPS)

    @classmethod
    def of(
        cls,
        address: str,
        host: str = "",
        token: str = "",
        topics: Sequence[str] | None = None,
        origins: Sequence[str] = (),
    ) -> FoxgloveServer:
        """Return the server of an address on the command line: a port, or nothing.

        Raises:
            InputError: the address is no port.
        """
        return cls(port_of(cls.name, address, PORT), host or "127.0.0.1", token, topics, origins)

    @property
    def port(self) -> int:
        """The TCP port."""
        return self._server.port

    @property
    def now(self) -> int:
        """Simulated time [ns] of the clients."""
        return 0 if self._graph is None else self._graph.now

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Listen, or announce another trial to the clients, whose views then begin anew.

        Raises:
            InputError: the port is in use.
        """
        if self._graph is not None:
            self._server.call(self._graph.change, interface)
            return
        self._graph = FoxgloveGraph(interface, inbox, self._server.call, self.topics)
        self._server.start()

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Hand the messages of a step to the thread of the server; if it is slow, the oldest steps are dropped."""
        self._steps.append(messages)
        self._server.call(self._deliver)

    def poll(self) -> None:
        """Do nothing: the thread of the server gives what arrives to the inbox."""

    def report(self, level: str, text: str) -> None:
        """Send a status message to all clients."""

        def tell() -> None:
            for session in self._graph.sessions if self._graph is not None else ():
                session.status(level, text)

        self._server.call(tell)

    def wants(self, topic: str) -> bool:
        """Return whether a client subscribes a topic, or with a final slash one that starts with it.

        The time is sent to all clients, so that one that sends commands wants it.
        """
        wanted = frozenset() if self._graph is None else self._graph.wanted
        if not topic.endswith("/"):
            return topic in wanted or topic == "/clock"
        return any(item == topic[:-1] or item.startswith(topic) for item in wanted)

    def stop(self) -> None:
        """Disconnect all clients and stop listening."""
        self._server.stop()

    def _session(self, wake: Callable[[], None]) -> FoxgloveSession:
        assert self._graph is not None
        return FoxgloveSession(self._graph, wake)

    def _deliver(self) -> None:
        assert self._graph is not None
        while self._steps:
            self._graph.deliver(self._steps.popleft())


def foxglove_layout(trial: Trial) -> dict[str, Any]:
    """Return the layout for the first robot of a trial; write it as JSON and import it in the app.

    Args:
        trial: a trial with a robot.

    >>> from crowdbot.trials import load_trial
    >>> layout = foxglove_layout(load_trial("frontal"))
    >>> sorted(layout["configById"])
    ['3D!scene', 'Plot!speed', 'Teleop!drive']
    """
    interface, robot = RobotInterface.of(trial), trial.robots[0].name
    images = [
        output.name for output in interface.outputs if output.robot == robot and output.kind == "sensor_msgs/msg/Image"
    ]
    panels: dict[str, Any] = {
        "3D!scene": _scene(interface, robot),
        "Plot!speed": _plot(robot),
        "Teleop!drive": _teleop(robot),
    }
    right: Any = {"direction": "column", "first": "Plot!speed", "second": "Teleop!drive", "splitPercentage": 50}
    if images:
        panels["Image!camera"] = {"imageMode": {"imageTopic": images[0]}, "cameraState": {}}
        right = {"direction": "column", "first": "Image!camera", "second": right, "splitPercentage": 40}
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {"direction": "row", "first": "3D!scene", "second": right, "splitPercentage": 70},
    }


def _scene(interface: RobotInterface, robot: str) -> dict[str, Any]:
    shown = {"sensor_msgs/msg/LaserScan", "sensor_msgs/msg/PointCloud2", "nav_msgs/msg/OccupancyGrid"}
    topics = {output.name: {"visible": True} for output in interface.outputs if output.kind in shown}
    return {
        "cameraState": {
            "perspective": True, "distance": 14.0, "phi": 50.0, "thetaOffset": 45.0, "targetOffset": [0, 0, 0],
            "target": [0, 0, 0], "targetOrientation": [0, 0, 0, 1], "fovy": 45.0, "near": 0.1, "far": 500.0,
        },
        "followMode": "follow-position",
        "followTf": f"{robot}/base_link",
        "scene": {},
        "transforms": {},
        "topics": {"/crowd/markers": {"visible": True}} | topics,
        "layers": {
            "grid": {"layerId": "foxglove.Grid", "instanceId": "grid", "visible": True, "size": 40, "divisions": 40},
            "urdf": {
                "layerId": "foxglove.Urdf", "instanceId": "urdf", "visible": True, "sourceType": "topic",
                "topic": f"/{robot}/robot_description", "framePrefix": "",
            },
        },
        "publish": {"type": "pose", "poseTopic": f"/{robot}/goal_pose"},
    }  # fmt: skip


def _plot(robot: str) -> dict[str, Any]:
    odometry = f"/{robot}/ground_truth/odom.twist.twist"
    paths = {"forward": f"{odometry}.linear.x", "turn": f"{odometry}.angular.z"}
    return {
        "title": "speed",
        "xAxisVal": "timestamp",
        "followingViewWidth": 30,
        "paths": [
            {"value": path, "label": label, "enabled": True, "timestampMethod": "receiveTime"}
            for label, path in paths.items()
        ],
    }  # fmt: skip


def _teleop(robot: str) -> dict[str, Any]:
    buttons = {
        "up": ("linear-x", 0.5),
        "down": ("linear-x", -0.3),
        "left": ("angular-z", 0.8),
        "right": ("angular-z", -0.8),
    }
    found: dict[str, Any] = {"topic": f"/{robot}/cmd_vel", "publishRate": 10}
    return found | {f"{name}Button": {"field": field, "value": value} for name, (field, value) in buttons.items()}
