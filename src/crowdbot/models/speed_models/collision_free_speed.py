"""CollisionFreeSpeed: direction from repulsion, speed from the gap ahead (Tordeux, Chraibi, Seyfried 2016)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, prange
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.models.agent_rows import LIMIT, RADIUS, WISH_X, WISH_Y, X, Y, begin_rows
from crowdbot.models.model import CrowdModel, launch, rows
from crowdbot.models.parameter_rows import parameter_rows
from crowdbot.models.valid_range import JAMS, JUPEDSIM, PAGE, ModelRange
from crowdbot.typing import Bools, Floats

__all__ = ["CollisionFreeSpeed", "is_hidden", "nearest_on_segment", "push_by_walls", "way_to", "within"]


STEEPEST = 100.0
"""Upper limit of exponents, against overflow; only the direction of a strong repulsion matters."""
LAW = ("strength", "range", "wall_strength", "wall_range", "time_gap", "neighbor_distance", "oncoming")
APART = 1e-9
"""Assumed distance of agents at the same position [m], along x, the first of them on the right."""


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


@kernel
def push_by_walls(
    walls: Floats, found: NDArray[np.int64], count: int, x: float, y: float, radius: float, strength: float,
    scale: float, ux: float, uy: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the unit vector along u with the repulsion by the found walls, or zeros if the sum is 0."""
    for n in range(count):
        m = found[n]
        nx, ny = nearest_on_segment(x, y, walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3])
        distance = math.sqrt((x - nx) ** 2 + (y - ny) ** 2)
        if distance > 0.0:
            push = strength * math.exp(min((radius - distance) / scale, STEEPEST))
            ux += push * (x - nx) / distance
            uy += push * (y - ny) / distance
    length = math.sqrt(ux * ux + uy * uy)
    return (ux / length, uy / length) if length > 0.0 else (0.0, 0.0)


@kernel(parallel=True)
def _choose(
    agents: Floats, walking: Bools, heading: Floats, laws: Floats, near: Neighbors, walls: Floats, out: Floats
) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        end = min((part + 1) * CHUNK, len(out))
        _choose_part(part * CHUNK, end, agents, walking, heading, laws, near, walls, out)


@kernel
def _choose_part(
    begin: int, end: int, agents: Floats, walking: Bools, heading: Floats, laws: Floats, near: Neighbors,
    walls: Floats, out: Floats,
) -> None:  # fmt: skip
    # unpack the tuples outside of the loop: each access counts references
    agent, number, order = near
    A = agent.shape[1]
    found = np.empty(len(walls), dtype=np.int64)
    # of each visible neighbour: relative position, sum of the radii, distance, repulsion and its components
    aside, along, contact = np.empty(agent.shape[2]), np.empty(agent.shape[2]), np.empty(agent.shape[2])
    distance, push, push_x, push_y = (
        np.empty(agent.shape[2]), np.empty(agent.shape[2]), np.empty(agent.shape[2]), np.empty(agent.shape[2])
    )  # fmt: skip
    strength = np.empty(agent.shape[2])
    for k in range(begin, end):
        row = order[k]
        wish = math.sqrt(agents[row, WISH_X] ** 2 + agents[row, WISH_Y] ** 2)
        if not walking[row] or wish == 0.0:
            continue
        e, a, law = row // A, row % A, row if len(laws) > 1 else 0
        shared = e % len(agent)  # copies of an environment have the same neighbours
        x, y, radius = agents[row, X], agents[row, Y], agents[row, RADIUS]
        ux, uy = agents[row, WISH_X] / wish, agents[row, WISH_Y] / wish
        count = within(walls, x, y, laws[law, 5], found)
        held = int(np.int64(0))  # a literal 0 has its own type, which compiles the callees twice
        for n in range(number[e, a]):
            other = row - a + agent[shared, a, n]
            dx, dy = agents[other, X] - x, agents[other, Y] - y
            if count > 0 and is_hidden(walls, found, count, x, y, dx, dy):
                continue
            if dx == 0.0 and dy == 0.0:
                dx = -APART if row < other else APART
            aside[held], along[held], contact[held] = dx, dy, radius + agents[other, RADIUS]
            against = agents[other, WISH_X] * agents[row, WISH_X] + agents[other, WISH_Y] * agents[row, WISH_Y] < 0.0
            strength[held] = laws[law, 0] * (laws[law, 6] if against else 1.0)
            held += 1
        _repel(aside, along, contact, held, strength, laws[law, 1], distance, push, push_x, push_y)
        for n in range(held):  # one after the other: the order of a sum decides on its last bits
            ux, uy = ux - push_x[n], uy - push_y[n]
        ux, uy = push_by_walls(walls, found, count, x, y, radius, laws[law, 2], laws[law, 3], ux, uy)
        if ux == 0.0 and uy == 0.0:
            ux, uy = math.cos(heading[row]), math.sin(heading[row])
        speed, gap = min(wish, agents[row, LIMIT]), laws[law, 4]
        if gap > 0.0:
            free = math.inf
            for n in range(held):
                # no branch: none could foresee it
                ahead = (ux * aside[n] + uy * along[n] >= 0.0) & (abs(ux * along[n] - uy * aside[n]) <= contact[n])
                free = min(free, distance[n] - contact[n] if ahead else math.inf)
            speed = min(speed, max(0.0, free) / gap)
        out[row, 0], out[row, 1] = speed * ux, speed * uy


@kernel(inline=True)
def _repel(
    aside: Floats, along: Floats, contact: Floats, held: int, strength: Floats, scale: float, distance: Floats,
    push: Floats, push_x: Floats, push_y: Floats,
) -> None:  # fmt: skip
    """Write distance, repulsion and its components for each neighbour, in loops that the compiler vectorizes."""
    for n in range(held):
        distance[n] = math.sqrt(aside[n] * aside[n] + along[n] * along[n])
    for n in range(held):
        push[n] = min((contact[n] - distance[n]) / scale, STEEPEST)
    for n in range(held):
        push[n] = strength[n] * math.exp(push[n])
    for n in range(held):
        push_x[n] = push[n] * aside[n] / distance[n]
    for n in range(held):
        push_y[n] = push[n] * along[n] / distance[n]


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
        oncoming: share of the repulsion by neighbours who want to walk the other way, 0 to 1.
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
    batched = True
    valid_range = ModelRange(3.0, JAMS, 0.01, PAGE, JUPEDSIM)

    strength: PerAgent = parameter(8.0, unit="1", low=1.0, high=15.0, source="JuPedSim 1.4.2")
    range: PerAgent = parameter(0.1, unit="m", low=0.02, high=0.5, source="JuPedSim 1.4.2", min=1e-3)
    wall_strength: PerAgent = parameter(5.0, unit="1", low=1.0, high=15.0, source="JuPedSim 1.4.2")
    wall_range: PerAgent = parameter(0.02, unit="m", low=0.01, high=0.2, source="JuPedSim 1.4.2", min=1e-3)
    time_gap: PerAgent = parameter(1.0, unit="s", low=0.3, high=2.0, source="JuPedSim 1.4.2")
    oncoming: PerAgent = parameter(1.0, unit="1", low=0.0, high=1.0, source="off by default", max=1.0)
    neighbor_distance: PerAgent = parameter(3.0, unit="m", low=1.0, high=5.0, source="JuPedSim 1.4.2")
    max_neighbors: PerAgent = parameter(50.0, unit="1", low=5.0, high=100.0, source="crowdbot: more are never needed")
    max_speed: PerAgent | None = None

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        start = begin_rows(scene, dt, self.max_speed)
        near = start.neighbors(self.neighbor_distance, self.max_neighbors)
        laws, heading = parameter_rows(self, LAW, scene.shape), rows(scene.heading)
        values = start.agents, start.walking, heading, laws, near, scene.walls.segments()
        launch(_choose, _choose_part, start.out, *values)
        return start.velocity
