"""Props: furniture, plants and lights of a stage."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot import world
from crowdbot.world import FLOORS, RANDOM, SKIES, WALL_SURFACES

from .fields import attribute, check


class _FixedProp(ABC):
    """A prop that is fixed to the floor."""

    def __post_init__(self) -> None:
        check(self)

    @abstractmethod
    def prop(self) -> world.PropBody:
        """Return the prop of a physics world."""

    @property
    def ring(self) -> NDArray[np.float64]:
        """Outline ``[N, 2]`` [m], counter-clockwise; for a tree the outline of its trunk."""
        return _outline(self.prop())


@dataclass(frozen=True, kw_only=True)
class Cube:
    """A box on the floor. In the physics world robots and people can push it unless it is fixed.

    >>> Cube(x=1, y=2, size=0.4).ring.round(9).tolist()[0]
    [0.8, 1.8]
    """

    x: float = attribute(about="x of the centre", unit="m")
    y: float = attribute(about="y of the centre", unit="m")
    heading: float = attribute(0.0, about="counter-clockwise from +x", unit="rad")
    size: float = attribute(0.5, about="edge length", unit="m", min=0.001, max=100.0)
    mass: float = attribute(10.0, about="mass", unit="kg", min=0.001, max=1e5)
    friction: float = attribute(0.5, about="friction coefficient on the floor", exclusive_min=0.0, max=10.0)
    fixed: bool = attribute(False, about="whether it is fixed to the floor")

    def __post_init__(self) -> None:
        check(self)

    @property
    def ring(self) -> NDArray[np.float64]:
        """Outline ``[N, 2]`` [m], counter-clockwise."""
        return _outline(world.CubeBody(**_values(Cube, self) | {"fixed": True}))

    def prop(self) -> world.PropBody:
        """Return the prop of a physics world."""
        return world.CubeBody(**_values(Cube, self))


@dataclass(frozen=True, kw_only=True)
class Table(_FixedProp):
    """A table, fixed to the floor."""

    x: float = attribute(about="x of the centre", unit="m")
    y: float = attribute(about="y of the centre", unit="m")
    heading: float = attribute(0.0, about="heading of the long side, counter-clockwise from +x", unit="rad")
    length: float = attribute(1.6, about="length of the top", unit="m", exclusive_min=0.05, max=100.0)
    width: float = attribute(0.8, about="width of the top", unit="m", exclusive_min=0.05, max=100.0)
    height: float = attribute(0.74, about="above the floor", unit="m", exclusive_min=0.05, max=100.0)

    def prop(self) -> world.PropBody:
        """Return the prop of a physics world."""
        return world.TableBody(**_values(Table, self))


@dataclass(frozen=True, kw_only=True)
class Tree(_FixedProp):
    """A tree, fixed to the floor."""

    x: float = attribute(about="x of the centre", unit="m")
    y: float = attribute(about="y of the centre", unit="m")
    heading: float = attribute(0.0, about="counter-clockwise from +x", unit="rad")
    height: float = attribute(5.0, about="height", unit="m", min=0.001, max=100.0)
    trunk: float = attribute(0.15, about="radius of the trunk", unit="m", min=0.001, max=10.0)
    crown: float = attribute(1.4, about="radius of the crown", unit="m", min=0.001, max=50.0)

    def prop(self) -> world.PropBody:
        """Return the prop of a physics world."""
        return world.TreeBody(**_values(Tree, self))


@dataclass(frozen=True, kw_only=True)
class Light:
    """A lamp that shines down. A stage without lamps has daylight."""

    x: float = attribute(about="x coordinate", unit="m")
    y: float = attribute(about="y coordinate", unit="m")
    z: float = attribute(4.0, about="above the floor", unit="m", exclusive_min=0.0, max=1000.0)
    brightness: float = attribute(0.5, about="brightness, 0 to 1", min=0.0, max=1.0)
    shadows: bool = attribute(False, about="whether it casts shadows")

    def __post_init__(self) -> None:
        check(self)

    def light(self) -> world.LightSource:
        """Return the light of a physics world."""
        return world.LightSource(**_values(Light, self))


@dataclass(frozen=True, kw_only=True)
class Appearance:
    """Surfaces, sky and light of a stage in images. Nothing else depends on them.

    >>> Appearance(floor="wood", sky="random").appearance().floor
    'wood'
    """

    floor: str = attribute(
        "tiles", about="surface of the floor; random: drawn for each seed", choices=(*FLOORS, RANDOM)
    )
    walls: str = attribute("plaster", about="surface of walls", choices=(*WALL_SURFACES, RANDOM))
    sky: str = attribute("clear", about="sky and light; random: also the place of the sun", choices=(*SKIES, RANDOM))
    sun_heading: float = attribute(
        2.15, about="direction in which the sun shines, counter-clockwise from +x", unit="rad"
    )
    sun_elevation: float = attribute(0.95, about="height of the sun", unit="rad", min=0.0873, max=1.5707)

    def __post_init__(self) -> None:
        check(self)

    def appearance(self) -> world.StageAppearance:
        """Return the surfaces, sky and light of a physics world."""
        return world.StageAppearance(**_values(Appearance, self))


Prop = Cube | Table | Tree


def _values(cls: type[Any], thing: Any) -> dict[str, Any]:
    """Return the fields of an element of a class; ``thing`` may be partial."""
    return {field.name: getattr(thing, field.name) for field in dataclasses.fields(cls)}


def _outline(body: world.PropBody) -> NDArray[np.float64]:
    ring = body.outline()
    assert ring is not None
    return ring
