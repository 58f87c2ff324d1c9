"""Heuristics: vision-based choice of direction and speed, with contact forces (Moussaid et al. 2011)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.core.geometry import nearest_on_segment, ray_to_disc, time_to_segment
from crowdbot.models.model import CrowdModel, begin_step, launch, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import parameter_columns
from crowdbot.models.valid_range import JAMS, TWO_WAY, UMANS, ModelRange
from crowdbot.typing import Floats, Ints

ANGLES = 61
"""Number of candidate directions: the desired one and as many on each side."""
EQUAL = 1e-9
"""Minimum advantage of another direction as a fraction of the largest cost, against rounding."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    desired: Floats
    radius: Floats
    max_speed: Floats
    field: Floats
    sight: Floats
    relaxation: Floats
    stiffness: Floats
    walking: NDArray[np.bool_]


@kernel
def _write_fan(ux: float, uy: float, widest: float, left_first: bool, fan: Floats) -> None:
    """Write unit directions to ``fan``: u first, then alternately to both sides in equal steps up to ``widest``.

    The third column is the cosine of the angle to u.
    """
    step = 2.0 * widest / (len(fan) - 1)
    turn = step if left_first else -step
    cos, sin = math.cos(turn), math.sin(turn)
    c, s = 1.0, 0.0
    fan[0, 0], fan[0, 1], fan[0, 2] = ux, uy, 1.0
    for k in range(1, len(fan), 2):
        c, s = c * cos - s * sin, s * cos + c * sin
        fan[k, 0], fan[k, 1], fan[k, 2] = c * ux - s * uy, s * ux + c * uy, c
        fan[k + 1, 0], fan[k + 1, 1], fan[k + 1, 2] = c * ux + s * uy, -s * ux + c * uy, c


@kernel
def _shorten_by_agent(
    x: float, y: float, vx: float, vy: float, reach: float, speed: float, fan: Floats, free: Floats
) -> None:
    """Limit the free paths by a neighbour: x, y is the vector from it to the agent, v its velocity."""
    c = x * x + y * y - reach * reach
    for k in range(len(fan)):
        wx, wy = speed * fan[k, 0] - vx, speed * fan[k, 1] - vy
        a, b = wx * wx + wy * wy, x * wx + y * wy
        root = b * b - a * c
        if b < 0.0 and root > 0.0:  # bodies in contact block only approaching agents
            free[k] = min(free[k], speed * max(0.0, c) / (math.sqrt(root) - b))


@kernel
def _time_to_wall(
    x: float, y: float, vx: float, vy: float, radius: float, ax: float, ay: float, bx: float, by: float
) -> float:
    """Return the time until a disc touches segment a-b; in contact, 0 if it approaches, otherwise inf."""
    nx, ny = nearest_on_segment(x, y, ax, ay, bx, by)
    nx, ny = x - nx, y - ny
    if nx * nx + ny * ny > radius * radius:
        return time_to_segment(x, y, vx, vy, radius, ax, ay, bx, by)
    return 0.0 if nx * vx + ny * vy < 0.0 else math.inf


@kernel
def _contact_acceleration(dx: float, dy: float, reach: float, stiffness: float, side: float) -> tuple[float, float]:
    """Return the acceleration by contact with a body at -dx, -dy; 0 beyond ``reach``."""
    distance = math.sqrt(dx * dx + dy * dy)
    if distance >= reach:
        return 0.0, 0.0
    if distance == 0.0:
        return side * stiffness * reach, 0.0
    push = stiffness * (reach - distance) / distance
    return push * dx, push * dy


@kernel
def _write_free_paths(
    row: int, others: Ints, place: Floats, velocity: Floats, radius: Floats, walls: Floats, sight: float, speed: float,
    fan: Floats, free: Floats,
) -> None:  # fmt: skip
    """Write the path length at ``speed`` before a contact in each direction to ``free``, at most ``sight``."""
    x, y, r = place[row, 0], place[row, 1], radius[row]
    free[:] = sight
    for o in others:
        reach = r + radius[o]
        _shorten_by_agent(x - place[o, 0], y - place[o, 1], velocity[o, 0], velocity[o, 1], reach, speed, fan, free)
    for m in range(len(walls)):
        ax, ay, bx, by = walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3]
        nx, ny = nearest_on_segment(x, y, ax, ay, bx, by)
        if (nx - x) ** 2 + (ny - y) ** 2 < (sight + r) ** 2:
            for k in range(len(fan)):
                free[k] = min(free[k], _time_to_wall(x, y, fan[k, 0], fan[k, 1], r, ax, ay, bx, by))


@kernel
def _most_direct(sight: float, fan: Floats, free: Floats) -> int:
    """Return the direction whose free path ends nearest to the point at ``sight`` in the desired direction."""
    best, least = 0, math.inf
    for k in range(len(fan)):
        cost = sight * sight + free[k] * free[k] - 2.0 * sight * free[k] * fan[k, 2]
        if cost < least - EQUAL * sight * sight:
            best, least = k, cost
    return best


@kernel
def _free_distance(row: int, others: Ints, place: Floats, radius: Floats, walls: Floats, ux: float, uy: float) -> float:
    """Return the free distance along u with all other agents at rest."""
    x, y, r = place[row, 0], place[row, 1], radius[row]
    way = math.inf
    for o in others:
        if ux * (place[o, 0] - x) + uy * (place[o, 1] - y) > 0.0:
            way = min(way, ray_to_disc(x, y, ux, uy, place[o, 0], place[o, 1], r + radius[o]))
    for m in range(len(walls)):
        way = min(way, _time_to_wall(x, y, ux, uy, r, walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3]))
    return way


@kernel
def _sum_contacts(
    row: int, others: Ints, place: Floats, radius: Floats, walls: Floats, stiffness: float
) -> tuple[float, float]:
    """Return the sum of the contact accelerations by bodies and walls."""
    x, y, r = place[row, 0], place[row, 1], radius[row]
    fx, fy = 0.0, 0.0
    for o in others:
        side = -1.0 if row < o else 1.0
        px, py = _contact_acceleration(x - place[o, 0], y - place[o, 1], r + radius[o], stiffness, side)
        fx, fy = fx + px, fy + py
    for m in range(len(walls)):
        nx, ny = nearest_on_segment(x, y, walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3])
        px, py = _contact_acceleration(x - nx, y - ny, r, stiffness, 0.0)
        fx, fy = fx + px, fy + py
    return fx, fy


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, out: Floats) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, dt, out)


@kernel
def _choose_part(begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, out: Floats) -> None:
    # unpack the tuples outside of the loop: each access counts references
    place, velocity, desired, radius, top, field, sight, relaxation, stiffness, walking = crowd
    agent, number, order = near
    A = agent.shape[1]
    fan, free = np.empty((ANGLES, 3)), np.empty(ANGLES)
    near_rows = np.empty(agent.shape[2], dtype=np.int64)
    for k in range(begin, end):
        row = order[k]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        for n in range(number[e, a]):
            near_rows[n] = row - a + agent[e, a, n]
        others = near_rows[: number[e, a]]
        vx, vy = velocity[row, 0], velocity[row, 1]
        speed = math.sqrt(desired[row, 0] ** 2 + desired[row, 1] ** 2)
        ux, uy = 0.0, 0.0
        if speed > 0.0:
            ux, uy = desired[row, 0] / speed, desired[row, 1] / speed
            _write_fan(ux, uy, field[row], ux * vy - uy * vx > EQUAL * speed, fan)
            _write_free_paths(row, others, place, velocity, radius, walls, sight[row], speed, fan, free)
            best = _most_direct(sight[row], fan, free)
            ux, uy = fan[best, 0], fan[best, 1]
            speed = min(speed, _free_distance(row, others, place, radius, walls, ux, uy) / relaxation[row])
        fx, fy = _sum_contacts(row, others, place, radius, walls, stiffness[row])
        vx += ((speed * ux - vx) / relaxation[row] + fx) * dt
        vy += ((speed * uy - vy) / relaxation[row] + fy) * dt
        shorter = min(1.0, top[row] / max(math.sqrt(vx * vx + vy * vy), 1e-300))
        out[row, 0], out[row, 1] = shorter * vx, shorter * vy


@dataclass(frozen=True)
class Heuristics(CrowdModel):
    """Two heuristics: the direction that leads closest to the goal, and a speed that leaves a fixed time to stop.

    Args:
        field_of_view: half field of view around the desired direction [rad].
        sight_distance: range of vision [m].
        relaxation_time: time gap to obstacles ahead, and time constant of the velocity [s]; at least the time step.
        contact_stiffness: acceleration per metre of overlap between bodies, and with walls [1/s^2]; limited to the
            value that resolves the overlap in one time step.
        neighbor_distance: maximum distance of neighbours [m].
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    In direction a, the free path f(a) is the distance at the desired speed to the first contact with a wall or a moving
    neighbour. Of 61 directions, the model chooses the one whose free path ends nearest to the point at sight distance
    in the desired direction (ties: on the side of the current velocity, otherwise on the right). The speed is
    min(desired, free path with all others at rest / relaxation time).

    The default follows the paper. Differences: the field of view is centred on the desired direction, and agents in
    contact are blocked only in the direction of contact.

    Source: Moussaid, Helbing, Theraulaz 2011, doi:10.1073/pnas.1016507108.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> meeting = Scene.of([[0, 0], [5, 0.1]], [[1.3, 0], [-1.3, 0]], goal=[[9, 0], [-9, 0.1]])
    >>> Heuristics().velocity(meeting, dt=0.1).round(3).tolist()
    [[[1.296, -0.045], [-1.296, 0.045]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Mehdi Moussaïd, Dirk Helbing, Guy Theraulaz",
        2011,
        "How simple rules determine pedestrian behavior and crowd disasters",
        "PNAS",
        "10.1073/pnas.1016507108",
    )
    batched = True
    valid_range = ModelRange(0.5, JAMS, 0.1, TWO_WAY, UMANS)

    field_of_view: PerAgent = parameter(
        math.radians(75.0), unit="rad", low=0.5, high=math.pi / 2, source="Moussaid et al. 2011, 75 degrees"
    )
    sight_distance: PerAgent = parameter(10.0, unit="m", low=2.0, high=15.0, source="Moussaid et al. 2011", min=1e-2)
    relaxation_time: PerAgent = parameter(0.5, unit="s", low=0.1, high=1.5, source="Moussaid et al. 2011")
    contact_stiffness: PerAgent = parameter(
        62.5, unit="1/s^2", low=10.0, high=200.0, source="Moussaid et al. 2011, 5000 kg/s^2 at 80 kg"
    )
    neighbor_distance: PerAgent = parameter(10.0, unit="m", low=2.0, high=15.0, source="the sight distance")
    max_neighbors: PerAgent = parameter(20.0, unit="1", low=1.0, high=40.0, source="chosen here")
    max_speed: PerAgent | None = None

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        wish, walking, seen, out = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        relaxation = np.maximum(per_agent(self.relaxation_time, scene.shape, "relaxation_time"), dt)
        stiffness = np.minimum(per_agent(self.contact_stiffness, scene.shape, "contact_stiffness"), 1.0 / dt**2)
        values = (
            rows(scene.position),
            rows(scene.velocity),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            *parameter_columns(self, scene.shape, "field_of_view", "sight_distance"),
            rows(relaxation),
            rows(stiffness),
            rows(walking),
        )
        crowd = _Crowd._make(values)
        launch(_choose, _choose_part, rows(out), crowd, near, scene.walls.segments(), float(dt))
        return out
