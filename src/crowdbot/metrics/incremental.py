"""NavigationMetrics: incremental navigation metrics of one robot, for live runs, recordings and logs.

Definition of values that depend on the source of the data:

=================================  ====================================================================================
key                                value
=================================  ====================================================================================
``success``, ``collision``,        with an outcome given to :meth:`NavigationMetrics.result` (a run with one robot):
``timeout``, ``time_to_goal``      that of the run, judged at every time step. Otherwise judged from the records: the
                                   clearance to people and walls, swept between records, or ``contact`` of a record
``contacts`` and its details,      from the clearance between discs at the records, also in the physics world
``min_clearance``
``duration`` and everything else   from the records up to the first at the goal, the time limit or the end
``heading_change``                 from the headings; if unknown (NaN) from the direction of the velocity while moving
``radius`` of people               the radius in each record
=================================  ====================================================================================
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .agent_states import AgentStates
from .contact_tracker import ContactTracker
from .motion import heading_change, jerk, longest_stall, path_efficiency, path_length, stalled_time
from .proximity import personal_space_compliance, proxemic_shares
from .record_clearance import record_clearance

__all__ = ["NavigationMetrics", "NavigationOutcome"]

Floats = NDArray[np.float64]

NEAR = 1.0
"""People closer than this [m] are tracked for contacts."""
MOVING = 0.05
"""Minimum speed [m/s] at which the direction of the velocity defines the heading."""


class NavigationOutcome(NamedTuple):
    """Outcome of an episode: ``success``, ``collision`` or ``timeout``, and the deciding sample."""

    name: str
    sample: int


class _Sample(NamedTuple):
    """Values of the robot at one record."""

    time: float
    position: Floats
    velocity: Floats
    heading: float
    swept: float
    nearest: float
    density: float
    ttc: float
    wall: float


class NavigationMetrics:
    """Navigation metrics of one robot, updated record by record; see :data:`crowdbot.metrics.NAVIGATION_METRICS`.

    Memory grows by a few numbers per record.

    Args:
        robot: id of the robot.
        radius: radius of the robot [m].
        goal: ``[2]`` position of the goal [m].
        tolerance: distance [m] below which the goal is reached.
        walls: segments ``[N, 4]`` [m].
        time_limit: time limit after the first record [s].

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
    ) -> None:
        self.robot, self.radius = robot, radius
        self.goal, self.tolerance, self.time_limit = np.asarray(goal, dtype=np.float64), tolerance, time_limit
        self.walls = np.zeros((0, 4)) if walls is None else walls
        self._samples: list[_Sample] = []
        self._contacts = ContactTracker(robot, radius)
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
        if self._samples and not states.time > self._samples[-1].time:
            raise InputError(
                f"navigation metrics: {states.time} s follows {self._samples[-1].time} s; time must increase"
            )
        if self._samples and states.time - self._samples[0].time > self.time_limit:
            self._finished = True
            return
        own = int(np.searchsorted(states.ids, self.robot))
        if own == len(states.ids) or states.ids[own] != self.robot:
            raise InputError(f"navigation metrics: robot {self.robot} is absent at {states.time} s")
        sample = self._measure(states, own)
        self._samples.append(sample)
        self._before = states
        away = sample.position - self.goal
        arrived = bool(np.hypot(away[0], away[1]) < self.tolerance)
        touched = contact or min(sample.swept, sample.wall) < 0.0
        if self._decided is None and (touched or arrived):
            self._decided = NavigationOutcome("collision" if touched else "success", len(self._samples) - 1)
        self._finished = arrived

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
        times = np.array([sample.time for sample in self._samples])
        position = np.array([sample.position for sample in self._samples])
        velocity = np.array([sample.velocity for sample in self._samples])
        heading = np.array([sample.heading for sample in self._samples])
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

    def _measure(self, states: AgentStates, own: int) -> _Sample:
        found = record_clearance(self._before, states, own, self.radius, self.walls, NEAR)
        self._contacts.update(states, found.near)
        place, velocity = states.position[own], states.velocity[own]
        return _Sample(states.time, place, velocity, _heading(states, own), *found[1:])

    def _nearness(self, times: Floats) -> dict[str, float]:
        rows = [(one.swept, one.nearest, one.wall, one.density) for one in self._samples]
        swept, nearest, wall, density = np.array(rows).T
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
        ttc = np.array([sample.ttc for sample in self._samples])
        return {
            "min_ttc": float(np.min(ttc)),
            "ttc_below_1s": float(np.mean(ttc < 1.0)),
            "ttc_below_3s": float(np.mean(ttc < 3.0)),
        }


def _heading(states: AgentStates, own: int) -> float:
    """Return the heading of the robot, or of its velocity if unknown; NaN at rest."""
    heading = float(states.heading[own])
    if math.isfinite(heading):
        return heading
    x, y = states.velocity[own]
    return float(np.arctan2(y, x)) if np.hypot(x, y) > MOVING else math.nan
