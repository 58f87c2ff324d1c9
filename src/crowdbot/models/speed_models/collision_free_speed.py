"""CollisionFreeSpeed: direction from repulsion, speed from the gap ahead (Tordeux, Chraibi, Seyfried 2016)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.models.model import (
    CrowdModel,
    begin_step,
    check_limit,
    launch,
    neighbors_of,
    rows,
    speed_limit,
)

__all__ = ["CollisionFreeSpeed", "is_hidden", "way_to", "within"]

Floats = NDArray[np.float64]

STEEPEST = 100.0
"""Upper limit of exponents, against overflow; only the direction of a strong repulsion matters."""
APART = 1e-9
"""Assumed distance of agents at the same position [m], along x, the first of them on the right."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    heading: Floats
    desired: Floats
    radius: Floats
    max_speed: Floats
    strength: Floats
    range: Floats
    wall_strength: Floats
    wall_range: Floats
    time_gap: Floats
    reach: Floats
    walking: NDArray[np.bool_]


@kernel
def within(walls: Floats, x: float, y: float, reach: float, found: NDArray[np.int64]) -> int:
    """Write the indices of the ``walls`` within ``reach`` of x, y to ``found``; return their number."""
    count = int(np.int64(0))  # a literal 0 has its own type, which compiles the callees twice
    for m in range(len(walls)):
        nx, ny = nearest_on_segment(x, y, walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3])
        if (nx - x) ** 2 + (ny - y) ** 2 <= reach * reach:
            found[count] = m
            count += 1
    return count


@kernel
def is_hidden(walls: Floats, found: NDArray[np.int64], count: int, x: float, y: float, dx: float, dy: float) -> bool:
    """Return whether one of the found walls crosses or touches the line of sight from x, y to x + dx, y + dy."""
    for n in range(count):
        m = found[n]
        ax, ay, bx, by = walls[m, 0] - x, walls[m, 1] - y, walls[m, 2] - x, walls[m, 3] - y
        ex, ey = bx - ax, by - ay
        side_a, side_b = dx * ay - dy * ax, dx * by - dy * bx
        side_x, side_o = ay * ex - ax * ey, (dx - ax) * ey - (dy - ay) * ex
        # each segment separates the ends of the other one
        if side_a * side_b <= 0.0 and side_x * side_o <= 0.0 and (side_a != 0.0 or side_b != 0.0):
            return True
    return False


@kernel
def way_to(dx: float, dy: float, ex: float, ey: float, reach: float) -> float:
    """Return the free distance [m] to a neighbour at dx, dy in direction e; inf if it is not in the way."""
    if ex * dx + ey * dy < 0.0 or abs(ex * dy - ey * dx) > reach:
        return math.inf
    return math.sqrt(dx * dx + dy * dy) - reach


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, walls: Floats, out: Floats) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, out)


@kernel
def _choose_part(begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: Floats, out: Floats) -> None:
    # unpack the tuples outside of the loop: each access counts references
    place, heading, desired, radius, top, strength, scale, wall_strength, wall_scale, gap, reach, walking = crowd
    agent, number, order = near
    A = agent.shape[1]
    found = np.empty(len(walls), dtype=np.int64)
    seen = np.empty((agent.shape[2], 3))  # relative position of each visible neighbour, and sum of the radii
    for k in range(begin, end):
        row = order[k]
        wish = math.sqrt(desired[row, 0] ** 2 + desired[row, 1] ** 2)
        if not walking[row] or wish == 0.0:
            continue
        e, a = row // A, row % A
        x, y = place[row, 0], place[row, 1]
        ux, uy = desired[row, 0] / wish, desired[row, 1] / wish
        count = within(walls, x, y, reach[row], found)
        held = 0
        for n in range(number[e, a]):
            other = row - a + agent[e, a, n]
            dx, dy = place[other, 0] - x, place[other, 1] - y
            if is_hidden(walls, found, count, x, y, dx, dy):
                continue
            if dx == 0.0 and dy == 0.0:
                dx = -APART if row < other else APART
            distance, contact = math.sqrt(dx * dx + dy * dy), radius[row] + radius[other]
            push = strength[row] * math.exp(min((contact - distance) / scale[row], STEEPEST))
            ux -= push * dx / distance
            uy -= push * dy / distance
            seen[held, 0], seen[held, 1], seen[held, 2] = dx, dy, contact
            held += 1
        for n in range(count):
            m = found[n]
            nx, ny = nearest_on_segment(x, y, walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3])
            distance = math.sqrt((x - nx) ** 2 + (y - ny) ** 2)
            if distance > 0.0:
                push = wall_strength[row] * math.exp(min((radius[row] - distance) / wall_scale[row], STEEPEST))
                ux += push * (x - nx) / distance
                uy += push * (y - ny) / distance
        length = math.sqrt(ux * ux + uy * uy)
        if length > 0.0:
            ux, uy = ux / length, uy / length
        else:
            ux, uy = math.cos(heading[row]), math.sin(heading[row])
        speed = min(wish, top[row])
        for n in range(held if gap[row] > 0.0 else 0):
            speed = min(speed, max(0.0, way_to(seen[n, 0], seen[n, 1], ux, uy, seen[n, 2])) / gap[row])
        out[row, 0], out[row, 1] = speed * ux, speed * uy


@dataclass(frozen=True)
class CollisionFreeSpeed(CrowdModel):
    """First-order model: neighbours and walls deflect the direction; the gap ahead and a time gap limit the speed.

    Args:
        strength: strength of the repulsion between agents, relative to 1 for the desired direction.
        range: decay length of the repulsion between agents [m].
        wall_strength: strength of the repulsion by walls, relative to 1 for the desired direction.
        wall_range: decay length of the repulsion by walls [m].
        time_gap: time gap to the next agent ahead at the chosen speed [s]; 0: the space ahead does not limit the speed,
            which is then left to the headway layer.
        neighbor_distance: maximum distance of neighbours and walls [m]; neighbours behind a wall are ignored.
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    The model has no inertia: direction and speed may jump, and agents never walk backwards. The speed avoids contact
    with the agent straight ahead; walls change only the direction.

    The default follows version 2 of the model in JuPedSim 1.4.2. Neighbourhoods are limited by distance and by number.

    Source: Tordeux, Chraibi, Seyfried 2016, doi:10.1007/978-3-319-33482-0_29, as version 2 of JuPedSim 1.4.2.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> behind = Scene.of([[0, 0], [0.9, 0]], radius=0.2, goal=[[9, 0], [9, 0]])
    >>> CollisionFreeSpeed().velocity(behind, dt=0.1).round(2).tolist()
    [[[0.5, 0.0], [1.3, 0.0]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Antoine Tordeux, Mohcine Chraibi, Armin Seyfried",
        2016,
        "Collision-free speed model for pedestrian dynamics",
        "Traffic and Granular Flow '15",
        "10.1007/978-3-319-33482-0_29",
    )

    strength: PerAgent = parameter(8.0, unit="1", low=1.0, high=15.0, source="JuPedSim 1.4.2")
    range: PerAgent = parameter(0.1, unit="m", low=0.02, high=0.5, source="JuPedSim 1.4.2", min=1e-3)
    wall_strength: PerAgent = parameter(5.0, unit="1", low=1.0, high=15.0, source="JuPedSim 1.4.2")
    wall_range: PerAgent = parameter(0.02, unit="m", low=0.01, high=0.2, source="JuPedSim 1.4.2", min=1e-3)
    time_gap: PerAgent = parameter(1.0, unit="s", low=0.3, high=2.0, source="JuPedSim 1.4.2")
    neighbor_distance: PerAgent = parameter(3.0, unit="m", low=1.0, high=5.0, source="JuPedSim 1.4.2")
    max_neighbors: PerAgent = parameter(50.0, unit="1", low=5.0, high=100.0, source="crowdbot: more are never needed")
    max_speed: PerAgent | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_limit(self, self.max_speed)

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        """Return the velocities ``[E, A, 2]`` [m/s] for the next ``dt`` [s]; ``rng`` is not used."""
        wish, walking, seen, out = begin_step(scene, dt)

        def value(name: str) -> Floats:
            return per_agent(getattr(self, name), scene.shape, name)

        near = neighbors_of(self, scene, seen, walking)
        crowd = _Crowd(
            rows(scene.position),
            rows(scene.heading),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            rows(value("strength")),
            rows(value("range")),
            rows(value("wall_strength")),
            rows(value("wall_range")),
            rows(value("time_gap")),
            rows(value("neighbor_distance")),
            rows(walking),
        )
        launch(_choose, _choose_part, rows(out), crowd, near, scene.walls.segments())
        return out
