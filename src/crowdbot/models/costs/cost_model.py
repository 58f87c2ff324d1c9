"""CostModel: a crowd model composed of costs over velocities (van Toll et al. 2020)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from crowdbot.core import InputError, Paper, PerAgent, Scene, did_you_mean, parameter, per_agent, stream
from crowdbot.models.model import CrowdModel, begin_step, neighbors_of, rows, speed_limit
from crowdbot.models.valid_range import FREE, PAGE, UMANS, ModelRange
from crowdbot.typing import Floats

from .cost_terms import HalfPlanes
from .neighbor_view import NeighborView
from .velocity_cost import VelocityCost, length, suitable_optimiser

OPTIMISERS = ("natural", "gradient", "sampling", "closed-form")
SAMPLES = ("polar", "umans", "random")
EQUAL = 1e-9
"""Relative tolerance within which costs are equal: rounding does not decide between velocities."""
BUDGET = 1_000_000
"""Maximum number of elements of an array; agents are processed in parts."""
GIVEN = 3
"""Number of candidates in addition to the samples: zero, the desired and the current velocity."""
STEEPEST = 1e9
"""Limit of gradients [m/s^2]."""


@dataclass(frozen=True)
class CostModel(CrowdModel):
    """Composable model: agents choose the velocity with the lowest sum of costs.

    Args:
        costs: the sum of costs, such as ``PreferredVelocity() + 0.3 * Inertia() + PowerLawEnergy()``; see
            :mod:`crowdbot.models.costs`.
        optimiser: ``gradient`` (one gradient step from the current velocity), ``sampling`` (the best of sampled
            velocities), ``closed-form`` (for a cost with a closed-form minimum), or ``natural`` (depends on the costs).
        relaxation_time: time constant with which the velocity follows the best one [s], not for ``gradient``; at least
            the time step.
        contact_stiffness: acceleration per metre of overlap between bodies, and with walls [1/s^2]; limited to the
            value that resolves the overlap in one time step. 62.5 is 5000 kg/s^2 at 80 kg.
        neighbor_distance: maximum distance of neighbours [m].
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_acceleration: ``[E, A]`` [m/s^2], without contact forces; None: no limit.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.
        samples: ``polar`` (desired, current and zero velocity, and rings around the desired direction), ``umans``
            (rings starting at -x, as in the UMANS library), ``random`` (uniform in the disc of possible speeds).
        speeds, angles: number of rings, and of velocities on each; their product for ``random``.
        refinements: number of local searches around the best sample, each half as wide as the one before.
        seed: seed of ``random`` samples for steps without a generator; all agents and steps then use the same samples.

    Costs are evaluated in NumPy: easy to extend, but slower than the compiled models.

    The default cost is :class:`~crowdbot.models.costs.HalfPlanes` in closed form, which reproduces ``orca`` in NumPy.
    The original is the UMANS library; its sampling pattern is ``samples="umans"``.

    Source: van Toll, Grzeskowiak, López, Amirian, Berton, Bruneau, Daniel, Jovane, Pettré 2020,
    doi:10.1145/3384382.3384532.

    Raises:
        InputError: a parameter is not finite or below its minimum, an option is unknown, or there is no closed form.

    >>> from crowdbot.models.costs import PowerLawEnergy, PreferredVelocity
    >>> careful = CostModel(PreferredVelocity() + 2.0 * PowerLawEnergy(), refinements=6)
    >>> ahead = Scene.of([[0, 0], [3, 0.1]], [[1, 0], [-1, 0]], preferred_velocity=[[1, 0], [-1, 0]])
    >>> careful.velocity(ahead, dt=0.1).round(2).tolist()
    [[[0.94, -0.26], [-0.94, 0.26]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Wouter van Toll, Fabien Grzeskowiak, Axel López, Javad Amirian, Florian Berton, Julien Bruneau, Beatriz"
        " Cabrero Daniel, Alberto Jovane, Julien Pettré",
        2020,
        "Generalized microscopic crowd simulation using costs in velocity space",
        "Symposium on Interactive 3D Graphics and Games",
        "10.1145/3384382.3384532",
    )
    batched = True
    valid_range = ModelRange(0.7, FREE, 0.1, PAGE, UMANS)

    costs: VelocityCost = field(default_factory=HalfPlanes)
    optimiser: str = "natural"
    relaxation_time: PerAgent = parameter(0.0, unit="s", low=0.0, high=1.5, source="no relaxation")
    contact_stiffness: PerAgent = parameter(0.0, unit="1/s^2", low=0.0, high=200.0, source="no contact")
    neighbor_distance: PerAgent = parameter(5.0, unit="m", low=1.0, high=15.0, source="UMANS, examples")
    max_neighbors: PerAgent = parameter(10.0, unit="1", low=1.0, high=60.0, source="RVO2, examples")
    max_acceleration: PerAgent | None = None
    max_speed: PerAgent | None = None
    samples: str = "polar"
    speeds: int = 10
    angles: int = 36
    refinements: int = 0
    seed: int = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.costs, VelocityCost):
            raise InputError(f"CostModel: costs = {self.costs!r} must be a VelocityCost or a sum of them")
        for name, known in (("optimiser", OPTIMISERS), ("samples", SAMPLES)):
            word = getattr(self, name)
            if word not in known:
                raise InputError(
                    f"CostModel: {name} {word!r} is unknown{did_you_mean(str(word), known)}; choose {', '.join(known)}"
                )
        for name, low, high in (("speeds", 1, 1000), ("angles", 1, 1000), ("refinements", 0, 50)):
            number = getattr(self, name)
            if not (isinstance(number, int) and low <= number <= high):
                raise InputError(
                    f"CostModel: {name} = {number!r} is not allowed, it must be a whole number from {low} to {high}"
                )
        if self.max_acceleration is not None and not np.all(np.asarray(self.max_acceleration) >= 0.0):
            raise InputError(
                f"CostModel: max_acceleration = {self.max_acceleration} [m/s^2] is not allowed, it must be at least 0"
                " m/s^2, or None for no limit"
            )

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        # rng is used by costs and samples
        wish, walking, seen, out = begin_step(scene, dt)

        def value(name: str) -> Floats:
            return per_agent(getattr(self, name), scene.shape, name)

        near = neighbors_of(self, scene, seen, walking)
        world = NeighborView.of(scene, wish, speed_limit(self.max_speed, scene), walking, near, float(dt), rng)
        optimiser = suitable_optimiser(self.costs) if self.optimiser == "natural" else self.optimiser
        discs = self._discs(rng) if optimiser == "sampling" else np.zeros((0, 2))
        step = max(1, BUDGET // ((len(discs) + GIVEN) * (world.there.shape[1] + len(world.segments) + 1)))
        for begin in range(0, len(world), step):
            part = world.part(begin, begin + step)
            rows(out)[part.row] = self._next(part, optimiser, discs)
        return out

    def _next(self, world: NeighborView, optimiser: str, discs: Floats) -> Floats:
        dt = world.dt
        if optimiser == "gradient":
            slope = self.costs.gradient(world, world.velocity)
            change = -np.clip(np.where(np.isfinite(slope), slope, 0.0), -STEEPEST, STEEPEST)
        else:
            best = self.costs.best(world) if optimiser == "closed-form" else self._best_sample(world, discs)
            relaxation = np.maximum(world.each(self.relaxation_time, "relaxation_time"), dt)
            change = (best - world.velocity) / relaxation[:, None]
        if self.max_acceleration is not None:
            change = _limit_length(change, world.each(self.max_acceleration, "max_acceleration"))
        velocity = _limit_length(world.velocity + change * dt, world.max_speed)
        stiffness = np.minimum(world.each(self.contact_stiffness, "contact_stiffness"), 1.0 / dt**2)
        if not np.any(stiffness):
            return velocity
        return _limit_length(velocity + (stiffness * dt)[:, None] * world.sum_overlaps(), world.max_speed)

    def _discs(self, random: np.random.Generator | None) -> Floats:
        """Return the samples ``[C, 2]`` for a maximum speed of 1 and the desired direction +x."""
        if self.samples == "random":
            random = stream(self.seed, "cost-model", "samples") if random is None else random
            size = np.sqrt(random.random(self.speeds * self.angles))
            way = 2.0 * math.pi * random.random(self.speeds * self.angles)
            return np.stack([size * np.cos(way), size * np.sin(way)], axis=-1)
        turns = np.arange(self.angles)
        if self.samples == "polar":  # straight ahead first, then alternately to both sides
            turns = np.where(turns % 2 == 1, -(turns + 1) // 2, turns // 2)
        angle = turns * (2.0 * math.pi / self.angles) + (math.pi if self.samples == "umans" else 0.0)
        speed = (1.0 + np.arange(self.speeds))[:, None] / self.speeds
        return np.stack([speed * np.cos(angle), speed * np.sin(angle)], axis=-1).reshape(-1, 2)

    def _best_sample(self, world: NeighborView, discs: Floats) -> Floats:
        ahead = world.direction()
        if self.samples == "umans":
            ahead = np.broadcast_to([1.0, 0.0], ahead.shape)
        across = np.stack([-ahead[:, 1], ahead[:, 0]], axis=-1)
        size = world.max_speed[:, None, None]
        turned = size * (discs[:, :1] * ahead[:, None] + discs[:, 1:] * across[:, None])
        given = [np.zeros_like(ahead)]
        if self.samples != "umans":
            given += [_limit_length(world.wish, world.max_speed), _limit_length(world.velocity, world.max_speed)]
        best = _lowest_cost(self.costs, world, np.concatenate([np.stack(given, axis=1), turned], axis=1))
        for level in range(self.refinements):
            span = size[:, 0] * (1.0 / self.speeds) / 2.0 ** (level + 1)
            tries = [best] + [best + span * (i * ahead + j * across) for i in (1, 0, -1) for j in (0, -1, 1) if i or j]
            best = _lowest_cost(self.costs, world, np.stack([_limit_length(t, world.max_speed) for t in tries], axis=1))
        return best


def _lowest_cost(costs: VelocityCost, world: NeighborView, candidates: Floats) -> Floats:
    """Return the candidate with the lowest cost ``[N, 2]``, the first one among equal costs."""
    cost = costs.value(world, candidates)
    cost = np.where(np.isnan(cost), np.inf, cost)
    least = np.min(cost, axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        chosen = np.argmax(cost <= least + EQUAL * (np.abs(least) + 1.0), axis=1)
    return np.asarray(candidates[np.arange(len(candidates)), chosen])


def _limit_length(vectors: Floats, longest: Floats) -> Floats:
    """Return vectors ``[N, 2]`` limited to the lengths ``longest`` [N]."""
    size = length(vectors)
    return np.asarray(vectors * np.minimum(1.0, longest / np.maximum(size, 1e-300))[:, None])
