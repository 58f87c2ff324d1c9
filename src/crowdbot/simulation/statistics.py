"""Statistics of a run without its arrays: digest, number of agents and navigation metrics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crowdbot.metrics import AgentStates, NavigationMetrics, fall_metrics, impact_metrics
from crowdbot.trials import Trial
from crowdbot.world import BodyContactEvent, Fall

from .episode_digest import EpisodeDigest
from .failure import RunFailure
from .orders.goal_order import GoalOrder
from .step_record import StepRecord
from .termination import FINISHED


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


class EpisodeStatistics:
    """Statistics of a running episode.

    Args:
        trial, seed: the trial and its seed.
        digest: digest of the time before the first record; None for a run from the start.
        robots: ids of the robots of the trial (default: the ids after those of the people at the start).
    """

    def __init__(
        self, trial: Trial, seed: int, digest: EpisodeDigest | None = None, robots: Sequence[int] | None = None
    ) -> None:
        self.trial, self.seed = trial, seed
        first = trial.people
        self.robot_ids = tuple(range(first, first + len(trial.robots))) if robots is None else tuple(robots)
        self.digest = digest or EpisodeDigest()
        self.agents = trial.people + len(trial.robots)
        self.begin = self.end = math.nan
        self._touching: set[int] = set()
        self.travels = new_metrics(trial, self.robot_ids)
        self.collisions: list[BodyContactEvent] = []
        self.falls: list[Fall] = []

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
        self._touching |= {who for touch in frame.touches for who in (touch.robot, touch.other)}
        self.collisions += frame.collisions
        self.falls += frame.falls
        if frame.due:
            self.end = frame.nanoseconds / 1e9
            self.begin = self.end if math.isnan(self.begin) else self.begin
            if self.travels:
                now = _instant(frame)
                for travel in self.travels:
                    if travel.robot not in now.ids:  # an order has removed it: its metrics end before
                        continue
                    travel.goal = frame.scene.goal[0, np.flatnonzero(frame.ids == travel.robot)[0]]
                    travel.update(now, travel.robot in self._touching)
            self._touching = set()

    def metrics(self, outcome: str) -> dict[str, float]:
        """Return the metrics of all robots, in the physics world with those of impacts.

        ``timeout`` is 1 where the goal was missed when the duration was over, also if that end was planned.
        """
        names = [robot.name for robot in self.trial.robots]
        if outcome == FINISHED and self.travels and not self.trial.end.goal:
            outcome = "timeout" if round(self.end / self.trial.step) >= self.trial.ticks else outcome
        return robot_metrics(self.travels, names, outcome) | self._impact_metrics()

    def _impact_metrics(self) -> dict[str, float]:
        found: dict[str, float] = {}
        for k, robot in enumerate(self.trial.robots if self.trial.world == "physics" else ()):
            body = ("robot", self.robot_ids[k])
            own = [
                collision
                for collision in self.collisions
                if tuple(collision.first) == body and collision.second.kind == "person"
            ]
            values = impact_metrics(own)
            if self.trial.balance:
                caused = [fall for fall in self.falls if (fall.cause, fall.causer) == body]
                values |= fall_metrics(self.falls, caused)
                values["max_severity"] = max(values["max_severity"], values["fall_severity"])
            found |= {(key if k == 0 else f"{robot.name}.{key}"): value for key, value in values.items()}
        return found

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


def new_metrics(trial: Trial, ids: Sequence[int]) -> list[NavigationMetrics]:
    """Return the metrics of each robot of a trial, with these ids, before its first record."""
    if not trial.robots:
        return []
    walls = trial.stage.as_walls().segments()
    ghosts = [own for own, robot in zip(ids, trial.robots, strict=True) if robot.ghost]
    return [
        NavigationMetrics(
            own,
            robot.radius,
            robot.goal.position,
            robot.goal.tolerance,
            walls=walls,
            ghost=robot.ghost,
            outline=robot.body.outline,
            ignored=[ghost for ghost in ghosts if ghost != own],
        )
        for own, robot in zip(ids, trial.robots, strict=True)
    ]


def robot_metrics(travels: Sequence[NavigationMetrics], names: Iterable[str], outcome: str) -> dict[str, float]:
    """Return the metrics of all robots; for a single robot, the outcome is that of the run."""
    found: dict[str, float] = {}
    for number, (travel, name) in enumerate(zip(travels, names, strict=True)):
        values = travel.result(outcome if len(travels) == 1 else None)
        found |= {(key if number == 0 else f"{name}.{key}"): value for key, value in values.items()}
    return found


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
