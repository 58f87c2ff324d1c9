"""Cameras of a trial: from where images and videos of it are made."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .attribute import attribute, check
from .notation import NAME

if TYPE_CHECKING:
    from crowdbot.world import physics

    from .stage import Stage

__all__ = ["OVERVIEW", "Camera", "overview"]

OVERVIEW = "overview"
"""Name of the camera that sees the whole stage, unless the trial has one of this name."""


@dataclass(frozen=True, kw_only=True)
class Camera:
    """A camera in the world, or on a robot or one of its links; it looks along x of its own frame.

    >>> Camera(name="door", x=1, y=2, heading=1.57).z
    1.6
    """

    name: str = attribute(about="by which it is chosen", pattern=NAME)
    x: float = attribute(0.0, about="place, in the world or forward on its robot", unit="m")
    y: float = attribute(0.0, about="place, in the world or left on its robot", unit="m")
    z: float = attribute(1.6, about="above the floor, or above the link", unit="m")
    heading: float = attribute(0.0, about="where it looks, counter-clockwise", unit="rad")
    pitch: float = attribute(0.0, about="nose down", unit="rad", at_least=-math.pi / 2, at_most=math.pi / 2)
    width: int = attribute(640, about="of the image in pixels", at_least=16, at_most=1920)
    height: int = attribute(480, about="of the image in pixels", at_least=16, at_most=1200)
    field_of_view: float = attribute(
        math.radians(70.0), about="horizontal", unit="rad", at_least=0.01, at_most=math.radians(170.0)
    )
    detail: int = attribute(1, about="of people, 0 the finest", at_least=0, at_most=2)
    shadows: bool = attribute(False, about="whether lights throw shadows, which takes longer")
    robot: str = attribute("", about="name of the robot that carries it")
    link: str = attribute("", about="link of that robot, by default the robot itself")

    def __post_init__(self) -> None:
        check(self)

    def view(self, agent: int | None) -> physics.Camera:
        """Return it for a studio; ``agent`` is the robot that carries it."""
        from crowdbot.world import physics

        flat = math.cos(self.pitch)
        ahead = (flat * math.cos(self.heading), flat * math.sin(self.heading), -math.sin(self.pitch))
        place = (self.x, self.y, self.z)
        return physics.Camera(
            place,
            (place[0] + ahead[0], place[1] + ahead[1], place[2] + ahead[2]),
            width=self.width,
            height=self.height,
            view=2.0 * math.atan(math.tan(0.5 * self.field_of_view) * self.height / self.width),
            robot=agent,
            link=self.link,
            detail=self.detail,
            shadows=self.shadows,
        )


def overview(stage: Stage, places: np.ndarray) -> Camera:
    """Return a camera that sees a whole stage, and all ``places`` ``[N, 2]`` [m], from the south and above."""
    points = (
        np.concatenate([*stage.rings, places.reshape(-1, 2)]) if len(stage.rings) or len(places) else np.zeros((1, 2))
    )
    low, high = points.min(axis=0), points.max(axis=0)
    middle, size = 0.5 * (low + high), np.maximum(high - low, 4.0)
    pitch, view, wide, tall = math.radians(60.0), math.radians(60.0), 960, 600
    across = 0.5 * size[0] / math.tan(0.5 * view)
    upwards = 0.5 * size[1] * math.sin(pitch) / (math.tan(0.5 * view) * tall / wide)
    away = 1.1 * float(max(across, upwards)) + 0.5 * float(size[1]) * math.cos(pitch)
    x, y = middle[0], middle[1] - away * math.cos(pitch)
    return Camera(
        name=OVERVIEW, x=float(x), y=float(y), z=away * math.sin(pitch), heading=math.pi / 2, pitch=pitch,
        width=wide, height=tall, field_of_view=view,
    )  # fmt: skip
