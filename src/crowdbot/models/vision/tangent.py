"""Tangent: vision-based avoidance with the smallest change of velocity (Pettré et al. 2009)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.models.model import CrowdModel, begin_step, neighbors_of, rows, speed_limit
from crowdbot.models.valid_range import JAMS, TWO_WAY, ModelRange
from crowdbot.typing import Floats

from .tangent_threats import MOST, RETREAT, THREAT, insert, least_change, retreat, threat_of_neighbor, threat_of_wall

REACTION = 3.5
"""Time to contact [s] at which agents with the default errors react (measured on the original)."""
RELAXATION = 1.0
"""Time constant [s] from the current to the desired velocity in the evaluated velocity (measured on the original)."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    desired: Floats
    comfort: Floats
    remaining: Floats
    radius: Floats
    area: Floats
    max_speed: Floats
    reaction: Floats
    horizon: Floats
    wall_horizon: Floats
    external: NDArray[np.bool_]
    walking: NDArray[np.bool_]


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, out: Floats) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, dt, out)


@kernel
def _choose_part(begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, out: Floats) -> None:
    # unpack the tuples outside of the loop: each access counts references
    (place, velocity, desired, comfort, remaining, radius, area, top, reaction, horizon, wall_horizon, external,
     walking) = crowd  # fmt: skip
    agent, number, order = near
    A = agent.shape[1]
    threats, lines = np.empty((MOST, THREAT)), np.empty((2 * MOST, 5))
    new, best = np.zeros(THREAT), np.empty(3)
    for k in range(begin, end):
        row = order[k]
        px, py = desired[row, 0], desired[row, 1]
        if not walking[row] or (px == 0.0 and py == 0.0):
            continue
        e, a = row // A, row % A
        x, y, vx, vy = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1]
        pull = min(1.0, dt / RELAXATION)
        hx, hy = vx + pull * (px - vx), vy + pull * (py - vy)  # evaluated velocity
        tx, ty = px, py
        close = _nearest_overlap(row, row - a, x, y, place, area, agent[e, a], number[e, a])
        if close >= 0:
            tx, ty = retreat(place[close, 0] - x, place[close, 1] - y, hx, hy, 1.0 if row < close else -1.0)
        for turn in range(2):  # evaluate the current course first, then the target
            bx, by = (hx, hy) if turn == 0 and close < 0 else (tx, ty)
            count = int(np.int64(0))  # a literal 0 has its own type
            for n in range(number[e, a] if close < 0 else 0):
                other = row - a + agent[e, a, n]
                if turn == 1 and not external[other]:
                    continue  # other agents give way themselves; external agents do not
                if threat_of_neighbor(new, place[other, 0] - x, place[other, 1] - y, bx, by, velocity[other, 0],
                           velocity[other, 1], area[row] + area[other], reaction[row], horizon[row], external[other],
                           top[row]):  # fmt: skip
                    count = insert(threats, count, new)
            for m in range(len(walls)):
                if threat_of_wall(new, walls[m], x, y, bx, by, radius[row], wall_horizon[row]):
                    count = insert(threats, count, new)
            if count > 0:
                tx, ty = least_change(threats, count, lines, best, bx, by, comfort[row], top[row])
                break
        out[row, 0], out[row, 1] = _change_velocity(
            vx, vy, tx, ty, comfort[row] * dt, top[row], remaining[row] / RETREAT
        )


@kernel
def _nearest_overlap(
    row: int, first: int, x: float, y: float, place: Floats, area: Floats, others: NDArray[np.int32], count: int
) -> int:
    """Return the row of the nearest neighbour whose personal area overlaps that of the agent, or -1."""
    for n in range(count):
        other = first + others[n]
        dx, dy, reach = place[other, 0] - x, place[other, 1] - y, area[row] + area[other]
        if dx * dx + dy * dy < reach * reach:
            return int(other)
    return -1


@kernel
def _change_velocity(
    vx: float, vy: float, tx: float, ty: float, most: float, top: float, arriving: float
) -> tuple[float, float]:
    """Return the velocity changed towards the target t, limited in change, in speed and near the goal."""
    dx, dy = tx - vx, ty - vy
    change = math.sqrt(dx * dx + dy * dy)
    if change > most:
        dx, dy = dx * most / change, dy * most / change
    x, y = vx + dx, vy + dy
    speed, limit = math.sqrt(x * x + y * y), min(top, arriving)
    if speed > limit:
        x, y = x * limit / speed, y * limit / speed
    return x, y


@dataclass(frozen=True)
class Tangent(CrowdModel):
    """Vision-based model: agents that would pass too close choose the smallest velocity change that avoids it.

    Velocities that just avoid a neighbour are on two tangents in velocity space. The agent that would arrive second at
    a crossing gives way early and passes behind; the first one reacts only shortly before contact. In nearly head-on or
    parallel encounters, and with agents that do not give way (external or at rest), agents pass on the nearer side. The
    smallest velocity change that avoids all neighbours is chosen; if there is none, the velocity that is safe the
    longest. An agent whose personal area is entered moves straight away from the nearest neighbour, slightly faster
    than it. The velocity changes by at most the comfort speed per second.

    Args:
        personal_area: radius of the personal area [m]; at least the radius of the body.
        direction_error: error of perceived directions (g_beta); larger values delay the reaction, 0 gives no delay.
        speed_error: error of perceived speeds (g_gamma), with the same effect.
        time_horizon: maximum time before contact at which an agent reacts [s].
        wall_horizon: time horizon for walls [s].
        neighbor_distance: maximum distance of neighbours [m].
        max_neighbors: maximum number of neighbours, the nearest first.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    The comfort speed is the preferred speed of the scene, or the length of the preferred velocity. The constraint of
    walls is specific to crowdbot: the speed towards a wall is limited so that it is reached at the end of the horizon.

    The default uses the geometry of the paper. Reaction time and braking are fitted to the implementation in the
    CrowdBot simulator; the law of perception errors of the paper is not reproduced.

    Source: Pettré, Ondřej, Olivier, Cretual, Donikian 2009, doi:10.1145/1599470.1599495.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> crossing = Scene.of([[-2.1, 0], [0, -2]], [[1, 0], [0, 1]], goal=[[9, 0], [0, 9]], preferred_speed=1.0)
    >>> Tangent().velocity(crossing, dt=0.1).round(3).tolist()
    [[[0.918, -0.057], [0.0, 1.0]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Julien Pettré, Jan Ondřej, Anne-Hélène Olivier, Armel Cretual, Stéphane Donikian",
        2009,
        "Experiment-based modeling, simulation and validation of interactions between virtual walkers",
        "Symposium on Computer Animation (SCA)",
        "10.1145/1599470.1599495",
    )
    batched = True
    valid_range = ModelRange(0.5, JAMS, 0.1, TWO_WAY, "CrowdBot simulator")

    personal_area: PerAgent = parameter(0.33, unit="m", low=0.15, high=0.6, source="CrowdBot simulator")
    direction_error: PerAgent = parameter(0.5, unit="1", low=0.0, high=1.0, source="CrowdBot simulator (g_beta)")
    speed_error: PerAgent = parameter(0.25, unit="1", low=0.0, high=1.0, source="CrowdBot simulator (g_gamma)")
    time_horizon: PerAgent = parameter(15.0, unit="s", low=1.0, high=15.0, source="CrowdBot simulator")
    wall_horizon: PerAgent = parameter(1.5, unit="s", low=0.5, high=4.0, source="chosen", min=1e-3)
    neighbor_distance: PerAgent = parameter(15.0, unit="m", low=3.0, high=15.0, source="CrowdBot simulator")
    max_neighbors: PerAgent = parameter(15.0, unit="1", low=1.0, high=20.0, source="CrowdBot simulator")
    max_speed: PerAgent | None = None

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        wish, walking, seen, out = begin_step(scene, dt)

        def each(name: str) -> Floats:
            return per_agent(getattr(self, name), scene.shape, name)

        near = neighbors_of(self, scene, seen, walking)
        comfort, remaining = _comfort_speed(scene, wish)
        with np.errstate(divide="ignore"):  # without errors, agents react immediately
            errors = (each("direction_error") / 0.5) ** 0.62 * (each("speed_error") / 0.25) ** 0.38
            reaction = REACTION / errors
        crowd = _Crowd(
            rows(scene.position), rows(scene.velocity), rows(wish), rows(comfort), rows(remaining),
            rows(scene.radius), rows(np.maximum(each("personal_area"), scene.radius)),
            rows(speed_limit(self.max_speed, scene)), rows(reaction), rows(each("time_horizon")),
            rows(each("wall_horizon")), rows(scene.external), rows(walking),
        )  # fmt: skip
        _choose(crowd, near, scene.walls.segments(), float(dt), rows(out))
        return out


def _comfort_speed(scene: Scene, wish: Floats) -> tuple[Floats, Floats]:
    """Return comfort speeds [m/s] and distances to the goal [m], each ``[E, A]``."""
    if scene.preferred_velocity is not None:
        return np.sqrt(wish[..., 0] ** 2 + wish[..., 1] ** 2), np.full(scene.shape, np.inf)
    away = np.where(scene.active[..., None], scene.goal - scene.position, 0.0)
    return np.where(scene.active, scene.preferred_speed, 0.0), np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
