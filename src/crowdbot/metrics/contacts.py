"""Contact events between a robot and people, in logs and step by step: cause, depth and impact speed."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from crowdbot.typing import Bools, Floats, Ints

from .agent_states import AgentStates
from .outline_clearance import outline_clearance, outline_touch
from .proximity import JUMP

RELEASE = 0.05
"""A contact ends if the clearance stays above this [m] ..."""
HOLD = 0.5
"""... for this long [s]."""
MARGIN = 0.05
"""Tolerance of closing speeds [m/s] for a mutual contact; a slower robot is at rest."""
APART = 1.0
"""A person is tracked until this time [s] after being near the robot; contacts end earlier."""


@dataclass(frozen=True)
class ContactEvent:
    """A contact between the robot and a person, from first contact to last overlap.

    Fields:
        person: index of the person.
        begin, end: first contact and end of the last time step with overlap [s].
        depth: maximum overlap [m], positive.
        cause: ``robot``, ``person`` or ``mutual``, see :func:`cause_of`.
        impact_speed: closing speed along the normal at first contact [m/s], 0 when separating.
    """

    person: int
    begin: float
    end: float
    depth: float
    cause: str
    impact_speed: float


def cause_of(normal: Floats, robot_velocity: Floats, person_velocity: Floats) -> str:
    """Return the cause of a contact: ``robot``, ``person`` or ``mutual``.

    With n the unit vector from robot to person, the closing speeds are ``c_R = max(0, v.n)`` and ``c_i = max(0,
    -v_i.n)``. The larger one is the cause if the difference exceeds 0.05 m/s. A robot slower than 0.05 m/s is never the
    cause.

    >>> n = np.array([1.0, 0.0])
    >>> cause_of(n, np.array([1.0, 0.0]), np.zeros(2)), cause_of(n, np.zeros(2), np.array([-1.0, 0.0]))
    ('robot', 'person')
    """
    robot_closing = max(0.0, float(robot_velocity @ normal))
    person_closing = max(0.0, float(-person_velocity @ normal))
    if math.hypot(*robot_velocity) < MARGIN or person_closing > robot_closing + MARGIN:
        return "person"
    return "robot" if robot_closing > person_closing + MARGIN else "mutual"


def contact_events(
    times: Floats, position: Floats, velocity: Floats, radius: Floats, active: Bools, robot: int,
    heading: Floats | None = None, outline: Floats | None = None,
) -> tuple[ContactEvent, ...]:  # fmt: skip
    """Return the contacts of the robot with all people, by first contact.

    An event begins when the swept clearance between two samples falls below 0, and ends when the clearance at the
    samples stays above 0.05 m for 0.5 s. Velocities at first contact are position differences between the two samples;
    ``velocity`` is used only for contacts at the first sample. With an ``outline`` ``[K, 2]`` [m] and headings ``[T]``
    [rad], the robot is a polygon, otherwise a disc.

    >>> p = np.zeros((3, 2, 2)); p[:, 1, 0] = [0.6, 0.4, 0.6]
    >>> v, r, here = np.zeros((3, 2, 2)), np.array([0.25, 0.25]), np.ones((3, 2), bool)
    >>> event = contact_events(np.array([0.0, 0.1, 0.2]), p, v, r, here, robot=0)[0]
    >>> round(event.begin, 3), event.cause, round(event.impact_speed, 3), round(event.depth, 3)
    (0.05, 'person', 2.0, 0.1)
    """
    turned, shape = (np.zeros(len(times)), None) if heading is None else (heading, outline)
    swept, gap, _ = outline_clearance(times, position, velocity, turned, radius, active, robot, shape)
    events: list[ContactEvent] = []
    for person in np.flatnonzero(np.any(swept < 0.0, axis=0)):
        for first, last in contact_stretches(times, swept[:, person], gap[:, person]):
            deepest = -float(np.min(swept[first : last + 1, person]))
            begin, normal, own, other = _first_touch(
                times, position, velocity, radius, active, robot, int(person), first, heading, outline
            )
            impact = max(0.0, float((own - other) @ normal))
            cause = cause_of(normal, own, other)
            events.append(ContactEvent(int(person), begin, float(times[last]), deepest, cause, impact))
    return tuple(sorted(events, key=lambda event: (event.begin, event.person)))


def contact_stretches(times: Floats, swept: Floats, gap: Floats) -> list[tuple[int, int]]:
    """Return first and last sample of each contact, from clearances ``[T]`` since the last sample and at the sample
    [m].

    >>> contact_stretches(np.arange(3.0), np.array([0.1, -0.1, 0.2]), np.array([0.1, 0.1, 0.2]))
    [(1, 1)]
    """
    found: list[tuple[int, int]] = []
    first = last = -1
    free_since = math.inf
    for k in range(len(times)):
        if swept[k] < 0.0:
            first = k if first < 0 else first
            last = k
        if gap[k] <= RELEASE:
            free_since = math.inf
        elif swept[k] < 0.0 or math.isinf(free_since):
            free_since = float(times[k])
        if first >= 0 and times[k] - free_since >= HOLD - 1e-9:
            found.append((first, last))
            first = -1
    return [*found, (first, last)] if first >= 0 else found


def _first_touch(
    times: Floats, position: Floats, velocity: Floats, radius: Floats, active: Bools, robot: int, person: int, k: int,
    heading: Floats | None, outline: Floats | None,
) -> tuple[float, Floats, Floats, Floats]:  # fmt: skip
    """Return time, normal (robot to person) and both velocities at first contact, in the step that ends at k."""
    reach = float(radius[robot] + radius[person])
    away = position[k, person] - position[k, robot]
    own, other = velocity[k, robot], velocity[k, person]
    begin = float(times[k])
    step = float(times[k] - times[k - 1]) if k > 0 else 0.0
    entered = k == 0 or not active[k - 1, person] or math.dist(*position[k - 1 : k + 1, person]) > JUMP * step
    if outline is not None and heading is not None and np.isfinite(heading[k]):
        b = k if entered else k - 1
        turn = (float(heading[b if np.isfinite(heading[b]) else k]), float(heading[k]))
        both = position[[b, k]][:, [robot, person]]
        share, normal = outline_touch(both, turn, (float(radius[robot]), float(radius[person])), outline)
        if not entered:
            own, other = (both[1] - both[0]) / step
            begin = float(times[b]) + share * step
        return begin, normal, own, other
    if not entered:
        own = (position[k, robot] - position[k - 1, robot]) / step
        other = (position[k, person] - position[k - 1, person]) / step
        before = position[k - 1, person] - position[k - 1, robot]
        closing = other - own
        after = min(step, max(0.0, _touch(before, closing, reach)))
        away = before + closing * after
        begin = float(times[k - 1]) + after
    length = math.hypot(away[0], away[1])
    normal = away / length if length > 0.0 else np.array([1.0, 0.0])
    return begin, normal, own, other


def _touch(away: Floats, closing: Floats, reach: float) -> float:
    """Return the time at which ``|away + closing t|`` reaches ``reach``, or its minimum (graze)."""
    a, b, c = float(closing @ closing), float(away @ closing), float(away @ away) - reach**2
    if a == 0.0 or b >= 0.0:
        return 0.0
    return c / (-b + math.sqrt(b * b - a * c)) if b * b > a * c else -b / a


class ContactTracker:
    """Detects the contact events of one robot incrementally. Only people near the robot are stored.

    Args:
        robot: id of the robot.
        radius: radius of the robot [m].
        outline: corners ``[K, 2]`` of the robot in its frame [m]; None for a disc.
    """

    def __init__(self, robot: int, radius: float, outline: Floats | None = None) -> None:
        self.robot, self.radius, self.outline = robot, radius, outline
        self._before: AgentStates | None = None
        self._ended: list[ContactEvent] = []
        self._near: dict[int, tuple[float, float, list[AgentStates]]] = {}
        """Data of people near the robot by id: last time near, radius, and the states of both."""

    def update(self, states: AgentStates, near: Ints) -> None:
        """Add a step; ``near`` are the ids of people close to the robot since the previous step."""
        if not len(near) and not self._near:
            self._before = states
            return
        for person in near.tolist():
            since = [] if self._before is None else [self._pair(self._before, person)]
            radius = float(states.radius[np.searchsorted(states.ids, person)])
            self._near[person] = (states.time, radius, self._near[person][2] if person in self._near else since)
        for person, (last, _, instants) in list(self._near.items()):
            instants.append(self._pair(states, person))
            if states.time - last > APART:
                self._ended += self._events_of(person)
                del self._near[person]
        self._before = states

    def events(self) -> tuple[ContactEvent, ...]:
        """Return the contact events so far by first contact, see :func:`contact_events`, with ids as ``person``."""
        events = [*self._ended, *(event for person in self._near for event in self._events_of(person))]
        return tuple(sorted(events, key=lambda event: (event.begin, event.person)))

    def _pair(self, states: AgentStates, person: int) -> AgentStates:
        """Return the states of the robot and one person; an absent person has the id -1."""
        ids = np.array([self.robot, person])
        position, velocity, here = states.at(ids)
        heading = np.zeros(2)
        if self.outline is not None and here[0]:
            heading[0] = states.heading[np.searchsorted(states.ids, self.robot)]
        return AgentStates(states.time, np.where(here, ids, -1), position, velocity, heading, np.zeros(2))

    def _events_of(self, person: int) -> list[ContactEvent]:
        _, radius, instants = self._near[person]
        events = contact_events(
            np.array([instant.time for instant in instants]),
            np.stack([instant.position for instant in instants]),
            np.stack([instant.velocity for instant in instants]),
            np.array([self.radius, radius]),
            np.stack([instant.ids >= 0 for instant in instants]),
            0,
            np.array([instant.heading[0] for instant in instants]),
            self.outline,
        )
        return [dataclasses.replace(event, person=person) for event in events]
