"""Requests for steps of a crowd model, which allow several worlds to be computed together."""

from __future__ import annotations

import dataclasses
from collections.abc import Generator, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.models import CrowdModel, Mixture

__all__ = ["CrowdStepRequest", "StepGenerator", "compute_together", "run_step"]

T = TypeVar("T")


class CrowdStepRequest(NamedTuple):
    """Request for the scene ``dt`` [s] later; the result is ``model.step(scene, dt, rng)``."""

    model: CrowdModel
    scene: Scene
    dt: float
    rng: np.random.Generator

    def compute(self) -> Scene:
        """Return the result of the request."""
        return self.model.step(self.scene, self.dt, self.rng)


StepGenerator = Generator[CrowdStepRequest, Scene, T]
"""Generator of a step: yields a request for each substep of the crowd and returns a ``T``."""


def run_step(step_requests: StepGenerator[T]) -> T:
    """Run a step, computing each request separately. An exception of the model is raised in the generator."""
    try:
        walk = next(step_requests)
        while True:
            try:
                answer = walk.compute()
            except Exception as error:
                walk = step_requests.throw(error)
            else:
                walk = step_requests.send(answer)
    except StopIteration as done:
        found: T = done.value
        return found


def compute_together(walks: Sequence[CrowdStepRequest]) -> list[Scene]:
    """Return the results of several requests, E = 1 each, of worlds with the same walls.

    Built-in models draw no random numbers and are computed once, with each request as an environment. The results are
    bit-identical to separate computation. Other models may draw random numbers or have state; they are computed one by
    one.

    >>> from crowdbot.models import ORCA
    >>> rng = np.random.default_rng(0)
    >>> scenes = [Scene.of(np.zeros((k + 1, 2)), goal=np.full((k + 1, 2), 5.0)) for k in range(2)]
    >>> walks = [CrowdStepRequest(ORCA(), scene, 0.1, rng) for scene in scenes]
    >>> [scene.digest() for scene in compute_together(walks)] == [walk.compute().digest() for walk in walks]
    True
    """
    if len(walks) < 2 or not all(_same_batch(walks[0], walk) for walk in walks):
        return [walk.compute() for walk in walks]
    agents = max(walk.scene.shape[1] for walk in walks)
    model = _join_models([walk.model for walk in walks], [walk.scene.shape[1] for walk in walks], agents)
    whole = _stack_scenes([walk.scene for walk in walks], agents)
    after = model.step(whole, walks[0].dt, walks[0].rng)
    return [_row(after, e, walk.scene) for e, walk in enumerate(walks)]


def _same_batch(first: CrowdStepRequest, other: CrowdStepRequest) -> bool:
    """Return whether two requests can be environments of one scene."""
    a, b = first.scene, other.scene
    return (
        _same_model(first.model, other.model)
        and first.dt == other.dt
        and a.time == b.time
        and a.bodies is b.bodies is None
        and a.height is b.height is None
        and (a.preferred_velocity is None) == (b.preferred_velocity is None)
        and a.memory.keys() == b.memory.keys()
        and (a.walls is b.walls or bool(np.array_equal(a.walls.segments(), b.walls.segments())))
    )


def _same_model(first: CrowdModel, other: CrowdModel) -> bool:
    """Return whether two models are of the same built-in class and differ only in numbers."""
    if type(first) is not type(other) or not type(first).__module__.startswith("crowdbot.models."):
        return False
    if isinstance(first, Mixture) and isinstance(other, Mixture):
        return len(first.models) == len(other.models) and all(map(_same_model, first.models, other.models))
    values = ((getattr(one, part.name) for one in (first, other)) for part in dataclasses.fields(first))
    return all((_number(a) and _number(b)) or _same(a, b) for a, b in values)


def _number(value: Any) -> bool:
    return isinstance(value, int | float | np.ndarray) and not isinstance(value, bool)


def _same(a: Any, b: Any) -> bool:
    return type(a) is type(b) and (np.array_equal(a, b) if isinstance(a, np.ndarray) else bool(a == b))


def _join_models(models: Sequence[CrowdModel], counts: Sequence[int], agents: int) -> CrowdModel:
    """Return one model, with a row per environment for each parameter that differs."""
    first: Any = models[0]
    changes: dict[str, Any] = {}
    for part in dataclasses.fields(first):
        values = [getattr(model, part.name) for model in models]
        if part.name == "models" and isinstance(first, Mixture):
            changes["models"] = tuple(_join_models(ones, counts, agents) for ones in zip(*values, strict=True))
        elif any(isinstance(value, np.ndarray) for value in values) or not all(_same(values[0], v) for v in values):
            changes[part.name] = np.stack(
                [_pad_row(np.broadcast_to(np.asarray(v), (n,)), agents) for v, n in zip(values, counts, strict=True)]
            )
    found: CrowdModel = dataclasses.replace(first, **changes) if changes else first
    return found


def _pad_row(row: NDArray[Any], agents: int) -> NDArray[Any]:
    """Return ``[A]`` extended to ``[agents]``; absent agents get the last value, or 1."""
    return np.concatenate([row, np.full(agents - len(row), row[-1] if len(row) else 1, dtype=row.dtype)])


def _stack_scenes(scenes: Sequence[Scene], agents: int) -> Scene:
    """Return the scenes as environments of one scene; shorter ones are padded with absent agents."""
    rows = [_filled(scene, agents) for scene in scenes]
    first = rows[0]
    arrays: dict[str, Any] = {
        part.name: np.concatenate([getattr(row, part.name) for row in rows])
        for part in dataclasses.fields(first)
        if isinstance(getattr(first, part.name), np.ndarray)
    }
    memory = {name: np.concatenate([row.memory[name] for row in rows]) for name in first.memory}
    return first.replace(**arrays, memory=memory)


def _filled(scene: Scene, agents: int) -> Scene:
    more = agents - scene.shape[1]
    if more == 0:
        return scene

    def filled(value: NDArray[Any], fill: Any = 0) -> NDArray[Any]:
        return np.concatenate([value, np.full((1, more, *value.shape[2:]), fill, dtype=value.dtype)], axis=1)

    fills = {"radius": 0.25, "group": -1}
    arrays: dict[str, Any] = {
        part.name: filled(getattr(scene, part.name), fills.get(part.name, 0))
        for part in dataclasses.fields(scene)
        if isinstance(getattr(scene, part.name), np.ndarray)
    }
    return scene.replace(**arrays, memory={name: filled(value) for name, value in scene.memory.items()})


def _row(whole: Scene, e: int, before: Scene) -> Scene:
    """Return environment ``e`` as the result for the scene ``before``."""
    agents = before.shape[1]
    arrays: dict[str, Any] = {
        part.name: getattr(whole, part.name)[e : e + 1, :agents].copy()
        for part in dataclasses.fields(whole)
        if isinstance(getattr(whole, part.name), np.ndarray)
    }
    memory = {name: value[e : e + 1, :agents].copy() for name, value in whole.memory.items()}
    return whole.replace(**arrays, memory=memory, walls=before.walls)
