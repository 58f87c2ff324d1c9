"""Rows of the benchmark of environments."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from .work_rate import WorkRate


@dataclass(frozen=True)
class PeerRate:
    """Rate of another simulator in a row.

    Fields:
        peer: its name.
        protocol: what its work includes, and how it differs from ours.
        rate: its rate.
        ratio_cpu, ratio_wall: our rate divided by its rate, per CPU second and per second.
    """

    peer: str
    protocol: str
    rate: WorkRate
    ratio_cpu: float
    ratio_wall: float


@dataclass(frozen=True)
class EnvironmentRow:
    """A rate of our simulation and those of other simulators.

    Fields:
        name: name of the row.
        protocol: what the work includes.
        unit: unit of the rates per second.
        people: people in each environment, without the robot.
        environments: environments E that advance together.
        rate: our rate.
        peers: rates of other simulators.
    """

    name: str
    protocol: str
    unit: str
    people: int
    environments: int
    rate: WorkRate
    peers: tuple[PeerRate, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Return the row as ``crowdbot bench environments --json`` prints it."""
        return {**asdict(self), "cpu_milliseconds_per_unit": 1e3 / self.rate.per_cpu_second}


@dataclass(frozen=True)
class CallRow:
    """Calls in one step of a simulation.

    Fields:
        name: name of the row.
        environments: environments E that advance together.
        python_calls: calls of Python functions per step.
        builtin_calls: calls of compiled functions from Python per step.
        ratio: Python calls divided by those of a single environment.
    """

    name: str
    environments: int
    python_calls: float
    builtin_calls: float
    ratio: float


@dataclass(frozen=True)
class TrialRate:
    """Speed of a built-in trial.

    Fields:
        name: name of the trial.
        agents: people and robots at the start.
        single: steps per second of a single environment.
        batch: steps of environments per second of a batch.
        environments: environments E of the batch.
        ratio: steps per CPU second of the batch divided by those of the single environment.
        reason: why the trial was not measured, empty otherwise.
    """

    name: str
    agents: int = 0
    single: WorkRate | None = None
    batch: WorkRate | None = None
    environments: int = 0
    ratio: float | None = None
    reason: str = ""
