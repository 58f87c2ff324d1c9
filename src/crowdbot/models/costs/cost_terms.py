"""Cost terms: the cost of each candidate velocity of an agent."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import PerAgent, parameter
from crowdbot.models.model import CrowdModel, rows
from crowdbot.models.velocity_obstacles.linear_program import best_velocity
from crowdbot.models.velocity_obstacles.orca_lines import avoid_agent, avoid_edge, edges_in_reach, edges_of
from crowdbot.typing import Floats

from .neighbor_view import NeighborView
from .velocity_cost import Force, VelocityCost, length

EDGE = 1e-9
"""Tolerance [m/s] outside of a half plane."""
SLOWEST = 1e-9
"""Least desired speed [m/s] in a quotient."""
FAR = 1e3
"""Distance of the goal, in planning times, if only a desired velocity is given."""


@dataclass(frozen=True)
class PreferredVelocity(VelocityCost):
    """Distance to the desired velocity: attraction to the goal.

    Args:
        exponent: exponent of the distance; 1 keeps the desired velocity, 2 allows small deviations.
    """

    natural: ClassVar[str] = "closed-form"

    exponent: PerAgent = parameter(1.0, unit="1", low=1.0, high=3.0, source="van den Berg et al. 2008", min=0.1)

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        # |v' - p|^exponent
        distance = length(candidates - world.wish[:, None])
        return np.asarray(distance ** world.each(self.exponent, "exponent")[:, None])

    def best(self, world: NeighborView) -> Floats:
        return world.wish


@dataclass(frozen=True)
class Inertia(VelocityCost):
    """Distance to the current velocity.

    Args:
        exponent: exponent of the distance; 1 keeps the current velocity, 2 allows small deviations.
    """

    natural: ClassVar[str] = "closed-form"

    exponent: PerAgent = parameter(1.0, unit="1", low=1.0, high=3.0, source="chosen here", min=0.1)

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        # |v' - v|^exponent
        distance = length(candidates - world.velocity[:, None])
        return np.asarray(distance ** world.each(self.exponent, "exponent")[:, None])

    def best(self, world: NeighborView) -> Floats:
        return world.velocity


@dataclass(frozen=True)
class NoiseTerm(VelocityCost):
    """Random cost of each velocity from the generator of the step; 0 without a generator.

    Args:
        deviation: standard deviation of the cost.
    """

    deviation: float = parameter(0.1, unit="1", low=0.0, high=1.0, source="chosen here")

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        if world.random is None:
            return np.zeros(candidates.shape[:2])
        return self.deviation * world.random.standard_normal(candidates.shape[:2])


@dataclass(frozen=True)
class GoalForce(Force):
    """Driving force ``(p - v) / relaxation_time``.

    Args:
        relaxation_time: time constant [s]; at least the time step.
    """

    relaxation_time: PerAgent = parameter(0.5, unit="s", low=0.1, high=1.5, source="Helbing and Molnar 1995")

    def force(self, world: NeighborView) -> Floats:
        relaxation = np.maximum(world.each(self.relaxation_time, "relaxation_time"), world.dt)
        return np.asarray((world.wish - world.velocity) / relaxation[:, None])


@dataclass(frozen=True)
class ModelForce(Force):
    """A crowd model as a cost: the force towards its velocity.

    Args:
        model: a :class:`CrowdModel`, such as ``SocialForce()``.
    """

    model: CrowdModel

    def force(self, world: NeighborView) -> Floats:
        chosen = world.compute_once(
            ("model", id(self.model)), lambda: self.model.velocity(world.scene, world.dt, world.random)
        )
        return np.asarray((rows(chosen)[world.row] - world.velocity) / world.dt)


@dataclass(frozen=True)
class PowerLawForce(Force):
    """Negative gradient of ``strength t^-exponent exp(-t / time_horizon)``, t the time to collision.

    The wall of the earliest contact is included. Overlapping discs and collisions after ``time_horizon`` are ignored.

    Args:
        strength: factor of the energy, per mass [m^2 s^(exponent - 2)].
        exponent: exponent of the time to collision [1].
        time_horizon: decay time of the energy [s]; later collisions are ignored.

    Source: Karamouzas, Skinner, Guy 2014, doi:10.1103/PhysRevLett.113.238701.
    """

    strength: PerAgent = parameter(1.5, unit="m^2 s^(m-2)", low=0.3, high=5.0, source="Karamouzas et al. 2014")
    exponent: PerAgent = parameter(2.0, unit="1", low=1.0, high=4.0, source="Karamouzas et al. 2014")
    time_horizon: PerAgent = parameter(3.0, unit="s", low=0.5, high=8.0, source="Karamouzas et al. 2014", min=1e-3)

    def force(self, world: NeighborView) -> Floats:
        time = world.contact_times(world.velocity[:, None])[:, 0]
        soon = np.isfinite(time)
        motion = world.velocity[:, None] - world.motion
        touch = world.offset + motion * np.where(soon, time, 0.0)[..., None]  # from neighbour to agent, on contact
        closing = -np.sum(touch * motion, axis=-1)
        size = self._steepness(world, time) / np.where(soon, closing, 1.0)
        pushes = np.sum(size[..., None] * touch, axis=1)
        return np.asarray(pushes + self._wall_force(world))

    def _wall_force(self, world: NeighborView) -> Floats:
        if len(world.segments) == 0:
            return np.zeros_like(world.velocity)
        time = world.wall_times(world.velocity[:, None])
        soon = np.isfinite(time[:, 0])
        touch = world.position + world.velocity * np.where(soon, time[:, 0], 0.0)[:, None]
        away = touch - world.nearest_on_walls(touch)
        closing = -np.sum(away * world.velocity, axis=-1)
        return np.asarray((self._steepness(world, time)[:, 0] / np.where(soon, closing, 1.0))[:, None] * away)

    def _steepness(self, world: NeighborView, time: Floats) -> Floats:
        """Return the negative time derivative of the energy ``[N, K]``; 0 without a collision within the horizon."""
        k, m, horizon = (world.each(getattr(self, name), name)[:, None] for name in _ENERGY)
        soon = (time > 0.0) & (time <= horizon)
        t = np.where(soon, time, 1.0)
        return np.where(soon, k * np.exp(-t / horizon) * t**-m * (m / t + 1.0 / horizon), 0.0)


_ENERGY = ("strength", "exponent", "time_horizon")


@dataclass(frozen=True)
class PowerLawEnergy(VelocityCost):
    """Energy ``strength t^-exponent exp(-t / time_horizon)`` of a velocity, t its time to collision.

    The included collisions are those of :class:`PowerLawForce`.

    Args:
        strength: factor of the energy, per mass [m^2 s^(exponent - 2)].
        exponent: exponent of the time to collision [1].
        time_horizon: decay time of the energy [s]; later collisions are ignored.

    Source: Karamouzas, Skinner, Guy 2014, doi:10.1103/PhysRevLett.113.238701.
    """

    strength: PerAgent = parameter(1.5, unit="m^2 s^(m-2)", low=0.3, high=5.0, source="Karamouzas et al. 2014")
    exponent: PerAgent = parameter(2.0, unit="1", low=1.0, high=4.0, source="Karamouzas et al. 2014")
    time_horizon: PerAgent = parameter(3.0, unit="s", low=0.5, high=8.0, source="Karamouzas et al. 2014", min=1e-3)

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        # sum of the energies with all neighbours and the first wall
        walls = world.wall_times(candidates)[..., None]
        time = np.concatenate([world.contact_times(candidates), walls], axis=-1)
        k, m, horizon = (world.each(getattr(self, name), name)[:, None, None] for name in _ENERGY)
        soon = time <= horizon
        t = np.where(soon, time, 1.0)
        with np.errstate(over="ignore", divide="ignore"):
            return np.asarray(np.sum(np.where(soon, k * np.exp(-t / horizon) * t**-m, 0.0), axis=-1))


@dataclass(frozen=True)
class ReciprocalObstacles(VelocityCost):
    """Reciprocal velocity obstacles: ``weight / t + |v' - p|``, t the time to contact at ``2 v' - v``.

    Args:
        weight: weight of the inverse time to contact [m].

    Source: van den Berg, Lin, Manocha 2008, doi:10.1109/ROBOT.2008.4543489, as a cost by van Toll et al. 2020.
    """

    weight: PerAgent = parameter(1.0, unit="m", low=0.1, high=10.0, source="UMANS")

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        time = world.first_contact(2.0 * candidates - world.velocity[:, None])
        cost = world.each(self.weight, "weight")[:, None] / time + length(candidates - world.wish[:, None])
        return np.where(length(candidates) <= world.max_speed[:, None] * (1.0 + 1e-9), cost, np.inf)


@dataclass(frozen=True)
class HalfPlanes(VelocityCost):
    """ORCA as a cost: distance to the desired velocity inside all half planes, penalty outside.

    Args:
        time_horizon: time horizon for agents [s].
        time_horizon_walls: time horizon for walls [s].

    Outside, the cost is the largest violation of a half plane plus twice the maximum speed.

    Source: van den Berg, Guy, Lin, Manocha 2011, doi:10.1007/978-3-642-19457-3_1, as a cost by van Toll et al. 2020.
    """

    natural: ClassVar[str] = "closed-form"

    time_horizon: PerAgent = parameter(2.0, unit="s", low=0.2, high=8.0, source="RVO2, pedestrian", min=1e-3)
    time_horizon_walls: PerAgent = parameter(
        2.0, unit="s", low=0.2, high=4.0, source="CrowdBot simulator, horizon of agents", min=1e-3
    )

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        lines, _, count = self._lines(world)
        dx = lines[:, None, :, 0] - candidates[:, :, None, 0]
        dy = lines[:, None, :, 1] - candidates[:, :, None, 1]
        outside = lines[:, None, :, 2] * dy - lines[:, None, :, 3] * dx
        outside = np.where(np.arange(lines.shape[1]) < count[:, None, None], outside, -np.inf)
        deepest = np.max(outside, axis=-1, initial=-np.inf)
        far = length(candidates - world.wish[:, None])
        return np.where(deepest <= EDGE, far, deepest + 2.0 * world.max_speed[:, None])

    def best(self, world: NeighborView) -> Floats:
        lines, fixed, count = self._lines(world)
        spare, top, wish = np.empty(lines.shape[1:]), world.max_speed, world.wish
        out = np.empty((len(world), 2))
        for n in range(len(world)):
            out[n] = best_velocity(lines[n], fixed[n], count[n], top[n], wish[n, 0], wish[n, 1], spare)
        return out

    def _lines(self, world: NeighborView) -> tuple[Floats, NDArray[np.int64], NDArray[np.int64]]:
        """Return the lines ``[N, L, 4]``, the number of wall lines ``[N]`` and the number of lines."""
        edges = edges_of(world.scene.walls)
        corner, following = edges.corner, edges.next
        found, gap2 = np.empty(len(corner), dtype=np.int64), np.empty(len(corner))
        lines = np.zeros((len(world), len(corner) + world.there.shape[1], 4))
        fixed = np.zeros(len(world), dtype=np.int64)
        horizon = world.each(self.time_horizon, "time_horizon")
        walls = world.each(self.time_horizon_walls, "time_horizon_walls")
        share = np.where(world.external, 1.0, 0.5)
        for n in range(len(world)):
            (x, y), (vx, vy), r = world.position[n], world.velocity[n], world.radius[n]
            reach = walls[n] * world.max_speed[n] + r
            for m in found[: edges_in_reach(corner, following, x, y, reach, found, gap2)]:
                at = fixed[n]
                fixed[n] += avoid_edge(lines[n], at, m, *edges, x, y, vx, vy, r, walls[n])
            for i in range(np.count_nonzero(world.there[n])):
                dx, dy = -world.offset[n, i]
                ox, oy = world.motion[n, i]
                side = 1.0 if world.first[n, i] else -1.0
                avoid_agent(
                    lines[n], fixed[n] + i, dx, dy, vx, vy, ox, oy,
                    world.reach[n, i], horizon[n], world.dt, share[n, i], side,
                )  # fmt: skip
        return lines, fixed, fixed + np.count_nonzero(world.there, axis=1)


@dataclass(frozen=True)
class Effort(VelocityCost):
    """Energy per mass to the goal [J/kg]; inf if a contact is too early.

    Args:
        rest_power: power at rest [J/(kg s)].
        walk_power: power per squared speed [J s/(kg m^2)].
        planning_time: time at the new velocity [s]; the rest of the path is walked at the cheapest speed.
        safe_time: minimum time to contact [s].

    Source: Guy et al. 2010, doi:10.2312/SCA/SCA10/119-128, with the contact rule of van Toll et al. 2020.
    """

    rest_power: PerAgent = parameter(2.23, unit="J/(kg s)", low=0.1, high=5.0, source="Guy et al. 2010")
    walk_power: PerAgent = parameter(1.26, unit="J s/(kg m^2)", low=0.5, high=3.0, source="Guy et al. 2010", min=1e-3)
    planning_time: PerAgent = parameter(3.0, unit="s", low=0.2, high=8.0, source="UMANS", min=1e-3)
    safe_time: PerAgent = parameter(0.5, unit="s", low=0.0, high=2.0, source="UMANS")

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        # t (e_s + e_w |v'|^2) + 2 |g - t v'| sqrt(e_s e_w)
        rest, walk, t, safe = (
            world.each(getattr(self, name), name)[:, None]
            for name in ("rest_power", "walk_power", "planning_time", "safe_time")
        )
        goal = world.goal - world.position if world.scene.preferred_velocity is None else FAR * t * world.wish
        left = length(goal[:, None] - t[..., None] * candidates)
        energy = t * (rest + walk * length(candidates) ** 2) + 2.0 * left * np.sqrt(rest * walk)
        return np.where(world.first_contact(candidates) < safe, np.inf, energy)


@dataclass(frozen=True)
class FreeWay(VelocityCost):
    """Distance between the end of the free path and the goal at sight distance, and deviation from the best speed.

    Args:
        sight_distance: range of vision [m].
        relaxation_time: time gap to obstacles ahead [s].

    Source: Moussaid, Helbing, Theraulaz 2011, doi:10.1073/pnas.1016507108, as a cost by van Toll et al. 2020.
    """

    sight_distance: PerAgent = parameter(10.0, unit="m", low=2.0, high=15.0, source="Moussaid et al. 2011")
    relaxation_time: PerAgent = parameter(0.5, unit="s", low=0.1, high=1.5, source="Moussaid et al. 2011", min=1e-3)

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        # (1 + D^2) (1 + (1 - |v'| / S)^2), D to the end of the free path f, S = min(|p|, f / tau)
        sight = world.each(self.sight_distance, "sight_distance")[:, None]
        speed, wanted = length(candidates), length(world.wish)[:, None]
        ahead = candidates / np.maximum(speed, 1e-300)[..., None]
        free = np.minimum(sight, wanted * world.first_contact(ahead * wanted[..., None]))
        cos = np.sum(ahead * world.wish[:, None], axis=-1) / np.maximum(wanted, 1e-300)
        distance2 = sight**2 + free**2 - 2.0 * sight * free * cos
        best = np.minimum(wanted, free / world.each(self.relaxation_time, "relaxation_time")[:, None])
        off = np.where(best > 0.0, (best - speed) / np.where(best > 0.0, best, 1.0), np.inf)
        return np.asarray((distance2 + 1.0) * (1.0 + off**2))


@dataclass(frozen=True)
class CollisionDistance(VelocityCost):
    """Free path that is missing to the sight distance, and deviations from desired and current velocity.

    Args:
        sight_distance: range of vision [m].

    Source: van Toll et al. 2020, doi:10.1145/3384382.3384532, the example cost of UMANS.
    """

    sight_distance: PerAgent = parameter(8.0, unit="m", low=2.0, high=15.0, source="UMANS, from its steps")

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        # (d - f) + angle(v', p) + ||v'| - |p|| / |p| + angle(v', v), f the free path, at most d
        sight = world.each(self.sight_distance, "sight_distance")[:, None]
        speed, wanted = length(candidates), length(world.wish)[:, None]
        time = world.first_contact(candidates)
        soon = np.isfinite(time)
        free = np.minimum(sight, np.where(soon, speed * np.where(soon, time, 0.0), np.inf))
        turn = _angle(candidates, world.wish) + _angle(candidates, world.velocity)
        return np.asarray(sight - free + turn + np.abs(speed - wanted) / np.maximum(wanted, SLOWEST))


def _angle(candidates: Floats, other: Floats) -> Floats:
    """Return the angles ``[N, C]`` [rad] between velocities ``[N, C, 2]`` and vectors [N, 2]; 0 if one of them is 0."""
    both = length(candidates) * length(other)[:, None]
    cos = np.sum(candidates * other[:, None], axis=-1) / np.where(both > 0.0, both, 1.0)
    return np.where(both > 0.0, np.arccos(np.clip(cos, -1.0, 1.0)), 0.0)
