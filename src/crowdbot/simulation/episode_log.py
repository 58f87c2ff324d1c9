"""EpisodeLog: collects an episode while it runs, from single records or from the records of many environments."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import FreeClock
from crowdbot.metrics import AgentLog, NavigationMetrics
from crowdbot.sensors import Reading
from crowdbot.trials import Trial
from crowdbot.typing import Floats, Ints
from crowdbot.world import BodyContactEvent, ContactForce, gesture_codes, reaction_codes

from .episode import Episode
from .episode_digest import EpisodeDigest, add_batch
from .failure import RunFailure
from .mounted_sensor import SensorReadings
from .orders.goal_order import GoalOrder
from .orders.order import Order
from .statistics import EpisodeStatistics, new_metrics
from .step_batch import StepBatch
from .step_record import RobotContact, StepRecord


class _Frame(NamedTuple):
    """The scene of one record: arrays over the agents ``[A, ...]`` and over the robots, and who has touched a robot."""

    nanoseconds: int
    ids: Ints
    active: NDArray[np.bool_]
    heading: Floats
    radius: Floats
    position: Floats
    velocity: Floats
    twists: Floats
    commands: Floats
    touching: frozenset[int]
    robots: tuple[int, ...]
    goals: Floats
    reactions: NDArray[np.int8] | None
    gestures: NDArray[np.int8] | None


class EpisodeLog(EpisodeStatistics):
    """Collects the arrays of an episode while it runs. Its metrics are computed from the arrays when asked for.

    Args:
        trial, seed, digest, robots: see :class:`EpisodeStatistics`.
    """

    def __init__(
        self, trial: Trial, seed: int, digest: EpisodeDigest | None = None, robots: Sequence[int] | None = None
    ) -> None:
        super().__init__(trial, seed, digest, robots)
        self.readings: dict[str, list[Reading | tuple[SensorReadings, int]]] = {}
        self.orders: list[tuple[int, Order]] = []
        self.contacts: list[tuple[float, RobotContact]] = []
        self.forces: list[tuple[float, ContactForce]] = []
        self._frames: list[_Frame] = []

    def keep(self, frame: StepRecord) -> None:
        self.agents = max(self.agents, 1 + int(frame.ids.max(initial=-1)))
        for robot, mount, reading in frame.readings:
            self.readings.setdefault(f"{robot.name}/{mount.name}", []).append(reading)
        self._keep_rare(frame.tick, frame.nanoseconds, frame.touches, frame.forces, frame.collisions, frame.orders)
        self.falls += frame.falls
        if frame.due:
            scene = frame.scene
            parts = (scene.active, scene.heading, scene.radius, scene.position, scene.velocity)
            arrays = [frame.ids, *(part[0] for part in parts), frame.twists, frame.commands]
            agents = [int(np.flatnonzero(frame.ids == robot)[0]) for robot in frame.robot_ids]
            codes = [None if rows is None else rows[0] for rows in (reaction_codes(scene), gesture_codes(scene))]
            self._keep_frame(frame.nanoseconds, arrays, frame.robot_ids, scene.goal[0, agents], codes)

    def keep_row(self, batch: StepBatch, row: int) -> None:
        """Add a row of a batch without its readings, which the digest already contains."""
        slots, nanoseconds = int(batch.slots[row]), int(batch.nanoseconds[row])
        touches, forces = batch.touches.get(row, ()), batch.forces.get(row, ())
        collisions, orders = batch.collisions.get(row, ()), batch.orders.get(row, ())
        self._keep_rare(int(batch.ticks[row]), nanoseconds, touches, forces, collisions, orders)
        self.falls += batch.falls.get(row, ())
        if batch.due[row]:
            parts = (batch.ids, batch.active, batch.heading, batch.radius, batch.position, batch.velocity)
            arrays = [part[row, :slots] for part in parts]
            whole = [*arrays, batch.twists[row], batch.commands[row]]
            codes = [None if rows is None else rows[row, :slots] for rows in (batch.reactions, batch.gestures)]
            self._keep_frame(nanoseconds, whole, self.robot_ids, batch.goals[row], codes)

    def metrics(self, outcome: str) -> dict[str, float]:
        return self._metrics(self._arrays(), outcome) if self.trial.robots and self._frames else {}

    def _metrics(self, arrays: Mapping[str, NDArray[Any]], outcome: str) -> dict[str, float]:
        if self.trial.robots:
            self.travels = new_metrics(self.trial, self.robot_ids)
            log = AgentLog(*(arrays[name] for name in AgentLog._fields))
            for travel in self.travels:
                there = log.active[:, travel.robot]
                end = len(there) if there.all() else int(np.argmin(there))  # an order has removed it
                self._measure(travel, log.part(0, end))
        return super().metrics(outcome)

    def _measure(self, travel: NavigationMetrics, log: AgentLog) -> None:
        """Add all records in which a robot is present to its metrics, with the goals in force."""
        frames = self._frames[: len(log.times)]
        touched = np.array([travel.robot in frame.touching for frame in frames])
        goals = [frame.goals[frame.robots.index(travel.robot)] for frame in frames]
        name = self.trial.robots[self.robot_ids.index(travel.robot)].name
        orders = [(at, item) for at, item in self.orders if isinstance(item, GoalOrder) and item.robot == name]
        if not orders and np.all(np.array(goals) == travel.goal):
            travel.update_log(log, touched)
            return
        step = FreeClock(self.trial.step).step_ns
        for states, frame, goal, contact in zip(log.states(), frames, goals, touched.tolist(), strict=True):
            travel.goal = goal
            for at, order in orders:
                if at * step <= frame.nanoseconds and order.tolerance is not None:
                    travel.tolerance = float(order.tolerance)
            travel.update(states, contact)

    def episode(
        self,
        outcome: str,
        steps: int,
        failure: RunFailure | None = None,
        decision_times: Mapping[str, tuple[float, ...]] | None = None,
    ) -> Episode:
        """Return the episode."""
        arrays = self._arrays()
        robots = tuple(dict.fromkeys(robot for frame in self._frames for robot in frame.robots))
        here = arrays["active"]
        last = len(here) - 1 - np.argmax(here[::-1], axis=0)
        radius = np.where(here.any(axis=0), arrays["radius"][last, np.arange(self.agents)], 0.0)
        return Episode(
            self.trial,
            self.seed,
            outcome,
            steps,
            arrays["times"],
            np.where(here[..., None], arrays["position"], 0.0),
            np.where(here[..., None], arrays["velocity"], 0.0),
            np.where(here, arrays["heading"], 0.0),
            radius,
            here,
            np.arange(self.agents, dtype=np.int64),
            robots,
            _by_robot([frame.twists for frame in self._frames], [frame.robots for frame in self._frames], robots),
            _by_robot([frame.commands for frame in self._frames], [frame.robots for frame in self._frames], robots),
            _Readings(self.readings),
            self._metrics(arrays, outcome),
            self.digest.hexdigest(outcome),
            failure,
            tuple(self.orders),
            tuple(self.contacts),
            tuple(self.forces),
            tuple(self.collisions),
            tuple(self.falls),
            self._codes("reactions"),
            self._codes("gestures"),
            dict(decision_times or {}),
        )

    def _codes(self, name: str) -> NDArray[np.int8] | None:
        """Return the codes of reactions to robots or of gestures ``[T, A]``, None if there can be none."""
        rows = [codes for frame in self._frames if (codes := getattr(frame, name)) is not None]
        if not rows or len(rows) < len(self._frames):
            return None
        return _by_person(rows, [frame.ids for frame in self._frames], self.agents)

    def _keep_rare(
        self,
        tick: int,
        nanoseconds: int,
        touches: Sequence[RobotContact],
        forces: Sequence[ContactForce],
        collisions: Sequence[BodyContactEvent],
        orders: Sequence[Order],
    ) -> None:
        if not (touches or forces or collisions or orders):
            return
        time = nanoseconds / 1e9
        self._touching |= {who for touch in touches for who in (touch.robot, touch.other)}
        self.orders += [(tick, order) for order in orders]
        self.contacts += [(time, contact) for contact in touches]
        self.forces += [(time, force) for force in forces]
        self.collisions += collisions

    def _keep_frame(
        self,
        nanoseconds: int,
        arrays: Sequence[NDArray[Any]],
        robots: tuple[int, ...],
        goals: Floats,
        codes: Sequence[NDArray[np.int8] | None],
    ) -> None:
        self.end = nanoseconds / 1e9
        self.begin = self.end if math.isnan(self.begin) else self.begin
        self._frames.append(_Frame._make([nanoseconds, *arrays, frozenset(self._touching), robots, goals, *codes]))
        self._touching = set()

    def _arrays(self) -> dict[str, NDArray[Any]]:
        """Return times ``[T]`` [s] and the arrays of the scenes ``[T, A, ...]`` with one column for each id."""
        frames, agents = self._frames, self.agents
        arrays: dict[str, NDArray[Any]] = {"times": np.array([frame.nanoseconds / 1e9 for frame in frames])}
        same = all(len(frame.ids) == agents for frame in frames)
        ids = np.stack([frame.ids for frame in frames]) if same else np.zeros((1, 0), dtype=np.int64)
        same = same and bool(np.all(ids == np.arange(agents)))
        for name in _Frame._fields[2:7]:
            rows: list[NDArray[Any]] = [getattr(frame, name) for frame in frames]
            arrays[name] = np.stack(rows) if same else _by_person(rows, [frame.ids for frame in frames], agents)
        return arrays


class EpisodeLogs:
    """Passes the records of each environment to its log; a sink of single records and of batches.

    Args:
        logs: the logs, by the number of the environment.
    """

    def __init__(self, logs: Sequence[EpisodeLog]) -> None:
        self.logs = logs

    def take(self, frame: StepRecord) -> None:
        """Process a step record."""
        self.logs[frame.environment].take(frame)

    def take_batch(self, batch: StepBatch) -> None:
        """Process the records of a step of many environments."""
        logs = [self.logs[e] for e in batch.environments.tolist()]
        add_batch([log.digest for log in self.logs], batch)
        for robot, mount, told, rows in batch.readings:
            name = f"{robot.name}/{mount.name}"
            for k, n in enumerate(rows.tolist()):
                if n >= 0:
                    logs[n].readings.setdefault(name, []).append((told, k))
        agents = (1 + batch.ids.max(axis=1, initial=-1)).tolist()
        for n, log in enumerate(logs):
            log.agents = max(log.agents, agents[n])
            log.keep_row(batch, n)


class _Readings(Mapping[str, tuple[Reading, ...]]):
    """Readings by name; those of batches are cut out of them when first asked for."""

    def __init__(self, rows: Mapping[str, list[Reading | tuple[SensorReadings, int]]]) -> None:
        self._rows = {name: list(found) for name, found in rows.items()}
        self._made: dict[str, tuple[Reading, ...]] = {}

    def __getitem__(self, name: str) -> tuple[Reading, ...]:
        if name not in self._made:
            rows = self._rows[name]
            self._made[name] = tuple(row[0].row(row[1]) if isinstance(row, tuple) else row for row in rows)
            self._rows[name] = []
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._rows)

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        return repr(dict(self))

    def __reduce__(self) -> tuple[Any, ...]:
        """Write only the own readings, not the batches."""
        return dict, (dict(self),)


def _by_robot(rows: Sequence[Floats], ids: Sequence[tuple[int, ...]], robots: tuple[int, ...]) -> Floats:
    """Return rows ``[R, 3]`` as ``[T, robots, 3]``, NaN while a robot is absent; ``ids`` are the robots of the rows."""
    if all(own == robots for own in ids):
        return np.stack(rows)
    out = np.full((len(rows), len(robots), 3), np.nan)
    for k, (row, own) in enumerate(zip(rows, ids, strict=True)):
        out[k, [robots.index(robot) for robot in own]] = row
    return out


def _by_person(rows: Sequence[NDArray[Any]], ids: Sequence[Ints], agents: int) -> NDArray[Any]:
    """Return rows ``[A, ...]`` as ``[T, agents, ...]`` with one column per id; ``ids`` are the ids of the rows."""
    out = np.zeros((len(rows), agents, *rows[0].shape[1:]), dtype=rows[0].dtype)
    for k, (row, who) in enumerate(zip(rows, ids, strict=True)):
        out[k, who[who >= 0]] = row[who >= 0]
    return out
