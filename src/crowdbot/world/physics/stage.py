"""PhysicsStage: wall height, floor, props and lights of a physics world."""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from crowdbot.core import Element, InputError, did_you_mean
from crowdbot.core.fields import attribute, check
from crowdbot.typing import Floats
from crowdbot.world.building import Building
from crowdbot.world.doors.door import Door
from crowdbot.world.ground.ground import Ground
from crowdbot.world.stage_appearance import Appearance
from crowdbot.world.urdf.geoms import row

from .layers import DYNAMIC, STANDING

Color = tuple[float, float, float]
LEG = 0.05
"""Width of the legs and thickness of the top of a table [m]."""
CHAIR_LEG = 0.035
"""Width of the legs of a chair, and thickness of its seat and its back [m]."""
DAYLIGHT = Appearance()
BARK = "0.45 0.33 0.22 1"
WOOD = "0.50 0.34 0.22 1"
BOX = {"type": "box", "group": "0", **STANDING}
LEAF = "0.33 0.52 0.27 1"


@dataclass(frozen=True)
class PropBody(ABC):
    """An object on the floor; an element of the stage of a trial."""

    x: float = attribute(about="x of the centre", unit="m")
    y: float = attribute(about="y of the centre", unit="m")
    heading: float = attribute(0.0, about="counter-clockwise from +x", unit="rad")

    def __post_init__(self) -> None:
        check(self)

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

    @property
    @abstractmethod
    def ring(self) -> Floats:
        """Outline ``[N, 2]`` [m], counter-clockwise; for a tree the outline of its trunk."""

    def outline(self) -> Floats | None:
        """Return the outline ``[N, 2]`` [m] that people avoid, counter-clockwise; None: people do not avoid it."""
        return self.ring

    def _standing(self, name: str, height: float) -> Element:
        place = {"pos": row((self.x, self.y, height)), "euler": row((0.0, 0.0, self.heading))}
        return Element("body", {"name": name, **place})

    def _rectangle(self, length: float, width: float) -> Floats:
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        corners = 0.5 * np.array([[-length, -width], [length, -width], [length, width], [-length, width]])
        return np.asarray(corners @ np.array([[cos, sin], [-sin, cos]]) + (self.x, self.y))


@dataclass(frozen=True)
class Cube(PropBody):
    """A box on the floor. In the physics world robots and people can push it unless it is fixed.

    Raises:
        InputError: a value is not allowed.

    >>> Cube(1.0, 2.0, size=0.4).movable, Cube(x=1, y=2, size=0.4).ring.round(9).tolist()[0]
    (True, [0.8, 1.8])
    """

    color: ClassVar[Color] = (0.80, 0.62, 0.38)
    size: float = attribute(0.5, about="edge length", unit="m", min=0.001, max=100.0)
    mass: float = attribute(10.0, about="mass", unit="kg", min=0.001, max=1e5)
    friction: float = attribute(0.5, about="friction coefficient on the floor", exclusive_min=0.0, max=10.0)
    fixed: bool = attribute(False, about="whether it is fixed to the floor")

    @property
    def movable(self) -> bool:
        return not self.fixed

    @property
    def weight(self) -> float:
        return math.inf if self.fixed else self.mass

    def body(self, name: str) -> Element:
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

    @property
    def ring(self) -> Floats:
        return self._rectangle(self.size, self.size)

    def outline(self) -> Floats | None:
        return self.ring if self.fixed else None  # people do not avoid a movable box


@dataclass(frozen=True)
class Table(PropBody):
    """A table, fixed to the floor."""

    heading: float = attribute(0.0, about="heading of the long side, counter-clockwise from +x", unit="rad")
    length: float = attribute(1.6, about="length of the top", unit="m", exclusive_min=0.05, max=100.0)
    width: float = attribute(0.8, about="width of the top", unit="m", exclusive_min=0.05, max=100.0)
    height: float = attribute(0.74, about="above the floor", unit="m", exclusive_min=0.05, max=100.0)

    def body(self, name: str) -> Element:
        element = self._standing(name, 0.0)
        element.children.extend(_on_legs(name, "0.62 0.44 0.30 1", (self.length, self.width, self.height), LEG))
        return element

    @property
    def ring(self) -> Floats:
        return self._rectangle(self.length, self.width)


@dataclass(frozen=True)
class Chair(PropBody):
    """A chair with four legs and a back, fixed to the floor.

    People avoid its seat as a solid square; in space a scanner below the seat meets the legs only.

    >>> Chair(1.0, 2.0).ring.round(2).tolist()
    [[0.78, 1.78], [1.22, 1.78], [1.22, 2.22], [0.78, 2.22]]
    """

    heading: float = attribute(0.0, about="where a person on it looks, counter-clockwise from +x", unit="rad")
    size: float = attribute(0.44, about="side of the seat", unit="m", min=0.1, max=10.0)
    seat: float = attribute(0.46, about="height of the seat", unit="m", min=0.1, max=10.0)
    height: float = attribute(0.86, about="height of the back, above the seat", unit="m", min=0.1, max=20.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        lowest = self.seat + CHAIR_LEG
        if self.height < lowest:
            raise InputError(
                f"height = {self.height:g} m must be at least {lowest:g} m, above the seat = {self.seat:g} m"
            )

    def body(self, name: str) -> Element:
        element = self._standing(name, 0.0)
        element.children.extend(_on_legs(name, WOOD, (self.size, self.size, self.seat), CHAIR_LEG))
        tall = (self.height - self.seat) / 2
        back = {"pos": row(((CHAIR_LEG - self.size) / 2, 0.0, self.seat + tall))}
        back |= {"size": row((CHAIR_LEG / 2, self.size / 2, tall))}
        element.children.append(Element("geom", {"name": f"{name}/5", "rgba": WOOD, **BOX, **back}))
        return element

    @property
    def ring(self) -> Floats:
        return self._rectangle(self.size, self.size)


def _on_legs(name: str, color: str, size: tuple[float, float, float], leg: float) -> list[Element]:
    """Return the boxes of a plate on four legs, of this length, width and height; ``leg`` is the width of all."""
    length, width, height = size
    shared = {"rgba": color, **BOX}
    top = {"pos": row((0.0, 0.0, height - leg / 2)), "size": row((length / 2, width / 2, leg / 2))}
    result = [Element("geom", {"name": f"{name}/0", **shared, **top})]
    tall = (height - leg) / 2
    corners = [(a * (length - leg) / 2, b * (width - leg) / 2) for a in (-1, 1) for b in (-1, 1)]
    for number, (x, y) in enumerate(corners):
        foot = {"pos": row((x, y, tall)), "size": row((leg / 2, leg / 2, tall))}
        result.append(Element("geom", {"name": f"{name}/{number + 1}", **shared, **foot}))
    return result


@dataclass(frozen=True)
class Tree(PropBody):
    """A tree, fixed to the floor."""

    height: float = attribute(5.0, about="height", unit="m", min=0.001, max=100.0)
    trunk: float = attribute(0.15, about="radius of the trunk", unit="m", min=0.001, max=10.0)
    crown: float = attribute(1.4, about="radius of the crown", unit="m", min=0.001, max=50.0)

    def body(self, name: str) -> Element:
        element = self._standing(name, 0.0)
        stem = max(0.3 * self.height, self.height - 1.6 * self.crown)
        wood = {"type": "cylinder", "size": row((self.trunk, stem / 2)), "pos": row((0.0, 0.0, stem / 2))}
        element.children.append(Element("geom", {"name": f"{name}/0", "rgba": BARK, "group": "0", **wood, **STANDING}))
        tall = 0.5 * (self.height - stem) + 0.2 * self.crown
        leaves = {"type": "ellipsoid", "size": row((self.crown, self.crown, tall))}
        leaves |= {"pos": row((0.0, 0.0, self.height - tall)), "rgba": LEAF, "group": "0"}
        element.children.append(Element("geom", {"name": f"{name}/1", "contype": "0", "conaffinity": "0", **leaves}))
        return element

    @property
    def ring(self) -> Floats:
        return self._rectangle(2.0 * self.trunk, 2.0 * self.trunk)


@dataclass(frozen=True)
class AbsentProp(PropBody):
    """The place of a prop that was removed: the numbers of the other props do not change."""

    x: float = 0.0
    y: float = 0.0

    def body(self, name: str) -> Element:
        return Element("body", {"name": name})

    @property
    def ring(self) -> Floats:
        return np.zeros((0, 2))

    def outline(self) -> Floats | None:
        return None


@dataclass(frozen=True)
class Light:
    """A lamp that shines down. A stage without lamps has daylight.

    Raises:
        InputError: a value is not allowed.
    """

    x: float = attribute(about="x coordinate", unit="m")
    y: float = attribute(about="y coordinate", unit="m")
    z: float = attribute(4.0, about="above the floor", unit="m", exclusive_min=0.0, max=1000.0)
    brightness: float = attribute(0.5, about="brightness, 0 to 1", min=0.0, max=1.0)
    shadows: bool = attribute(False, about="whether it casts shadows")

    def __post_init__(self) -> None:
        check(self)

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

    >>> PhysicsStage(props=(Cube(1.0, 0.0), Table(3.0, 0.0))).outlines()[0].tolist()
    [[2.2, -0.4], [3.8, -0.4], [3.8, 0.4], [2.2, 0.4]]
    """

    wall_height: float = 2.5
    friction: float = 1.0
    props: tuple[PropBody, ...] = ()
    lights: tuple[Light, ...] = ()
    floor_color: Color = (0.80, 0.80, 0.78)
    wall_color: Color = (0.86, 0.84, 0.80)
    ground: Ground | None = None
    doors: tuple[Door, ...] = ()
    appearance: Appearance = DAYLIGHT
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

    >>> stage = PhysicsStage(props=(Cube(1.0, 0.0), Table(3.0, 0.0)))
    >>> [type(prop).__name__ for prop in without_prop(stage, 0).props], len(without_prop(stage, 1).props)
    (['AbsentProp', 'Table'], 1)
    """
    props = [AbsentProp() if k == number else prop for k, prop in enumerate(stage.props)]
    while props and isinstance(props[-1], AbsentProp):
        props.pop()
    return replace(stage, props=tuple(props))


def new_prop_name(names: Sequence[str], name: str) -> str:
    """Return the name of a new prop, ``prop`` with its number by default.

    Raises:
        InputError: the name is taken.
    """
    numbers = (f"prop{k}" for k in itertools.count(len(names)))
    name = name or next(number for number in numbers if number not in names)
    if name in names:
        raise InputError(f"there is already a prop {name!r}; names of props must differ")
    return name


def prop_number(names: Sequence[str], name: str) -> int:
    """Return the number of a prop.

    Raises:
        InputError: there is no prop of this name.
    """
    if not name or name not in names:
        known = [name for name in names if name]
        meant = did_you_mean(name, known)
        raise InputError(f"there is no prop {name!r}{meant}; props are {', '.join(known) or 'none'}")
    return list(names).index(name)


def without_prop_name(names: Sequence[str], number: int) -> list[str]:
    """Return the names of the props on a stage :func:`without_prop`.

    >>> without_prop_name(["table", "chair"], 0), without_prop_name(["", "chair"], 1)
    (['', 'chair'], [])
    """
    left = [*names[:number], "", *names[number + 1 :]]
    while left and not left[-1]:
        left.pop()
    return left
