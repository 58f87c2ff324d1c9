"""NavigationMetrics: incremental navigation metrics of one robot, for live runs, recordings and logs.

Definition of values that depend on the source of the data:

=================================  ====================================================================================
key                                value
=================================  ====================================================================================
``success``, ``collision``,        with an outcome given to :meth:`NavigationMetrics.result` (a run with one robot):
``timeout``, ``time_to_goal``      that of the run, judged at every time step. Otherwise judged from the records: the
                                   clearance to people and walls, swept between records, or ``contact`` of a record
``contacts`` and its details,      from the clearance between people, who are discs, and the outline of the robot at the
``min_clearance``                  records, also in the physics world; where its heading is unknown, the robot is a disc
``duration`` and everything else   from the records up to the first at the goal, the time limit or the end
``heading_change``                 from the headings; if unknown (NaN) from the direction of the velocity while moving
``radius`` of people               the radius in each record
=================================  ====================================================================================
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Bools, Floats

from .agent_states import AgentLog, AgentStates
from .contacts import ContactTracker
from .motion import heading_change, jerk, longest_stall, path_efficiency, path_length, stalled_time
from .proximity import personal_space_compliance, proxemic_shares
from .record_clearance import log_clearance, record_clearance

NEAR = 1.0
"""People closer than this [m] are tracked for contacts."""
TOUCH = 1e-6
"""People who come closer than this [m] may touch the robot; larger than rounding errors."""
CONTACT_METRICS = (
    "contacts",
    "robot_caused_contacts",
    "person_caused_contacts",
    "contact_time",
    "max_penetration",
    "max_impact_speed",
)
"""Metrics of contacts, which a ghost does not have."""
MOVING = 0.05
"""Minimum speed [m/s] at which the direction of the velocity defines the heading."""


class NavigationOutcome(NamedTuple):
    """Outcome of an episode: ``success``, ``collision`` or ``timeout``, and the deciding sample."""

    name: str
    sample: int


class _Samples:
    """Values of the robot at each record, 11 numbers of 8 bytes: no record with all people is kept alive by a view."""

    WIDTH = 11

    def __init__(self) -> None:
        self._numbers = array("d")

    def __len__(self) -> int:
        return len(self._numbers) // self.WIDTH

    def add(self, *row: float) -> None:
        """Add time, position, velocity, heading, swept and nearest clearance, density, ttc and wall clearance."""
        self._numbers.extend(row)

    def extend(self, *columns: Floats) -> None:
        """Add columns ``[N]`` of many records."""
        self._numbers.frombytes(np.stack(columns, axis=1).astype(np.float64).tobytes())

    def time(self, number: int) -> float:
        """Return the time of a record."""
        return self._numbers[(number % len(self)) * self.WIDTH]

    def columns(self, *numbers: int) -> Floats:
        """Return some values of all records ``[N, len(numbers)]``."""
        table = np.array(self._numbers, dtype=np.float64).reshape(-1, self.WIDTH)
        return np.ascontiguousarray(table[:, numbers])

    @property
    def times(self) -> Floats:
        """Times ``[N]`` [s]."""
        return self.columns(0).ravel()

    @property
    def headings(self) -> Floats:
        """Headings ``[N]`` [rad]; NaN at rest if unknown."""
        return self.columns(5).ravel()

    @property
    def collision_times(self) -> Floats:
        """Smallest times to collision ``[N]`` [s]."""
        return self.columns(9).ravel()


class NavigationMetrics:
    """Navigation metrics of one robot, updated record by record; see :data:`crowdbot.metrics.NAVIGATION_METRICS`.

    Memory grows by 100 bytes per record, however many people there are.

    Args:
        robot: id of the robot.
        radius: radius of the robot [m].
        goal: ``[2]`` position of the goal [m].
        tolerance: distance [m] below which the goal is reached.
        walls: segments ``[N, 4]`` [m].
        time_limit: time limit after the first record [s].
        ghost: whether the robot is a ghost, which passes through people and walls: the metrics of
            :data:`CONTACT_METRICS` are absent, and the outcome is never a collision.
        ignored: ids of agents that do not exist for this robot, such as other ghosts.
        outline: corners ``[K, 2]`` of the convex outline in the frame of the robot, counter-clockwise [m], see
            :attr:`crowdbot.world.Robot.outline`; None for a disc.

    >>> metrics = NavigationMetrics(0, 0.3, (1.0, 0.0), tolerance=0.2)
    >>> for k in range(3):
    ...     at = np.array([[0.5 * k, 0.0]])
    ...     metrics.update(AgentStates(float(k), np.array([0]), at, np.zeros((1, 2)), np.zeros(1), np.array([0.3])))
    >>> metrics.outcome, metrics.result()["path_length"]
    (NavigationOutcome(name='success', sample=2), 1.0)
    """

    def __init__(
        self,
        robot: int,
        radius: float,
        goal: tuple[float, float] | Floats,
        tolerance: float,
        *,
        walls: Floats | None = None,
        time_limit: float = math.inf,
        ghost: bool = False,
        ignored: Sequence[int] = (),
        outline: Floats | None = None,
    ) -> None:
        self.outline = outline
        self.ghost, self.ignored = ghost, np.asarray(ignored, dtype=np.int64)
        self.robot, self.radius = robot, radius
        self.goal, self.tolerance, self.time_limit = np.asarray(goal, dtype=np.float64), tolerance, time_limit
        self.walls = np.zeros((0, 4)) if walls is None else walls
        self._samples = _Samples()
        self._contacts = ContactTracker(robot, radius, outline)
        self._before: AgentStates | None = None
        self._decided: NavigationOutcome | None = None
        self._finished = False

    @property
    def outcome(self) -> NavigationOutcome:
        """Outcome according to the records; a timeout until decided."""
        return self._decided or NavigationOutcome("timeout", len(self._samples) - 1)

    def update(self, states: AgentStates, contact: bool = False) -> None:
        """Add a record. Records after the arrival at the goal or after the time limit do not count.

        Args:
            states: all agents present, including the robot.
            contact: whether the world detected a contact of the robot since the previous record.

        Raises:
            InputError: the time does not increase, or the robot is absent.
        """
        if self._finished:
            return
        if self._samples and not states.time > self._samples.time(-1):
            raise InputError(
                f"navigation metrics: {states.time} s follows {self._samples.time(-1)} s; time must increase"
            )
        if self._samples and states.time - self._samples.time(0) > self.time_limit:
            self._finished = True
            return
        if len(self.ignored):
            states = states.select(~np.isin(states.ids, self.ignored))
        own = int(np.searchsorted(states.ids, self.robot))
        if own == len(states.ids) or states.ids[own] != self.robot:
            raise InputError(f"navigation metrics: robot {self.robot} is absent at {states.time} s")
        swept, wall = self._measure(states, own)
        place = states.position[own]
        self._before = states
        away = place - self.goal
        arrived = bool(np.hypot(away[0], away[1]) < self.tolerance)
        touched = not self.ghost and (contact or min(swept, wall) < 0.0)
        if self._decided is None and (touched or arrived):
            self._decided = NavigationOutcome("collision" if touched else "success", len(self._samples) - 1)
        self._finished = arrived

    def update_log(self, log: AgentLog, contact: Bools) -> None:
        """Add all records of a log; the result is that of :meth:`update` with each of them, to the last bit.

        Args:
            log: all agents, including the robot, with ids as columns.
            contact: ``[T]`` whether the world detected a contact of the robot since the previous record.

        Raises:
            InputError: the times do not increase, or the robot is absent.
        """
        if len(self.ignored):
            active = log.active.copy()
            active[:, self.ignored] = False
            log = log._replace(active=active)
        if self._samples or self._finished:
            for states, touched in zip(log.states(), contact.tolist(), strict=True):
                self.update(states, touched)
            return
        log, arrived = self._counted(log)
        found = log_clearance(log, self.robot, self.radius, self.walls, self.outline)
        touched = contact[: len(log.times)] | (np.minimum(found.swept, found.wall) < 0.0)
        touched &= not self.ghost
        if (touched | arrived).any():
            first = int(np.argmax(touched | arrived))
            self._decided = NavigationOutcome("collision" if touched[first] else "success", first)
        place, velocity = log.position[:, self.robot], log.velocity[:, self.robot]
        heading = np.array(list(map(_heading, log.heading[:, self.robot].tolist(), velocity)), dtype=np.float64)
        self._samples.extend(log.times, *place.T, *velocity.T, heading, *found[1:])
        self._update_contacts(log, found.closest)
        self._before = next(log.part(-1, None).states())

    def _counted(self, log: AgentLog) -> tuple[AgentLog, Bools]:
        """Return the records that count, and at which of them the robot is at its goal; set whether it is the end."""
        times, there = log.times, log.active[:, self.robot]
        away = log.position[:, self.robot] - self.goal
        arrived = there & (np.hypot(away[:, 0], away[:, 1]) < self.tolerance)
        late = times - times[0] > self.time_limit
        count = min(
            (int(np.argmax(flag)) + extra for flag, extra in ((arrived, 1), (late, 0)) if flag.any()),
            default=len(times),
        )
        self._finished = bool(arrived.any() or late.any())
        order = np.diff(times[:count]) > 0.0
        if not order.all():
            k = int(np.argmin(order))
            raise InputError(f"navigation metrics: {times[k + 1]} s follows {times[k]} s; time must increase")
        if not there[:count].all():
            missing = times[int(np.argmin(there[:count]))]
            raise InputError(f"navigation metrics: robot {self.robot} is absent at {missing} s")
        return log.part(0, count), arrived[:count]

    def _update_contacts(self, log: AgentLog, closest: Floats) -> None:
        """Track the people who touch the robot in the log; all others have no contact events."""
        margin = TOUCH + max(0.0, self.radius - float(log.radius[:, self.robot].min()))
        people = np.flatnonzero(closest.min(axis=0) < margin)
        if len(people) and not self.ghost:
            for k, states in enumerate(log.states(np.sort(np.append(people, self.robot)))):
                self._contacts.update(states, people[closest[k, people] < NEAR])

    def result(self, outcome: str | None = None) -> dict[str, float]:
        """Return every metric of :data:`crowdbot.metrics.NAVIGATION_METRICS` so far.

        Args:
            outcome: outcome of the run if evaluated at every time step (default: :attr:`outcome`).

        Raises:
            InputError: there is no record yet.
        """
        if not self._samples:
            raise InputError("navigation metrics: there is no record yet")
        ended = self.outcome.name if outcome is None else outcome
        times, heading = self._samples.times, self._samples.headings
        position, velocity = self._samples.columns(1, 2), self._samples.columns(3, 4)
        duration = float(times[-1] - times[0])
        first, last = (math.dist(position[k], self.goal) for k in (0, -1))
        jerks = jerk(times, velocity)
        return {
            **{name: float(ended == name) for name in ("success", "collision", "timeout")},
            "duration": duration,
            "time_to_goal": duration if ended == "success" else math.nan,
            "goal_progress": 1.0 - last / first if first > 0.0 else 1.0,
            "path_length": path_length(position),
            "path_efficiency": path_efficiency(position),
            **self._nearness(times),
            **self._contact_metrics(),
            **self._time_to_collision(),
            "stalled_time": stalled_time(times, velocity),
            "longest_stall": longest_stall(times, velocity),
            "mean_jerk": float(np.mean(jerks)) if len(jerks) else math.nan,
            "max_jerk": float(np.max(jerks)) if len(jerks) else math.nan,
            "heading_change": heading_change(heading[np.isfinite(heading)]),
        }

    def _measure(self, states: AgentStates, own: int) -> tuple[float, float]:
        """Keep the values of a record; return the swept clearance to people and that to walls."""
        found = record_clearance(self._before, states, own, self.radius, self.walls, NEAR, self.outline)
        if not self.ghost:
            self._contacts.update(states, found.near)
        place, velocity = states.position[own], states.velocity[own]
        heading = _heading(float(states.heading[own]), velocity)
        self._samples.add(states.time, *place.tolist(), *velocity.tolist(), heading, *found[1:])
        return found.swept, found.wall

    def _nearness(self, times: Floats) -> dict[str, float]:
        swept, nearest, wall, density = self._samples.columns(6, 7, 10, 8).T
        someone = np.isfinite(nearest)
        return {
            "min_clearance": float(np.min(swept)),
            "min_clearance_time": float(times[np.argmin(swept)]) if np.any(np.isfinite(swept)) else math.nan,
            "mean_nearest_distance": float(np.mean(nearest[someone])) if np.any(someone) else math.inf,
            "personal_space_compliance": personal_space_compliance(nearest),
            **{f"{zone}_share": share for zone, share in proxemic_shares(nearest).items()},
            "local_density": float(np.mean(density)),
            "max_local_density": float(np.max(density)),
            "min_wall_clearance": float(np.min(wall)),
        }

    def _contact_metrics(self) -> dict[str, float]:
        if self.ghost:
            return {}
        events = self._contacts.events()
        return {
            "contacts": float(len(events)),
            "robot_caused_contacts": float(sum(event.cause == "robot" for event in events)),
            "person_caused_contacts": float(sum(event.cause == "person" for event in events)),
            "contact_time": sum((event.end - event.begin for event in events), 0.0),
            "max_penetration": max((event.depth for event in events), default=0.0),
            "max_impact_speed": max((event.impact_speed for event in events), default=0.0),
        }

    def _time_to_collision(self) -> dict[str, float]:
        ttc = self._samples.collision_times
        return {
            "min_ttc": float(np.min(ttc)),
            "ttc_below_1s": float(np.mean(ttc < 1.0)),
            "ttc_below_3s": float(np.mean(ttc < 3.0)),
        }


def _heading(heading: float, velocity: Floats) -> float:
    """Return the heading of the robot, or of its velocity if unknown; NaN at rest."""
    if math.isfinite(heading):
        return heading
    x, y = velocity
    return float(np.arctan2(y, x)) if np.hypot(x, y) > MOVING else math.nan
