"""The parts of a trial that checks look at, whether it was made in Python or could be read only in part."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any

from crowdbot.models import CrowdModel

from .agent import Agent
from .camera import Camera
from .crowd import Routing
from .journey import Exit, Journey, Portal
from .people import Source, Spawner
from .recorded_people import RecordedPeople
from .stage import Stage
from .trial import Recording, Robot, Trial

__all__ = ["Checked", "Problems"]

Problems = Iterator[tuple[Any, str]]
"""Elements that have a problem, each with the end of a sentence about it."""


@dataclass(frozen=True)
class Checked:
    """The parts of a trial that are there; None for those that could not be read.

    ``broken`` are the elements of which one could not be read, so that others may well have named it.
    """

    stage: Stage | None
    crowd: CrowdModel | None
    routing: Routing | None
    journeys: Sequence[Journey]
    agents: Sequence[Agent]
    spawners: Sequence[Spawner]
    sources: Sequence[Source]
    recorded: Sequence[RecordedPeople]
    exits: Sequence[Exit]
    portals: Sequence[Portal]
    robots: Sequence[Robot]
    cameras: Sequence[Camera]
    capacity: int | None
    step: float | None
    seed: int
    duration: float | None
    recording: Recording | None
    broken: Collection[str] = ()

    @property
    def people(self) -> tuple[Agent | Spawner | Source, ...]:
        """Where people come from."""
        return (*self.agents, *self.spawners, *self.sources)

    @classmethod
    def of(cls, values: dict[str, Any], broken: Collection[str] = ()) -> Checked:
        """Take the parts from the fields of a trial that could be read."""
        lists = ("journeys", "agents", "spawners", "sources", "recorded", "exits", "portals", "robots", "cameras")
        empty: dict[str, Any] = dict.fromkeys(lists, ()) | {"seed": 0}
        names = [field.name for field in fields(cls) if field.name != "broken"]
        parts: dict[str, Any] = {name: values.get(name, empty.get(name)) for name in names}
        return cls(**parts, broken=broken)

    @classmethod
    def all_of(cls, trial: Trial) -> Checked:
        """Take the parts of a whole trial."""
        return cls.of({field.name: getattr(trial, field.name) for field in fields(cls) if field.name != "broken"})
