"""ContactTracker: incremental detection of the contact events of a robot."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from .agent_states import AgentStates
from .contacts import ContactEvent, contact_events

APART = 1.0
"""A person is tracked until this time [s] after being near the robot; contacts end earlier."""


class ContactTracker:
    """Detects the contact events of one robot incrementally. Only people near the robot are stored.

    Args:
        robot: id of the robot.
        radius: radius of the robot [m].
        outline: corners ``[K, 2]`` of the robot in its frame [m]; None for a disc.
    """

    def __init__(self, robot: int, radius: float, outline: NDArray[np.float64] | None = None) -> None:
        self.robot, self.radius, self.outline = robot, radius, outline
        self._before: AgentStates | None = None
        self._ended: list[ContactEvent] = []
        self._near: dict[int, tuple[float, float, list[AgentStates]]] = {}
        """Data of people near the robot by id: last time near, radius, and the states of both."""

    def update(self, states: AgentStates, near: NDArray[np.int64]) -> None:
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
