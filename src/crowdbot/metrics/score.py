"""Score: the errors of one predictor under one protocol, as numbers that never lose the name of their protocol."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import InputError
from crowdbot.data.forecast import Forecast
from crowdbot.data.windows import Windows

from .displacement import PersonErrors, miss_rate, person_errors

__all__ = ["Score", "score"]


@dataclass(frozen=True)
class Score:
    """Errors of one predictor on some windows, means over persons.

    Fields:
        predictor: name of the predictor.
        protocol: name of the protocol that cut the windows.
        source: name of the recording, or of several joined by ``+``.
        windows: number of windows.
        persons: number of scored persons, counted once for each window.
        ade, fde: average and final displacement error [m].
        samples: futures per person; ``best_of`` is the rule that chose among them.
        miss_rate: share of persons whose final error is above 2 m; NaN in pixels.
        collisions: share of persons, in windows with at least two, predicted closer than 0.2 m to another; NaN when
            there are none, and in pixels. ``together`` is how many persons that is a share of.
        horizon: mean error [m] at each step; ``there`` is how many persons were still there.
        dt: the step [s]; NaN for recordings with different steps together.
        seconds_per_window: time to predict one window [s], NaN when it was not measured.
        units: ``m``; or ``px``, and then every [m] above is pixels.
    """

    predictor: str
    protocol: str
    source: str
    windows: int
    persons: int
    ade: float
    fde: float
    samples: int
    best_of: str
    miss_rate: float
    collisions: float
    together: int
    horizon: tuple[float, ...]
    there: tuple[int, ...]
    dt: float
    seconds_per_window: float = math.nan
    units: str = "m"

    @classmethod
    def of(cls, errors: PersonErrors, forecast: Forecast, future: Windows, best_of: str) -> Score:
        """Summarise errors of people; forecast and future say where they come from and how many windows there are.

        Raises:
            InputError: nobody is scored.
        """
        persons = len(errors.ade)
        if persons == 0:
            raise InputError(f"protocol {future.protocol!r} scores nobody in {len(future)} windows of {future.source}")
        metric = future.units == "m"
        together = int(errors.together.sum()) if metric else 0
        return cls(
            predictor=forecast.predictor,
            protocol=future.protocol,
            source=future.source,
            windows=len(future),
            persons=persons,
            ade=float(errors.ade.mean()),
            fde=float(errors.fde.mean()),
            samples=forecast.samples,
            best_of=best_of,
            miss_rate=miss_rate(errors.fde) if metric else math.nan,
            collisions=float(errors.collided[errors.together].mean()) if together else math.nan,
            together=together,
            horizon=tuple(errors.over_horizon().tolist()),
            there=tuple(errors.exists.sum(axis=0).tolist()),
            dt=future.dt,
            units=future.units,
        )

    @classmethod
    def total(cls, scores: Sequence[Score]) -> Score:
        """Return the score of several recordings together, every mean taken over all their persons.

        Raises:
            InputError: there is no score, or they differ in predictor, protocol, samples, rule, units or horizon.
        """
        if not scores:
            raise InputError("a total needs at least one score")
        if len(scores) == 1:
            return scores[0]
        first = scores[0]
        for name in ("predictor", "protocol", "samples", "best_of", "units"):
            values = [getattr(one, name) for one in scores]
            if any(value != values[0] for value in values):
                raise InputError(f"scores with different {name} cannot be added up: {', '.join(map(repr, values))}")
        if len({len(one.horizon) for one in scores}) > 1:
            reach = ", ".join(str(len(one.horizon)) for one in scores)
            raise InputError(f"scores of different horizons cannot be added up: {reach} steps")
        persons = [one.persons for one in scores]
        windows = [one.windows for one in scores]
        there = [tuple(one.there) for one in scores]
        return dataclasses.replace(
            first,
            source=" + ".join(one.source for one in scores),
            windows=sum(windows),
            persons=sum(persons),
            ade=_mean([one.ade for one in scores], persons),
            fde=_mean([one.fde for one in scores], persons),
            miss_rate=_mean([one.miss_rate for one in scores], persons),
            collisions=_mean([one.collisions for one in scores], [one.together for one in scores]),
            together=sum(one.together for one in scores),
            horizon=tuple(map(_mean, zip(*(one.horizon for one in scores), strict=True), zip(*there, strict=True))),
            there=tuple(sum(counts) for counts in zip(*there, strict=True)),
            dt=first.dt if all(one.dt == first.dt for one in scores) else math.nan,
            seconds_per_window=_mean([one.seconds_per_window for one in scores], windows),
        )

    def as_dict(self) -> dict[str, Any]:
        """Return every field by its name, for JSON."""
        return dataclasses.asdict(self)

    @property
    def columns(self) -> tuple[str, ...]:
        """Heads of the columns of :meth:`cells`."""
        return ("windows", "persons", f"ADE [{self.units}]", f"FDE [{self.units}]", "collisions", "ms/window")

    def cells(self) -> tuple[str, ...]:
        """Return the main numbers as words for a table; what was not measured is ``-``."""
        clash = "-" if math.isnan(self.collisions) else f"{100.0 * self.collisions:.1f} %"
        time = "-" if math.isnan(self.seconds_per_window) else f"{1e3 * self.seconds_per_window:.3g}"
        return (str(self.windows), str(self.persons), f"{self.ade:.3f}", f"{self.fde:.3f}", clash, time)

    def __str__(self) -> str:
        """Return one paragraph that carries protocol, predictor and counts."""
        best = f", best of {self.samples} per {self.best_of}" if self.samples > 1 else ""
        length = "different lengths" if math.isnan(self.dt) else f"{self.dt:g} s"
        reach = f"{len(self.horizon)} steps of {length}"
        time = "" if math.isnan(self.seconds_per_window) else f", {1e3 * self.seconds_per_window:.3g} ms a window"
        miss = "" if math.isnan(self.miss_rate) else f", missed by 2 m {100 * self.miss_rate:.1f} %"
        clash = "" if math.isnan(self.collisions) else f", collisions {100 * self.collisions:.1f} %"
        return (
            f"{self.predictor} on {self.source}: ADE {self.ade:.3f} {self.units}, FDE {self.fde:.3f} {self.units}"
            f" (protocol {self.protocol}, {reach}{best}; {self.persons} persons in {self.windows} windows"
            f"{miss}{clash}{time})"
        )


def score(forecast: Forecast, future: Windows, best_of: str = "person") -> Score:
    """Score a forecast against what happened.

    Args:
        forecast: of W windows.
        future: the same windows, whose ``scored`` mask is the protocol's.
        best_of: how the best of K samples is chosen, see :func:`~crowdbot.metrics.best_of`.

    Raises:
        InputError: they do not belong together, a scored person was not predicted, or nobody is scored.

    >>> import numpy as np
    >>> here = np.ones((1, 2, 1), dtype=bool)
    >>> future = Windows(np.zeros((1, 2, 1, 2)), here, here[:, 0], ~here[:, 0], np.array([[7]]),
    ...     np.array([[10, 20]]), 0.4, "all", "street")
    >>> print(score(Forecast.of(np.full((1, 1, 2, 1, 2), 0.1), here[:, 0], 0.4, "me"), future))
    me on street: ADE 0.141 m, FDE 0.141 m (protocol all, 2 steps of 0.4 s; 1 persons in 1 windows, missed by 2 m 0.0 %)
    """
    return Score.of(person_errors(forecast, future, best_of), forecast, future, best_of)


def _mean(values: Sequence[float], counts: Sequence[int]) -> float:
    """Return the mean weighted by counts; values without a count do not matter."""
    total = sum(counts)
    known = [(value, count) for value, count in zip(values, counts, strict=True) if count > 0]
    return float(np.sum([value * count for value, count in known]) / total) if total else math.nan
