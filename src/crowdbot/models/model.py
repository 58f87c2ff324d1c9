"""CrowdModel: the contract of microscopic crowd models."""

from __future__ import annotations

import abc
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import (
    SMALL,
    Bounds,
    InputError,
    Neighbors,
    Paper,
    PerAgent,
    Scene,
    check_parameters,
    did_you_mean,
    per_agent,
    reset_undeclared,
)
from crowdbot.core.neighbors import nearest
from crowdbot.typing import Bools, Floats

from .agent_rows import LARGEST, StepStart, begin_step, speed_limit
from .valid_range import ModelRange

__all__ = [
    "CrowdModel",
    "StepStart",
    "begin_step",
    "check_limit",
    "check_variant",
    "desired_velocity",
    "launch",
    "movable",
    "neighbors_of",
    "rows",
    "speed_limit",
]


@dataclass(frozen=True)
class CrowdModel(abc.ABC):
    """Contract: compute the next velocities of agents.

    A model is a frozen dataclass. Its parameters are fields defined with :func:`crowdbot.core.parameter`: a number for
    all agents or an array that broadcasts to ``[E, A]``. Results are reproducible bit for bit from scene, time step and
    random stream; they do not depend on the batch or the number of threads.

    Class attributes, which a subclass does not inherit:
        batched: whether the model draws no random numbers, so that one call for E environments gives what a call for
            each would give. Otherwise a world of several environments calls it once for each of them.
        valid_range: density and time step that the model is made for, None if they are not known; ``crowdbot check``
            names trials beyond it.

    Raises:
        InputError: a parameter is not finite, below its minimum or above 1e9.

    >>> class Straight(CrowdModel):
    ...     paper = Paper("Nobody", 2020, "Walking straight", "Nowhere")
    ...
    ...     def velocity(self, scene, dt, rng=None):
    ...         return desired_velocity(scene, dt)
    >>> scene = Scene.of([[0.0, 0.0]], goal=[[9.0, 0.0]], preferred_speed=1.0)
    >>> Straight().step(scene, 0.5).position.tolist()
    [[[0.5, 0.0]]]
    """

    paper: ClassVar[Paper]
    batched: ClassVar[bool] = False
    valid_range: ClassVar[ModelRange | None] = None

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        reset_undeclared(cls, batched=False, valid_range=None)

    def __post_init__(self) -> None:
        check_parameters(self, LARGEST)
        check_limit(self, getattr(self, "max_speed", None))

    @abc.abstractmethod
    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        """Return the velocities ``[E, A, 2]`` [m/s] for the next ``dt`` [s].

        All velocities are computed from the same scene. External agents keep their velocity; absent agents get 0.

        Raises:
            InputError: ``dt`` is not positive, or a value of the scene is not finite or above 1e9.
        """

    @property
    def memory_at_start(self) -> Mapping[str, float]:
        """Initial values in ``Scene.memory`` for a new agent, by name; empty for models without memory."""
        return {}

    @property
    def is_batched(self) -> bool:
        """Whether one call may compute several environments: as the class declares, or as all its parts do."""
        return type(self).batched

    @property
    def is_individual(self) -> bool:
        """Whether :meth:`individual` draws differences between people."""
        return False

    def individual(self, agents: int, rng: np.random.Generator) -> CrowdModel:
        """Return the model with the differences between ``agents`` people; the model itself if it has none."""
        return self

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        """Return the scene ``dt`` [s] later."""
        return scene.advance(self.velocity(scene, dt, rng), dt)


def desired_velocity(scene: Scene, dt: float) -> Floats:
    """Check the values that models read; return the desired velocities ``[E, A, 2]`` [m/s], 0 for absent agents.

    Raises:
        InputError: ``dt`` is not positive, or a value of an active agent is not finite or larger than 1e9.
    """
    return begin_step(scene, dt).desired


def movable(scene: Scene) -> Bools:
    """Return the mask ``[E, A]`` of agents that a model moves: active and not external."""
    return np.greater(scene.active, scene.external)


def check_limit(model: CrowdModel, max_speed: PerAgent | None) -> None:
    """Raise :class:`InputError` unless a model's maximum speed is None, or finite and at least 0."""
    if max_speed is None:
        return
    bounds = Bounds("m/s", min=0.0, max=LARGEST)
    if not bounds.holds(max_speed):
        raise InputError(
            f"{type(model).__name__}: max_speed = {bounds.worst(max_speed)} [m/s] is not allowed, it must be"
            f" {bounds.describe()}, or None to use the maximum speed of the scene"
        )


def check_variant(model: CrowdModel, variant: str, known: Sequence[str]) -> None:
    """Raise :class:`InputError` unless the variant of a model is among the ``known`` ones."""
    if variant not in known:
        near = did_you_mean(variant, known)
        raise InputError(f"{type(model).__name__}: variant {variant!r} is unknown{near}; choose {' or '.join(known)}")


def neighbors_of(model: Any, scene: Scene, seen: Bools, walking: Bools) -> Neighbors:
    """Return the neighbours of ``walking`` agents: the nearest ``seen`` agents, limited in distance and number."""
    reach, most = model.neighbor_distance, model.max_neighbors
    if not isinstance(reach, float):
        reach = per_agent(reach, scene.shape, "neighbor_distance")
    most = round(most) if isinstance(most, float) else np.rint(per_agent(most, scene.shape, "max_neighbors"))
    return nearest(scene.position, reach, most, seen, walking)


def rows(value: NDArray[Any]) -> NDArray[Any]:
    """Return ``[E, A, ...]`` as rows ``[E * A, ...]``, C-contiguous and writeable as kernels require."""
    if value.flags.carray:
        if value.ndim == 2:
            return value.reshape(-1)
        if value.ndim == 3 and value.shape[2]:
            return value.reshape(-1, value.shape[2])
    E, A = value.shape[:2]
    return np.require(value, requirements=["C", "W"]).reshape(E * A, *value.shape[2:])


def launch(whole: Callable[..., None], part: Callable[..., None], out: Floats, *values: Any) -> None:
    """Fill the rows of ``out`` [E * A, ...] with a kernel, in one thread if there are few rows, otherwise in parallel.

    Args:
        whole: parallel kernel of ``values`` and ``out``, which calls ``part`` for :data:`CHUNK` rows at a time.
        part: kernel of the first row, the end row (exclusive), ``values`` and ``out``.
        out: output of the kernels.
        values: input of the kernels.
    """
    # plain tuples: numba dispatches slowly on named tuples with similar fields, 0.1 ms per call (measured)
    plain = [tuple(value) if isinstance(value, tuple) else value for value in values]
    if len(out) <= SMALL:
        part(0, len(out), *plain, out)
    else:
        whole(*plain, out)
