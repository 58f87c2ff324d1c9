"""The score of a policy: outcomes in cases that its training has not seen."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crowdbot.navigation import PolicyNavigator
from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial

from .policy_task import TrainingTask

__all__ = ["FIRST_CASE", "score_policy"]

FIRST_CASE = 10**6
"""Smallest seed of the cases; seeds of a training are above them, those of tests below."""


def score_policy(file: Path, tasks: Sequence[TrainingTask], cases: int = 200) -> list[dict[str, str | float]]:
    """Return the outcomes of the navigator with a file of weights in each task.

    Args:
        file: weights.
        tasks: trials; their numbers of environments have no effect.
        cases: number of cases of each.

    Returns:
        for each task its ``trial``, the shares of ``success``, ``collision`` and ``timeout``, and the mean time of the
        successes [s].
    """
    rows: list[dict[str, str | float]] = []
    for task in tasks:
        trial = load_trial(task.trial, task.values)
        robots = tuple(dataclasses.replace(one, navigator=PolicyNavigator(file=str(file))) for one in trial.robots)
        simulation = Simulation(dataclasses.replace(trial, robots=robots), range(FIRST_CASE, FIRST_CASE + cases))
        outcomes, times = np.full(cases, "", dtype="U16"), np.zeros(cases)
        while (outcomes == "").any():
            simulation.advance()
            for e in np.flatnonzero(simulation.may_end() & (outcomes == "")).tolist():
                outcomes[e] = simulation.outcome(e) or ""
                times[e] = simulation.ticks[e] * trial.step
        won = outcomes == "success"
        title = " ".join([task.trial, *(f"{name}={value}" for name, value in task.values.items())])
        shares = {name: float((outcomes == name).mean()) for name in ("success", "collision", "timeout")}
        rows.append({"trial": title, **shares, "time": float(times[won].mean()) if won.any() else 0.0})
    return rows
