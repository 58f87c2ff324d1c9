"""Rows of the benchmark of engines."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class EngineRow:
    """Time of a step of a model and of the same model in another engine.

    Fields:
        model: name of our model.
        engine: name of the other engine.
        people: number of people.
        order: order of the people in memory, ``random`` or ``sorted`` by place.
        threads: threads of both.
        dt: time step of both [s].
        ours, theirs: median time of a step [ms].
        ratio: ``theirs / ours``, the median over the repetitions.
        low, high: 10th and 90th percentile of these ratios.
    """

    model: str
    engine: str
    people: int
    order: str
    threads: int
    dt: float
    ours: float
    theirs: float
    ratio: float
    low: float
    high: float

    def as_dict(self) -> dict[str, Any]:
        """Return the row as ``crowdbot bench engines --json`` prints it."""
        return asdict(self)


@dataclass(frozen=True)
class MillionRow:
    """A step of a very large crowd in a process of its own.

    Fields:
        model: name of the model.
        people: number of people.
        seconds: shortest time of a step [s].
        megabytes: largest memory of the process [MB].
    """

    model: str
    people: int
    seconds: float
    megabytes: float
