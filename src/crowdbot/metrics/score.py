"""Score: the errors of one predictor under one protocol, as numbers that never lose the name of their protocol."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data import Forecast, Windows

from .displacement import MISS, miss_rate
from .interval import Interval, Intervals, PersonValues
from .persons import PersonErrors, person_errors

SAMPLED = ("NLL", "energy")
"""Columns that a table of deterministic forecasts does without: they have no density, and their energy is the ADE."""

SWEPT = ("swept_collisions", "swept_contacts", "swept_collisions_truth", "swept_contacts_truth")


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
        samples: futures per person, those of weight 0 too; ``best_of`` is the rule that chose among them.
        miss_rate: share of persons whose final error is above 2 m; NaN in pixels.
        collisions: share of persons, in windows with at least two, predicted closer than 0.2 m to another; NaN when
            there are none, and in pixels. ``together`` is how many persons that is a share of.
        true_collisions: the same share for others, robots too, where they truly walked; of ``accompanied`` persons.
        swept_collisions, swept_contacts: shares of the ``together`` persons who come closer than 0.2 m, and than the
            sum of the radii, to another scored person of the same sample; people move straight between rows, from the
            last observed one. See :func:`~crowdbot.metrics.swept_collisions`. NaN without a past, and in pixels.
        swept_collisions_truth, swept_contacts_truth: the same shares of the true people.
        nll: negative log-likelihood by kernel densities [nat], a mean over the ``dense`` persons whose samples have a
            density; NaN for a deterministic forecast, see :func:`~crowdbot.metrics.kde_nll`.
        energy: energy score over steps [m], see :func:`~crowdbot.metrics.energy_score`: the ADE of a deterministic
            forecast; NaN for more than 100 samples, where it would take longer than all the rest.
        intervals: where the means are expected to lie, 95 %, see :func:`~crowdbot.metrics.bootstrap_interval`; NaN for
            a single person.
        horizon: mean error [m] at each step; ``there`` is how many persons were still there.
        dt: the step [s]; NaN for recordings with different steps together.
        seconds_per_window: time to predict one window [s], NaN when it was not measured.
        units: ``m``; or ``px``, and then every [m] above is pixels.
        people: what the intervals are drawn from, so that totals have theirs; not part of the JSON.
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
    true_collisions: float = math.nan
    accompanied: int = 0
    swept_collisions: float = math.nan
    swept_contacts: float = math.nan
    swept_collisions_truth: float = math.nan
    swept_contacts_truth: float = math.nan
    nll: float = math.nan
    dense: int = 0
    energy: float = math.nan
    intervals: Intervals = field(default_factory=Intervals)
    people: PersonValues | None = field(default=None, compare=False, repr=False)

    @classmethod
    def of(cls, errors: PersonErrors, predictor: str, samples: int, future: Windows, best_of: str) -> Score:
        """Summarise errors of people; the future says where they come from and how many windows there are.

        Raises:
            InputError: nobody is scored.
        """
        persons = len(errors.ade)
        if persons == 0:
            raise InputError(f"protocol {future.protocol!r} scores nobody in {len(future)} windows of {future.source}")
        metric = future.units == "m"
        together = errors.together & metric
        accompanied = errors.accompanied & metric
        people = PersonValues.of(errors.person, _values(errors, together, accompanied, metric))
        return cls(
            predictor=predictor,
            protocol=future.protocol,
            source=future.source,
            windows=len(future),
            persons=persons,
            ade=float(errors.ade.mean()),
            fde=float(errors.fde.mean()),
            samples=samples,
            best_of=best_of,
            miss_rate=miss_rate(errors.fde) if metric else math.nan,
            collisions=_known_mean(errors.collided[together]),
            together=int(together.sum()),
            horizon=tuple(errors.over_horizon().tolist()),
            there=tuple(errors.exists.sum(axis=0).tolist()),
            dt=future.dt,
            units=future.units,
            true_collisions=_known_mean(errors.true_collided[accompanied]),
            accompanied=int(accompanied.sum()),
            **_swept(errors, together),
            nll=_known_mean(errors.nll[~np.isnan(errors.nll)]),
            dense=int(np.sum(~np.isnan(errors.nll))),
            energy=_known_mean(errors.energy[~np.isnan(errors.energy)]),
            intervals=people.intervals(),
            people=people,
        )

    @classmethod
    def total(cls, scores: Sequence[Score]) -> Score:
        """Return the score of several recordings together, every mean taken over all their persons.

        The intervals are drawn anew from the people of all of them; they are unknown when one score came back from
        JSON and no longer knows its people.

        Raises:
            InputError: there is no score, or they differ in predictor, protocol, samples, rule, units or horizon.
        """
        if not scores:
            raise InputError("a total needs at least one score")
        if len(scores) == 1:
            return scores[0]
        first = scores[0]
        for name in ("predictor", "protocol", "samples", "best_of", "units"):
            values = [getattr(item, name) for item in scores]
            if any(value != values[0] for value in values):
                raise InputError(f"scores with different {name} cannot be added up: {', '.join(map(repr, values))}")
        if len({len(item.horizon) for item in scores}) > 1:
            reach = ", ".join(str(len(item.horizon)) for item in scores)
            raise InputError(f"scores of different horizons cannot be added up: {reach} steps")
        persons = [item.persons for item in scores]
        windows = [item.windows for item in scores]
        there = [tuple(item.there) for item in scores]
        known = [item.people for item in scores if item.people is not None]
        people = PersonValues.concatenate(known) if len(known) == len(scores) else None

        def mean(name: str, counts: Sequence[int]) -> float:
            return _mean([getattr(item, name) for item in scores], counts)

        swept: dict[str, Any] = {name: mean(name, [item.together for item in scores]) for name in SWEPT}
        return dataclasses.replace(
            first,
            source=" + ".join(item.source for item in scores),
            windows=sum(windows),
            persons=sum(persons),
            ade=mean("ade", persons),
            fde=mean("fde", persons),
            miss_rate=mean("miss_rate", persons),
            collisions=mean("collisions", [item.together for item in scores]),
            together=sum(item.together for item in scores),
            true_collisions=mean("true_collisions", [item.accompanied for item in scores]),
            accompanied=sum(item.accompanied for item in scores),
            **swept,
            nll=mean("nll", [item.dense for item in scores]),
            dense=sum(item.dense for item in scores),
            energy=mean("energy", persons),
            horizon=tuple(map(_mean, zip(*(item.horizon for item in scores), strict=True), zip(*there, strict=True))),
            there=tuple(sum(counts) for counts in zip(*there, strict=True)),
            dt=first.dt if all(item.dt == first.dt for item in scores) else math.nan,
            seconds_per_window=mean("seconds_per_window", windows),
            intervals=people.intervals() if people is not None else Intervals(),
            people=people,
        )

    def difference(self, other: Score, name: str = "ade") -> tuple[float, Interval]:
        """Return how much more ``name`` is here than there, and the 95 % interval of that, drawn by person.

        The same people are drawn for both scores, so it is far narrower than the intervals of the two apart: a
        predictor is better than another on such recordings when the interval of its ADE less theirs lies below 0.

        Args:
            other: another predictor on the same windows.
            name: a field of :class:`~crowdbot.metrics.Intervals`.

        Raises:
            InputError: the name is unknown, the scores are not of the same people, or one came back from JSON.
        """
        if self.people is None or other.people is None:
            raise InputError("a score that came back from JSON no longer knows its people: score the forecast again")
        if (self.source, self.protocol) != (other.source, other.protocol):
            raise InputError(
                f"scores on {self.source} ({self.protocol}) and {other.source} ({other.protocol}) cannot be compared"
                " person by person"
            )
        return self.people.minus(other.people, name)

    def as_dict(self) -> dict[str, Any]:
        """Return every field but ``people`` by its name, for JSON."""
        plain = dataclasses.asdict(dataclasses.replace(self, people=None))
        del plain["people"]
        return plain

    @property
    def columns(self) -> tuple[str, ...]:
        """Heads of the columns of :meth:`cells`; those of samples and intervals are there when their numbers are."""
        return Score.heads([self])

    @staticmethod
    def heads(scores: Sequence[Score]) -> tuple[str, ...]:
        """Return the heads of the columns with at least one value, for a table of several scores.

        Pass them to :meth:`cells` of each score.
        """
        measured = {name: None for item in scores for name, word in item._words().items() if word != "-"}
        kept = {"collisions", "ms/window", *measured} - (
            set(SAMPLED) if all(item.samples == 1 for item in scores) else set()
        )
        order = dict.fromkeys(name for item in scores for name in item._words())
        return tuple(name for name in order if name in kept)

    def cells(self, columns: Sequence[str] | None = None) -> tuple[str, ...]:
        """Return the main numbers as words for a table, by default those of :attr:`columns`; ``-`` is not measured."""
        words = self._words()
        return tuple(words.get(name, "-") for name in (self.columns if columns is None else columns))

    def _words(self) -> dict[str, str]:
        low, high = self.intervals.ade
        return {
            "windows": str(self.windows),
            "persons": str(self.persons),
            f"ADE [{self.units}]": f"{self.ade:.3f}",
            "95 %": "-" if math.isnan(low) else f"{low:.3f}-{high:.3f}",
            f"FDE [{self.units}]": f"{self.fde:.3f}",
            "NLL": "-" if math.isnan(self.nll) else f"{self.nll:.2f}{self._share_with_density()}",
            "energy": "-" if math.isnan(self.energy) else f"{self.energy:.3f}",
            "collisions": "-" if math.isnan(self.collisions) else f"{100.0 * self.collisions:.1f} %",
            "swept [%]": _shares(self.swept_collisions, self.swept_collisions_truth),
            "radii [%]": _shares(self.swept_contacts, self.swept_contacts_truth),
            "ms/window": "-" if math.isnan(self.seconds_per_window) else f"{1e3 * self.seconds_per_window:.3g}",
        }

    def _share_with_density(self) -> str:
        """Return, in brackets, of how many percent of the persons the NLL is a mean; nothing when it is of all."""
        return "" if self.dense == self.persons else f" ({100.0 * self.dense / self.persons:.0f} %)"

    def __str__(self) -> str:
        """Return one paragraph that carries protocol, predictor and counts."""
        best = f", best of {self.samples} per {self.best_of}" if self.samples > 1 else ""
        length = "different lengths" if math.isnan(self.dt) else f"{self.dt:g} s"
        reach = f"{len(self.horizon)} steps of {length}"
        low, high = self.intervals.ade
        main = [
            f"ADE {self.ade:.3f} {self.units}" + ("" if math.isnan(low) else f" (95 %: {low:.3f} to {high:.3f})"),
            f"FDE {self.fde:.3f} {self.units}",
            "" if math.isnan(self.nll) else f"NLL {self.nll:.2f} nat{self._share_with_density()}",
            "" if self.samples == 1 or math.isnan(self.energy) else f"energy {self.energy:.3f} {self.units}",
        ]
        more = [
            f"{self.persons} persons in {self.windows} windows",
            "" if math.isnan(self.miss_rate) else f"missed by {MISS:g} m {100 * self.miss_rate:.1f} %",
            "" if math.isnan(self.collisions) else f"collisions {100 * self.collisions:.1f} %",
            ""
            if math.isnan(self.swept_collisions)
            else "swept between rows (truth) at 0.2 m"
            f" {_shares(self.swept_collisions, self.swept_collisions_truth)} %, at the radii"
            f" {_shares(self.swept_contacts, self.swept_contacts_truth)} %",
            "" if math.isnan(self.seconds_per_window) else f"{1e3 * self.seconds_per_window:.3g} ms a window",
        ]
        return (
            f"{self.predictor} on {self.source}: {', '.join(filter(None, main))}"
            f" (protocol {self.protocol}, {reach}{best}; {', '.join(filter(None, more))})"
        )


def score(forecast: Forecast, future: Windows, best_of: str = "person", past: Windows | None = None) -> Score:
    """Score a forecast against what happened.

    Args:
        forecast: of W windows.
        future: the same windows, whose ``scored`` mask is the protocol's.
        best_of: how the best of K samples is chosen, see :func:`~crowdbot.metrics.best_of`.
        past: the same windows; swept collisions start at their last row, and are NaN without it.

    Raises:
        InputError: they do not belong together, a scored person was not predicted, or nobody is scored.

    >>> import numpy as np
    >>> here = np.ones((1, 2, 1), dtype=bool)
    >>> future = Windows(np.zeros((1, 2, 1, 2)), here, here[:, 0], ~here[:, 0], np.array([[7]]),
    ...     np.array([[10, 20]]), 0.4, "all", "street")
    >>> print(score(Forecast.of(np.full((1, 1, 2, 1, 2), 0.1), here[:, 0], 0.4, "me"), future))
    me on street: ADE 0.141 m, FDE 0.141 m (protocol all, 2 steps of 0.4 s; 1 persons in 1 windows, missed by 2 m 0.0 %)
    """
    errors = person_errors(forecast, future, best_of, past)
    return Score.of(errors, forecast.predictor, forecast.samples, future, best_of)


def _values(
    errors: PersonErrors, together: NDArray[np.bool_], accompanied: NDArray[np.bool_], metric: bool
) -> list[NDArray[np.float64]]:
    """Return what the means are taken of, in the order of the intervals; NaN where a person has no part in it."""
    missed = np.where(metric, errors.fde > MISS, np.nan)
    clash = np.where(together, errors.collided, np.nan), np.where(accompanied, errors.true_collided, np.nan)
    swept = np.where(together[:, None], errors.swept, np.nan).T
    return [errors.ade, errors.fde, missed, *clash, *swept, errors.nll, errors.energy]


def _swept(errors: PersonErrors, together: NDArray[np.bool_]) -> dict[str, float]:
    """Return the shares of swept collisions by field, over the people in company."""
    values = np.concatenate([errors.swept, errors.true_swept], axis=1)[together].T
    return {name: _known_mean(row) for name, row in zip(SWEPT, values, strict=True)}


def _shares(value: float, truth: float) -> str:
    """Return a share and, in brackets, that of the truth [%]."""
    return "-" if math.isnan(value) else f"{100.0 * value:.1f} ({100.0 * truth:.1f})"


def _known_mean(values: NDArray[np.float64]) -> float:
    return float(values.mean()) if len(values) else math.nan


def _mean(values: Sequence[float], counts: Sequence[int]) -> float:
    """Return the mean weighted by counts; values without a count do not matter."""
    total = sum(counts)
    known = [(value, count) for value, count in zip(values, counts, strict=True) if count > 0]
    return float(np.sum([value * count for value, count in known]) / total) if total else math.nan
