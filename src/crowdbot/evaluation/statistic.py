"""Statistics of a metric over runs, by name: ``collision-rate``, ``mean-jerk``, ``p95:min-clearance``."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.metrics import Metric, metric_table
from crowdbot.typing import Floats

from .intervals import Estimate, bootstrap_estimate, proportion_interval
from .own_metric import metric_name

RATES = {
    "success-rate": "success",
    "collision-rate": "collision",
    "person-collision-rate": "person_collision",
    "wall-collision-rate": "wall_collision",
    "object-collision-rate": "object_collision",
    "robot-collision-rate": "robot_collision",
    "timeout-rate": "timeout",
    "error-rate": "error",
}
"""Names of the shares of runs, with their metric; ``collision`` is a contact that ends a run, whatever is touched."""
QUANTILE = re.compile(r"p(\d{1,2})")
TAIL = re.compile(r"cvar(\d{1,2})")
OWN = re.compile(r"(?P<kind>[a-z]\w*:)?(?P<address>[^:]*(?:\.py|/):[A-Za-z_]\w*)")
"""A metric of users, after a kind."""


@dataclass(frozen=True)
class Statistic:
    """A number that summarises a metric over runs.

    Fields:
        name: as given, such as ``collision-rate``.
        metric: name of the metric, such as ``collision``.
        kind: ``rate``, ``mean``, ``median``, ``max``, ``min``, ``p5`` to ``p99``, or ``cvar5`` to ``cvar99``: the mean
            of the values at or above this percentile.
        address: class of a metric of users, such as ``mine.py:TimeNear``; empty for built-in metrics.
    """

    name: str
    metric: str
    kind: str
    address: str = ""

    @property
    def title(self) -> str:
        """Name with the unit of its metric, as the head of a column.

        >>> parse_statistic("p95:time-to-goal").title, parse_statistic("success-rate").title
        ('p95:time-to-goal [s]', 'success-rate [share]')
        """
        unit = "share" if self.kind == "rate" else metric_unit(self.metric)
        return f"{self.name} [{unit}]" if unit else self.name

    def estimate(self, values: Floats, confidence: float = 0.95) -> Estimate:
        """Return the statistic of one value for each run, with its interval.

        A run without the metric (NaN), such as the time to the goal of a run that fails, does not count. An infinite
        value counts where lower is better: one contact with a head, whose severity is infinite, makes the mean
        infinite. Other infinite values do not count, such as the time to collision of a run in which nobody comes
        nearer. The interval of ``max`` and ``min`` ends at the value: a bootstrap cannot go beyond what has been seen.
        """
        kept = np.asarray(values, dtype=np.float64)
        kept = kept[~np.isnan(kept)]
        if self.kind == "rate":
            return proportion_interval(int(np.sum(kept > 0.5)), len(kept), confidence)
        if not len(kept):
            return bootstrap_estimate(kept, confidence=confidence)
        function = _FUNCTIONS.get(self.kind) or _of_percentile(self.kind)
        return bootstrap_estimate(kept, function, confidence, infinite=_is_better_lower(self.metric))


def parse_statistic(name: str, metrics: Mapping[str, object] | None = None) -> Statistic:
    """Return the statistic with a name.

    Args:
        name: a share of runs, such as ``success-rate`` or ``person-collision-rate``; a metric, of which the mean is
            taken; or a metric after ``median:``, ``min:``, ``max:``, a percentile such as ``p95:`` or the mean of the
            tail above it, ``cvar95:``. A metric of users has its address: ``mine.py:TimeNear``.
        metrics: known metrics, to refuse others.

    Raises:
        InputError: there is no such metric or kind.

    >>> parse_statistic("collision-rate").metric, parse_statistic("p95:time-to-goal").kind
    ('collision', 'p95')
    """
    if own := OWN.fullmatch(name):
        word, address = metric_name(own["address"]), own["address"]
        statistic = parse_statistic(f"{own['kind'] or ''}{word}", metrics)
        return Statistic(f"{own['kind'] or ''}{word.replace('_', '-')}", word, statistic.kind, address)
    kind, colon, word = name.rpartition(":")
    if not colon and word in RATES:
        return Statistic(name, RATES[word], "rate")
    kind = kind if colon else "mean"
    if kind not in _FUNCTIONS and not (QUANTILE.fullmatch(kind) or TAIL.fullmatch(kind)):
        kinds = f"{', '.join(_FUNCTIONS)}, p5 to p99 and cvar5 to cvar99"
        raise InputError(f"statistic {name!r}: {kind!r} is unknown; possible are {kinds}")
    metric = word.replace("-", "_")
    if metrics is not None and metric not in metrics:
        known = [*RATES, *(metric.replace("_", "-") for metric in metrics)]
        hint = did_you_mean(word, known) or f"; known are {', '.join(known)}"
        raise InputError(f"there is no metric {word!r}{hint}")
    return Statistic(name, metric, kind)


def metric_title(metric: str) -> str:
    """Return the name and the unit of a metric over runs, as the head of its column: a share of runs, or its mean.

    >>> metric_title("person_collision"), metric_title("time_to_goal")
    ('person-collision-rate [share]', 'time-to-goal [s]')
    """
    rate = next((name for name, item in RATES.items() if item == metric), None)
    return Statistic(rate or metric.replace("_", "-"), metric, "rate" if rate else "mean").title


def check_metrics(statistics: Iterable[Statistic]) -> None:
    """Check that the metrics of statistics exist, before any run.

    Raises:
        InputError: there is no such metric.

    >>> check_metrics([parse_statistic("p95:time-to-goal")])
    >>> check_metrics([parse_statistic("time-to-gaol")])
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: there is no metric 'time-to-gaol', did you mean 'time-to-goal'?
    """
    statistics = list(statistics)
    own = {statistic.metric: None for statistic in statistics if statistic.address} | dict.fromkeys(RATES.values())
    for statistic in statistics:
        if statistic.metric not in own and _row_of(statistic.metric) is None:
            parse_statistic(statistic.name, {**own, **metric_table()})


_FUNCTIONS: dict[str, Callable[[Floats], Floats]] = {
    "mean": lambda rows: np.asarray(np.mean(rows, axis=1)),
    "median": lambda rows: np.asarray(np.median(rows, axis=1)),
    "min": lambda rows: np.asarray(np.min(rows, axis=1)),
    "max": lambda rows: np.asarray(np.max(rows, axis=1)),
}


def metric_unit(metric: str) -> str:
    """Return the unit of a metric, ``1`` for numbers and shares; empty if it is in no table.

    >>> metric_unit("min_clearance"), metric_unit("impact_severity_hand"), metric_unit("mine")
    ('m', '1', '')
    """
    row = _row_of(metric)
    return "" if row is None else row.unit


def _is_better_lower(metric: str) -> bool:
    """Return whether the table says that a metric is better when it is lower."""
    row = _row_of(metric)
    return row is not None and row.better == "lower"


def _row_of(metric: str) -> Metric | None:
    """Return the row of a metric in the table; those of body regions share one."""
    table = metric_table()
    family = next((name for name in table if name.endswith("*") and metric.startswith(name[:-1])), metric)
    return table.get(metric) or table.get(family)


def _of_percentile(kind: str) -> Callable[[Floats], Floats]:
    """Return a percentile of each row, or the mean of its values from there on (expected shortfall)."""
    if match := TAIL.fullmatch(kind):
        return functools.partial(_tail_mean, share=int(match[1]) / 100.0)
    share = int(kind[1:]) / 100.0
    return lambda rows: _quantile(rows, share)


def _quantile(rows: Floats, share: float) -> Floats:
    """Return a quantile of each row; next to an infinite value it is not interpolated."""
    if np.isfinite(rows).all():
        return np.asarray(np.quantile(rows, share, axis=1))
    return np.asarray(np.quantile(rows, share, axis=1, method="higher"))


def _tail_mean(rows: Floats, share: float) -> Floats:
    count = rows.shape[1]
    first = min(count - 1, math.ceil(share * count - 1e-9))
    return np.asarray(np.sort(rows, axis=1)[:, first:].mean(axis=1))
