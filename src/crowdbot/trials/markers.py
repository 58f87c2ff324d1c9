"""Shapes for viewers: people, robots, goals and walls as a ``visualization_msgs/MarkerArray``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene

from .messages import Messages
from .trial import Robot

__all__ = ["markers"]

BODY_HEIGHT, ROBOT_HEIGHT, GOAL_HEIGHT = 1.7, 0.8, 0.02
ORANGE, BLUE, GREEN, GRAY = (0.9, 0.6, 0.0), (0.0, 0.45, 0.7), (0.0, 0.62, 0.45), (0.5, 0.5, 0.5)
"""Colours that people with colour blindness can tell apart (Okabe & Ito)."""


def markers(messages: Messages, nanoseconds: int, scene: Scene, ids: NDArray[np.int64], robots: Sequence[Robot]) -> Any:
    """Return everything that is there as shapes; the array begins by deleting those before.

    Args:
        messages: makes the messages.
        nanoseconds: simulated time [ns].
        scene: E is 1; agents that are moved from outside are the ``robots``.
        ids: ``[A]`` who is who.
        robots: in the order of the trial.
    """
    types = messages.store.types["visualization_msgs/msg/Marker"]
    shapes = [_shape(messages, nanoseconds, "clear", 0, types.SPHERE, action=types.DELETEALL)]
    for agent in np.flatnonzero(scene.active[0]).tolist():
        person = not scene.external[0, agent]
        shapes.append(
            _disc(
                messages,
                nanoseconds,
                "people" if person else "robots",
                int(ids[agent]),
                scene.position[0, agent],
                float(scene.radius[0, agent]),
                BODY_HEIGHT if person else ROBOT_HEIGHT,
                ORANGE if person else BLUE,
            )
        )
    for number, robot in enumerate(robots):
        place = np.array(robot.goal.position)
        shapes.append(_disc(messages, nanoseconds, "goals", number, place, robot.goal.tolerance, GOAL_HEIGHT, GREEN))
    shapes.append(_walls(messages, nanoseconds, scene.walls.segments()))
    return messages.make("visualization_msgs/msg/MarkerArray", markers=shapes)


def _disc(
    messages: Messages,
    nanoseconds: int,
    group: str,
    number: int,
    place: NDArray[np.float64],
    radius: float,
    height: float,
    color: tuple[float, float, float],
) -> Any:
    cylinder = messages.store.types["visualization_msgs/msg/Marker"].CYLINDER
    return _shape(
        messages,
        nanoseconds,
        group,
        number,
        cylinder,
        pose=messages.pose(float(place[0]), float(place[1]), 0.0, height / 2.0),
        scale=messages.vector(2.0 * radius, 2.0 * radius, height),
        color=_color(messages, color),
    )


def _walls(messages: Messages, nanoseconds: int, segments: NDArray[np.float64]) -> Any:
    lines = messages.store.types["visualization_msgs/msg/Marker"].LINE_LIST
    ends = segments.reshape(-1, 2).tolist()
    return _shape(
        messages,
        nanoseconds,
        "walls",
        0,
        lines,
        scale=messages.vector(0.05, 0.0, 0.0),
        color=_color(messages, GRAY),
        points=[messages.point(x, y) for x, y in ends],
    )


def _color(messages: Messages, color: tuple[float, float, float]) -> Any:
    red, green, blue = color
    return messages.make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=1.0)


def _shape(messages: Messages, nanoseconds: int, group: str, number: int, kind: int, **fields: Any) -> Any:
    """Return a ``visualization_msgs/Marker``; what is not given is empty."""
    make = messages.make
    empty = {
        "action": 0,
        "pose": messages.pose(0.0, 0.0, 0.0),
        "scale": messages.vector(1.0, 1.0, 1.0),
        "color": _color(messages, GRAY),
        "lifetime": make("builtin_interfaces/msg/Duration", sec=0, nanosec=0),
        "frame_locked": False,
        "points": [],
        "colors": [],
        "texture_resource": "",
        "texture": make(
            "sensor_msgs/msg/CompressedImage",
            header=messages.header(nanoseconds),
            format="",
            data=np.zeros(0, dtype=np.uint8),
        ),
        "uv_coordinates": [],
        "text": "",
        "mesh_resource": "",
        "mesh_file": make("visualization_msgs/msg/MeshFile", filename="", data=np.zeros(0, dtype=np.uint8)),
        "mesh_use_embedded_materials": False,
    }
    return make(
        "visualization_msgs/msg/Marker",
        header=messages.header(nanoseconds),
        ns=group,
        id=number,
        type=kind,
        **(empty | fields),
    )
