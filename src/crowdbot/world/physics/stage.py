"""PhysicsStage: wall height, floor, props and lights of a physics world."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, fields, replace

import numpy as np

from crowdbot.core import Element, InputError
from crowdbot.typing import Floats
from crowdbot.world.buildings.building import Building
from crowdbot.world.doors.leaf import DoorLeaf
from crowdbot.world.ground.ground import Ground
from crowdbot.world.stage_appearance import StageAppearance
from crowdbot.world.urdf.geoms import row

from .layers import DYNAMIC, STANDING

Color = tuple[float, float, float]
LEG = 0.05
"""Width of the legs and thickness of the top of a table [m]."""
DAYLIGHT = StageAppearance()
BARK = "0.45 0.33 0.22 1"
LEAF = "0.33 0.52 0.27 1"


@dataclass(frozen=True)
class PropBody(ABC):
    """An object on the floor at ``x``, ``y`` [m] with a ``heading`` [rad]."""

    x: float
    y: float
    heading: float = 0.0

    def __post_init__(self) -> None:
        for part in fields(self):
            value = getattr(self, part.name)
            number = not isinstance(value, bool | str | tuple)
            signed = part.name in ("x", "y", "heading")
            if number and not (math.isfinite(value) and (signed or value > 0.0)):
                raise InputError(
                    f"{type(self).__name__}: {part.name} = {value} must be finite{'' if signed else ' and above 0'}"
                )

    @property
    def movable(self) -> bool:
        """Whether it can be pushed."""
        return False

    @property
    def weight(self) -> float:
        """Mass in a collision [kg]; infinite for a fixed object."""
        return math.inf

    @abstractmethod
    def body(self, name: str) -> Element:
        """Return the object as an MJCF body."""

    @abstractmethod
    def outline(self) -> Floats | None:
        """Return the outline ``[N, 2]`` [m] that people avoid, counter-clockwise; None: people do not avoid it."""

    def _standing(self, name: str, height: float) -> Element:
        place = {"pos": row((self.x, self.y, height)), "euler": row((0.0, 0.0, self.heading))}
        return Element("body", {"name": name, **place})

    def _ring(self, length: float, width: float) -> Floats:
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        corners = 0.5 * np.array([[-length, -width], [length, -width], [length, width], [-length, width]])
        return np.asarray(corners @ np.array([[cos, sin], [-sin, cos]]) + (self.x, self.y))


@dataclass(frozen=True)
class CubeBody(PropBody):
    """A box of ``size`` [m] and ``mass`` [kg] on the floor; it can be pushed unless it is ``fixed``.

    Raises:
        InputError: a number is not finite, or a size, mass or friction is not above 0.

    >>> CubeBody(1.0, 2.0, size=0.4).movable
    True
    """

    size: float = 0.5
    mass: float = 10.0
    friction: float = 0.5
    fixed: bool = False
    color: Color = (0.80, 0.62, 0.38)

    @property
    def movable(self) -> bool:
        """Whether it can be pushed."""
        return not self.fixed

    @property
    def weight(self) -> float:
        """Mass in a collision [kg]."""
        return math.inf if self.fixed else self.mass

    def body(self, name: str) -> Element:
        """Return the object as an MJCF body."""
        half = 0.5 * self.size
        element = self._standing(name, half)
        if not self.fixed:
            inertia = self.mass * self.size**2 / 6.0
            element.children += [
                Element("freejoint", {"name": name}),
                Element("inertial", {"pos": "0 0 0", "mass": row((self.mass,)), "diaginertia": row([inertia] * 3)}),
            ]
        layer = DYNAMIC if not self.fixed else STANDING
        values = {"type": "box", "size": row([half] * 3), "rgba": row((*self.color, 1.0)), "group": "0"}
        rub = {
            "friction": row((self.friction, 0.005, 0.0001)),
            "priority": "1",
        }  # its own friction instead of that of the floor
        element.children.append(Element("geom", {"name": f"{name}/0", **values, **rub, **layer}))
        return element

    def outline(self) -> Floats | None:
        """Return the outline that people avoid; None for a movable box."""
        return self._ring(self.size, self.size) if self.fixed else None


@dataclass(frozen=True)
class TableBody(PropBody):
    """A fixed table: a top of ``length``, ``width`` at ``height`` [m] on four legs."""

    length: float = 1.6
    width: float = 0.8
    height: float = 0.74

    def body(self, name: str) -> Element:
        """Return the object as an MJCF body."""
        element = self._standing(name, 0.0)
        shared = {"type": "box", "rgba": "0.62 0.44 0.30 1", "group": "0", **STANDING}
        top = {"pos": row((0.0, 0.0, self.height - LEG / 2)), "size": row((self.length / 2, self.width / 2, LEG / 2))}
        element.children.append(Element("geom", {"name": f"{name}/0", **shared, **top}))
        tall = (self.height - LEG) / 2
        corners = [(a * (self.length - LEG) / 2, b * (self.width - LEG) / 2) for a in (-1, 1) for b in (-1, 1)]
        for number, (x, y) in enumerate(corners):
            leg = {"pos": row((x, y, tall)), "size": row((LEG / 2, LEG / 2, tall))}
            element.children.append(Element("geom", {"name": f"{name}/{number + 1}", **shared, **leg}))
        return element

    def outline(self) -> Floats | None:
        """Return the outline that people avoid."""
        return self._ring(self.length, self.width)


@dataclass(frozen=True)
class TreeBody(PropBody):
    """A tree of ``height`` [m]; ``trunk`` and ``crown`` are radii [m]."""

    height: float = 5.0
    trunk: float = 0.15
    crown: float = 1.4

    def body(self, name: str) -> Element:
        """Return the object as an MJCF body."""
        element = self._standing(name, 0.0)
        stem = max(0.3 * self.height, self.height - 1.6 * self.crown)
        wood = {"type": "cylinder", "size": row((self.trunk, stem / 2)), "pos": row((0.0, 0.0, stem / 2))}
        element.children.append(Element("geom", {"name": f"{name}/0", "rgba": BARK, "group": "0", **wood, **STANDING}))
        tall = 0.5 * (self.height - stem) + 0.2 * self.crown
        leaves = {"type": "ellipsoid", "size": row((self.crown, self.crown, tall))}
        leaves |= {"pos": row((0.0, 0.0, self.height - tall)), "rgba": LEAF, "group": "0"}
        element.children.append(Element("geom", {"name": f"{name}/1", "contype": "0", "conaffinity": "0", **leaves}))
        return element

    def outline(self) -> Floats | None:
        """Return the outline that people avoid."""
        return self._ring(2.0 * self.trunk, 2.0 * self.trunk)


@dataclass(frozen=True)
class AbsentProp(PropBody):
    """The place of a prop that was removed: the numbers of the other props do not change."""

    x: float = 0.0
    y: float = 0.0

    def body(self, name: str) -> Element:
        """Return an empty body."""
        return Element("body", {"name": name})

    def outline(self) -> Floats | None:
        """Return None: people do not avoid it."""
        return None


@dataclass(frozen=True)
class LightSource:
    """A downward light at ``x``, ``y``, ``z`` [m] with a brightness from 0 to 1.

    Raises:
        InputError: a number is not finite, or the brightness is outside 0 to 1.
    """

    x: float
    y: float
    z: float = 4.0
    brightness: float = 0.5
    shadows: bool = False

    def __post_init__(self) -> None:
        for name in ("x", "y", "z"):
            if not math.isfinite(getattr(self, name)):
                raise InputError(f"LightSource: {name} = {getattr(self, name)} m must be finite")
        if not 0.0 <= self.brightness <= 1.0:
            raise InputError(f"LightSource: brightness = {self.brightness} must be from 0 to 1")

    def element(self, name: str) -> Element:
        """Return the light as an MJCF element."""
        values = {"name": name, "pos": row((self.x, self.y, self.z)), "dir": "0 0 -1", "cutoff": "85"}
        values |= {"diffuse": row([self.brightness] * 3), "specular": row([0.2 * self.brightness] * 3)}
        return Element("light", values | {"castshadow": str(self.shadows).lower()})


@dataclass(frozen=True)
class PhysicsStage:
    """Properties of a stage besides the walls of its scene.

    Fields:
        wall_height: height of all walls [m].
        friction: friction coefficient of the floor.
        props: objects on the floor.
        lights: lights (default: daylight).
        floor_color, wall_color: red, green, blue from 0 to 1.
        ground: ramps, stairs, platforms and thresholds; None: level.
        doors: doors; their state is that of a world.
        appearance: surfaces, sky and light in images of the renderer ``software``.
        building: a building that is drawn instead of the walls; sensors and people meet the walls.

    Raises:
        InputError: the height or the friction is not finite and above 0.

    >>> PhysicsStage(props=(CubeBody(1.0, 0.0), TableBody(3.0, 0.0))).outlines()[0].tolist()
    [[2.2, -0.4], [3.8, -0.4], [3.8, 0.4], [2.2, 0.4]]
    """

    wall_height: float = 2.5
    friction: float = 1.0
    props: tuple[PropBody, ...] = ()
    lights: tuple[LightSource, ...] = ()
    floor_color: Color = (0.80, 0.80, 0.78)
    wall_color: Color = (0.86, 0.84, 0.80)
    ground: Ground | None = None
    doors: tuple[DoorLeaf, ...] = ()
    appearance: StageAppearance = DAYLIGHT
    building: Building | None = None

    def __post_init__(self) -> None:
        for name in ("wall_height", "friction"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise InputError(f"PhysicsStage: {name} = {getattr(self, name)} must be finite and above 0")

    def outlines(self) -> tuple[Floats, ...]:
        """Return what people avoid: the outlines of props, and edges of the ground that are too high for them."""
        rings = tuple(ring for prop in self.props if (ring := prop.outline()) is not None)
        return rings + (() if self.ground is None else self.ground.people_barriers())


def without_prop(stage: PhysicsStage, number: int) -> PhysicsStage:
    """Return the stage without a prop; the numbers of the others do not change.

    >>> stage = PhysicsStage(props=(CubeBody(1.0, 0.0), TableBody(3.0, 0.0)))
    >>> [type(prop).__name__ for prop in without_prop(stage, 0).props], len(without_prop(stage, 1).props)
    (['AbsentProp', 'TableBody'], 1)
    """
    props = [AbsentProp() if k == number else prop for k, prop in enumerate(stage.props)]
    while props and isinstance(props[-1], AbsentProp):
        props.pop()
    return replace(stage, props=tuple(props))
