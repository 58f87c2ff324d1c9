"""AgentStates: states of the agents present at one time; AgentLog: states of agents at many times."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Floats


@dataclass(frozen=True)
class AgentStates:
    """States of the N agents, people and robots, present at one time.

    Fields:
        time: simulated time [s].
        ids: identity of each agent ``[N]``, increasing.
        position, velocity: ``[N, 2]`` [m], [m/s].
        heading, radius: ``[N]`` [rad], [m].

    >>> here = AgentStates(0.0, np.array([4]), np.ones((1, 2)), np.zeros((1, 2)), np.zeros(1), np.array([0.3]))
    >>> here.at(np.array([4, 7]))[2].tolist()
    [True, False]
    """

    time: float
    ids: NDArray[np.int64]
    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats

    def at(self, ids: NDArray[np.int64]) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """Return position and velocity ``[M, 2]`` of the given agents, 0 if absent, and which are present ``[M]``."""
        place = np.clip(np.searchsorted(self.ids, ids), 0, len(self.ids) - 1)
        here = self.ids[place] == ids
        return (
            np.where(here[:, None], self.position[place], 0.0),
            np.where(here[:, None], self.velocity[place], 0.0),
            here,
        )

    def select(self, chosen: NDArray[np.bool_]) -> AgentStates:
        """Return the states of some agents, ``chosen [N]``."""
        return AgentStates(
            self.time,
            self.ids[chosen],
            self.position[chosen],
            self.velocity[chosen],
            self.heading[chosen],
            self.radius[chosen],
        )


class AgentLog(NamedTuple):
    """States of A agents, people and robots, at T times; column k belongs to the agent with id k.

    Fields:
        times: increasing ``[T]`` [s].
        position, velocity: ``[T, A, 2]`` [m], [m/s].
        heading, radius: ``[T, A]`` [rad], [m].
        active: ``[T, A]`` who is present; other values of absent agents have no meaning.

    >>> still = np.zeros((1, 2, 2))
    >>> log = AgentLog(np.zeros(1), still, still, np.zeros((1, 2)), np.ones((1, 2)), np.array([[False, True]]))
    >>> [states.ids.tolist() for states in log.states()]
    [[1]]
    """

    times: Floats
    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats
    active: NDArray[np.bool_]

    def part(self, first: int, last: int | None) -> AgentLog:
        """Return the records from ``first`` to before ``last``."""
        return AgentLog._make(column[first:last] for column in self)

    def states(self, agents: NDArray[np.int64] | None = None) -> Iterator[AgentStates]:
        """Yield the states at each time, of all agents or only of those with the given increasing ids."""
        every = np.arange(self.active.shape[1]) if agents is None else agents
        for k, time in enumerate(self.times.tolist()):
            ids = every[self.active[k, every]]
            position, velocity = self.position[k, ids], self.velocity[k, ids]
            yield AgentStates(time, ids, position, velocity, self.heading[k, ids], self.radius[k, ids])
