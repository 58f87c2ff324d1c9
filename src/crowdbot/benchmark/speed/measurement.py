"""Results of a benchmark: timed work, or a value that is read once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Measurement:
    """Work to time: ``work()`` processes ``amount`` units; its speed is divided by ``reference`` [units/s].

    If ``other`` is given, it processes ``other_amount`` of the same units, and its speed is the reference.
    """

    unit: str
    amount: float
    work: Callable[[], object]
    against: str
    reference: float = 0.0
    other: Callable[[], object] | None = None
    other_amount: float = 0.0


@dataclass(frozen=True)
class Gauge:
    """A value that is read once and not timed; the ratio is ``value / reference``."""

    unit: str
    value: float
    against: str
    reference: float
