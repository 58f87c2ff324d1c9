"""Worst runs of an evaluation, simulated again for the report."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from crowdbot.simulation import Episode, RunFailureWarning, simulate
from crowdbot.trials import floor_plan

from .job import RunRow
from .plan import EvaluationPlan
from .result import CellResult, EvaluationResult

__all__ = ["WorstRun", "worst_runs"]

RATE = 10.0
"""Largest number of pictures a second in the report."""
ORDER = ("collision", "fall", "error", "timeout", "finished", "success")
"""Outcomes from the worst to the best."""


class WorstRun(NamedTuple):
    """A run as the report shows it.

    Fields:
        cell: trial, navigator and robot.
        row: the run.
        drawing: what the page draws: times, tracks, walls, ground and doors, bounds.
        same: whether the new run has the digest of the evaluated one.
    """

    cell: CellResult
    row: RunRow
    drawing: dict[str, Any]
    same: bool


def worst_runs(plan: EvaluationPlan, result: EvaluationResult, count: int = 1) -> list[WorstRun]:
    """Return the worst runs of each cell, simulated again.

    Collisions come first, the fastest impact first of all; then falls of people, failures of the navigator, timeouts,
    and runs with the smallest clearance.

    Args:
        plan, result: of the same evaluation.
        count: runs of each cell.
    """
    found = []
    for planned, cell in zip(plan.cells, result.cells, strict=True):
        for row in sorted(cell.valid, key=_rank)[:count]:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", RunFailureWarning)
                episode = simulate(planned.variant, row.seed)
            found.append(WorstRun(cell, row, _drawing(episode), episode.digest == row.digest))
    return sorted(found, key=lambda run: _rank(run.row)[:3])


def _rank(row: RunRow) -> tuple[float, ...]:
    place = ORDER.index(row.outcome) if row.outcome in ORDER else len(ORDER)
    values = [row.metrics.get(name, math.nan) for name in ("max_severity", "max_impact_speed", "min_clearance")]
    severity, speed, clearance = (0.0 if math.isnan(value) else value for value in values)
    return (place, -severity, -speed, clearance, row.seed)


def _drawing(episode: Episode) -> dict[str, Any]:
    step = max(1, round(1.0 / RATE / max(1e-9, float(np.diff(episode.times[:2]).sum() or 1.0 / RATE))))
    rows = np.arange(0, len(episode.times), step)
    rows = rows if rows[-1] == len(episode.times) - 1 else np.append(rows, len(episode.times) - 1)
    seen = episode.active[rows].any(axis=0) & (episode.radius > 0)
    tracks = []
    for agent in np.flatnonzero(seen).tolist():
        here = episode.active[rows, agent]
        points = np.round(episode.position[rows, agent], 2)
        tracks.append(
            {
                "robot": agent in episode.robots,
                "radius": round(float(episode.radius[agent]), 3),
                "heading": np.round(episode.heading[rows, agent], 2).tolist(),
                "track": [point if on else None for point, on in zip(points.tolist(), here.tolist(), strict=True)],
            }
        )
    walls = [np.round(ring, 2).tolist() for ring in episode.walls]
    goals = [list(robot.goal.position) for robot in episode.trial.robots]
    return {
        "times": np.round(episode.times[rows], 2).tolist(),
        "agents": tracks,
        "walls": walls,
        "plan": _plan(episode),
        "goals": goals,
        "bounds": _bounds(episode, walls, goals),
    }


def _plan(episode: Episode) -> list[dict[str, Any]]:
    """Return the strokes of uneven ground and doors as values for the page."""
    found = []
    for line in floor_plan(episode.trial.stage):
        gaps = np.flatnonzero(np.isnan(line.points[:, 0]))
        for stroke in np.split(line.points, gaps):
            points = np.round(stroke[~np.isnan(stroke[:, 0])], 2).tolist()
            found.append({"color": line.color, "width": line.width, "points": points})
    return found


def _bounds(episode: Episode, walls: Sequence[Any], goals: Sequence[Any]) -> list[float]:
    points = [episode.position[episode.active], np.array(goals, dtype=np.float64).reshape(-1, 2)]
    points += [np.array(ring, dtype=np.float64).reshape(-1, 2) for ring in walls]
    every = np.concatenate(points)
    low, high = every.min(axis=0) - 1.0, every.max(axis=0) + 1.0
    return [round(float(value), 2) for value in (*low, *high)]
