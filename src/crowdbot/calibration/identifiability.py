"""Whether recordings identify the parameters of a fit: profiles, intervals and their plot."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, stream
from crowdbot.data import Windows
from crowdbot.metrics import draw_counts, percentile_interval
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

from .calibrator import Calibrator
from .fit import Fit
from .parameter_space import RADIUS

RESAMPLES = 500


@dataclass(frozen=True, eq=False)
class ParameterProfile:
    """Cost over one parameter, with all other parameters fitted anew at each value.

    Fields:
        name, unit: the parameter.
        best: calibrated value.
        values: ``[K]`` values, from the lower to the upper bound, the calibrated value among them.
        cost: ``[K]`` mean cost over people with the other parameters at their best [m].
        low, high: ``[K]`` 95 % interval of the difference to the cost of the calibrated parameters, by the bootstrap
            over people [m].
        interval: smallest and largest value whose cost is not significantly above that of the calibrated parameters.
        bootstrap: 95 % interval of the best value over bootstrap samples of people, each of which chooses among all
            profiled parameter sets.
    """

    name: str
    unit: str
    best: float
    values: Floats
    cost: Floats
    low: Floats
    high: Floats
    interval: tuple[float, float]
    bootstrap: tuple[float, float]

    @property
    def identified(self) -> str:
        """``yes``, or the side without a limit: ``no``, ``not from below``, ``not from above``."""
        below, above = self.interval[0] > self.values[0], self.interval[1] < self.values[-1]
        if below and above:
            return "yes"
        return "no" if not below and not above else "not from below" if above else "not from above"

    def as_dict(self) -> dict[str, Any]:
        """Return the fields as lists and numbers for JSON, with ``identified``."""
        lists = {name: getattr(self, name).tolist() for name in ("values", "cost", "low", "high")}
        head = {"name": self.name, "unit": self.unit, "best": self.best, "identified": self.identified}
        return {**head, "interval": list(self.interval), "bootstrap": list(self.bootstrap), **lists}


def profile_parameters(
    calibrator: Calibrator,
    fit: Fit,
    past: Windows | Sequence[Windows],
    points: int = 11,
    budget: int = 50,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> tuple[ParameterProfile, ...]:
    """Return the profile of each parameter of a shared fit.

    A profile whose cost rises on both sides shows that the data identify the parameter; a flat one, that other values
    fit as well. See Raue et al. 2009, Structural and practical identifiability analysis by exploiting the profile
    likelihood, doi 10.1093/bioinformatics/btp358.

    Args:
        calibrator: the calibrator of the fit.
        fit: its result for ``past``.
        past: the windows of the calibration.
        points: values of each parameter, equidistant between its bounds.
        budget: evaluations of the search of the other parameters at each value.
        seed: seed of the searches and of the bootstrap.
        progress: called with the completed share, 0 to 1.

    Raises:
        InputError: the fit is not shared, or points or budget are too few.

    Example: a made crowd of two people who pass each other, and one parameter::

        calibrator = Calibrator("orca", shared=True, free=("time_horizon",), budget=40)
        fit = calibrator.fit(windows)
        for one in profile_parameters(calibrator, fit, windows, points=7):
            print(one.name, one.best, one.interval, one.identified)
    """
    if not fit.shared:
        raise InputError("profiles need a fit with shared parameters (shared=True)")
    if points < 3 or budget < 1:
        raise InputError(f"a profile needs at least 3 points and a budget of 1, not {points} and {budget}")
    pasts = [past] if isinstance(past, Windows) else list(past)
    best, table = fit.values[0, 0], fit.space.table
    owners = [(d, value) for d, row in enumerate(table) for value in _grid(row.low, row.high, best[d], points)]
    sets = [best]
    for k, (d, value) in enumerate(owners):
        sets.append(best if value == best[d] else _best_others(calibrator, fit, pasts, d, value, budget, seed))
        if progress is not None:
            progress((k + 1) / len(owners))
    candidates = _Candidates.of(calibrator, pasts, np.stack(sets), seed)
    found = []
    for d, row in enumerate(table):
        own = np.array([k + 1 for k, (owner, _) in enumerate(owners) if owner == d])
        values = np.array([value for owner, value in owners if owner == d])
        low, high = candidates.above_best(own)
        kept = values[low <= 0.0] if np.any(low <= 0.0) else best[[d]]
        ends = (float(kept.min()), float(kept.max()))
        spread = candidates.best_values(d)
        mean = candidates.cost[own].mean(axis=1)
        found.append(ParameterProfile(row.name, row.unit, float(best[d]), values, mean, low, high, ends, spread))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class _Candidates:
    """Costs of parameter sets and their means over bootstrap samples of people.

    Fields:
        sets: ``[S, D]`` parameters.
        cost: ``[S, N]`` cost of each person in each window [m].
        means: ``[R, S]`` mean cost of each bootstrap sample [m].
    """

    sets: Floats
    cost: Floats
    means: Floats

    @classmethod
    def of(cls, calibrator: Calibrator, pasts: list[Windows], sets: Floats, seed: int) -> _Candidates:
        cost, person = _person_costs(calibrator, pasts, sets)
        total, count = _sums(cost, person)
        weights = draw_counts(stream(seed, "profile"), len(count), RESAMPLES)
        return cls(sets, cost, (weights @ total.T) / (weights @ count)[:, None])

    def above_best(self, chosen: NDArray[np.int64]) -> tuple[Floats, Floats]:
        """Return the interval of the difference of chosen sets to the best one, which a profile may have found."""
        best = int(np.argmin(self.cost.mean(axis=1)))
        return percentile_interval(self.means[:, chosen] - self.means[:, [best]])

    def best_values(self, column: int) -> tuple[float, float]:
        """Return the interval of a parameter of the best set over the bootstrap samples."""
        low, high = percentile_interval(self.sets[np.argmin(self.means, axis=1), column])
        return float(low), float(high)


def _grid(low: float, high: float, best: float, points: int) -> Floats:
    """Return equidistant values between the bounds, the nearest of them replaced by the calibrated value."""
    grid = np.linspace(low, high, points)
    inner = 1 + int(np.argmin(np.abs(grid[1:-1] - best)))
    near = int(np.argmin(np.abs(grid - best)))
    grid[near if best in (low, high) else inner] = best
    return grid


def _best_others(
    calibrator: Calibrator, fit: Fit, pasts: list[Windows], column: int, value: float, budget: int, seed: int
) -> Floats:
    """Return the best set ``[D]`` with one parameter fixed, found by the search from the calibrated values."""
    names, values = fit.space.names, np.array(fit.values[0, 0])
    values[column] = value
    others = tuple(name for name in names if name != names[column])
    if not others:
        return values
    part = dataclasses.replace(_at(calibrator, names, values), free=others, budget=budget)
    values[[names.index(name) for name in others]] = part.fit(pasts, seed).values[0, 0]
    return values


def _at(calibrator: Calibrator, names: Sequence[str], values: Floats) -> Calibrator:
    """Return the calibrator with these initial values."""
    given = {name: float(value) for name, value in zip(names, values, strict=True)}
    radius = given.pop(RADIUS.name, calibrator.radius)
    assert isinstance(calibrator.model, CrowdModel)
    return dataclasses.replace(calibrator, model=dataclasses.replace(calibrator.model, **given), radius=radius)


def _person_costs(calibrator: Calibrator, pasts: list[Windows], sets: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Return the costs ``[S, N]`` of people in windows, and the person of each column."""
    costs, people, known = [], [], 0
    for past in pasts:
        person_costs = calibrator.person_costs(past, sets)
        counted = ~np.any(np.isnan(person_costs), axis=0)
        _, person = np.unique(past.id[counted], return_inverse=True)
        costs.append(person_costs[:, counted])
        people.append(person + known)
        known += int(person.max(initial=-1)) + 1
    return np.concatenate(costs, axis=1), np.concatenate(people)


def _sums(cost: Floats, person: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Return the sums of the costs ``[S, M]`` and the number of windows ``[M]`` of each person."""
    count = np.bincount(person).astype(np.float64)
    return np.stack([np.bincount(person, weights=row) for row in cost]), count


COLUMNS = 3
LINE, RANGE, BEST = "#0072b2", "#e69f00", "#d55e00"


def plot_profiles(profiles: Sequence[ParameterProfile], file: Path) -> Path:
    """Draw one panel for each parameter and return the file, PNG.

    The line is the cost with all other parameters fitted anew, the band the 95 % interval of its difference to the
    calibrated cost over people, the vertical line the calibrated value and the shaded range its interval.

    Args:
        profiles: result of :func:`~crowdbot.calibration.profile_parameters`.
        file: output file; its folder exists.
    """
    from matplotlib.figure import Figure

    columns = min(COLUMNS, len(profiles))
    rows = -(-len(profiles) // columns)
    figure = Figure(figsize=(3.1 * columns + 0.4, 2.5 * rows + 0.3), dpi=110, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, sharey=True)
    for axis, profile in zip(axes.flat, profiles, strict=False):
        start = (
            float(profile.cost[profile.values == profile.best][0])
            if profile.best in profile.values
            else float(profile.cost.min())
        )
        axis.axvspan(*profile.interval, color=RANGE, alpha=0.25, linewidth=0)
        axis.axvline(profile.best, color=BEST, linewidth=1.2)
        axis.fill_between(profile.values, start + profile.low, start + profile.high, color=LINE, alpha=0.2, linewidth=0)
        axis.plot(profile.values, profile.cost, "o-", color=LINE, markersize=3, linewidth=1.2)
        axis.set_xlabel(f"{profile.name.replace('_', ' ')} [{profile.unit}]", fontsize=9)
        axis.set_title(f"identified: {profile.identified}", fontsize=9)
        axis.tick_params(labelsize=8)
        axis.grid(alpha=0.25, linewidth=0.6)
    for axis in axes.flat[len(profiles) :]:
        axis.set_visible(False)
    figure.supylabel("mean cost [m]", fontsize=9)
    draft = file.with_suffix(".part")
    figure.savefig(draft, format="png", metadata={"Software": None})
    os.replace(draft, file)
    return file
