"""CrowdModel: the contract of microscopic crowd models."""

from __future__ import annotations

import abc
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

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
    kernel,
    per_agent,
)
from crowdbot.core.neighbors import BOOL, FLOAT, dense, nearest

__all__ = [
    "CrowdModel",
    "StepStart",
    "begin_step",
    "check_limit",
    "desired_velocity",
    "launch",
    "movable",
    "neighbors_of",
    "rows",
    "speed_limit",
]

LARGEST = 1e9
"""Upper limit of positions [m], speeds [m/s] and parameters, against overflow."""

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


class StepStart(NamedTuple):
    """Checked values with which most models begin a step.

    Fields:
        desired: ``[E, A, 2]`` desired velocity [m/s], 0 for absent agents.
        walking: ``[E, A]`` bool, whether the model moves the agent: active and not external.
        seen: ``[E, A]`` bool, whether others react to the agent: active and visible.
        velocity: ``[E, A, 2]`` [m/s], output array of the model: the velocity of external agents, 0 for all others.
    """

    desired: Floats
    walking: Bools
    seen: Bools
    velocity: Floats


@dataclass(frozen=True)
class CrowdModel(abc.ABC):
    """Contract: compute the next velocities of agents.

    A model is a frozen dataclass. Its parameters are fields defined with :func:`crowdbot.core.parameter`: a number for
    all agents or an array that broadcasts to ``[E, A]``. Results are reproducible bit for bit from scene, time step and
    random stream; they do not depend on the batch or the number of threads.

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

    def __post_init__(self) -> None:
        check_parameters(self, LARGEST)

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

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        """Return the scene ``dt`` [s] later."""
        return scene.advance(self.velocity(scene, dt, rng), dt)


def begin_step(scene: Scene, dt: float) -> StepStart:
    """Check the values that models read; return them together with the desired velocities.

    Raises:
        InputError: ``dt`` is not positive, or a value of an active agent is not finite or larger than 1e9.
    """
    if not (math.isfinite(dt) and dt > 0.0):
        raise InputError(f"time step {dt} s is not allowed, it must be above 0 and finite")
    shape = scene.shape
    pairs = (*shape, 2)
    given = scene.preferred_velocity is not None
    start = StepStart(np.empty(pairs), np.empty(shape, BOOL), np.empty(shape, BOOL), np.empty(pairs))
    fits = _begin(
        dense(scene.position, pairs, FLOAT),
        dense(scene.velocity, pairs, FLOAT),
        dense(scene.radius, shape, FLOAT),
        dense(scene.max_speed, shape, FLOAT),
        dense(scene.preferred_velocity if given else scene.goal, pairs, FLOAT),
        dense(scene.preferred_speed, shape, FLOAT),
        dense(scene.active, shape, BOOL),
        dense(scene.visible, shape, BOOL),
        dense(scene.external, shape, BOOL),
        given,
        float(dt),
        *start,
    )
    if not fits:
        aim = () if given else ("goal", "preferred_speed")
        for name in ("position", "velocity", "radius", "max_speed", *aim):
            _check(name, getattr(scene, name), scene.active)
        _check("preferred velocity", start.desired, scene.active)
    return start


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


def speed_limit(max_speed: PerAgent | None, scene: Scene) -> Floats:
    """Return the maximum speeds ``[E, A]`` [m/s] of the model, or of the scene if the model has none."""
    return scene.max_speed if max_speed is None else per_agent(max_speed, scene.shape, "max_speed")


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


def _check(name: str, value: Floats, active: NDArray[np.bool_]) -> None:
    fits = np.abs(value) <= LARGEST  # False for NaN too
    if value.ndim == 3:
        fits = fits[..., 0] & fits[..., 1]
    wrong = active & ~fits
    if np.any(wrong):
        e, a = np.argwhere(wrong)[0]
        raise InputError(
            f"scene: {name} {value[e, a]} of agent {a} in environment {e} is not finite or larger than {LARGEST:g};"
            " mark absent agents active=False"
        )


@kernel
def _begin(
    position: Floats, velocity: Floats, radius: Floats, max_speed: Floats, aim: Floats, preferred_speed: Floats,
    active: Bools, visible: Bools, external: Bools, given: bool, dt: float, desired: Floats, walking: Bools,
    seen: Bools, chosen: Floats,
) -> bool:  # fmt: skip
    """Fill the arrays of a :class:`StepStart`; return whether all values of active agents are allowed.

    Args:
        aim: desired velocities if they are ``given``, otherwise goals.
    """
    fits = True
    for e in range(active.shape[0]):
        for a in range(active.shape[1]):
            here = active[e, a]
            walking[e, a], seen[e, a] = here and not external[e, a], here and visible[e, a]
            desired[e, a, 0] = desired[e, a, 1] = chosen[e, a, 0] = chosen[e, a, 1] = 0.0
            if not here:
                continue
            x, y = aim[e, a, 0], aim[e, a, 1]
            if not given:
                fits &= abs(x) <= LARGEST and abs(y) <= LARGEST and abs(preferred_speed[e, a]) <= LARGEST
                x, y = x - position[e, a, 0], y - position[e, a, 1]
                distance = math.sqrt(x * x + y * y)
                share = min(preferred_speed[e, a], distance / dt) / max(distance, 1e-12)
                x, y = x * share, y * share
            desired[e, a, 0], desired[e, a, 1] = x, y
            if external[e, a]:
                chosen[e, a, 0], chosen[e, a, 1] = velocity[e, a, 0], velocity[e, a, 1]
            # False for NaN, too
            fits &= abs(position[e, a, 0]) <= LARGEST and abs(position[e, a, 1]) <= LARGEST
            fits &= abs(velocity[e, a, 0]) <= LARGEST and abs(velocity[e, a, 1]) <= LARGEST
            fits &= abs(radius[e, a]) <= LARGEST and abs(max_speed[e, a]) <= LARGEST
            fits &= abs(x) <= LARGEST and abs(y) <= LARGEST
    return fits
