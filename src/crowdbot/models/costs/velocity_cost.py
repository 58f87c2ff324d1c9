"""VelocityCost: contract of costs over velocities, their sums, and forces as costs.

Most microscopic models can be written as a cost over velocities with an optimiser (van Toll et al. 2020,
doi:10.1145/3384382.3384532). A force is the cost ``squared distance to the resulting velocity``.
"""

from __future__ import annotations

import abc
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import InputError, check_parameters
from crowdbot.typing import Floats

from .neighbor_view import NeighborView

STEP = 1e-4
"""Half step [m/s] of numerical gradients."""


@dataclass(frozen=True)
class VelocityCost(abc.ABC):
    """Contract: compute the cost of velocities. Costs can be added and scaled: ``GoalForce() + 0.5 * Inertia()``.

    A cost is a frozen dataclass with the method :meth:`value`. Optional methods are :meth:`gradient` and, for a minimum
    in closed form, :meth:`best`. ``natural`` is the preferred optimiser.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> from crowdbot.models.costs import PreferredVelocity
    >>> class KeepRight(VelocityCost):
    ...     def value(self, world, candidates):
    ...         ahead = world.direction()[:, None]
    ...         return candidates[..., 1] * ahead[..., 0] - candidates[..., 0] * ahead[..., 1]
    >>> str(PreferredVelocity() + 0.2 * KeepRight())
    'PreferredVelocity(exponent=1.0) + 0.2 * KeepRight()'
    """

    natural: ClassVar[str] = "sampling"

    def __post_init__(self) -> None:
        check_parameters(self)

    @abc.abstractmethod
    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        """Return the cost ``[N, C]`` of each velocity ``[N, C, 2]`` [m/s]; inf excludes a velocity."""

    def gradient(self, world: NeighborView, velocity: Floats) -> Floats:
        """Return the gradient ``[N, 2]`` of the cost at ``velocity`` [N, 2] [m/s]; by default numerical."""
        steps = STEP * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        cost = self.value(world, velocity[:, None] + steps)
        with np.errstate(invalid="ignore"):  # inf - inf: no step
            return np.stack([cost[:, 0] - cost[:, 1], cost[:, 2] - cost[:, 3]], axis=-1) / (2.0 * STEP)

    def best(self, world: NeighborView) -> Floats:
        """Return the velocities ``[N, 2]`` [m/s] with the lowest cost.

        Raises:
            InputError: this cost has no closed form.
        """
        raise InputError(f"{self} has no closed form; use the optimiser sampling or gradient")

    def __str__(self) -> str:
        return repr(self)

    def __add__(self, other: VelocityCost) -> Sum:
        return Sum((*_terms(self), *_terms(other)))

    def __rmul__(self, weight: float) -> Sum:
        return Sum(tuple((weight * own, cost) for own, cost in _terms(self)))


@dataclass(frozen=True)
class Sum(VelocityCost):
    """Weighted sum of costs, the result of ``+`` and ``*``.

    Raises:
        InputError: a weight is not finite.
    """

    terms: tuple[tuple[float, VelocityCost], ...]

    def __post_init__(self) -> None:
        for weight, cost in self.terms:
            if not math.isfinite(weight):
                raise InputError(f"weight {weight} of {cost} is not finite")

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        total = np.zeros(candidates.shape[:2])
        for weight, cost in self.terms:
            if weight != 0.0:
                total = total + weight * cost.value(world, candidates)
        return total

    def gradient(self, world: NeighborView, velocity: Floats) -> Floats:
        total = np.zeros_like(velocity)
        for weight, cost in self.terms:
            if weight != 0.0:
                total = total + weight * cost.gradient(world, velocity)
        return total

    def best(self, world: NeighborView) -> Floats:
        if len(self.terms) != 1 or not self.terms[0][0] > 0.0:
            return super().best(world)
        return self.terms[0][1].best(world)

    def __str__(self) -> str:
        return " + ".join(str(cost) if weight == 1.0 else f"{weight:g} * {cost}" for weight, cost in self.terms)


def suitable_optimiser(cost: VelocityCost) -> str:
    """Return the default optimiser of a cost: gradient for a sum of forces, sampling for other sums.

    >>> from crowdbot.models.costs import GoalForce, PowerLawForce, PreferredVelocity
    >>> suitable_optimiser(GoalForce() + PowerLawForce()), suitable_optimiser(GoalForce() + PreferredVelocity())
    ('gradient', 'sampling')
    >>> suitable_optimiser(2.0 * PreferredVelocity())
    'closed-form'
    """
    terms = _terms(cost)
    kinds = {term.natural for _, term in terms}
    if len(terms) == 1 and terms[0][0] > 0.0:
        return kinds.pop()
    return "gradient" if kinds == {"gradient"} else "sampling"


def _terms(cost: VelocityCost) -> tuple[tuple[float, VelocityCost], ...]:
    return cost.terms if isinstance(cost, Sum) else ((1.0, cost),)


def length(vectors: Floats) -> Floats:
    """Return the lengths of vectors ``[..., 2]``."""
    return np.asarray(np.sqrt(vectors[..., 0] ** 2 + vectors[..., 1] ** 2))


@dataclass(frozen=True)
class Force(VelocityCost):
    """A force F [m/s^2] as a cost ``|v' - (v + F dt)|^2 / (2 dt)``: one gradient step equals one step with the force.

    Subclasses define :meth:`force`.
    """

    natural: ClassVar[str] = "gradient"

    @abc.abstractmethod
    def force(self, world: NeighborView) -> Floats:
        """Return the accelerations ``[N, 2]`` [m/s^2]."""

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        # |v' - (v + F dt)|^2 / (2 dt)
        to = self.best(world)
        return np.asarray(length(candidates - to[:, None]) ** 2 / (2.0 * world.dt))

    def gradient(self, world: NeighborView, velocity: Floats) -> Floats:
        # (velocity - v) / dt - F
        return np.asarray((velocity - world.velocity) / world.dt - self.force(world))

    def best(self, world: NeighborView) -> Floats:
        # v + F dt
        return np.asarray(world.velocity + world.dt * self.force(world))
