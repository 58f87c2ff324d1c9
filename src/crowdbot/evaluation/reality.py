"""Where the metrics of a recording lie in the distribution of those of its simulated runs."""

from __future__ import annotations

import html
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from crowdbot.metrics import metric_table

from .intervals import proportion_interval
from .job import RunRow

INSIDE = (0.025, 0.975)
"""Quantiles of the simulations between which reality is inside."""
OWN_MOTION = (
    "success", "timeout", "duration", "time_to_goal", "goal_progress", "path_length", "path_efficiency",
    "min_wall_clearance", "stalled_time", "longest_stall", "mean_jerk", "max_jerk", "heading_change",
    "failures_to_progress", "final_goal_distance", "min_goal_distance", "mean_wall_clearance", "wall_collision",
    "wall_collisions", "obstacle_force_on_robot",
)  # fmt: skip
FEWEST_RUNS = 10
"""Metrics with fewer simulated values are left out."""


class RealPlacement(NamedTuple):
    """Where reality lies in the distribution of one metric.

    Fields:
        metric: name.
        real: value of the recording.
        quantile: share of the runs with a smaller value, plus half of those with an equal one.
        low, high: Wilson interval of 95 % of the quantile.
        first, median, last: 2.5 %, 50 % and 97.5 % quantile of the simulations.
        runs: number of runs with a value.
        inside: whether reality is between ``first`` and ``last``.
        constant: whether all runs and reality have the same value, which says nothing.
    """

    metric: str
    real: float
    quantile: float
    low: float
    high: float
    first: float
    median: float
    last: float
    runs: int
    inside: bool
    constant: bool


def place_reality(real: Mapping[str, float], runs: Sequence[RunRow], mirror: bool = False) -> list[RealPlacement]:
    """Return where reality lies for each metric that both have; values that are not finite do not count.

    Args:
        real: metrics of the recording.
        runs: simulated runs of it.
        mirror: whether the robot follows its recorded path in the runs: metrics of its own motion are then left out.

    >>> rows = [RunRow(k, "success", "", {"path_length": float(k)}) for k in range(100)]
    >>> place_reality({"path_length": 24.5}, rows)[0].quantile
    0.25
    """
    real_placements = []
    for name, value in real.items():
        if mirror and _is_of_robot(name):
            continue
        values = np.array([row.metrics.get(name, math.nan) for row in runs if row.valid])
        values = values[np.isfinite(values)]
        if not math.isfinite(value) or len(values) < FEWEST_RUNS:
            continue
        near = np.isclose(values, value, rtol=1e-9, atol=1e-12)
        below = float(np.sum((values < value) & ~near)) + 0.5 * float(near.sum())
        about = proportion_interval(round(below), len(values), method="wilson")
        first, median, last = (float(item) for item in np.quantile(values, [INSIDE[0], 0.5, INSIDE[1]]))
        slack = 1e-9 * max(1.0, abs(value))
        real_placements.append(
            RealPlacement(
                name, float(value), below / len(values), min(about.low, below / len(values)),
                max(about.high, below / len(values)), first, median, last, len(values),
                bool(first - slack <= value <= last + slack), bool(near.all()),
            )
        )  # fmt: skip
    return real_placements


def _is_of_robot(name: str) -> bool:
    """Return whether a metric depends on the motion of the robot alone, not on people."""
    family = metric_table()[name].family
    return family in ("path", "motion", "legibility") or name in OWN_MOTION


def reality_svg(placements: Sequence[RealPlacement]) -> str:
    """Return a picture with a row for each metric: the quantile of reality with its interval; constant
    ones are left out.

    The grey band is the central 95 % of the simulations; filled dots are inside.
    """
    rows = [placement for placement in placements if not placement.constant]
    left, width, step = 230, 420, 18
    height = 40 + step * len(rows)

    def x_of(share: float) -> float:
        return left + width * share

    size = f'width="{width * 0.95:.1f}" height="{step * len(rows)}"'
    parts = [f'<rect x="{x_of(INSIDE[0]):.1f}" y="24" {size} fill="#e8edf3"/>']
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        parts.append(f'<text x="{x_of(share):.1f}" y="16" text-anchor="middle">{share:g}</text>')
        parts.append(f'<path d="M{x_of(share):.1f} 22V{height - 12}" stroke="#c5ced8"/>')
    for k, row in enumerate(rows):
        y = 24 + step * (k + 0.5)
        color = "#1b6ca8" if row.inside else "#c8553d"
        name = html.escape(row.metric.replace("_", " "))
        parts.append(f'<text x="{left - 12}" y="{y + 4:.1f}" text-anchor="end">{name}</text>')
        parts.append(f'<path d="M{x_of(row.low):.1f} {y:.1f}H{x_of(row.high):.1f}" stroke="{color}" stroke-width="2"/>')
        fill = color if row.inside else "#fff"
        paint = f'fill="{fill}" stroke="{color}" stroke-width="2"'
        parts.append(f'<circle cx="{x_of(row.quantile):.1f}" cy="{y:.1f}" r="4" {paint}/>')
    body = "".join(parts)
    style = 'font-family="system-ui, sans-serif" font-size="12"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {left + width + 24} {height}" {style} role="img"'
        f' aria-label="Quantile of reality in the simulations">{body}</svg>'
    )
