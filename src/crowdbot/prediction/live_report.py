"""LiveReport: what a live prediction took, and what its time bought."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from crowdbot.core import InputError

UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}
"""Units of durations [s]."""


@dataclass(frozen=True)
class LiveReport:
    """What the last call of :meth:`Live.predict` took, and what it calibrated in this time.

    Fields:
        latency: duration of the call [s]; NaN before the first.
        budget: time that it had [s]; infinity without a limit.
        evaluations: candidate crowds that the calibration evaluated; 0 without calibration.
        wanted: candidate crowds of an unlimited calibration.
        cost: smallest cost that the calibration reached, in the unit of the cost; NaN without calibration.

    >>> str(LiveReport(0.039, 0.04, 120, 240, 0.031))
    '39 ms of 40 ms: 120 of 240 evaluations, cost 0.031'
    >>> LiveReport(0.05, 0.04).is_late
    True
    """

    latency: float = math.nan
    budget: float = math.inf
    evaluations: int = 0
    wanted: int = 0
    cost: float = math.nan

    @property
    def is_late(self) -> bool:
        """Whether the prediction took longer than its budget."""
        return self.latency > self.budget

    def __str__(self) -> str:
        """Return the report as a sentence."""
        if math.isnan(self.latency):
            return "no prediction yet"
        taken = f"{1e3 * self.latency:.3g} ms" + (f" of {1e3 * self.budget:.3g} ms" if self.budget < math.inf else "")
        late = ", too late" if self.is_late else ""
        searched = f": {self.evaluations} of {self.wanted} evaluations, cost {self.cost:.3g}" if self.wanted else ""
        return taken + late + searched


def parse_seconds(value: float | str, name: str) -> float:
    """Return a duration [s] from a number of seconds, or from a text with a unit (s, ms, us, min).

    Raises:
        InputError: the text is no number with a unit.

    >>> parse_seconds("40 ms", "budget"), parse_seconds("0.3s", "budget"), parse_seconds(2, "budget")
    (0.04, 0.3, 2.0)
    """
    if not isinstance(value, str):
        return float(value)
    match = re.fullmatch(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*([a-z]+)\s*", value)
    if match is None or match[2] not in UNITS:
        raise InputError(
            f"live: {name} = {value!r} is no duration; give seconds as a number, or a text with a unit"
            f" ({', '.join(UNITS)}), such as '40 ms'"
        )
    return float(match[1]) * UNITS[match[2]]
