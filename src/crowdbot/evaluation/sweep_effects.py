"""Effects of factors in a factorial sweep: main effects and interactions of two factors, with intervals."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, stream
from crowdbot.metrics import draw_counts, percentile_interval
from crowdbot.typing import Floats

from .intervals import Estimate
from .result import CellResult, EvaluationResult

RESAMPLES = 1000


class FactorEffect(NamedTuple):
    """Effect of levels of one or two factors on the mean of a metric.

    Fields:
        trial, method, robot, metric: what it is about; the trial without its levels.
        factors: one factor for a main effect, two for an interaction.
        levels: their levels.
        mean: mean of the metric at these levels.
        effect: for one factor, that mean minus the mean of all cells; for two, what is left of it after both main
        effects.
    """

    trial: str
    method: str
    robot: str
    metric: str
    factors: tuple[str, ...]
    levels: tuple[str, ...]
    mean: Estimate
    effect: Estimate


def factor_effects(
    result: EvaluationResult, metric: str, confidence: float = 0.95, seed: int = 0
) -> list[FactorEffect]:
    """Return main effects and interactions of all pairs of factors on a metric.

    Means are means of cells, so that all levels weigh the same. Intervals come from the bootstrap over seeds: a
    resample draws the same seeds for all cells, since runs with one seed are alike. NaN values are left out; a cell
    without values in a resample makes that resample NaN, and it does not count.

    Args:
        result: an evaluation with factors.
        metric: name of the metric, such as ``collision``.
        confidence: level of the intervals, between 0 and 1.
        seed: seed of the resamples.

    Raises:
        InputError: no cell has factors, or the level is out of range.
    """
    if not 0.0 < confidence < 1.0:
        raise InputError(f"confidence = {confidence} must be between 0 and 1")
    groups: dict[tuple[str, str, str], list[CellResult]] = {}
    for cell in result.cells:
        if cell.factors:
            groups.setdefault((cell.base, cell.method, cell.robot), []).append(cell)
    if not groups:
        raise InputError("the evaluation has no factors; sweep values, as in --sweep robot.visible=true,false")
    effects: list[FactorEffect] = []
    for names, cells in groups.items():
        means = _cell_means(cells, metric, seed)
        effects += [
            FactorEffect(*names, metric, factors, levels, _estimate(mean, confidence), _estimate(effect, confidence))
            for factors, levels, mean, effect in _effects(cells, means)
        ]
    return effects


def _cell_means(cells: Sequence[CellResult], metric: str, seed: int) -> Floats:
    """Return the mean of each cell ``[1 + R, C]``: of all runs first, then of each resample of the seeds."""
    seeds = list(dict.fromkeys(row.seed for cell in cells for row in cell.runs))
    place = {seed: k for k, seed in enumerate(seeds)}
    values = np.full((len(cells), len(seeds)), math.nan)
    for c, cell in enumerate(cells):
        for row in cell.valid:
            values[c, place[row.seed]] = row.metrics.get(metric, math.nan)
    values[~np.isfinite(values)] = math.nan
    rng = stream(seed, "factor effects", len(seeds))
    weight = np.concatenate([np.ones((1, len(seeds))), draw_counts(rng, len(seeds), RESAMPLES)])
    known = np.isfinite(values)
    count = weight @ known.T
    total = weight @ np.where(known, values, 0.0).T
    return np.where(count > 0, total / np.maximum(1, count), math.nan)


def _effects(
    cells: Sequence[CellResult], means: Floats
) -> list[tuple[tuple[str, ...], tuple[str, ...], Floats, Floats]]:
    """Return factors, levels, means and effects ``[1 + R]`` of each main effect and interaction."""
    factors = {name: list(dict.fromkeys(cell.factors[name] for cell in cells)) for name in cells[0].factors}
    all_mean = means.mean(axis=1)
    effects: list[tuple[tuple[str, ...], tuple[str, ...], Floats, Floats]] = []
    main: dict[tuple[str, str], Floats] = {}
    for name, levels in factors.items():
        for level in levels:
            mean = means[:, _chosen(cells, {name: level})].mean(axis=1)
            main[name, level] = mean - all_mean
            effects.append(((name,), (level,), mean, main[name, level]))
    for item, two in itertools.combinations(factors, 2):
        for a, b in itertools.product(factors[item], factors[two]):
            mean = means[:, _chosen(cells, {item: a, two: b})].mean(axis=1)
            effects.append(((item, two), (a, b), mean, mean - all_mean - main[item, a] - main[two, b]))
    return effects


def _chosen(cells: Sequence[CellResult], levels: Mapping[str, str]) -> NDArray[np.bool_]:
    return np.array([all(cell.factors[name] == level for name, level in levels.items()) for cell in cells])


def _estimate(values: Floats, confidence: float) -> Estimate:
    known = values[1:][np.isfinite(values[1:])]
    if not math.isfinite(values[0]) or not len(known):
        return Estimate(math.nan, math.nan, math.nan, 0)
    low, high = percentile_interval(known, confidence)
    return Estimate(float(values[0]), float(low), float(high), len(known))
