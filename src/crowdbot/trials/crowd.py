"""Crowd: the models of people, their routing, contact and limits.

A trial has one crowd model for all people, or several named crowds with a model each.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from crowdbot import world
from crowdbot.core import InputError, Walls
from crowdbot.core.fields import NAME, attribute, check, mounted_field
from crowdbot.models import CrowdModel, Mixture


@dataclass(frozen=True, kw_only=True)
class Crowd:
    """A crowd model. If a trial has several, each has a name that spawners and sources refer to."""

    name: str = attribute("", about="name that spawners and sources refer to", pattern=NAME)
    model: CrowdModel = mounted_field("models", "CrowdModel", drawn=True, about="crowd model")

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True)
class Crowds(Mixture):
    """Several named crowds, each with its model. Spawners and sources refer to them by name.

    Fields:
        models: model of each crowd.
        names: name of each crowd.

    Raises:
        InputError: a name is missing or used twice.

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
        """Return the crowds of a trial as one model; a single crowd without a name is its model itself."""
        if len(crowds) == 1 and not crowds[0].name:
            return crowds[0].model
        return Crowds(tuple(crowd.model for crowd in crowds), names=tuple(crowd.name for crowd in crowds))

    @staticmethod
    def spread(model: CrowdModel) -> tuple[Crowd, ...]:
        """Return the crowds of a model from :meth:`gather`."""
        if not isinstance(model, Crowds):
            return (Crowd(model=model),)
        return tuple(Crowd(name=name, model=item) for name, item in zip(model.names, model.models, strict=True))

    @staticmethod
    def problems(crowds: Sequence[Crowd]) -> Iterator[tuple[int, str]]:
        """Yield the index of every crowd with a missing or duplicate name, and the problem."""
        names = [crowd.name for crowd in crowds]
        for k, name in enumerate(names):
            if not name and len(names) > 1:
                yield k, "needs the attribute 'name': each of several crowds has its own"
            elif name in names[:k]:
                yield k, f"name {name!r} is already used by another crowd; names must differ"


def crowd_names(model: Any) -> tuple[str, ...]:
    """Return the names of the crowds of a trial; empty for a single crowd without a name."""
    return model.names if isinstance(model, Crowds) else ()


@dataclass(frozen=True, kw_only=True)
class Routing:
    """People take the shortest path around walls to their goals. Without routing they walk straight to them."""

    radius: float = attribute(0.3, about="distance that paths keep from walls", unit="m", exclusive_min=0.0, max=10.0)
    unreachable: str = attribute(
        "error",
        about="treatment of unreachable goals: an error, or the nearest reachable point",
        choices=("error", "nearest"),
    )

    def __post_init__(self) -> None:
        check(self)

    def router(self, walls: Walls) -> world.Router:
        """Return the router for these walls."""
        return world.Router.of(walls, self.radius, self.unreachable)


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits of speed and acceleration of people, applied after the crowd model."""

    max_speed: float | None = attribute(None, about="maximum speed", unit="m/s", exclusive_min=0.0)
    max_acceleration: float | None = attribute(
        None, about="maximum acceleration, including braking and turning", unit="m/s2", exclusive_min=0.0
    )

    def __post_init__(self) -> None:
        check(self)

    def limits(self) -> world.CrowdLimits:
        """Return the limits of a world."""
        return world.CrowdLimits(self.max_speed, self.max_acceleration)
