"""FoxgloveServer: a live WebSocket server for the Foxglove app, and a layout of the app."""

from __future__ import annotations

from typing import Any

from crowdbot.bridges.interface import RobotInterface
from crowdbot.bridges.socket_transport import SocketTransport
from crowdbot.trials import Trial

from .session import FoxgloveGraph, FoxgloveSession


class FoxgloveServer(SocketTransport[FoxgloveSession]):
    """A server of the Foxglove WebSocket protocol, with the messages of the recorder as CDR.

    Clients can publish commands (JSON or CDR), call the services (CDR), pause and play. A slow client gets the newest
    messages. When another trial begins, their views begin anew.

    >>> FoxgloveServer(port=0).host
    '127.0.0.1'
    """

    name, usual_port = "foxglove", 8765
    # the second is that of Foxglove Studio and Lichtblick: the same frames, but clients do not pause the run
    protocols = ("foxglove.sdk.v1", "foxglove.websocket.v1")
    graph, session = FoxgloveGraph, FoxgloveSession

    def wants(self, topic: str) -> bool:
        """Return whether a client subscribes a topic, or with a final slash one that starts with it.

        The time is sent to all clients, so that one that sends commands wants it.
        """
        return topic == "/clock" or super().wants(topic)


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
