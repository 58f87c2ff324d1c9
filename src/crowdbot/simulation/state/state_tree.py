"""State of a simulation as a flat mapping from paths to arrays, numbers and texts, and back.

A value is an array, a number, a text, None, or a :class:`StateMark` for a container, whose parts have longer paths. The
mapping has no classes of users and no code: a new simulation of the same trial gives all structure, and the mapping
only the values. Random generators are stored by the state of their bit generator, the physics engine by its state
vector.
"""

from __future__ import annotations

import collections
import dataclasses
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crowdbot.core import InputError, RandomStreams

from .engine_state import has_engine, read_engine
from .state_fields import AVATARS, ENVIRONMENT_TIME, holder_fields, is_holder, qualified, value_name
from .world_structure import structure_problem

if TYPE_CHECKING:
    from crowdbot.simulation.simulation import Simulation

__all__ = ["CHECKED", "StateError", "StateMark", "state_of", "stream_avatars", "value_fields"]

SCALARS = (bool, int, float, str)
KINDS = "biuf"
CHECKED = "Twists"
"""A class whose objects note that they have been checked."""


class StateError(InputError):
    """A state cannot be stored or restored."""


class StateMark(NamedTuple):
    """A container or a special value in a state.

    Fields:
        kind: ``holder``, ``value``, ``list``, ``tuple``, ``dict``, ``deque``, ``objects``, ``number``, ``random``,
            ``streams``, ``time`` or ``same``.
        content: name of the class, number of parts, state of random generators, or path of the same object.
    """

    kind: str
    content: Any = None


def state_of(simulation: Simulation) -> dict[str, Any]:
    """Return the complete state of a simulation between two steps.

    Raises:
        StateError: a part of the state is an object of an unknown class, such as the memory of a navigator that is not
            made of plain values; or robots or props were added or removed while the simulation ran.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.simulation import Simulation
    >>> from crowdbot.trials import Trial
    >>> simulation = Simulation(Trial(name="empty", duration=1.0, crowd=ORCA()))
    >>> simulation.advance()
    >>> state_of(simulation)["simulation/world/environment_time/ticks"].tolist()
    [1]
    """
    problem = structure_problem(simulation)
    if problem:
        raise StateError(problem)
    writer = _Writer(stream_avatars(simulation))
    writer.put("simulation", simulation)
    return writer.found


def stream_avatars(simulation: Simulation) -> frozenset[str]:
    """Return the names of avatars and robots whose samples come from outside; other sources do not change."""
    robots = [(f"robot/{one.name}", one.mirror) for one in simulation.trial.robots]
    named = [(one.name, one) for one in simulation.trial.avatars] + [(name, pose) for name, pose in robots if pose]
    return frozenset(name for name, one in named if one.source == "external")


class _Writer:
    """Collects the values of a state by path.

    Args:
        streams: names of the avatars whose sources are part of the state.
    """

    def __init__(self, streams: frozenset[str]) -> None:
        self.found: dict[str, Any] = {}
        self._streams = streams
        self._known: dict[int, tuple[str, Any]] = {}

    def put(self, path: str, value: Any) -> None:
        """Add a value and its parts."""
        kind = type(value)
        if value is None or kind in SCALARS:
            self.found[path] = value
        elif isinstance(value, np.generic) and value.dtype.kind in KINDS:
            self.found[path] = StateMark("number", [value.dtype.str, value.item()])
        elif kind is tuple or (isinstance(value, tuple) and value_name(value)):
            self._parts(path, value)
        elif id(value) in self._known:
            self.found[path] = StateMark("same", self._known[id(value)][0])
        else:
            self._known[id(value)] = (path, value)
            self._object(path, value)

    def _object(self, path: str, value: Any) -> None:
        if type(value) is np.ndarray:
            self._array(path, value)
        elif is_holder(value):
            self._holder(path, value)
        elif qualified(type(value)) == ENVIRONMENT_TIME:
            self.found[path] = StateMark("time")
            self.put(f"{path}/ticks", value.ticks)
            self.put(f"{path}/begin", value.begin)
        elif isinstance(value, np.random.Generator) and isinstance(value.bit_generator, np.random.PCG64):
            self.found[path] = StateMark("random", value.bit_generator.state)
        elif type(value) is RandomStreams:
            self.found[path] = StateMark("streams", value.states)
        else:
            self._parts(path, value)

    def _array(self, path: str, value: Any) -> None:
        if value.dtype.kind in KINDS:
            self.found[path] = np.ascontiguousarray(value).reshape(value.shape)
        elif value.dtype == object and value.ndim == 1:
            self.found[path] = StateMark("objects", len(value))
            self._numbered(path, value)
        else:
            raise StateError(f"{path} is an array of {value.dtype}, which cannot be stored")

    def _holder(self, path: str, value: Any) -> None:
        self.found[path] = StateMark("holder", type(value).__name__)
        for name in holder_fields(value):
            self.put(f"{path}/{name}", getattr(value, name))
        if has_engine(value):
            self.put(f"{path}/engine", read_engine(value))
        if qualified(type(value)) == AVATARS:
            for e, sources in enumerate(value.sources):
                for name, source in zip(value.names, sources, strict=True):
                    if name in self._streams:
                        self.put(f"{path}/sources/{e}/{name}", source)

    def _parts(self, path: str, value: Any) -> None:
        kind = type(value)
        if (name := value_name(value)) is not None:
            self.found[path] = StateMark("value", name)
            for field in value_fields(kind):
                if not (kind.__name__ == "Scene" and field == "walls"):
                    self.put(f"{path}/{field}", getattr(value, field))
            if name == CHECKED:
                self.put(f"{path}/_count", getattr(value, "_count", None))
        elif kind in (list, tuple):
            self.found[path] = StateMark(kind.__name__, len(value))
            self._numbered(path, value)
        elif kind is dict:
            self.found[path] = StateMark("dict", len(value))
            for k, (key, part) in enumerate(value.items()):
                self.put(f"{path}/{k}/key", key)
                self.put(f"{path}/{k}/value", part)
        elif kind is collections.deque:
            self.found[path] = StateMark("deque", [len(value), value.maxlen])
            self._numbered(path, value)
        else:
            raise StateError(f"{path} is a {kind.__name__}, which cannot be stored; plain values can")

    def _numbered(self, path: str, parts: Any) -> None:
        for k, part in enumerate(parts):
            self.put(f"{path}/{k}", part)


def value_fields(kind: type[Any]) -> tuple[str, ...]:
    """Return the names of the fields of a dataclass or named tuple."""
    if dataclasses.is_dataclass(kind):
        return tuple(field.name for field in dataclasses.fields(kind))
    names: tuple[str, ...] = kind._fields
    return names
