"""DoorLeaf: a door in a passage, hinged or sliding."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import Element, InputError
from crowdbot.typing import Floats
from crowdbot.world.physics.layers import LEAF
from crowdbot.world.urdf.geoms import row

KINDS = ("hinged", "sliding")
OPENINGS = ("order", "schedule", "approach", "push")
THICK = 0.04
"""Thickness [m] of a leaf."""
GLASS = "0.45 0.55 0.62 1"


@dataclass(frozen=True)
class DoorLeaf:
    """A door between two points: a leaf that turns about the first point, or slides along the line beyond it.

    Fields:
        name: name of the door.
        x, y: the hinge, or the side to which it slides [m].
        end_x, end_y: other end of the closed leaf [m].
        kind: ``hinged`` or ``sliding``.
        opening: ``order`` (it follows :attr:`Doors.wanted`), ``schedule`` (it switches at ``times``), ``approach``
            (somebody is near), or ``push`` (in the physics world the leaf is a body that people and robots push).
        times: times [s] at which a scheduled door switches between open and closed.
        distance: distance [m] to the closed leaf within which somebody opens a door by approach.
        hold: time [s] for which it stays open afterwards.
        duration: time [s] to open or close.
        angle: angle [rad] of an open hinged leaf, counter-clockwise from the closed one.
        height: height [m].
        mass: mass [kg] of a pushed leaf.
        closer: torque [N m] at the full angle with which a pushed leaf closes.

    Raises:
        InputError: a value is not allowed.

    >>> DoorLeaf("hall", 0.0, 0.0, 1.0, 0.0).line(1.0).round(3).tolist()
    [[0.0, 0.0], [0.0, 1.0]]
    """

    name: str
    x: float
    y: float
    end_x: float
    end_y: float
    kind: str = "hinged"
    opening: str = "order"
    times: tuple[float, ...] = ()
    distance: float = 1.5
    hold: float = 2.0
    duration: float = 1.0
    angle: float = 0.5 * math.pi
    height: float = 2.1
    mass: float = 20.0
    closer: float = 10.0

    def __post_init__(self) -> None:
        who = f"DoorLeaf {self.name!r}"
        if self.kind not in KINDS or self.opening not in OPENINGS:
            raise InputError(
                f"{who}: kind is {self.kind!r} and opening {self.opening!r}; allowed are {', '.join(KINDS)}, and"
                f" {', '.join(OPENINGS)}"
            )
        if self.opening == "push" and self.kind != "hinged":
            raise InputError(f"{who}: only a hinged door opens by push")
        if not (math.isfinite(self.x + self.y + self.end_x + self.end_y) and self.width > 0.0):
            raise InputError(f"{who}: both ends must be finite and differ")
        for name in ("duration", "height", "mass"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise InputError(f"{who}: {name} = {getattr(self, name)} must be finite and above 0")
        for name in ("distance", "hold", "closer"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise InputError(f"{who}: {name} = {getattr(self, name)} must be finite and at least 0")
        if not 0.0 < abs(self.angle) <= math.pi:
            raise InputError(f"{who}: angle = {self.angle} rad must be from -pi to pi and not 0")
        if list(self.times) != sorted(set(self.times)) or any(not 0.0 <= time < math.inf for time in self.times):
            raise InputError(f"{who}: times = {self.times} must increase, from 0 s on")

    @property
    def width(self) -> float:
        """Width [m] of the leaf."""
        return math.hypot(self.end_x - self.x, self.end_y - self.y)

    @property
    def yaw(self) -> float:
        """Direction [rad] of the closed leaf."""
        return math.atan2(self.end_y - self.y, self.end_x - self.x)

    @property
    def lets_pass(self) -> bool:
        """Whether it opens for everybody who comes, so that paths lead through it while it is closed."""
        return self.opening in ("approach", "push")

    def line(self, share: float) -> Floats:
        """Return the ends ``[2, 2]`` [m] of the leaf in the passage, 0 closed to 1 open; an open sliding leaf is short.

        Args:
            share: from 0 to 1; below 0, a pushed leaf opens in the other direction.
        """
        start, end = np.array([self.x, self.y]), np.array([self.end_x, self.end_y])
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
