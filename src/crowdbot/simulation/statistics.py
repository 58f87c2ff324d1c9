"""Statistics of a run without its arrays: digest, number of agents and navigation metrics."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Pose, SpatialPose
from crowdbot.metrics import AgentStates, NavigationMetrics
from crowdbot.trials import Trial

from .failure import RunFailure
from .goal_order import GoalOrder
from .orders import write_order
from .resumable_hash import ResumableHash
from .state_tree import StateError
from .step_record import StepRecord

__all__ = ["EpisodeDigest", "EpisodeStatistics", "RunSummary", "present", "robot_metrics"]


@dataclass(frozen=True)
class RunSummary:
    """Summary of a run, without its arrays.

    Fields:
        trial, seed: the trial and its seed.
        outcome, steps, digest, metrics: see :class:`Episode`.
        begin, end: times of the first and the last recorded step [s].
        agents: total number of people and robots.
        path: the recording, or None.
        failure: the exception that ended the run, for the outcome ``error``.
    """

    trial: Trial
    seed: int
    outcome: str
    steps: int
    begin: float
    end: float
    agents: int
    metrics: Mapping[str, float]
    digest: str
    path: Path | None = None
    failure: RunFailure | None = None


class EpisodeDigest:
    """Hash of an episode, updated while it runs.

    Args:
        state: a stored state to continue from, or empty for a new hash whose state can be stored; None: neither.

    Raises:
        InputError: the state is not that of a hash.
    """

    def __init__(self, state: Mapping[str, Any] | None = None) -> None:
        self._sum: Any = hashlib.blake2b(digest_size=16)
        if state is not None:
            self._sum = ResumableHash.of(state) if state else ResumableHash()

    @property
    def state(self) -> dict[str, Any]:
        """The state to continue from, as arrays and numbers.

        Raises:
            StateError: the hash was made without a state.
        """
        if not isinstance(self._sum, ResumableHash):
            raise StateError("the digest of this run cannot be stored")
        return self._sum.state

    def take(self, frame: StepRecord) -> None:
        """Add a record: all arrays of its readings, then of its scene if due, then forces."""
        for robot, mount, reading in frame.readings:
            self._sum.update(f"reading {frame.nanoseconds} {robot.name}/{mount.name}\n".encode())
            for field in dataclasses.fields(reading):
                self._sum.update(_bytes(getattr(reading, field.name)))
        if frame.due:
            self._sum.update(f"frame {frame.nanoseconds}\n".encode())
            who = [] if np.array_equal(frame.ids, np.arange(len(frame.ids))) else [frame.ids]
            for array in (*who, *present(frame), frame.twists, frame.commands):
                self._sum.update(_bytes(array))
        for force in frame.forces:
            self._sum.update(f"force {_contact_text(*force)}\n".encode())
        for order in frame.orders:
            self._sum.update(f"order {frame.nanoseconds} {write_order(order)}\n".encode())
        for collision in frame.collisions:
            self._sum.update(f"collision {_contact_text(*dataclasses.astuple(collision))}\n".encode())

    def hexdigest(self, outcome: str) -> str:
        """Return the hash of all records so far and the outcome."""
        whole = self._sum.copy()
        whole.update(f"outcome {outcome}\n".encode())
        return str(whole.hexdigest())


class EpisodeStatistics:
    """Statistics of a running episode.

    Args:
        trial, seed: the trial and its seed.
        digest: digest of the time before the first record; None for a run from the start.
    """

    def __init__(self, trial: Trial, seed: int, digest: EpisodeDigest | None = None) -> None:
        self.trial, self.seed = trial, seed
        self.digest = digest or EpisodeDigest()
        self.agents = trial.people + len(trial.robots)
        self.begin = self.end = math.nan
        self._touching: set[int] = set()
        walls = trial.stage.as_walls().segments()
        self.travels = [
            NavigationMetrics(trial.people + k, robot.radius, robot.goal.position, robot.goal.tolerance, walls=walls)
            for k, robot in enumerate(trial.robots)
        ]

    def take(self, frame: StepRecord) -> None:
        """Add a record."""
        self.digest.take(frame)
        self.keep(frame)

    def keep(self, frame: StepRecord) -> None:
        """Add a record that the digest already contains."""
        self.agents = max(self.agents, 1 + int(frame.ids.max(initial=-1)))
        for order in frame.orders:
            if isinstance(order, GoalOrder) and order.tolerance is not None:
                names = [robot.name for robot in self.trial.robots]
                self.travels[names.index(order.robot)].tolerance = float(order.tolerance)
        self._touching |= {who for one in frame.touches for who in (one.robot, one.other)}
        if frame.due:
            self.end = frame.nanoseconds / 1e9
            self.begin = self.end if math.isnan(self.begin) else self.begin
            if self.travels:
                now = _instant(frame)
                for travel in self.travels:
                    travel.goal = frame.scene.goal[0, travel.robot]
                    travel.update(now, travel.robot in self._touching)
            self._touching = set()

    def metrics(self, outcome: str) -> dict[str, float]:
        """Return the metrics of all robots."""
        return robot_metrics(self.travels, [robot.name for robot in self.trial.robots], outcome)

    def summary(
        self, outcome: str, steps: int, path: Path | None = None, failure: RunFailure | None = None
    ) -> RunSummary:
        """Return the summary of the run."""
        return RunSummary(
            self.trial,
            self.seed,
            outcome,
            steps,
            self.begin,
            self.end,
            self.agents,
            self.metrics(outcome),
            self.digest.hexdigest(outcome),
            path,
            failure,
        )


def robot_metrics(travels: Sequence[NavigationMetrics], names: Iterable[str], outcome: str) -> dict[str, float]:
    """Return the metrics of all robots; for a single robot, the outcome is that of the run."""
    found: dict[str, float] = {}
    for number, (travel, name) in enumerate(zip(travels, names, strict=True)):
        values = travel.result(outcome if len(travels) == 1 else None)
        found |= {(key if number == 0 else f"{name}.{key}"): value for key, value in values.items()}
    return found


def present(frame: StepRecord) -> tuple[NDArray[Any], ...]:
    """Return position, velocity, heading and active of a record, E = 1; 0 for absent agents."""
    scene = frame.scene
    here = scene.active[0]
    return (
        np.where(here[:, None], scene.position[0], 0.0),
        np.where(here[:, None], scene.velocity[0], 0.0),
        np.where(here, scene.heading[0], 0.0),
        here.copy(),
    )


def _instant(frame: StepRecord) -> AgentStates:
    scene = frame.scene
    there = np.flatnonzero(scene.active[0])
    there = there[np.argsort(frame.ids[there])]
    return AgentStates(
        frame.nanoseconds / 1e9,
        frame.ids[there],
        scene.position[0, there],
        scene.velocity[0, there],
        scene.heading[0, there],
        scene.radius[0, there],
    )


def _contact_text(first: tuple[str, int], second: tuple[str, int], *values: object) -> str:
    """Return what the digest takes of a contact: text without the names of classes, which may change."""
    bodies = [f"Party(kind={kind!r}, number={number!r})" for kind, number in (first, second)]
    return f"({', '.join([*bodies, *map(repr, values)])})"


def _bytes(value: Any) -> bytes:
    if isinstance(value, Pose):
        value = np.column_stack([value.position, value.heading])
    elif isinstance(value, SpatialPose):
        value = np.column_stack([value.position, value.rotation])
    elif dataclasses.is_dataclass(value):
        return b"".join(_bytes(getattr(value, field.name)) for field in dataclasses.fields(value))
    array = np.ascontiguousarray(value)
    return repr(value).encode() if array.dtype.hasobject else array.tobytes()
