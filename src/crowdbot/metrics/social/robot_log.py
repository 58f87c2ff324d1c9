"""RobotLog: the log of one robot among people, with what the metrics of logs read from it."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.metrics.agent_states import AgentLog
from crowdbot.metrics.contacts import ContactEvent, contact_events
from crowdbot.metrics.motion import STALL_SPEED
from crowdbot.metrics.outline_clearance import OutlineClearance, outline_clearance
from crowdbot.metrics.step_clearance import step_outline_wall_clearance, step_wall_clearance
from crowdbot.typing import Bools, Floats, Ints

from .body_region import BodyRegion


class OtherRobots(NamedTuple):
    """Other robots in the log of a robot: T samples, Q robots.

    Fields:
        position: ``[T, Q, 2]`` [m]; NaN where absent.
        radius: radii of their circumscribed discs ``[Q]`` [m].
        heading: ``[T, Q]`` [rad].
        outlines: corners ``[K, 2]`` of each in its frame [m]; None for a disc.
    """

    position: Floats
    radius: Floats
    heading: Floats
    outlines: tuple[Floats | None, ...]


@dataclass(frozen=True, eq=False)
class RobotLog:
    """The log of one robot among people, up to its arrival at the goal: T samples, P people.

    It comes from a simulated episode or from a recording of a real robot.

    Fields:
        times: increasing ``[T]`` [s].
        position, velocity: ``[T, 2]`` [m], [m/s] of the robot.
        heading: ``[T]`` [rad].
        radius: radius of the robot [m].
        people_position, people_velocity: ``[T, P, 2]`` [m], [m/s].
        people_radius: ``[P]`` [m].
        present: ``[T, P]`` who is present.
        goal: ``[2]`` [m], or None.
        tolerance: distance [m] below which the goal is reached.
        success: whether the goal was reached, before any contact.
        walls: segments ``[N, 4]`` [m].
        objects: static discs ``[M, 3]``: x, y, radius [m].
        robots: other robots, or None.
        path: shortest path ``[K, 2]`` [m] from the start to the goal around walls, or None.
        max_speed: largest speed of the robot [m/s]; NaN if unknown.
        mass, height: of the robot [kg], [m]; NaN if unknown.
        groups: indices of the members of each group; None to detect them.
        regions: limits of body regions by name.
        outline: corners ``[K, 2]`` of the robot in its frame [m], for clearances and contacts; None for a disc.
        gestures: ``[T, P]`` codes of the gestures of people to the robot, indices in
            :data:`crowdbot.core.GESTURES`; None if they are not known.

    Raises:
        InputError: shapes do not match, times do not increase, or a value of the robot is not finite.

    >>> log = RobotLog.of(AgentLog(
    ...     np.arange(3.0), np.array([[[k, 0.0], [5.0, 0.0]] for k in range(3)]), np.zeros((3, 2, 2)),
    ...     np.zeros((3, 2)), np.full((3, 2), 0.3), np.ones((3, 2), bool)), robot=0, goal=(9.0, 0.0))
    >>> log.gap[:, 0].round(1).tolist()
    [4.4, 3.4, 2.4]
    """

    times: Floats
    position: Floats
    velocity: Floats
    heading: Floats
    radius: float
    people_position: Floats
    people_velocity: Floats
    people_radius: Floats
    present: Bools
    goal: Floats | None = None
    tolerance: float = 0.3
    success: bool = False
    walls: Floats = dataclasses.field(default_factory=lambda: np.zeros((0, 4)))
    objects: Floats = dataclasses.field(default_factory=lambda: np.zeros((0, 3)))
    robots: OtherRobots | None = None
    path: Floats | None = None
    max_speed: float = math.nan
    mass: float = math.nan
    height: float = math.nan
    groups: Sequence[Sequence[int]] | None = None
    regions: Mapping[str, BodyRegion] = dataclasses.field(default_factory=dict)
    outline: Floats | None = None
    gestures: NDArray[np.int8] | None = None

    def __post_init__(self) -> None:
        count, people = len(self.times), self.present.shape[1:]
        shapes = {
            "position": (self.position, (count, 2)),
            "velocity": (self.velocity, (count, 2)),
            "heading": (self.heading, (count,)),
            "people_position": (self.people_position, (count, *people, 2)),
            "people_velocity": (self.people_velocity, (count, *people, 2)),
            "people_radius": (self.people_radius, people),
            "present": (self.present, (count, *people)),
        }
        if self.gestures is not None:
            shapes["gestures"] = (self.gestures, (count, *people))
        for name, (value, shape) in shapes.items():
            if np.shape(value) != shape:
                raise InputError(f"robot log: {name} has shape {list(np.shape(value))}, it must be {list(shape)}")
        if count == 0 or np.any(np.diff(self.times) <= 0.0):
            raise InputError("robot log: times must increase and contain at least one sample")
        if not (np.isfinite(self.position).all() and np.isfinite(self.velocity).all()):
            raise InputError("robot log: a position or velocity of the robot is not finite")

    @classmethod
    def of(
        cls,
        log: AgentLog,
        robot: int,
        goal: Sequence[float] | Floats | None = None,
        tolerance: float = 0.3,
        *,
        others: Sequence[int] = (),
        ignore: Sequence[int] = (),
        outcome: str | None = None,
        outlines: Mapping[int, Floats | None] | None = None,
        gestures: NDArray[np.int8] | None = None,
        **fields: object,
    ) -> RobotLog:
        """Return the log of one robot of a log of agents, up to the first sample at its goal.

        Args:
            log: states of all agents.
            robot: id of the robot; samples without it are left out.
            goal, tolerance: see the fields.
            others: ids of other robots.
            ignore: ids of agents that do not exist for this robot, such as ghosts.
            outcome: outcome of the run (default: success if the goal is reached without contact).
            outlines: corners ``[K, 2]`` of robots in their frames [m] by id (default: discs).
            gestures: ``[T, A]`` codes of the gestures of all agents (default: not known).
            fields: further fields.
        """
        there = log.active[:, robot]
        log = AgentLog._make(column[there] for column in log)
        aim = None if goal is None else np.asarray(goal, dtype=np.float64)
        reached = False
        if aim is not None and len(log.times):
            at_goal = np.hypot(*(log.position[:, robot] - aim).T) < tolerance
            reached = bool(at_goal.any())
            log = log.part(0, int(np.argmax(at_goal)) + 1 if reached else None)
        away = {robot, *others, *ignore}
        people = np.array([k for k in np.flatnonzero(log.active.any(axis=0)).tolist() if k not in away], dtype=np.int64)
        seen = log.active[:, people]
        radius = np.where(seen, log.radius[:, people], 0.0).max(axis=0, initial=0.0)
        rest = [k for k in others if k != robot and k not in ignore]
        robots, shapes = None, outlines or {}
        if rest:
            robots = OtherRobots(
                np.where(log.active[:, rest, None], log.position[:, rest], np.nan),
                log.radius[:, rest].max(axis=0, initial=0.0),
                log.heading[:, rest],
                tuple(shapes.get(k) for k in rest),
            )
        made = cls(
            log.times, log.position[:, robot], log.velocity[:, robot], log.heading[:, robot],
            float(log.radius[:, robot].max(initial=0.0)), log.position[:, people], log.velocity[:, people],
            radius, seen, aim, tolerance, robots=robots,
            gestures=None if gestures is None else gestures[there][: len(log.times), people],
            **{"outline": shapes.get(robot), **fields},  # type: ignore[arg-type]
        )  # fmt: skip
        success = reached and not (made.least_gap < 0.0).any() if outcome is None else outcome == "success"
        return dataclasses.replace(made, success=bool(success))

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.times[-1] - self.times[0])

    @functools.cached_property
    def speed(self) -> Floats:
        """Speed of the robot ``[T]`` [m/s]."""
        return np.asarray(np.hypot(self.velocity[:, 0], self.velocity[:, 1]))

    @functools.cached_property
    def all_positions(self) -> tuple[Floats, Floats, Floats, Bools]:
        """Positions, velocities, radii and presence of people and, as the last agent, the robot."""
        return (
            np.concatenate([self.people_position, self.position[:, None]], axis=1),
            np.concatenate([self.people_velocity, self.velocity[:, None]], axis=1),
            np.append(self.people_radius, self.radius),
            np.concatenate([self.present, np.ones((len(self.times), 1), dtype=np.bool_)], axis=1),
        )

    @functools.cached_property
    def _clearances(self) -> OutlineClearance:
        """Clearances and times to collision of each person ``[T, P]``; infinite if absent."""
        position, velocity, radius, active = self.all_positions
        own = len(radius) - 1
        rows = outline_clearance(self.times, position, velocity, self.heading, radius, active, own, self.outline)
        return OutlineClearance(*(row[:, :-1] for row in rows))

    @functools.cached_property
    def gap(self) -> Floats:
        """Clearance of each person ``[T, P]`` [m], infinite if absent."""
        return self._clearances.gap

    @functools.cached_property
    def least_gap(self) -> Floats:
        """Smallest clearance of each person since the sample before ``[T, P]`` [m], infinite if absent."""
        return self._clearances.swept

    @functools.cached_property
    def nearest(self) -> Floats:
        """Clearance of the nearest person ``[T]`` [m]; infinite without people."""
        return np.asarray(self.gap.min(axis=1, initial=math.inf))

    @functools.cached_property
    def wall_clearance(self) -> Floats:
        """Clearance to the nearest wall ``[T]`` [m]; that of the disc where the heading is unknown."""
        return self._wall_clearance(np.arange(len(self.times)))

    @functools.cached_property
    def least_wall_clearance(self) -> Floats:
        """Smallest clearance to a wall since the sample before ``[T]`` [m], as :attr:`wall_clearance`."""
        return self._wall_clearance(np.maximum(np.arange(len(self.times)) - 1, 0))

    def _wall_clearance(self, since: Ints) -> Floats:
        size, before, after = np.full(len(self.times), self.radius), self.position[since], self.position
        disc = step_wall_clearance(before, after, size, self.walls)
        if self.outline is None:
            return disc
        known = np.isfinite(self.heading) & np.isfinite(self.heading[since])
        turn = np.where(np.isfinite(self.heading), self.heading, 0.0)
        outline = step_outline_wall_clearance(before, turn[since], after, turn, size, self.outline, self.walls)
        return np.where(known, outline, disc)

    @functools.cached_property
    def ttc(self) -> Floats:
        """Time to collision with each person ``[T, P]`` [s]; infinite without a collision."""
        return self._clearances.ttc

    @functools.cached_property
    def contacts(self) -> tuple[ContactEvent, ...]:
        """Contacts with people, in order of time."""
        position, velocity, radius, active = self.all_positions
        met = np.append(np.flatnonzero((self.least_gap < 0.0).any(axis=0)), len(radius) - 1)
        if len(met) == 1:
            return ()
        found = contact_events(
            self.times, position[:, met], velocity[:, met], radius[met], active[:, met], len(met) - 1,
            self.heading, self.outline,
        )  # fmt: skip
        return tuple(dataclasses.replace(one, person=int(met[one.person])) for one in found)

    @functools.cached_property
    def people_heading(self) -> Floats:
        """Heading of each person ``[T, P]`` [rad]: direction of the last velocity above 0.05 m/s, first 0."""
        speed = np.hypot(self.people_velocity[..., 0], self.people_velocity[..., 1])
        moves = (speed > STALL_SPEED) & self.present
        rows = np.maximum.accumulate(np.where(moves, np.arange(len(self.times))[:, None], -1), axis=0)
        heading = np.arctan2(self.people_velocity[..., 1], self.people_velocity[..., 0])
        return np.where(rows >= 0, np.take_along_axis(heading, np.maximum(rows, 0), axis=0), 0.0)

    @functools.cached_property
    def goal_distance(self) -> Floats:
        """Distance to the goal ``[T]`` [m]; NaN without a goal."""
        if self.goal is None:
            return np.full(len(self.times), math.nan)
        return np.asarray(np.hypot(*(self.position - self.goal).T))
