"""RecordedRows: recorded states of people and robots, one row for each agent at each time at which it is present."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import GESTURES, EpisodeError
from crowdbot.metrics import AgentLog, AgentStates
from crowdbot.typing import Floats
from crowdbot.world import REACTIONS

Value = TypeVar("Value", bound=np.generic)
DENSE_CELLS = 100_000_000
"""Largest number of cells ``T * A`` of an array with a column for each id; positions take 1.6 GB then."""


class RobotRow(NamedTuple):
    """State of a robot at one time: its id, radius [m], x, y [m], heading [rad] and velocity vx, vy [m/s]."""

    id: int
    radius: float
    x: float
    y: float
    heading: float
    vx: float
    vy: float


@dataclass(frozen=True, eq=False, repr=False)
class RecordedRows:
    """States of people and robots by time: M rows, one for each agent at each of the T times at which it is present.

    The memory grows with what was recorded, also where each arrival gets a new id.

    Fields:
        times: increasing ``[T]`` [s].
        starts: ``[T + 1]``; the rows of time k are ``starts[k]`` to before ``starts[k + 1]``.
        ids: id of each row ``[M]``, increasing at each time.
        position, velocity: ``[M, 2]`` [m], [m/s].
        heading, radius: ``[M]`` [rad], [m].
        count: number A of ids; all are below it.
        reactions: codes of the reactions to robots ``[M]``; None if nobody can react.
        gestures: codes of the gestures ``[M]``, see :data:`crowdbot.core.GESTURES`; None if nobody can make one.

    >>> here = AgentStates(0.0, np.array([4]), np.ones((1, 2)), np.zeros((1, 2)), np.zeros(1), np.array([0.3]))
    >>> rows = RecordedRows.of([here, here], [[RobotRow(2, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0)], []], 5)
    >>> rows.ids.tolist(), rows.starts.tolist(), rows.present().tolist()
    ([2, 4, 4], [0, 2, 3], [2, 4])
    >>> rows.log([2, 4]).active.tolist()
    [[True, True], [False, True]]
    """

    times: Floats
    starts: NDArray[np.int64]
    ids: NDArray[np.int64]
    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats
    count: int
    reactions: NDArray[np.int8] | None = None
    gestures: NDArray[np.int8] | None = None

    @classmethod
    def of(
        cls,
        people: Sequence[AgentStates],
        robots: Sequence[Sequence[RobotRow]],
        count: int,
        reactions: Sequence[Mapping[str, Sequence[int]] | None] = (),
        gestures: Sequence[Mapping[str, Sequence[int]] | None] = (),
    ) -> RecordedRows:
        """Return the rows of people and robots at T times.

        Args:
            people, robots: who is present at each time.
            count: number A of ids.
            reactions: ids of the people who react to robots by kind of reaction, at each time; None or nothing if
                nobody can react.
            gestures: ids of the people who make a gesture by its name, likewise.

        Raises:
            ValueError: an id is below 0, not below ``count``, or twice at one time.
        """
        machines = np.array([row for present in robots for row in present], dtype=np.float64).reshape(-1, 7)
        step = np.concatenate(
            [_steps([len(states.ids) for states in people]), _steps([len(present) for present in robots])]
        )
        ids = np.concatenate([*(states.ids for states in people), machines[:, 0].astype(np.int64)])
        order = np.lexsort((ids, step))
        step, ids = step[order], ids[order]
        if len(ids) and (ids.min() < 0 or ids.max() >= count):
            wrong = int(ids.min()) if ids.min() < 0 else int(ids.max())
            raise ValueError(f"an agent has the id {wrong}; ids are from 0 to {count - 1}")
        twice = np.flatnonzero((np.diff(ids) == 0) & (np.diff(step) == 0))
        if len(twice):
            raise ValueError(f"two agents have the id {int(ids[twice[0]])} at one time")
        starts = np.searchsorted(step, np.arange(len(people) + 1))
        return cls(
            np.array([states.time for states in people], dtype=np.float64),
            starts,
            ids,
            np.concatenate([*(states.position for states in people), machines[:, 2:4]])[order],
            np.concatenate([*(states.velocity for states in people), machines[:, 5:7]])[order],
            np.concatenate([*(states.heading for states in people), machines[:, 4]])[order],
            np.concatenate([*(states.radius for states in people), machines[:, 1]])[order],
            count,
            _codes(starts, ids, reactions, REACTIONS),
            _codes(starts, ids, gestures, GESTURES),
        )

    def at(self, k: int) -> slice:
        """Return the rows of time k."""
        return slice(int(self.starts[k]), int(self.starts[k + 1]))

    def find(self, k: int, ids: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return the rows ``[N]`` of agents at time k, and which of them are present; rows of others have no meaning.

        Args:
            k: number of the time.
            ids: ``[N]``.
        """
        part = self.at(k)
        if part.start == part.stop:
            return np.zeros(len(ids), dtype=np.int64), np.zeros(len(ids), dtype=np.bool_)
        rows = part.start + np.minimum(np.searchsorted(self.ids[part], ids), part.stop - part.start - 1)
        return rows, self.ids[rows] == ids

    @property
    def every(self) -> NDArray[np.int64]:
        """All ids ``[A]``, also of those who were never present.

        Raises:
            EpisodeError: there are too many, see :data:`DENSE_CELLS`.
        """
        self._check_size(1, self.count)
        return np.arange(self.count, dtype=np.int64)

    def present(self, first: int = 0, last: int | None = None) -> NDArray[np.int64]:
        """Return the increasing ids of all who are present at times ``first`` to before ``last`` (default: all)."""
        return np.unique(self.ids[self._part(first, last)])

    def log(self, ids: Sequence[int] | NDArray[np.int64], first: int = 0, last: int | None = None) -> AgentLog:
        """Return the states of agents at times ``first`` to before ``last`` as arrays with a column for each agent.

        Column c belongs to ``ids[c]``, and values of absent agents are 0. The radius is the last one of each agent.

        Args:
            ids: increasing ids ``[N]``.
            first, last: numbers of times (default: all).

        Raises:
            EpisodeError: the arrays are too large, see :data:`DENSE_CELLS`.
        """
        part, who = self._part(first, last), np.asarray(ids, dtype=np.int64)
        times = self.times[first:last]
        self._check_size(len(times), len(who))
        column = np.searchsorted(who, self.ids[part])
        rows = np.arange(part.start, part.stop)
        if len(who) < self.count:
            chosen = column < len(who)
            chosen[chosen] = who[column[chosen]] == self.ids[part][chosen]
            column, rows = column[chosen], rows[chosen]
        step = np.searchsorted(self.starts, rows, side="right") - 1 - first
        shape = (len(times), len(who))
        position, velocity = np.zeros((*shape, 2)), np.zeros((*shape, 2))
        heading, radius, active = np.zeros(shape), np.zeros(len(who)), np.zeros(shape, dtype=np.bool_)
        position[step, column], velocity[step, column] = self.position[rows], self.velocity[rows]
        heading[step, column], radius[column], active[step, column] = self.heading[rows], self.radius[rows], True
        return AgentLog(times, position, velocity, heading, np.broadcast_to(radius, shape), active)

    def dense(self, values: NDArray[Value]) -> NDArray[Value]:
        """Return values of rows ``[M, ...]`` as an array ``[T, A, ...]`` with a column for each id, 0 if absent.

        Raises:
            EpisodeError: the array is too large, see :data:`DENSE_CELLS`.

        >>> here = AgentStates(0.0, np.array([4]), np.ones((1, 2)), np.zeros((1, 2)), np.zeros(1), np.array([0.3]))
        >>> rows = RecordedRows.of([here], [[]], 5)
        >>> rows.dense(rows.radius).tolist()
        [[0.0, 0.0, 0.0, 0.0, 0.3]]
        """
        self._check_size(len(self.times), self.count)
        result = np.zeros((len(self.times), self.count, *values.shape[1:]), dtype=values.dtype)
        result[_steps(np.diff(self.starts)), self.ids] = values
        return result

    @staticmethod
    def _check_size(times: int, ids: int) -> None:
        if times * ids > DENSE_CELLS:
            raise EpisodeError(
                f"{times} times and {ids} ids are too many for arrays with a column for each id; their product may be"
                f" {DENSE_CELLS}: use the rows by time, RecordedEpisode.rows"
            )

    def _part(self, first: int, last: int | None) -> slice:
        return slice(int(self.starts[first]), int(self.starts[len(self.times) if last is None else last]))


def _steps(sizes: Sequence[int] | NDArray[np.int64]) -> NDArray[np.int64]:
    return np.repeat(np.arange(len(sizes)), np.asarray(sizes, dtype=np.int64))


def _codes(
    starts: NDArray[np.int64], ids: NDArray[np.int64], rows: Sequence[Any], names: Sequence[str]
) -> NDArray[np.int8] | None:
    """Return the index in ``names`` of each row, from the ids by name at each time; None if they are not known."""
    if not rows or any(row is None for row in rows):
        return None
    codes = np.zeros(len(ids), dtype=np.int8)
    for k, kinds in enumerate(rows):
        here, found = ids[starts[k] : starts[k + 1]], codes[starts[k] : starts[k + 1]]
        for kind, people in kinds.items():
            if not np.isin(people, here).all():
                raise ValueError(f"somebody who is absent reacts: {kind!r} of {people}")
            found[np.isin(here, people)] = names.index(kind)
    return codes
