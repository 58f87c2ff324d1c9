"""Crowd: by which model people walk, around which walls they find their way, and what their bodies do.

Everybody walks by the one model of a trial, or, when it has several named crowds, by that of the own crowd.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from crowdbot import world
from crowdbot.core import InputError, Walls
from crowdbot.models import CrowdModel, Mixture

from .fields import attribute, check, mounted_field
from .notation import NAME

__all__ = ["ContactSpec", "Crowd", "Crowds", "Limits", "Routing", "crowd_names"]


@dataclass(frozen=True, kw_only=True)
class Crowd:
    """A model and, when there are several, the name by which spawners and sources choose it."""

    name: str = attribute("", about="name that spawners and sources choose it by", pattern=NAME)
    model: CrowdModel = mounted_field("models", "CrowdModel", drawn=True, about="how its people walk")

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True)
class Crowds(Mixture):
    """Several named crowds, each with its model; spawners and sources say whose people are in which.

    Fields:
        models: of each crowd.
        names: of each crowd.

    Raises:
        InputError: names are missing, or not all different.

    >>> from crowdbot.models import ORCA, SocialForce
    >>> Crowds((ORCA(), SocialForce()), names=("calm", "hurried")).names
    ('calm', 'hurried')
    """

    names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "names", tuple(self.names))
        if self.which != 0 or len(self.names) != len(self.models):
            raise InputError(
                f"Crowds: {len(self.models)} models and the names {', '.join(self.names) or 'none'}; give each model a"
                " name, and leave out which: spawners and sources choose by name"
            )
        for k, sentence in self.problems(self.spread(self)):
            raise InputError(f"Crowds: crowd {k + 1} {sentence}")

    @staticmethod
    def gather(crowds: Sequence[Crowd]) -> CrowdModel:
        """Return the crowds of a trial as one model: the only one itself when it has no name."""
        if len(crowds) == 1 and not crowds[0].name:
            return crowds[0].model
        return Crowds(tuple(crowd.model for crowd in crowds), names=tuple(crowd.name for crowd in crowds))

    @staticmethod
    def spread(model: CrowdModel) -> tuple[Crowd, ...]:
        """Return the crowds that :meth:`gather` made a model of."""
        if not isinstance(model, Crowds):
            return (Crowd(model=model),)
        return tuple(Crowd(name=name, model=one) for name, one in zip(model.names, model.models, strict=True))

    @staticmethod
    def problems(crowds: Sequence[Crowd]) -> Iterator[tuple[int, str]]:
        """Yield the index of every crowd whose name is missing or taken, and a sentence."""
        names = [crowd.name for crowd in crowds]
        for k, name in enumerate(names):
            if not name and len(names) > 1:
                yield k, "needs the attribute 'name': of several crowds each has its own"
            elif name in names[:k]:
                yield k, f"name {name!r} is taken by another crowd; give each its own"


def crowd_names(model: Any) -> tuple[str, ...]:
    """Return the names of the crowds of a trial; none when it has one without a name."""
    return model.names if isinstance(model, Crowds) else ()


@dataclass(frozen=True, kw_only=True)
class Routing:
    """People find the shortest way around walls to their goals; without it they walk straight towards them."""

    radius: float = attribute(0.3, about="ways keep this far from walls", unit="m", exclusive_min=0.0, max=10.0)
    unreachable: str = attribute(
        "error", about="a goal that cannot be reached is an error, or the nearest place", choices=("error", "nearest")
    )

    def __post_init__(self) -> None:
        check(self)

    def router(self, walls: Walls) -> world.Router:
        """Return who leads people around these walls."""
        return world.Router.of(walls, self.radius, self.unreachable)


@dataclass(frozen=True, kw_only=True)
class ContactSpec:
    """People whose bodies overlap after a step are pushed apart, and nobody ends up in a wall."""

    variant: str = attribute(
        "position", about="overlaps end at once, or push with a force", choices=("position", "force")
    )
    stiffness: float = attribute(62.5, about="of a force, for each metre", unit="1/s2", exclusive_min=0.0, max=1e9)
    iterations: int = attribute(8, about="rounds of pushing by position in a step", min=1, max=1000)

    def __post_init__(self) -> None:
        check(self)

    def bodies(self) -> world.ContactModel:
        """Return what bodies do in a world."""
        return world.ContactModel(self.variant, self.stiffness, self.iterations)


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What people cannot go beyond, whatever their model asks for."""

    max_speed: float | None = attribute(None, about="largest speed", unit="m/s", exclusive_min=0.0)
    max_acceleration: float | None = attribute(
        None, about="largest change of velocity: speeding up, braking, turning", unit="m/s2", exclusive_min=0.0
    )

    def __post_init__(self) -> None:
        check(self)

    def limits(self) -> world.CrowdLimits:
        """Return the limits of a world."""
        return world.CrowdLimits(self.max_speed, self.max_acceleration)
