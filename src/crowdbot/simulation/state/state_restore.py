"""Restore a simulation from its state, see :mod:`crowdbot.simulation.state.state_tree`."""

from __future__ import annotations

import collections
import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.core import InputError, RandomStreams, Scene
from crowdbot.world import show_doors

from .engine_state import has_engine, read_engine, update_engine, write_engine
from .state_fields import AVATARS, ENVIRONMENT_TIME, holder_fields, is_holder, qualified, value_class
from .state_tree import CHECKED, SCALARS, StateError, StateMark, stream_avatars, value_fields
from .world_structure import add_people, part_worlds

if TYPE_CHECKING:
    from crowdbot.simulation.simulation import Simulation

__all__ = ["restore_state"]

FREE = ("_begin", "_heading", "_limbs", "led")
"""Fields of arrays whose lengths change during a run."""


def restore_state(simulation: Simulation, state: Mapping[str, Any]) -> None:
    """Continue a simulation from a stored state of the same trial and seeds.

    Random numbers, people, robots, sensors and the physics engine continue exactly. If the state is refused, the
    simulation must not be used any more.

    Args:
        simulation: a new simulation of the trial, with the changes of the trial up to the state.
        state: from :func:`state_of`.

    Raises:
        StateError: the state does not belong to this trial, or is damaged.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.simulation import Simulation, state_of
    >>> from crowdbot.trials import Trial
    >>> trial = Trial(name="empty", duration=1.0, crowd=ORCA())
    >>> first, second = Simulation(trial), Simulation(trial)
    >>> first.advance()
    >>> restore_state(second, state_of(first))
    >>> second.tick
    1
    """
    try:
        add_people(simulation.world, state)
        reader = _Reader(state, stream_avatars(simulation))
        reader.get("simulation", simulation)
        unknown = sorted(set(state) - reader.used)
        if unknown:
            raise StateError(f"the state has a value {unknown[0]!r}, which this trial does not have")
        for _, world in part_worlds(simulation.world):
            update_engine(world)
            if world.doors is not None:
                show_doors(world, new_paths=False)
            _check_scene(world.scene)
            _check_scene(world._previous)
    except StateError:
        raise
    except Exception as error:  # wrong values make their classes fail in many ways
        raise StateError(f"the state is damaged: {type(error).__name__}: {str(error)[:80]}") from error


class _Reader:
    """Sets the values of a state in the objects of a new simulation.

    Args:
        state: the state.
        streams: names of the avatars whose sources are part of the state.
    """

    def __init__(self, state: Mapping[str, Any], streams: frozenset[str]) -> None:
        self.state, self.used = state, set[str]()
        self._streams = streams
        self._known: dict[str, Any] = {}

    def get(self, path: str, old: Any = None, fixed: bool = False) -> Any:
        """Return the value at a path.

        Args:
            path: the path.
            old: the value in the new simulation, None if there is none.
            fixed: whether an array must keep its shape.
        """
        if path not in self.state:
            raise StateError(f"the state lacks {path!r}")
        leaf = self.state[path]
        self.used.add(path)
        if isinstance(leaf, np.ndarray):
            value = self._array(path, leaf, old, fixed)
        elif not isinstance(leaf, StateMark):
            value = leaf
        elif leaf.kind == "same":
            if not isinstance(leaf.content, str) or leaf.content not in self._known:
                raise StateError(f"{path} refers to {leaf.content!r}, which is not before it")
            value = self._known[leaf.content]
        else:
            value = self._marked(path, leaf, old)
        self._known[path] = value
        _check_kind(path, value, old)
        return value

    def _array(self, path: str, leaf: Any, old: Any, fixed: bool) -> Any:
        if isinstance(old, np.ndarray):
            if leaf.dtype != old.dtype or leaf.ndim != old.ndim:
                raise StateError(
                    f"{path} has {leaf.ndim} axes of {leaf.dtype}, but the trial has {old.ndim} of {old.dtype}"
                )
            if fixed and leaf.shape != old.shape:
                raise StateError(f"{path} has the shape {list(leaf.shape)}, but the trial has {list(old.shape)}")
        return leaf.copy()

    def _marked(self, path: str, leaf: StateMark, old: Any) -> Any:
        kind, content = leaf
        if kind == "holder":
            return self._holder(path, old)
        if kind == "value":
            return self._value(path, str(content), old)
        if kind == "time":
            return self._time(path, old)
        if kind == "random":
            return _generator(path, content)
        if kind == "streams":
            return _streams(path, content, old)
        if kind == "number":
            return np.dtype(content[0]).type(content[1])
        if kind == "dict":
            return self._dict(path, int(content), old)
        if kind in ("list", "tuple"):
            parts = self._numbered(path, int(content), old)
            return parts if kind == "list" else tuple(parts)
        if kind == "deque":
            return collections.deque(self._numbered(path, int(content[0]), None), maxlen=content[1])
        if kind == "objects":
            parts = self._numbered(path, int(content), old)
            found = np.empty(len(parts), dtype=object)
            for k, part in enumerate(parts):
                found[k] = part
            return found
        raise StateError(f"{path} is a {kind!r}, which is unknown")

    def _numbered(self, path: str, count: int, old: Any) -> list[Any]:
        known = old if isinstance(old, list | tuple) else ()
        if count != len(known) and any(is_holder(part) for part in known):
            raise StateError(f"{path} has {count} parts, but the trial has {len(known)}")
        return [self.get(f"{path}/{k}", known[k] if k < len(known) else None) for k in range(count)]

    def _dict(self, path: str, count: int, old: Any) -> dict[Any, Any]:
        known, found = old if isinstance(old, dict) else {}, {}
        for k in range(count):
            key = self.get(f"{path}/{k}/key")
            found[key] = self.get(f"{path}/{k}/value", known.get(key))
        if any(is_holder(part) for part in known.values()) and found.keys() != known.keys():
            raise StateError(f"{path} has the parts {sorted(found)}, but the trial has {sorted(known)}")
        return found

    def _holder(self, path: str, old: Any) -> Any:
        if not is_holder(old):
            raise StateError(f"{path} is not a part of this trial")
        self._known[path] = old
        for name in holder_fields(old):
            setattr(old, name, self.get(f"{path}/{name}", getattr(old, name), name not in FREE))
        if has_engine(old):
            found = self.get(f"{path}/engine", read_engine(old), True)
            if not np.isfinite(found).all():
                raise StateError(f"{path}/engine has a value that is not finite")
            write_engine(old, found)
        if qualified(type(old)) == AVATARS:
            old.sources = [
                tuple(
                    self.get(f"{path}/sources/{e}/{name}", source) if name in self._streams else source
                    for name, source in zip(old.names, sources, strict=True)
                )
                for e, sources in enumerate(old.sources)
            ]
        return old

    def _value(self, path: str, name: str, old: Any) -> Any:
        kind = value_class(name)
        if kind is None:
            raise StateError(f"{path} is a {name!r}, which is unknown")
        scene = kind is Scene
        values = {
            field: self.get(f"{path}/{field}", getattr(old, field, None) if scene else None, scene)
            for field in value_fields(kind)
            if not (scene and field == "walls")
        }
        if scene:
            if not isinstance(old, Scene):
                raise StateError(f"{path} is a scene, which this trial does not have there")
            values["walls"] = old.walls
        late = (
            [field.name for field in dataclasses.fields(kind) if not field.init]
            if hasattr(kind, "__dataclass_fields__")
            else []
        )
        found = kind(**{field: value for field, value in values.items() if field not in late})
        for field in late:
            object.__setattr__(found, field, values[field])
        if name == CHECKED and (count := self.get(f"{path}/_count")) is not None:
            object.__setattr__(found, "_count", int(count))
        return found

    def _time(self, path: str, old: Any) -> Any:
        if qualified(type(old)) != ENVIRONMENT_TIME:
            raise StateError(f"{path} is not the time of environments")
        ticks = self.get(f"{path}/ticks", old.first_tick, True)
        if ticks.min() < 0 or ticks.max() > 2**53:
            raise StateError(f"{path}/ticks has a step number outside 0 to 2^53")
        old.begin = self.get(f"{path}/begin", old.begin, True)
        old.clock.tick = int(ticks.max())
        old.first_tick = old.clock.tick - ticks
        return old


def _check_kind(path: str, value: Any, old: Any) -> None:
    """Raise :class:`StateError` if a value has another kind than in the new simulation."""
    if old is None or value is None or (isinstance(old, SCALARS) and isinstance(value, np.ndarray | np.generic)):
        fits = not is_holder(old)
    elif isinstance(old, tuple):
        fits = isinstance(value, tuple) or hasattr(value, "forward")
    elif isinstance(old, np.ndarray):
        fits = isinstance(value, np.ndarray) or (isinstance(value, float) and path.endswith("/time"))
    elif isinstance(old, (*SCALARS, list, dict, Scene, np.random.Generator, RandomStreams)) or is_holder(old):
        fits = type(value) is type(old)
    else:
        fits = not isinstance(value, (*SCALARS, list, dict))
    if not fits:
        raise StateError(f"{path} is a {type(value).__name__}, but the trial has a {type(old).__name__}")


def _generator(path: str, content: Any) -> np.random.Generator:
    bits = np.random.PCG64(0)
    try:
        bits.state = content
    except (ValueError, TypeError, KeyError, OverflowError) as error:
        raise StateError(f"{path} is not the state of a random generator: {str(error)[:80]}") from None
    return np.random.Generator(bits)


def _streams(path: str, content: Any, old: Any) -> RandomStreams:
    count = len(old) if isinstance(old, RandomStreams) else -1
    if not isinstance(content, list) or len(content) != count:
        raise StateError(f"{path} has not one random stream for each environment of the trial")
    try:
        return RandomStreams.of_states(content)
    except InputError as error:
        raise StateError(f"{path}: {error}") from None


def _check_scene(scene: Scene) -> None:
    """Raise :class:`StateError` if the arrays of a scene do not fit together."""
    for name, array in scene.memory.items():
        if not isinstance(name, str) or not isinstance(array, np.ndarray) or array.shape[:2] != scene.shape:
            raise StateError(f"the memory {name!r} of people has no row for each person")
    scene.check()
