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
NARROW, WIDE, SPEED_MARGIN = 0.05, np.pi / 6.0, 0.05
"""Greatest turn of :class:`AdmissibleRange` [rad] with late and with earlier contacts, and margin of speeds [m/s]."""
PARALLEL = 1e-5
"""Least product of a direction and a velocity [m/s] whose lines cross."""
NEAREST, SLOWEST_FLOW, SHARPEST = 0.1, 0.01, 0.1
"""Least distance ahead [m] and closing speed [m/s] in the optical flow, and greatest turn of its gradient [rad]."""


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


@dataclass(frozen=True)
class AdmissibleRange(VelocityCost):
    """Turn, change of speed and time to contact of velocities in a range that the time to contact sets.

    The time to contact of the desired velocity sets the range. After ``far``, only the desired velocity is in it (with
    0.05 rad and 0.05 m/s around it); before ``far``, turns of up to 30 degrees and changes of speed of up to the
    difference between maximum and desired speed; before ``near``, all speeds, and turns of up to 90 degrees at contact.
    From ``middle`` to ``far`` the greatest turn falls linearly. UMANS, whose ramp lacks a factor, allows no direction
    there.

    Args:
        turn, acceleration, deviation, urgency: weights of the turn from the desired velocity, of the change of speed,
            of the distance to the desired velocity and of the time to contact [1].
        near, middle, far: times to contact [s] at which the range changes; contacts after ``far`` cost nothing.

    Source: Karamouzas, Overmars 2010, A velocity-based approach for simulating human collision avoidance, as a cost by
    van Toll et al. 2020.
    """

    turn: PerAgent = parameter(5.0, unit="1", low=0.0, high=20.0, source="UMANS")
    acceleration: PerAgent = parameter(0.5, unit="1", low=0.0, high=5.0, source="UMANS")
    deviation: PerAgent = parameter(1.0, unit="1", low=0.0, high=5.0, source="UMANS")
    urgency: PerAgent = parameter(1.0, unit="1", low=0.0, high=5.0, source="UMANS")
    near: PerAgent = parameter(2.5, unit="s", low=0.5, high=5.0, source="UMANS", min=1e-3)
    middle: PerAgent = parameter(6.0, unit="s", low=1.0, high=8.0, source="UMANS", min=1e-3)
    far: PerAgent = parameter(8.0, unit="s", low=2.0, high=12.0, source="UMANS", min=1e-3)

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        # turn (1 - cos / 2) + acceleration ||v'| - |v|| / top + deviation |v' - p| / (2 top) + urgency (far - t)+ / far
        turn, change, deviation, urgency, near, middle, far = (
            world.each(getattr(self, name), name)[:, None]
            for name in ("turn", "acceleration", "deviation", "urgency", "near", "middle", "far")
        )
        first = world.first_contact(world.wish[:, None])
        ramp = (far - first) / np.maximum(far - middle, SLOWEST)
        widest = np.where(first < middle, WIDE, NARROW + (WIDE - NARROW) * np.clip(ramp, 0.0, 1.0))
        widest = np.where(first < near, WIDE + (1.0 - first / near) ** 2 * (0.5 * np.pi - WIDE), widest)
        speed, wanted, top = length(candidates), length(world.wish)[:, None], world.max_speed[:, None]
        least = np.where(first < near, 0.0, wanted - SPEED_MARGIN - np.where(first < far, np.abs(top - wanted), 0.0))
        most = np.where(first < near, top, wanted + np.where(first < far, np.abs(top - wanted), 0.0)) + SPEED_MARGIN
        outside = (_angle(candidates, world.wish) > widest) | (speed < least) | (speed > most)
        both = speed * wanted
        cos = np.sum(candidates * world.wish[:, None], axis=-1) / np.where(both > 0.0, both, 1.0)
        top = np.maximum(top, SLOWEST)
        cost = turn * (1.0 - 0.5 * cos) + change * np.abs(speed - length(world.velocity)[:, None]) / top
        cost = cost + deviation * length(candidates - world.wish[:, None]) / (2.0 * top)
        cost = cost + urgency * np.maximum(far - world.first_contact(candidates), 0.0) / far
        return np.where(outside, np.inf, cost)


@dataclass(frozen=True)
class PassingTimes(VelocityCost):
    """Direction, then speed, that pass the point where paths cross before or after each neighbour. Walls are ignored.

    A neighbour covers the crossing of the paths from t1 to t2. The cost of a direction grows with the part of t1 to t2
    that the desired speed is in, less for late crossings, and with its angle; that of a speed with its distance to
    the speeds that arrive at t1 and t2. An agent that walks away from the crossing of paths ignores it.

    Args:
        avoidance: weight of neighbours in the choice of a direction, the rest is that of the angle [1].
        time_horizon: latest t1 and t2 [s].

    Source: Paris, Pettré, Donikian 2007, doi:10.1111/j.1467-8659.2007.01090.x, in the interpretation of van Toll et al.
    2020, whose authors do not vouch for it.
    """

    avoidance: PerAgent = parameter(0.5, unit="1", low=0.0, high=1.0, source="UMANS")
    time_horizon: PerAgent = parameter(8.0, unit="s", low=1.0, high=12.0, source="UMANS", min=1e-3)

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        # 1000 (w mean of speed cost x earliness + (1 - w) (1 - cos) / 2) + sum of speed deviations + |v' - p| / 1000
        horizon = world.each(self.time_horizon, "time_horizon")[:, None, None]
        weight = world.each(self.avoidance, "avoidance")[:, None]
        speed, wanted = length(candidates), length(world.wish)[:, None]
        ahead = candidates / np.maximum(speed, 1e-300)[..., None]
        motion = np.broadcast_to(world.motion[:, None], (*speed.shape, *world.motion.shape[1:]))
        place = -world.offset[:, None]
        turn = ahead[..., None, 0] * motion[..., 1] - ahead[..., None, 1] * motion[..., 0]
        crosses = np.abs(turn) >= PARALLEL
        along = (place[..., 0] * motion[..., 1] - place[..., 1] * motion[..., 0]) / np.where(crosses, turn, 1.0)
        crossing = along[..., None] * ahead[:, :, None]
        reach = world.reach[:, None]
        walking = world.velocity[:, None, None]
        meets = (_reach_time(-crossing, walking, reach) < horizon) | (length(walking) == 0.0)
        pace = length(motion)
        begin = np.minimum(_reach_time(place - crossing, motion, reach), horizon)
        end = begin + reach / np.maximum(pace, 1e-300)
        end = np.where(end > horizon, 0.0, end)
        hurry, wait = (  # speeds that arrive at both times
            np.where(time > 0.0, np.abs(along) / np.where(time > 0.0, time, 1.0), np.inf) for time in (begin, end)
        )
        counts = world.there[:, None] & crosses & meets
        blocked = world.there[:, None] & ~crosses & (world.contact_times(ahead) <= horizon)
        desired = np.maximum(wanted, SLOWEST)[..., None]
        inside = np.minimum(np.maximum(1.0 - hurry / desired, 0.0), np.maximum(wait / desired - 1.0, 0.0))
        inside = np.sum(np.where(counts, inside * (1.0 - begin / horizon), 0.0), axis=-1)
        inside = inside / np.maximum(np.count_nonzero(world.there, axis=-1), 1)[:, None]
        off = np.maximum(np.maximum(hurry - speed[..., None], speed[..., None] - wait), 0.0) / desired
        off = np.sum(np.where(counts, off, np.where(blocked, np.inf, 0.0)), axis=-1)
        cos = np.sum(ahead * world.wish[:, None], axis=-1) / np.maximum(wanted, 1e-300)
        direction = weight * inside + (1.0 - weight) * 0.5 * (1.0 - cos)
        return np.asarray(1e3 * direction + off + 1e-3 * length(candidates - world.wish[:, None]))


@dataclass(frozen=True)
class FocusOfExpansion(VelocityCost):
    """Neighbours ahead, by the time until they are abreast and the lateral distance at which they then pass.

    The cost of a neighbour is ``importance 10^(-distance / (sum of radii))``; the importance falls from ``strength`` to
    a hundredth of it at ``time_horizon``, and to 0 at twice that time. Walls are ignored. The gradient is a turn of at
    most 0.1 rad and a change of speed. It is meant for ``GoalForce() + 3.0 * FocusOfExpansion()``.

    Args:
        strength: importance of a neighbour who is abreast now [1].
        time_horizon: time in which the importance falls [s].

    Source: López, Chaumette, Marchand, Pettré 2019, doi:10.1111/cgf.13629, as a cost by van Toll et al. 2020.
    """

    natural: ClassVar[str] = "gradient"

    strength: PerAgent = parameter(10.0, unit="1", low=0.0, high=50.0, source="UMANS")
    time_horizon: PerAgent = parameter(5.0, unit="s", low=0.5, high=10.0, source="UMANS", min=1e-3)

    def value(self, world: NeighborView, candidates: Floats) -> Floats:
        return np.asarray(np.sum(self._flow(world, candidates)[0], axis=-1))

    def gradient(self, world: NeighborView, velocity: Floats) -> Floats:
        # sums over neighbours, over the angle and the speed of the velocity
        cost, across, shift, rate, scale = (value[:, 0] for value in self._flow(world, velocity[:, None]))
        speed, side = length(velocity)[:, None], np.sign(across - shift) / scale
        turn = np.sum(cost * side * (shift**2 - across**2 - speed / rate), axis=-1)
        turn = np.clip(turn, -SHARPEST, SHARPEST)
        faster = np.sum(cost * side * (-shift / rate), axis=-1)
        ahead = velocity / np.maximum(speed, 1e-300)
        right = np.stack([ahead[:, 1], -ahead[:, 0]], axis=-1)
        forward = speed[:, 0] * (1.0 - np.cos(turn)) + faster
        return np.asarray(-(speed * np.sin(turn)[:, None] * right + forward[:, None] * ahead))

    def _flow(self, world: NeighborView, candidates: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Return the cost of each neighbour ``[N, C, K]``, and tangents, rates [m/s] and scales of its optical flow."""
        speed = length(candidates)
        ahead = (candidates / np.maximum(speed, 1e-300)[..., None])[:, :, None]
        right = np.stack([ahead[..., 1], -ahead[..., 0]], axis=-1)
        place, motion = -world.offset[:, None], world.motion[:, None] - candidates[:, :, None]
        depth, closing = np.sum(place * ahead, axis=-1), -np.sum(motion * ahead, axis=-1)
        seen = world.there[:, None] & (depth >= NEAREST) & (closing >= SLOWEST_FLOW) & (speed > 0.0)[..., None]
        depth, closing = np.where(seen, depth, 1.0), np.where(seen, closing, 1.0)
        across = np.sum(place * right, axis=-1) / depth  # where the neighbour is seen, and where it expands from
        shift = -np.sum(motion * right, axis=-1) / closing
        strength, horizon = (
            world.each(getattr(self, name), name)[:, None, None] for name in ("strength", "time_horizon")
        )
        time = depth / closing
        importance = np.where(time <= 2.0 * horizon, strength * np.clip(1.0 - time / horizon, 0.01, 1.0), 0.0)
        scale = world.reach[:, None] / (depth * np.log(10.0))
        cost = importance * np.exp(-np.abs(across - shift) / np.maximum(scale, 1e-300))
        return np.where(seen, cost, 0.0), across, shift, closing, np.maximum(scale, 1e-300)


def _reach_time(place: Floats, velocity: Floats, reach: Floats) -> Floats:
    """Return when a point at ``place`` comes within ``reach`` [m] of the origin ``[..., K]`` [s], 0 inside, or inf."""
    a, b = np.sum(velocity**2, axis=-1), np.sum(place * velocity, axis=-1)
    apart = np.sum(place**2, axis=-1) - reach**2
    root = b * b - a * apart
    meets = (b < 0.0) & (root > 0.0)
    time = np.where(meets, apart / np.where(meets, np.sqrt(np.maximum(root, 0.0)) - b, 1.0), np.inf)
    return np.where(apart <= 0.0, 0.0, time)


def _angle(candidates: Floats, other: Floats) -> Floats:
    """Return the angles ``[N, C]`` [rad] between velocities ``[N, C, 2]`` and vectors [N, 2]; 0 if one of them is 0."""
    both = length(candidates) * length(other)[:, None]
    cos = np.sum(candidates * other[:, None], axis=-1) / np.where(both > 0.0, both, 1.0)
    return np.where(both > 0.0, np.arccos(np.clip(cos, -1.0, 1.0)), 0.0)
