"""Episode: the result of a run as arrays over recorded steps."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import FreeClock, InputError, TickSchedule
from crowdbot.data import Trajectories
from crowdbot.metrics import AgentLog, PersonImpact, TableRobot, people_table
from crowdbot.sensors import Reading, Scan, planar_pose
from crowdbot.trials import Trial, floor_plan
from crowdbot.typing import Floats
from crowdbot.world import BodyContactEvent, ContactForce, Fall

from .failure import RunFailure
from .orders.order import Order
from .step_record import RobotContact


@dataclass(frozen=True)
class ScanRow:
    """One scan of one sensor.

    Fields:
        time: time [s].
        pose: x, y [m] and heading [rad] of the sensor in the world.
        angles, ranges: ``[R]`` [rad], [m]; ranges as in :class:`crowdbot.sensors.Scan`.
        hit: ``[R]`` index of the agent that was hit; -1 nothing, -2 a wall.
    """

    time: float
    pose: tuple[float, float, float]
    angles: Floats
    ranges: Floats
    hit: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Episode:
    """The result of a run as arrays: T recorded steps, A agents, R robots.

    Agents are the initial people, then the robots, then the people who enter, in order of entry. Each agent has one
    column in the arrays and one id.

    Fields:
        trial, seed: the trial and its seed.
        outcome: ``success``, ``collision`` or ``timeout``; ``finished`` at a planned end (see the outcomes of a trial),
            ``interrupted`` if stopped from outside, ``error`` after an exception in user code.
        steps: number of time steps.
        times: times ``[T]`` [s].
        position, velocity: ``[T, A, 2]`` [m], [m/s]; 0 for absent agents.
        heading: ``[T, A]`` [rad].
        radius: ``[A]`` [m]; 0 for agents present only between two recorded steps.
        active: ``[T, A]`` whether the agent is present.
        ids: ``[A]`` identity in recordings and tracks.
        robots: indices of the robots, in the order of the trial.
        twists, commands: ``[T, R, 3]`` forward [m/s], turn [rad/s], left [m/s]: current twist of each robot, and its
            command from this time on.
        readings: all readings by ``robot/sensor``.
        metrics: metrics of the first robot; those of others are named ``name.metric``. See ``NAVIGATION_METRICS``.
        digest: hash of all recorded arrays, readings and commands and of the outcome.
        failure: the exception that ended the run, for the outcome ``error``.
        orders: orders from outside with their ticks, in the order of their application.
        contacts: time [s] and :class:`RobotContact` of every step with a contact of a robot.
        forces: time [s] and contact force of every step with one, in the physics world.
        collisions: contact events of the physics world, ordered by end.
        falls: falls of people in the physics world, ordered by end.
        reactions: ``[T, A]`` code of the reaction of each person to a robot, an index in
            :data:`crowdbot.world.REACTIONS`, 0 for none; None if nobody can react.
        gestures: ``[T, A]`` code of the gesture of each person to a robot, an index in
            :data:`crowdbot.core.GESTURES`, 0 for none; None if nobody can make one.
        decision_times: compute times [s] of the decisions by robot, of those with a deadline or with a navigator in
            another process, without the first one; not recorded.

    >>> from crowdbot.simulation import simulate
    >>> from crowdbot.trials import load_trial
    >>> episode = simulate(load_trial("frontal", duration=3.0))
    >>> episode.outcome, episode.steps, episode.position.shape
    ('timeout', 60, (31, 2, 2))
    """

    trial: Trial
    seed: int
    outcome: str
    steps: int
    times: Floats
    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats
    active: NDArray[np.bool_]
    ids: NDArray[np.int64]
    robots: tuple[int, ...]
    twists: Floats
    commands: Floats
    readings: Mapping[str, tuple[Reading, ...]]
    metrics: Mapping[str, float]
    digest: str
    failure: RunFailure | None = None
    orders: tuple[tuple[int, Order], ...] = ()
    contacts: tuple[tuple[float, RobotContact], ...] = ()
    forces: tuple[tuple[float, ContactForce], ...] = ()
    collisions: tuple[BodyContactEvent, ...] = ()
    falls: tuple[Fall, ...] = ()
    reactions: NDArray[np.int8] | None = None
    gestures: NDArray[np.int8] | None = None
    decision_times: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    @property
    def walls(self) -> tuple[Floats, ...]:
        """Walls of the stage as rings ``[N, 2]`` [m]."""
        return self.trial.stage.rings

    @property
    def scans(self) -> tuple[ScanRow, ...]:
        """Scans of the first laser scanner of the first robot."""
        for readings in self.readings.values():
            rows = tuple(scan_row(reading) for reading in readings if isinstance(reading, Scan))
            if rows:
                return rows
        return ()

    @functools.cached_property
    def people(self) -> dict[str, NDArray[Any]]:
        """One row for each person: columns of :data:`crowdbot.metrics.PEOPLE_COLUMNS`, as of a recorded episode.

        >>> from crowdbot.simulation import simulate
        >>> from crowdbot.trials import load_trial
        >>> people = simulate(load_trial("frontal", duration=2.0), 0).people
        >>> people["id"].tolist(), people["left"].tolist()
        ([0], [0.0])
        """
        specs = self.trial.robots
        robots = [TableRobot(k, spec.name, spec.ghost) for k, spec in zip(self.robots, specs, strict=True)]
        impacts = None
        if self.trial.world == "physics":
            hits = [
                collision
                for collision in self.collisions
                if (collision.first.kind, collision.second.kind) == ("robot", "person")
            ]
            impacts = [PersonImpact(hit.second.number, hit.peak_force, hit.severity) for hit in hits]
        return people_table(log_of(self), robots, impacts)

    @property
    def footprints(self) -> tuple[Floats | None, ...]:
        """Outline ``[N, 2]`` [m] of each robot with a type, in its own frame; None for a disc of its radius."""
        return tuple(robot.body.footprint if robot.type else None for robot in self.trial.robots)

    def tracks(self, dt: float = 0.4) -> Trajectories:
        """Return people and robots every ``dt`` [s] as trajectories; frame k is k times ``dt`` after the first.

        If the recording period is not a whole number of time steps, a frame is the recorded step at or after its
        time, by less than one time step.

        Raises:
            InputError: ``dt`` is not a multiple of the recording period.
        """
        return tracks_of(self, self.trial.name, dt)

    def _repr_svg_(self) -> str:
        """Return a drawing of walls and paths for notebooks."""
        name = f"{self.trial.name}, seed {self.seed}, {self.outcome}"
        return tracks_of(self, name, self.trial.recording.period).drawing(floor_plan(self.trial.stage))

    @property
    def schedule(self) -> TickSchedule:
        """Ticks of the recorded steps."""
        return FreeClock(self.trial.step).schedule(self.trial.recording.period)


def tracks_of(view: Any, name: str, dt: float) -> Trajectories:
    """Return the trajectories of an episode."""
    schedule = view.schedule
    ticks = np.rint(view.times * 1e9 / schedule.step_ns).astype(np.int64)
    times = schedule.index(ticks) * (schedule.period_ns / 1e9)  # at or less than one step before those of the steps
    begin = float(times[0])  # above 0 if it continues another episode
    count = math.floor((float(times[-1]) - begin) / dt + 1e-9) + 1
    wanted = begin + np.arange(min(count, len(times))) * dt  # count is larger if steps are missing or dt is too short
    rows = np.clip(np.searchsorted(times, wanted - 1e-6), 0, len(times) - 1)
    if count > len(times) or np.any(np.abs(times[rows] - wanted) > 1e-6):
        period = schedule.period_ns / 1e9
        raise InputError(f"tracks every {dt} s: the episode was recorded every {period:g} s, dt must be a multiple")
    frame, agent = np.nonzero(view.active[rows])
    place = view.position[rows[frame], agent]
    return Trajectories(
        view.ids[agent],
        frame,
        place[:, 0],
        place[:, 1],
        row_rate=1.0 / dt,
        frame_step=1,
        name=name,
        note="simulated",
        robots=frozenset(int(view.ids[robot]) for robot in view.robots),
        walls=tuple(view.walls),
    )


def log_of(view: Any) -> AgentLog:
    """Return the states of all agents of an episode."""
    radius = np.broadcast_to(view.radius, view.active.shape)
    return AgentLog(view.times, view.position, view.velocity, view.heading, radius, view.active)


def scan_row(scan: Scan) -> ScanRow:
    """Return a scan with E = 1 as a row."""
    pose = planar_pose(scan.pose)
    (x, y), heading = pose.position[0], pose.heading[0]
    return ScanRow(float(scan.time), (float(x), float(y), float(heading)), scan.angles, scan.ranges[0], scan.hit[0])
