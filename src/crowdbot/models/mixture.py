"""Mixture: several models in one scene, one for each agent."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, Scene
from crowdbot.typing import Floats, Ints

from .model import CrowdModel

MODEL = "model"
"""Name in the memory of a scene: the model index of each agent ``[E, A]``, which overrides ``which``."""


@dataclass(frozen=True)
class Mixture(CrowdModel):
    """Several models in one scene: each agent uses its own model, and all agents see each other.

    Args:
        models: the models, at least one.
        which: ``[A]`` or ``[E, A]`` int, the index of each agent's model; a number applies to all agents.

    Agents of other models are ordinary neighbours: a reciprocal model assumes that they do their share of the
    avoidance. All models read the same scene. Every model computes the whole crowd, and the computing time is the sum
    over the models. Each model keeps its own memory. The models use the random generator one after the other.

    Agents can change their model during a run: :data:`MODEL` in ``Scene.memory`` overrides ``which``.

    Source: mixed models as in van Toll et al. 2020, doi:10.1145/3384382.3384532.

    Raises:
        InputError: ``models`` is empty or has an element that is not a crowd model, or an index is out of range.

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
    which: int | Sequence[int] | Ints = 0

    @property
    def is_batched(self) -> bool:
        return all(model.is_batched for model in self.models)

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
        parts = (model.memory_at_start for model in self.models)
        return {name: value for part in parts for name, value in part.items()}

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        own = self.of(scene)
        out = self.models[0].velocity(scene, dt, rng)
        for k in range(1, len(self.models)):
            out = np.where((own == k)[..., None], self.models[k].velocity(scene, dt, rng), out)
        return out

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        own = self.of(scene)
        after = [model.step(scene, dt, rng) for model in self.models]

        def merge(read: Callable[[Scene], Floats]) -> Floats:
            whole = read(after[0])
            for k in range(1, len(after)):
                whole = np.where((own == k).reshape(*own.shape, *[1] * (whole.ndim - 2)), read(after[k]), whole)
            return whole

        return after[0].replace(
            position=merge(lambda one: one.position),
            velocity=merge(lambda one: one.velocity),
            heading=merge(lambda one: one.heading),
            memory=_memory(scene, after, own),
        )

    def of(self, scene: Scene) -> Ints:
        """Return the model index of each agent ``[E, A]``."""
        which = self._check_indices(np.asarray(scene.memory.get(MODEL, self.which)))
        try:
            return np.broadcast_to(which, scene.shape)
        except ValueError:
            raise InputError(
                f"Mixture: which has shape {list(which.shape)}, which does not broadcast to [E, A] ="
                f" {list(scene.shape)}; give one model index for each agent"
            ) from None

    def _check_indices(self, which: NDArray[Any]) -> Ints:
        whole: Ints | None = None
        if which.dtype == np.int64:
            whole = which
        elif which.dtype.kind in "iuf" and np.all(np.isfinite(which)):
            whole = which.astype(np.int64)
        if whole is None or (whole is not which and np.any(whole != which)):
            raise InputError(f"Mixture: which = {which.tolist()} must contain only whole numbers")
        if whole.size and not 0 <= whole.min() <= whole.max() < len(self.models):
            wrong = whole[(whole < 0) | (whole >= len(self.models))]
            raise InputError(
                f"Mixture: which = {wrong.flat[0]} is out of range, it must be from 0 to {len(self.models) - 1}"
            )
        return whole


def _memory(scene: Scene, after: Sequence[Scene], own: Ints) -> dict[str, Floats]:
    """Return the memory of all models; if several models write the same name, the agent's own model takes priority."""
    memory = dict(scene.memory)
    written: set[str] = set()
    for k, item in enumerate(after):
        for name, value in item.memory.items():
            if value is scene.memory.get(name):
                continue
            mine = (own == k).reshape(*own.shape, *[1] * (value.ndim - 2))
            memory[name] = np.where(mine, value, memory[name]) if name in written else value
            written.add(name)
    return memory
