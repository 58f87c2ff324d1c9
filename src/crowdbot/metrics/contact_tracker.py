"""Contact events of a robot, found while the records arrive."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from .agent_states import AgentStates
from .contacts import ContactEvent, contact_events

__all__ = ["ContactTracker"]

APART = 1.0
"""A person is followed until this long [s] after the last instant near the robot; a contact ends earlier than that."""


class ContactTracker:
    """Finds the contact events of one robot incrementally. Only the people near the robot are kept in memory.

    Args:
        robot: id of the robot.
        radius: its radius [m].
    """

    def __init__(self, robot: int, radius: float) -> None:
        self.robot, self.radius = robot, radius
        self._before: AgentStates | None = None
        self._ended: list[ContactEvent] = []
        self._near: dict[int, tuple[float, float, list[AgentStates]]] = {}
        """By id of a person near the robot: last time near, radius, and the instants with both alone."""

    def update(self, states: AgentStates, near: NDArray[np.int64]) -> None:
        """Add an instant; ``near`` are the ids of the people close to the robot since the instant before."""
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
        """Return the contact events up to now by first touch, as :func:`contact_events`, with ids as ``person``."""
        events = [*self._ended, *(event for person in self._near for event in self._events_of(person))]
        return tuple(sorted(events, key=lambda event: (event.begin, event.person)))

    def _pair(self, states: AgentStates, person: int) -> AgentStates:
        """Return an instant with the robot and one person alone; an absent person has the id -1."""
        ids = np.array([self.robot, person])
        position, velocity, here = states.at(ids)
        return AgentStates(states.time, np.where(here, ids, -1), position, velocity, np.zeros(2), np.zeros(2))

    def _events_of(self, person: int) -> list[ContactEvent]:
        _, radius, instants = self._near[person]
        events = contact_events(
            np.array([one.time for one in instants]),
            np.stack([one.position for one in instants]),
            np.stack([one.velocity for one in instants]),
            np.array([self.radius, radius]),
            np.stack([one.ids >= 0 for one in instants]),
            0,
        )
        return [dataclasses.replace(event, person=person) for event in events]
