"""Rows of environments: scenes and crowd models of several worlds as the environments of one."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.models import CrowdModel, Mixture

__all__ = [
    "concatenate_arrays",
    "join_models",
    "pad_ids",
    "pad_scene",
    "put_arrays",
    "put_scene",
    "set_models",
    "stack_scenes",
    "take_arrays",
    "trim_scene",
    "works_in_batches",
]

T = TypeVar("T")

FILLS = {"radius": 0.25, "group": -1, "external": True, "visible": True}
"""Values of the slots that pad a scene. They are external, so that nobody enters in them."""


def works_in_batches(model: CrowdModel) -> bool:
    """Return whether one call of a model for several environments equals one call for each.

    Built-in models draw no random numbers. Others may draw some or have state, and are called per environment.
    """
    if isinstance(model, Mixture):
        return all(works_in_batches(one) for one in model.models)
    return type(model).__module__.startswith("crowdbot.models.")


def stack_scenes(scenes: Sequence[Scene]) -> Scene:
    """Return the scenes as environments of one scene with the walls of the first; shorter ones are padded.

    >>> stack_scenes([Scene.of([[0.0, 0.0]]), Scene.of([[1.0, 0.0], [2.0, 0.0]])]).active.tolist()
    [[True, False], [True, True]]
    """
    if len(scenes) == 1:
        return scenes[0]
    agents = max(scene.shape[1] for scene in scenes)
    rows = [pad_scene(scene, agents) for scene in scenes]
    arrays = {name: np.concatenate([getattr(row, name) for row in rows]) for name in _names(rows[0])}
    names = {name: value for row in rows for name, value in row.memory.items()}
    memory = {name: np.concatenate([_memory(row, name, value) for row in rows]) for name, value in names.items()}
    times = np.concatenate([np.broadcast_to(row.time, (row.shape[0],)) for row in rows])
    return rows[0].replace(**arrays, memory=memory, time=_shared(times))


def _memory(scene: Scene, name: str, like: NDArray[Any]) -> NDArray[Any]:
    """Return a memory of a scene, zeros if it begins later in the run, as that of pushes."""
    known = scene.memory.get(name)
    return np.zeros((*scene.shape, *like.shape[2:]), dtype=like.dtype) if known is None else known


def pad_scene(scene: Scene, agents: int) -> Scene:
    """Return a scene with absent, external agents at the end, so that it has this number of agents."""
    more = agents - scene.shape[1]
    if more <= 0:
        return scene

    def padded(value: NDArray[Any], fill: Any = 0) -> NDArray[Any]:
        block = np.full((len(value), more, *value.shape[2:]), fill, dtype=value.dtype)
        return np.concatenate([value, block], axis=1)

    arrays = {name: padded(getattr(scene, name), FILLS.get(name, 0)) for name in _names(scene)}
    return scene.replace(**arrays, memory={name: padded(value) for name, value in scene.memory.items()})


def pad_ids(ids: NDArray[np.int64], agents: int) -> NDArray[np.int64]:
    """Return identities with unique negative ones for further slots."""
    more = agents - ids.shape[1]
    if more <= 0:
        return ids
    least = np.minimum(ids.min(axis=1, initial=0), 0)[:, None]
    return np.concatenate([ids, least - 1 - np.arange(more)], axis=1)


def set_models(world: Any, models: list[Any]) -> None:
    """Set the model of each environment, as one model if a call for all equals a call for each."""
    joined = join_models(models, world.scene.shape[1])
    world._models = models
    world.joined = joined is not None
    world.model = models[0] if joined is None else joined


def trim_scene(scene: Scene, agents: int) -> Scene:
    """Return a scene with only the first agents."""
    arrays = {name: getattr(scene, name)[:, :agents].copy() for name in _names(scene)}
    return scene.replace(**arrays, memory={name: value[:, :agents].copy() for name, value in scene.memory.items()})


def put_scene(scene: Scene, index: NDArray[np.int64], rows: Scene) -> Scene:
    """Return the scene with the environments ``index`` replaced by those of another with as many agents."""
    arrays = {name: _put(getattr(scene, name), index, getattr(rows, name)) for name in _names(scene)}
    names = {**rows.memory, **scene.memory}
    memory = {
        name: _put(_memory(scene, name, value), index, _memory(rows, name, value)) for name, value in names.items()
    }
    times = np.array(np.broadcast_to(scene.time, (scene.shape[0],)))
    times[index] = rows.time
    return scene.replace(**arrays, memory=memory, time=_shared(times))


def take_arrays(value: T, index: NDArray[np.int64]) -> T:
    """Return a dataclass of arrays ``[E, ...]`` with the environments ``index``."""
    anything: Any = value
    names = [part.name for part in dataclasses.fields(anything)]
    found: T = dataclasses.replace(anything, **{name: getattr(anything, name)[index] for name in names})
    return found


def concatenate_arrays(values: Sequence[T]) -> T:
    """Return dataclasses of arrays ``[E, ...]`` as one, with the environments of all."""
    first: Any = values[0]
    names = [part.name for part in dataclasses.fields(first)]
    columns = {name: np.concatenate([getattr(one, name) for one in values]) for name in names}
    found: T = dataclasses.replace(first, **columns)
    return found


def put_arrays(value: T, index: NDArray[np.int64], rows: T) -> T:
    """Return a dataclass of arrays ``[E, ...]`` with the environments ``index`` replaced."""
    anything: Any = value
    names = [part.name for part in dataclasses.fields(anything)]
    changed = {name: _put(getattr(anything, name), index, getattr(rows, name)) for name in names}
    found: T = dataclasses.replace(anything, **changed)
    return found


def join_models(models: Sequence[CrowdModel], agents: int) -> CrowdModel | None:
    """Return one model for several environments, with a row for each in parameters that differ.

    None if the models are of different classes or differ in more than numbers.

    >>> from crowdbot.models import ORCA
    >>> join_models([ORCA(time_horizon=1.0), ORCA(time_horizon=3.0)], 2).time_horizon.tolist()
    [[1.0, 1.0], [3.0, 3.0]]
    """
    first: Any = models[0]
    if all(model is first for model in models):
        return _widen_model(models[0], agents)
    if not all(_is_alike(first, model) for model in models[1:]):
        return None
    changes: dict[str, Any] = {}
    for part in dataclasses.fields(first):
        values = [getattr(model, part.name) for model in models]
        if part.name == "models" and isinstance(first, Mixture):
            changes["models"] = tuple(join_models(ones, agents) for ones in zip(*values, strict=True))
        elif not all(_is_same(values[0], v) for v in values):
            changes[part.name] = np.stack([_pad_row(np.asarray(v), agents) for v in values])
        elif isinstance(values[0], np.ndarray) and values[0].ndim:
            changes[part.name] = np.broadcast_to(_pad_row(values[0], agents), (len(models), agents)).copy()
    found: CrowdModel = dataclasses.replace(first, **changes) if changes else first
    return found


def _widen_model(model: CrowdModel, agents: int) -> CrowdModel:
    """Return a model whose parameters by agent reach for this number of agents."""
    changes: dict[str, Any] = {}
    for part in dataclasses.fields(model):
        value = getattr(model, part.name)
        if part.name == "models" and isinstance(model, Mixture):
            wide = tuple(_widen_model(one, agents) for one in value)
            if any(one is not other for one, other in zip(wide, value, strict=True)):
                changes["models"] = wide
        elif isinstance(value, np.ndarray) and value.ndim and 1 < value.shape[-1] < agents:
            more = np.repeat(value[..., -1:], agents - value.shape[-1], axis=-1)
            changes[part.name] = np.concatenate([value, more], axis=-1)
    return dataclasses.replace(model, **changes) if changes else model


def _is_alike(first: CrowdModel, other: CrowdModel) -> bool:
    """Return whether two models are of the same class and differ only in numbers."""
    if type(first) is not type(other):
        return False
    if isinstance(first, Mixture) and isinstance(other, Mixture):
        return len(first.models) == len(other.models) and all(map(_is_alike, first.models, other.models))
    values = [(getattr(first, part.name), getattr(other, part.name)) for part in dataclasses.fields(first)]
    return all((_is_number(a) and _is_number(b)) or _is_same(a, b) for a, b in values)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.ndarray) and not isinstance(value, bool)


def _is_same(a: Any, b: Any) -> bool:
    return type(a) is type(b) and (np.array_equal(a, b) if isinstance(a, np.ndarray) else bool(a == b))


def _pad_row(value: NDArray[Any], agents: int) -> NDArray[Any]:
    """Return a number or ``[A]`` or ``[1, A]`` as ``[agents]``; further agents get the last value, or 1."""
    row = np.atleast_1d(value).reshape(-1)
    return np.concatenate([row, np.full(agents - len(row), row[-1] if len(row) else 1, dtype=row.dtype)])


def _names(scene: Scene) -> list[str]:
    """Return the fields of a scene that are arrays ``[E, A, ...]``."""
    names = (part.name for part in dataclasses.fields(scene) if part.name != "time")
    return [name for name in names if isinstance(getattr(scene, name), np.ndarray)]


def _put(value: NDArray[Any], index: NDArray[np.int64], rows: NDArray[Any]) -> NDArray[Any]:
    changed = value.copy()
    changed[index] = rows
    return changed


def _shared(times: NDArray[np.float64]) -> Any:
    """Return the common time of all environments, or their times ``[E]``."""
    return float(times[0]) if np.all(times == times[0]) else times
