"""Requirements on statistics, such as ``collision-rate<0.01@95%``, and their verdicts."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .intervals import Estimate
from .statistic import Statistic, parse_statistic

TEXT = re.compile(r"\s*([^<>=@\s]+)\s*(<=|>=|<|>)\s*([-+]?[0-9.]+(?:e[-+]?\d+)?)\s*(?:@\s*([0-9.]+)\s*%)?\s*")


class RequirementVerdict(NamedTuple):
    """Whether a requirement holds for one method in one trial.

    Fields:
        holds: whether it holds; a requirement with a confidence holds only if the whole interval does.
        estimate: the statistic with its interval.
        sentence: the verdict in words.
    """

    holds: bool
    estimate: Estimate
    sentence: str


@dataclass(frozen=True)
class Requirement:
    """A bound on a statistic.

    Fields:
        text: as given.
        statistic: what is bounded.
        comparison: ``<``, ``<=``, ``>`` or ``>=``.
        bound: the bound.
        confidence: confidence with which it must hold, or None: the value itself must hold.
    """

    text: str
    statistic: Statistic
    comparison: str
    bound: float
    confidence: float | None

    def judge(self, values: NDArray[np.float64]) -> RequirementVerdict:
        """Judge the values of the metric, one for each run.

        With a confidence of 95 %, the bound of a one-sided 95 % interval must hold, which is a bound of the two-sided
        90 % interval. Without any value the requirement does not hold.
        """
        level = 0.95 if self.confidence is None else 2.0 * self.confidence - 1.0
        estimate = self.statistic.estimate(values, level)
        upper = self.comparison in ("<", "<=")
        seen = estimate.value if self.confidence is None else (estimate.high if upper else estimate.low)
        holds = {"<": seen < self.bound, "<=": seen <= self.bound, ">": seen > self.bound, ">=": seen >= self.bound}
        name = self.statistic.name
        if math.isnan(seen):
            told = f"{name} has too few values ({estimate.runs})"
        elif self.confidence is None:
            told = f"{name} is {seen:.4g} in {estimate.runs} runs, required {self.comparison} {self.bound:g}"
        else:
            side = "at most" if upper else "at least"
            told = (
                f"{name} is {estimate.value:.4g} in {estimate.runs} runs, {side} {seen:.4g} with"
                f" {100 * self.confidence:g} % confidence, required {self.comparison} {self.bound:g}"
            )
        return RequirementVerdict(bool(holds[self.comparison]), estimate, told)


def parse_requirement(text: str, metrics: dict[str, object] | None = None) -> Requirement:
    """Return the requirement in a text.

    Args:
        text: ``statistic < bound``, optionally followed by ``@95%``; see :func:`parse_statistic`.
        metrics: known metrics, to refuse others.

    Raises:
        InputError: the text is not a requirement, or its confidence is not between 50 and 100 %.

    >>> requirement = parse_requirement("collision-rate<0.01@95%")
    >>> requirement.judge(np.zeros(100)).sentence
    'collision-rate is 0 in 100 runs, at most 0.02951 with 95 % confidence, required < 0.01'
    >>> requirement.judge(np.zeros(400)).holds
    True
    """
    match = TEXT.fullmatch(text)
    if match is None:
        more = "; give each bound with its own --require" if re.search("[,;]", text) else ""
        raise InputError(f"requirement {text!r} must be like collision-rate<0.01@95% or min-clearance>0.2{more}")
    name, comparison, bound, confidence = match.groups()
    try:
        number = float(bound)
        level = None if confidence is None else float(confidence) / 100.0
    except ValueError:
        raise InputError(f"requirement {text!r} has an invalid number") from None
    if level is not None and not 0.5 < level < 1.0:
        raise InputError(f"requirement {text!r}: the confidence {confidence} % must be above 50 and below 100")
    return Requirement(text.strip(), parse_statistic(name, metrics), comparison, number, level)
