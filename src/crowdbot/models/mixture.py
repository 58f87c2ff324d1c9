"""Mixture: several models in one scene, each person walking by one of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, Scene

from .model import CrowdModel, initial_velocity

__all__ = ["MODEL", "Mixture"]

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]

MODEL = "model"
"""Name in the memory of a scene ``[E, A]``: which model each agent walks by, where it is not what ``which`` says."""


@dataclass(frozen=True)
class Mixture(CrowdModel):
    """Several models in one scene: each agent walks by its own and sees everybody.

    Args:
        models: of which people walk by one.
        which: ``[A]`` or ``[E, A]`` int, the index of each agent's model; a number is for all.

    People of other models are neighbours like any others: a model that shares the work of avoiding takes it that they
    do their part too. All models choose from the same old scene. Every model is asked for the whole crowd, so that the
    cost is the sum of theirs; what they keep from step to step is kept for each. Models draw from the stream of
    randomness one after the other, in their order.

    People may change their model: :data:`MODEL` in ``Scene.memory`` goes before ``which``.

    Source: models of different kinds side by side as in van Toll et al. 2020, doi:10.1145/3384382.3384532.

    Raises:
        InputError: there is no model, something is no model, or an index is not that of a model.

    >>> from crowdbot.models import ORCA, SocialForce
    >>> ahead = Scene.of([[0, 0], [3, 0.1]], [[1, 0], [-1, 0]], preferred_velocity=[[1, 0], [-1, 0]])
    >>> chosen = Mixture((ORCA(), SocialForce()), which=[0, 1]).velocity(ahead, dt=0.1)
    >>> bool((chosen[0, 0] == ORCA().velocity(ahead, 0.1)[0, 0]).all())
    True
    """

    paper: ClassVar[Paper] = Paper(
        "Wouter van Toll, Fabien Grzeskowiak, Axel López, Javad Amirian, Florian Berton, Julien Bruneau, Beatriz"
        " Cabrero Daniel, Alberto Jovane, Julien Pettré",
        2020,
        "Generalized microscopic crowd simulation using costs in velocity space",
        "Symposium on Interactive 3D Graphics and Games",
        "10.1145/3384382.3384532",
    )

    models: tuple[CrowdModel, ...]
    which: int | Sequence[int] | Numbers = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.models, tuple) or not self.models:
            raise InputError(f"Mixture: models = {self.models!r}, it must be a tuple of at least one model")
        for model in self.models:
            if not isinstance(model, CrowdModel):
                raise InputError(f"Mixture: {model!r} is not a crowd model")
        self._check_indices(np.asarray(self.which))

    @property
    def memory_at_start(self) -> Mapping[str, float]:
        """What the memory of a scene holds for somebody new, by name, where that is not 0: as the models say it."""
        parts = (model.memory_at_start for model in self.models)
        return {name: value for part in parts for name, value in part.items()}

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        """Return the velocities ``[E, A, 2]`` [m/s] for the next ``dt`` [s], each agent's from its own model."""
        own = self.of(scene)
        out = initial_velocity(scene)
        for k, model in enumerate(self.models):
            out = np.where((own == k)[..., None], model.velocity(scene, dt, rng), out)
        return out

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        """Return the scene ``dt`` [s] later, each agent as its own model moves it."""
        own = self.of(scene)
        after = [model.step(scene, dt, rng) for model in self.models]

        def merged(read: Callable[[Scene], Floats]) -> Floats:
            whole = read(after[0])
            for k in range(1, len(after)):
                whole = np.where((own == k).reshape(*own.shape, *[1] * (whole.ndim - 2)), read(after[k]), whole)
            return whole

        return after[0].replace(
            position=merged(lambda one: one.position),
            velocity=merged(lambda one: one.velocity),
            heading=merged(lambda one: one.heading),
            memory=_memory(scene, after, own),
        )

    def of(self, scene: Scene) -> Numbers:
        """Return ``[E, A]``: the index of the model that each agent of a scene walks by."""
        which = self._check_indices(np.asarray(scene.memory.get(MODEL, self.which)))
        try:
            return np.broadcast_to(which, scene.shape)
        except ValueError:
            raise InputError(
                f"Mixture: which has shape {list(which.shape)}, which does not broadcast to [E, A] ="
                f" {list(scene.shape)}: it must name a model for every agent"
            ) from None

    def _check_indices(self, which: NDArray[Any]) -> Numbers:
        whole = which.astype(np.int64) if which.dtype.kind in "iuf" and np.all(np.isfinite(which)) else None
        if whole is None or np.any(whole != which):
            raise InputError(f"Mixture: which = {which.tolist()} holds something that is no whole number")
        wrong = whole[(whole < 0) | (whole >= len(self.models))]
        if wrong.size:
            raise InputError(
                f"Mixture: which names model {wrong.flat[0]}, there are models 0 to {len(self.models) - 1}"
            )
        return whole


def _memory(scene: Scene, after: Sequence[Scene], own: Numbers) -> dict[str, Floats]:
    """Return the memory of all models: where several write under one name, each agent's own model has the say."""
    memory = dict(scene.memory)
    written: set[str] = set()
    for k, one in enumerate(after):
        for name, value in one.memory.items():
            if value is scene.memory.get(name):
                continue
            mine = (own == k).reshape(*own.shape, *[1] * (value.ndim - 2))
            memory[name] = np.where(mine, value, memory[name]) if name in written else value
            written.add(name)
    return memory
