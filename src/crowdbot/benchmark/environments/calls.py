"""Python calls in one step of a simulation."""

from __future__ import annotations

import sys
from types import FrameType
from typing import Any

from crowdbot.simulation import Simulation
from crowdbot.trials import Trial

from .rows import CallRow


def count_calls(simulation: Simulation, steps: int) -> tuple[float, float]:
    """Return the calls of Python functions and of compiled functions per step, in the calling thread."""
    found = {"call": 0, "c_call": 0}

    def tally(frame: FrameType, event: str, argument: Any) -> None:
        if event in found:
            found[event] += 1

    before = sys.getprofile()
    sys.setprofile(tally)
    try:
        for _ in range(steps):
            simulation.advance()
    finally:
        sys.setprofile(before)
    return found["call"] / steps, (found["c_call"] - 1) / steps  # the last one is setprofile


def call_rows(trial: Trial, environments: int, steps: int) -> list[CallRow]:
    """Return the calls of a single environment and of a batch."""
    rows: list[CallRow] = []
    for name, count in (("calls-single", 1), ("calls-batch", environments)):
        simulation = Simulation(trial, range(count))
        simulation.advance()
        python, builtin = count_calls(simulation, steps)
        rows.append(CallRow(name, count, python, builtin, python / rows[0].python_calls if rows else 1.0))
    return rows
