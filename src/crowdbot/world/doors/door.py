"""Door: an element of the stage that closes a passage, hinged or sliding."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import Element, InputError, parse_number
from crowdbot.core.fields import Points, attribute, check
from crowdbot.typing import Floats
from crowdbot.world.physics.layers import LEAF
from crowdbot.world.urdf.geoms import row

THICK = 0.04
"""Thickness [m] of a leaf."""
GLASS = "0.45 0.55 0.62 1"


@dataclass(frozen=True, kw_only=True)
class Door:
    """A door in a passage. It opens by a change of ``open``, at times, by approach, or by a push.

    A hinged leaf turns about the first of its points, a sliding one moves along the line beyond it. In the physics
    world a leaf that opens by a push is a body that people and robots push.

    Raises:
        InputError: a value is not allowed.

    >>> Door(name="hall", points="0,0 1,0").line(1.0).round(3).tolist()
    [[0.0, 0.0], [0.0, 1.0]]
    >>> Door(name="hall", points=[(2, 0), (2, 1)], opening="schedule", times="5 20").switches
    (5.0, 20.0)
    """

    name: str = attribute(about="name of the door", pattern=r"\S.{0,79}")
    points: Points = attribute(about="x,y of the hinge (or the side to which it slides) and of the other end", unit="m")
    kind: str = attribute("hinged", about="hinged or sliding leaf", choices=("hinged", "sliding"))
    opening: str = attribute(
        "order",
        about="what opens it: the value of open, times, approach of people and robots, or a push",
        choices=("order", "schedule", "approach", "push"),
    )
    open: bool = attribute(False, about="whether it is open at the start; while it runs, orders change it")
    times: str = attribute("", about="times at which a scheduled door opens or closes, separated by spaces", unit="s")
    distance: float = attribute(1.5, about="distance at which approach opens it", unit="m", min=0.0, max=100.0)
    hold: float = attribute(2.0, about="time for which it then stays open", unit="s", min=0.0, max=86_400.0)
    duration: float = attribute(1.0, about="time to open or close", unit="s", min=0.01, max=3600.0)
    angle: float = attribute(
        math.pi / 2, about="angle of the open leaf, counter-clockwise", unit="rad", min=-math.pi, max=math.pi
    )
    height: float = attribute(2.1, about="height", unit="m", min=0.1, max=100.0)
    mass: float = attribute(20.0, about="mass of a leaf that is pushed", unit="kg", min=0.1, max=1e4)
    closer: float = attribute(
        10.0, about="torque of the closer of a leaf that is pushed, at the full angle", min=0.0, max=1000.0
    )

    def __post_init__(self) -> None:
        check(self)
        if len(self.points) != 2 or self.points[0] == self.points[1]:
            raise InputError(f"points has {len(self.points)} points; give two different ones, the hinge first")
        try:
            given = self.switches
        except InputError as error:
            raise InputError(f'times="{self.times[:60]}" {error}') from None
        if self.opening == "schedule" and not given:
            raise InputError('opening="schedule" needs times, such as times="5 20"')
        if self.opening != "schedule" and self.times:
            raise InputError(f'times need opening="schedule", not "{self.opening}"')
        if self.opening == "push" and self.kind == "sliding":
            raise InputError('opening="push" needs a hinged door')
        if self.angle == 0.0:
            raise InputError("angle must not be 0")

    @functools.cached_property
    def switches(self) -> tuple[float, ...]:
        """Times [s] at which a scheduled door switches between open and closed."""
        times = tuple(parse_number(word) for word in self.times.split())
        if list(times) != sorted(set(times)) or any(time < 0.0 for time in times):
            raise InputError("must increase, from 0 s on")
        return times

    @property
    def x(self) -> float:
        """x [m] of the first of its points."""
        return self.points[0][0]

    @property
    def y(self) -> float:
        """y [m] of the first of its points."""
        return self.points[0][1]

    @property
    def width(self) -> float:
        """Width [m] of the leaf."""
        return math.dist(*self.points)

    @property
    def yaw(self) -> float:
        """Direction [rad] of the closed leaf."""
        (x, y), (end_x, end_y) = self.points
        return math.atan2(end_y - y, end_x - x)

    @property
    def lets_pass(self) -> bool:
        """Whether it opens for everybody who comes, so that paths lead through it while it is closed."""
        return self.opening in ("approach", "push")

    def line(self, share: float) -> Floats:
        """Return the ends ``[2, 2]`` [m] of the leaf in the passage, 0 closed to 1 open; an open sliding leaf is short.

        Args:
            share: from 0 to 1; below 0, a pushed leaf opens in the other direction.
        """
        start, end = np.array(self.points)
        if self.kind == "sliding":
            return np.stack([start, start + (1.0 - share) * (end - start)])
        turn = self.yaw + share * self.angle
        return np.stack([start, start + self.width * np.array([math.cos(turn), math.sin(turn)])])

    @property
    def range(self) -> float:
        """Coordinate of its joint when it is open [rad or m]."""
        return self.angle if self.kind == "hinged" else -self.width

    def body(self, name: str) -> Element:
        """Return the leaf as an MJCF body with the joint ``name``."""
        element = Element("body", {"name": name, "pos": row((self.x, self.y, 0.0)), "euler": row((0.0, 0.0, self.yaw))})
        joint = {"name": name, "type": "hinge", "axis": "0 0 1"}
        if self.kind == "sliding":
            joint |= {"type": "slide", "axis": "1 0 0"}
        if self.opening == "push":
            # critically damped: the leaf closes without swinging
            inertia = self.mass * self.width**2 / 3.0
            spring = max(self.closer, 1e-3) / abs(self.angle)
            joint |= {"stiffness": row((spring,)), "damping": row((2.0 * math.sqrt(spring * inertia),))}
            joint |= {"limited": "true", "range": row((-abs(self.angle), abs(self.angle)))}
        element.children.append(Element("joint", joint))
        across = self.mass * (self.width**2 + THICK**2) / 12.0
        inertia_row = {"pos": row((0.5 * self.width, 0.0, 0.5 * self.height)), "mass": row((self.mass,))}
        element.children.append(Element("inertial", {**inertia_row, "diaginertia": row((across, across, across))}))
        size = {"type": "box", "size": row((0.5 * self.width, 0.5 * THICK, 0.5 * self.height - 0.01))}
        place = {"pos": row((0.5 * self.width, 0.0, 0.5 * self.height + 0.01))}
        geom = {"name": f"{name}/leaf", "rgba": GLASS, "group": "0", **size, **place, **LEAF}
        element.children.append(Element("geom", geom))
        return element

    def box(self, share: float) -> tuple[Floats, Floats, float]:
        """Return the centre ``[3]`` and half sides ``[3]`` [m] and the yaw [rad] of the leaf."""
        yaw = self.yaw + (share * self.angle if self.kind == "hinged" else 0.0)
        along = np.array([math.cos(yaw), math.sin(yaw)])
        away = 0.5 * self.width - (share * self.width if self.kind == "sliding" else 0.0)
        centre = np.array([self.x, self.y]) + away * along
        half = np.array([0.5 * self.width, 0.5 * THICK, 0.5 * self.height])
        return np.array([*centre.tolist(), 0.5 * self.height]), half, yaw
