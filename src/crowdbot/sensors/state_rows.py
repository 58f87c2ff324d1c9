"""States of sensors by environment: some measure, some start again, the others keep their state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, storable, tree
from crowdbot.typing import Ints

from .noise import Randomness
from .sensor import Reading, Sensor, join_readings
from .view import SensorView


@storable
@dataclass(frozen=True)
class StateGroups:
    """States of one sensor that have different structures, for example None before the first measurement.

    Fields:
        environments: the environments of each state, ascending.
        states: states of these environments.
    """

    environments: tuple[Ints, ...]
    states: tuple[Any, ...]

    @property
    def count(self) -> int:
        """Number of environments."""
        return sum(map(len, self.environments))


def take_state_rows(state: Any, index: ArrayLike) -> Any:
    """Return the state of the environments ``index``, in this order.

    A state is None, a number, an array ``[E, ...]``, or a dataclass, tuple, list or dict of these. None and numbers
    belong to all environments.

    Raises:
        InputError: an environment does not exist, or the state has another form.

    >>> take_state_rows({"time": 0.5, "bias": np.array([1.0, 2.0, 3.0])}, [2, 1])
    {'time': 0.5, 'bias': array([3., 2.])}
    """
    if isinstance(state, StateGroups):
        rows = tree.environment_index(index, state.count, "state")
        return _grouped([(where, tree.take(part, found)) for where, found, part in _chosen(state, rows)], len(rows))
    return tree.take(state, tree.environment_index(index, tree.count(state, "state"), "state"))


def put_state_rows(state: Any, index: ArrayLike, rows: Any, environments: int | None = None) -> Any:
    """Return ``state`` with the environments ``index`` replaced by those of ``rows``, for example after a measurement.

    ``rows`` may be the state of :meth:`Sensor.begin`, which starts these environments again. If the structures differ,
    the result is a :class:`StateGroups`, which :func:`measure_rows` understands. Numbers that differ become arrays
    over the environments.

    Args:
        state: state of E environments.
        index: environments to replace, each once.
        rows: their new state.
        environments: E; needed only if ``state`` has no arrays, for example None.

    Raises:
        InputError: an environment does not exist or occurs twice, or E is not known.

    >>> put_state_rows(np.array([1.0, 2.0, 3.0]), [2, 0], np.array([9.0, 8.0])).tolist()
    [8.0, 2.0, 9.0]
    >>> mixed = put_state_rows(np.array([1.0, 2.0, 3.0]), [1], None)
    >>> take_state_rows(mixed, [1]), take_state_rows(mixed, [2, 0]).tolist()
    (None, [3.0, 1.0])
    """
    count = _count(state)
    if count is None:
        count = environments
    elif environments is not None and environments != count:
        raise InputError(f"state: it has {count} environments, not {environments}")
    chosen = tree.environment_index(index, count, "state")
    if len(np.unique(chosen)) != len(chosen):
        raise InputError(f"state: the environments are {chosen.tolist()}, each must occur once")
    if (new := _count(rows)) is not None and new != len(chosen):
        raise InputError(f"state: {new} rows were given for {len(chosen)} environments")
    if count is None:
        if isinstance(state, type(None)) and rows is None:
            return None
        raise InputError("state: a state without arrays needs the number of environments: pass environments=E")
    if len(chosen) == count and np.array_equal(chosen, np.arange(count)):
        return rows
    if not isinstance(state, StateGroups) and not isinstance(rows, StateGroups):
        try:
            return tree.put(state, chosen, rows, count)
        except TypeError:  # other structures: groups
            pass
    kept = np.ones(count, dtype=np.bool_)
    kept[chosen] = False
    rest = np.flatnonzero(kept)
    pieces = [(rest[at], part) for at, part in _pieces(take_state_rows(state, rest), len(rest)) if len(at)]
    pieces += [(chosen[at], part) for at, part in _pieces(rows, len(chosen)) if len(at)]
    return _grouped(pieces, count)


def measure_rows(sensor: Sensor, view: SensorView, state: Any, rng: Randomness | None = None) -> tuple[Reading, Any]:
    """Return a reading and the next state, as :meth:`Sensor.measure`, also if environments start at different times.

    Environments of one structure of state measure together: with a :class:`StateGroups` the sensor is called once for
    each group. Random numbers of an environment come from its generator, so the groups do not change the reading.

    Raises:
        InputError: the state has another number of environments, or the sensor rejects the input.
    """
    if not isinstance(state, StateGroups):
        return sensor.measure(view, state, rng)
    name = type(sensor).__name__
    if state.count != view.environments:
        raise InputError(f"{name}: the state has {state.count} environments, but the view has {view.environments}")
    readings, pieces = [], []
    for where, part in zip(state.environments, state.states, strict=True):
        own = rng if rng is None or isinstance(rng, np.random.Generator) else [rng[e] for e in where]
        reading, after = sensor.measure(view.select(where), part, own)
        readings.append(reading)
        pieces.append((where, after))
    return join_readings(readings, state.environments), _grouped(pieces, state.count)


def _count(state: Any) -> int | None:
    return state.count if isinstance(state, StateGroups) else tree.count(state, "state")


def _pieces(state: Any, count: int) -> list[tuple[Ints, Any]]:
    """Return the groups of a state of ``count`` environments."""
    if isinstance(state, StateGroups):
        return list(zip(state.environments, state.states, strict=True))
    return [(np.arange(count), state)]


def _chosen(state: StateGroups, rows: Ints) -> list[tuple[Ints, Ints, Any]]:
    """Return for each group the places in ``rows``, their rows in the state of the group, and this state."""
    chosen = []
    for where, part in zip(state.environments, state.states, strict=True):
        places = np.flatnonzero(np.isin(rows, where))
        if len(places):
            chosen.append((places, np.searchsorted(where, rows[places]), part))
    return chosen


def _grouped(pieces: list[tuple[Ints, Any]], count: int) -> Any:
    """Return the state of ``count`` environments from pieces; pieces of one structure become one group."""
    groups: list[tuple[Ints, Any]] = []
    for where, part in pieces:
        for number, (others, state) in enumerate(groups):
            both = np.sort(np.concatenate([others, where]))
            places = [np.searchsorted(both, others), np.searchsorted(both, where)]
            try:
                groups[number] = (both, tree.join([state, part], places, len(both)))
            except TypeError:
                continue
            break
        else:
            order = np.argsort(where)
            groups.append((where[order], tree.take(part, order)))
    if len(groups) == 1:
        return groups[0][1]
    return StateGroups(tuple(where for where, _ in groups), tuple(part for _, part in groups))
