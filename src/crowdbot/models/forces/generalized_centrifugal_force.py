"""GeneralizedCentrifugalForce: elliptical bodies that grow with the speed (Chraibi, Seyfried, Schadschneider 2010)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.models.model import CrowdModel, begin_step, launch, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import parameter_columns
from crowdbot.models.speed_models.collision_free_speed import is_hidden, nearest_on_segment, within
from crowdbot.models.valid_range import JUPEDSIM, PAGE, ModelRange
from crowdbot.typing import Floats

CONTACT = 0.5
"""Distance [m] between ellipses, or between ellipse and wall, below which the force does not grow hyperbolically."""
STILL = 1e-3
"""Speed [m/s] below which agents feel no repulsion, distance [m] below which it has no direction."""
SHORTEST = 0.1
"""Walls below this length [m] are ignored."""
FARTHEST = 1e9
"""Upper limit of speeds in the force [m/s], against overflow."""
LAW = (
    "strength", "wall_strength", "interaction_distance", "wall_distance", "blending_distance",
    "wall_blending_distance", "force_limit", "wall_force_limit",
)  # fmt: skip
"""Parameters in the order of the kernel."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    heading: Floats
    desired: Floats
    max_speed: Floats
    strength: Floats
    wall_strength: Floats
    distance: Floats
    wall_distance: Floats
    blending: Floats
    wall_blending: Floats
    force_limit: Floats
    wall_force_limit: Floats
    relaxation: Floats
    length: Floats
    stretch: Floats
    wide: Floats
    narrow: Floats
    reach: Floats
    walking: NDArray[np.bool_]


@kernel
def _blend(x: float, first: float, last: float, low: float, high: float, slope: float, end_slope: float) -> float:
    """Return the cubic between x = ``first`` and ``last`` with these values and slopes at both ends."""
    width = last - first
    t = (x - first) / width
    t2, t3 = t * t, t * t * t
    left = low * (2.0 * t3 - 3.0 * t2 + 1.0) + slope * (t3 - 2.0 * t2 + t) * width
    return left + high * (3.0 * t2 - 2.0 * t3) + end_slope * (t3 - t2) * width


@kernel
def _repulsion(gap: float, base: float, most: float, overlap: float, reach: float, blend: float) -> float:
    """Return the repulsion [m/s^2] at a gap [m]: ``base / gap``, blended to its ends at contact and at ``reach``.

    Args:
        base: numerator of the force [m^2/s^2].
        most: value below ``overlap``.
        overlap: gap [m] below which the force is constant.
        reach, blend: gap without force and width of the blending [m].
    """
    low, high = CONTACT + blend, reach - blend
    if gap >= reach:
        return 0.0
    if gap <= overlap:
        return most
    if gap > high:
        return _blend(gap, high, reach, base / high, 0.0, -base / (high * high), 0.0)
    if gap >= low:
        return base / gap
    return _blend(gap, CONTACT - blend, low, most, base / low, 0.0, -base / (low * low))


@kernel
def _surface(dx: float, dy: float, hx: float, hy: float, long: float, short: float) -> tuple[float, float]:
    """Return the point [m] of an ellipse with its long axis along h in the direction d, relative to its centre."""
    distance = math.sqrt(dx * dx + dy * dy)
    along, across = (dx * hx + dy * hy) / distance * long, (dy * hx - dx * hy) / distance * short
    return along * hx - across * hy, along * hy + across * hx


@kernel
def _half_width(speed: float, wish: float, wide: float, narrow: float) -> float:
    """Return the half axis [m] across the walking direction: wide at rest, narrow at the desired speed."""
    return wide - (wide - narrow) * (min(speed / wish, 1.0) if wish > 0.0 else 1.0)


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, out: Floats) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, dt, out)


@kernel
def _choose_part(begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, out: Floats) -> None:
    # unpack the tuples outside of the loop: each access counts references
    place, velocity, heading, desired, top, strength, wall_strength, distance, wall_distance, blending = crowd[:10]
    wall_blending, limit, wall_limit, relaxation, length, stretch, wide, narrow, reach, walking = crowd[10:]
    agent, number, order = near
    A = agent.shape[1]
    found = np.empty(len(walls), dtype=np.int64)
    for k in range(begin, end):
        row = order[k]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        x, y, vx, vy = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1]
        wish = math.sqrt(desired[row, 0] ** 2 + desired[row, 1] ** 2)
        speed = math.sqrt(vx * vx + vy * vy)
        ax, ay = (desired[row, 0] - vx) / relaxation[row], (desired[row, 1] - vy) / relaxation[row]
        if STILL <= speed < FARTHEST:
            count = within(walls, x, y, reach[row], found)
            long, short = length[row] + stretch[row] * speed, _half_width(speed, wish, wide[row], narrow[row])
            hx, hy = vx / speed, vy / speed
            for n in range(number[e, a]):
                o = row - a + agent[e, a, n]
                dx, dy = place[o, 0] - x, place[o, 1] - y
                apart = math.sqrt(dx * dx + dy * dy)
                ahead = hx * dx + hy * dy
                if apart < STILL or ahead <= STILL * apart or is_hidden(walls, found, count, x, y, dx, dy):
                    continue
                ox, oy = velocity[o, 0], velocity[o, 1]
                other = math.sqrt(ox * ox + oy * oy)
                fx, fy = (ox / other, oy / other) if other > 0.0 else (math.cos(heading[o]), math.sin(heading[o]))
                wanted = math.sqrt(desired[o, 0] ** 2 + desired[o, 1] ** 2)
                ix, iy = _surface(dx, dy, hx, hy, long, short)
                jx, jy = _surface(
                    -dx, -dy, fx, fy, length[o] + stretch[o] * other, _half_width(other, wanted, wide[o], narrow[o])
                )
                gap = math.sqrt((dx + jx - ix) ** 2 + (dy + jy - iy) ** 2)
                closing = max(0.0, ((vx - ox) * dx + (vy - oy) * dy) / apart)
                base = ahead / apart * (strength[row] * wish + closing) ** 2
                most = limit[row] * base / (CONTACT + blending[row])
                push = _repulsion(gap, base, most, CONTACT - blending[row], distance[row], blending[row])
                ax, ay = ax - push * dx / apart, ay - push * dy / apart
            for n in range(count):
                px, py = _wall_push(
                    walls[found[n]], x, y, vx, vy, long, short, wall_strength[row] * wish, wall_limit[row],
                    wall_distance[row], wall_blending[row],
                )  # fmt: skip
                ax, ay = ax + px, ay + py
        vx, vy = vx + dt * ax, vy + dt * ay
        speed = math.sqrt(vx * vx + vy * vy)
        share = top[row] / speed if speed > top[row] else 1.0
        out[row, 0], out[row, 1] = share * vx, share * vy


@kernel
def _wall_push(
    wall: Floats, x: float, y: float, vx: float, vy: float, long: float, short: float, drive: float, limit: float,
    reach: float, blend: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the acceleration [m/s^2] by a wall; only walls abreast of the agent and in front of it repel."""
    ex, ey = wall[2] - wall[0], wall[3] - wall[1]
    extent = math.sqrt(ex * ex + ey * ey)
    nx, ny = nearest_on_segment(x, y, wall[0], wall[1], wall[2], wall[3])
    dx, dy = nx - x, ny - y
    apart = math.sqrt(dx * dx + dy * dy)
    ahead = vx * dx + vy * dy
    if extent < SHORTEST or abs(ex * dx + ey * dy) > STILL or apart < STILL or ahead <= 0.0:
        return 0.0, 0.0
    speed = math.sqrt(vx * vx + vy * vy)
    sx, sy = _surface(dx, dy, vx / speed, vy / speed, long, short)
    radius = math.sqrt(sx * sx + sy * sy)
    base = ahead / (apart * speed) * (drive + abs(vx * ey - vy * ex) / extent) ** 2
    gap, overlap = apart - radius, CONTACT - blend + radius
    if gap <= overlap:
        push = limit
    else:
        push = _repulsion(gap, base, limit * base / (CONTACT + blend), CONTACT - blend, reach, blend)
    return -push * dx / apart, -push * dy / apart


@dataclass(frozen=True)
class GeneralizedCentrifugalForce(CrowdModel):
    """Force model: bodies are ellipses that grow with the speed; agents ahead repel by the inverse of the gap.

    Args:
        strength: share of the desired speed in the repulsion by agents.
        wall_strength: share of the desired speed in the repulsion by walls.
        interaction_distance: gap between two ellipses [m] without repulsion.
        wall_distance: gap between ellipse and wall [m] without repulsion.
        blending_distance: width [m] of the transitions at contact and at the end of the interaction.
        wall_blending_distance: width [m] of these transitions at walls.
        force_limit: repulsion by agents in contact, relative to the force at the end of the transition.
        wall_force_limit: repulsion by walls in contact [m/s^2].
        relaxation_time: time constant of the desired velocity [s]; at least the time step.
        length: half axis of the ellipse along the walking direction at rest [m].
        stretch: growth of this half axis with the speed [s].
        wide: half axis across the walking direction at rest [m].
        narrow: half axis across the walking direction at the desired speed [m].
        neighbor_distance: maximum distance of neighbours and walls [m]; neighbours behind a wall are ignored.
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    The acceleration is ``(p - v) / relaxation_time - sum K (strength |p| + V)^2 / gap n`` over the agents in front,
    with the direction ``n`` to the neighbour, ``K`` the cosine of its angle to the velocity, ``V`` the speed of
    approach and the gap between the two ellipses. The force is bounded in contact and vanishes at
    ``interaction_distance``; cubic polynomials connect the parts. The size of a body is that of the ellipse, not the
    radius of the scene. Agents at rest feel no repulsion.

    The default follows JuPedSim 1.4.2. Differences: the desired direction changes without a delay, the ellipse is not
    narrower than ``narrow`` above the desired speed, and the speed is limited.

    Source: Chraibi, Seyfried, Schadschneider 2010, doi:10.1103/PhysRevE.82.046111, as in JuPedSim 1.4.2.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> behind = Scene.of([[0, 0], [3.6, 0.1]], [[1.3, 0], [0.5, 0]], goal=[[9, 0], [9, 0.1]])
    >>> GeneralizedCentrifugalForce().velocity(behind, dt=0.1).round(2).tolist()
    [[[1.2, -0.0], [0.66, 0.0]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Mohcine Chraibi, Armin Seyfried, Andreas Schadschneider",
        2010,
        "Generalized centrifugal-force model for pedestrian dynamics",
        "Physical Review E 82, 046111",
        "10.1103/PhysRevE.82.046111",
    )
    batched = True
    valid_range = ModelRange(0.1, "a one-way crowd of 0.25 people/m2 walks at 0.7 m/s", 0.01, PAGE, JUPEDSIM)

    strength: PerAgent = parameter(0.3, unit="1", low=0.05, high=1.0, source="JuPedSim 1.4.2")
    wall_strength: PerAgent = parameter(0.2, unit="1", low=0.05, high=1.0, source="JuPedSim 1.4.2")
    interaction_distance: PerAgent = parameter(2.0, unit="m", low=1.0, high=4.0, source="JuPedSim 1.4.2", min=1.0)
    wall_distance: PerAgent = parameter(2.0, unit="m", low=1.0, high=4.0, source="JuPedSim 1.4.2", min=1.0)
    blending_distance: PerAgent = parameter(
        0.1, unit="m", low=0.02, high=0.2, source="JuPedSim 1.4.2", min=1e-3, max=0.2
    )
    wall_blending_distance: PerAgent = parameter(
        0.1, unit="m", low=0.02, high=0.2, source="JuPedSim 1.4.2", min=1e-3, max=0.2
    )
    force_limit: PerAgent = parameter(9.0, unit="1", low=1.0, high=20.0, source="JuPedSim 1.4.2")
    wall_force_limit: PerAgent = parameter(3.0, unit="m/s^2", low=1.0, high=20.0, source="JuPedSim 1.4.2")
    relaxation_time: PerAgent = parameter(0.5, unit="s", low=0.1, high=1.5, source="Chraibi et al. 2010")
    length: PerAgent = parameter(0.2, unit="m", low=0.1, high=0.4, source="JuPedSim 1.4.2", min=1e-2)
    stretch: PerAgent = parameter(1.0, unit="s", low=0.0, high=1.0, source="JuPedSim 1.4.2")
    wide: PerAgent = parameter(0.4, unit="m", low=0.2, high=0.5, source="JuPedSim 1.4.2", min=1e-2)
    narrow: PerAgent = parameter(0.2, unit="m", low=0.1, high=0.3, source="JuPedSim 1.4.2", min=1e-2)
    neighbor_distance: PerAgent = parameter(4.0, unit="m", low=1.0, high=6.0, source="JuPedSim 1.4.2")
    max_neighbors: PerAgent = parameter(50.0, unit="1", low=5.0, high=100.0, source="crowdbot: more are never needed")
    max_speed: PerAgent | None = None

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        wish, walking, seen, out = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        values = (
            rows(scene.position),
            rows(scene.velocity),
            rows(scene.heading),
            rows(wish),
            rows(speed_limit(self.max_speed, scene)),
            *parameter_columns(self, scene.shape, *LAW),
            rows(np.maximum(per_agent(self.relaxation_time, scene.shape, "relaxation_time"), dt)),
            *parameter_columns(self, scene.shape, "length", "stretch", "wide", "narrow", "neighbor_distance"),
            rows(walking),
        )
        crowd = _Crowd._make(values)
        launch(_choose, _choose_part, rows(out), crowd, near, scene.walls.segments(), float(dt))
        return out
