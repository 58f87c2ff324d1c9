"""Contact model of the crowd: resolves overlaps between people, and between people and walls, after a step."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import CHUNK, SMALL, Neighbors, Scene, kernel, prange
from crowdbot.core.fields import attribute, check
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.core.neighbors import nearest
from crowdbot.core.outlines import Outlines, point_to_outline, to_frame
from crowdbot.typing import Bools, Floats, Ints, Rows

from .agent_arrays import BOOL, FLOAT, dense
from .wall_cells import WallCells
from .wall_crossing import (
    PASSES,
    ContactSurfaces,
    cell_index,
    first_crossing,
    gather_bodies,
    project_off_wall,
    shift_bodies,
)


def find_close_bodies(position: Floats, reach: Floats, most: int, seen: Bools, asking: Bools) -> Neighbors:
    """Return the nearest neighbors within short distances, equal to those of :func:`crowdbot.core.nearest`.

    Args:
        position: ``[E, A, 2]`` [m].
        reach: ``[E, A]`` distance of neighbors [m], exclusive.
        most: maximum number of neighbors.
        seen: ``[E, A]`` whether an agent can be a neighbor.
        asking: ``[E, A]`` whether to search the neighbors of an agent.

    >>> place, all_ = np.array([[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]]), np.ones((1, 3), dtype=bool)
    >>> find_close_bodies(place, np.full((1, 3), 1.5), 8, all_, all_).number.tolist()
    [[1, 1, 2]]
    """
    E, A = position.shape[:2]
    agent = np.empty((E, A, max(0, min(most, A - 1))), dtype=np.int32)
    number, fits = np.zeros((E, A), dtype=np.int32), np.ones(E, dtype=np.bool_)
    if E * A <= SMALL:
        _sweep_range(0, E, position, reach, seen, asking, agent, number, fits)
    else:
        _sweep(position, reach, seen, asking, agent, number, fits)
    if not fits.all():
        return nearest(position, reach, most, seen, asking)
    return Neighbors(agent, number, np.arange(E * A, dtype=np.int32))


@kernel(parallel=True)
def _sweep(position: Floats, reach: Floats, seen: Bools, asking: Bools, agent: Rows, number: Rows, fits: Bools) -> None:
    for k in prange(len(fits)):
        e: Any = np.int64(k)  # the index is unsigned: the call would be compiled twice
        _sweep_range(e, e + 1, position, reach, seen, asking, agent, number, fits)


@kernel
def _sweep_range(
    begin: int, end: int, position: Floats, reach: Floats, seen: Bools, asking: Bools, agent: Rows, number: Rows,
    fits: Bools,
) -> None:  # fmt: skip
    """Write the neighbors of the agents of some environments; ``fits`` is False if there are too many."""
    A = number.shape[1]
    key, gap2 = np.empty(A), np.empty(agent.shape[1:])
    for e in range(begin, end):
        longest = 0.0
        for a in range(A):
            x = position[e, a, 0]
            key[a] = x if (seen[e, a] or asking[e, a]) and math.isfinite(x) else math.inf
            longest = max(longest, reach[e, a])
        order = np.argsort(key, kind="mergesort")  # the sort that the sensors have compiled, too
        for i in range(A):
            a = order[i]
            for j in range(i + 1, A):
                b = order[j]
                if not key[b] - key[a] < longest:
                    break
                dx, dy = position[e, b, 0] - position[e, a, 0], position[e, b, 1] - position[e, a, 1]
                d2 = dx * dx + dy * dy
                if asking[e, a] and seen[e, b] and d2 < reach[e, a] * reach[e, a]:
                    fits[e] = _insert(agent[e, a], gap2[a], number[e], a, b, d2) and fits[e]
                if asking[e, b] and seen[e, a] and d2 < reach[e, b] * reach[e, b]:
                    fits[e] = _insert(agent[e, b], gap2[b], number[e], b, a, d2) and fits[e]


@kernel
def _insert(near: Rows, gap2: Floats, number: Rows, a: int, b: int, d2: float) -> bool:
    """Insert a neighbor b of agent a in the order of distance, then of index; return False if there is no space."""
    k = int(number[a])
    if k == len(near):
        return False
    while k > 0 and (gap2[k - 1] > d2 or (gap2[k - 1] == d2 and near[k - 1] > b)):
        gap2[k], near[k] = gap2[k - 1], near[k - 1]
        k -= 1
    gap2[k], near[k] = d2, b
    number[a] += 1
    return True


MOST = 24
"""Maximum number of neighbors that push a person at the same time, nearest first."""
TOUCH = 1.0 - 1e-4
"""Fraction of the contact distance at which two bodies, or a body and a wall, count as separated."""
ALONE = 8
"""Minimum number of environments for which each is the work of one thread."""
GOLDEN = math.pi * (3.0 - math.sqrt(5.0))


class _Bodies(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    before: Floats
    chosen: Floats
    radius: Floats
    pushed: Bools
    """Whether a push can move the agent."""
    heading: Floats
    corner: Floats
    first: Ints
    """Outlines by index in an environment, see :class:`Outlines`."""


@kernel(parallel=True)
def _push_environments(
    environments: int, iterations: int, bodies: _Bodies, near: Neighbors, cells: WallCells, solid: Bools, gain: float,
    now: Floats, moved: Bools, then: Floats, moves: Bools,
) -> None:  # fmt: skip
    """Push all agents, each environment in one thread, and leave their positions in ``now``."""
    A = len(now) // environments
    for e in prange(environments):
        _push_range(e * A, (e + 1) * A, iterations, bodies, near, cells, solid, gain, now, moved, then, moves)


@kernel
def _push_range(
    begin: int, end: int, iterations: int, bodies: _Bodies, near: Neighbors, cells: WallCells, solid: Bools,
    gain: float, now: Floats, moved: Bools, then: Floats, moves: Bools,
) -> None:  # fmt: skip
    """Push the agents of whole environments until nobody moves, and leave their positions in ``now``."""
    place, other = now, then
    for _ in range(iterations):
        _push_part(begin, end, bodies, near, cells, solid, gain, place, moved, other, moves)
        place, other, moved, moves = other, place, moves, moved
        some = False
        for row in range(begin, end):
            some = some or moved[row]
        if not some:
            break
    for row in range(begin, end):
        now[row, 0], now[row, 1] = place[row, 0], place[row, 1]


@kernel(parallel=True)
def _push(
    bodies: _Bodies, near: Neighbors, cells: WallCells, solid: Bools, gain: float, place: Floats, moved: Bools,
    out: Floats, moves: Bools,
) -> None:  # fmt: skip
    """Push all agents once, from ``place`` to ``out``.

    ``moved`` marks the agents pushed in the last iteration, ``moves`` in this one.
    """
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        begin, end = part * CHUNK, min((part + 1) * CHUNK, len(out))
        _push_part(begin, end, bodies, near, cells, solid, gain, place, moved, out, moves)


@kernel
def _push_part(
    begin: int, end: int, bodies: _Bodies, near: Neighbors, cells: WallCells, solid: Bools, gain: float,
    place: Floats, moved: Bools, out: Floats, moves: Bools,
) -> None:  # fmt: skip
    before, chosen, radius, pushed, heading, corner, first_corner = bodies
    agent, number, order = near
    wall, first, member, frame = cells
    A = agent.shape[1]
    for k in range(begin, end):
        row = order[k]
        x, y, r = place[row, 0], place[row, 1], radius[row]
        out[row, 0], out[row, 1], moves[row] = x, y, False
        e, a = row // A, row % A
        anew = moved[row]
        for n in range(number[e, a]):
            anew = anew or moved[row - a + agent[e, a, n]]
        if not pushed[row] or not anew:  # unchanged since the last iteration
            continue
        near_row = agent[e, a, : number[e, a]]
        px, py, count = _push_sum(row, near_row, row - a, place, before, radius, pushed, first_corner, gain)
        if len(corner) > 0:
            ox, oy, more = _push_off_outlines(row, near_row, row - a, place, radius, heading, corner, first_corner)
            px, py, count = px + ox, py + oy, count + more
        if count > 0:
            x, y = _apply_push(x, y, px, py, count, gain, chosen[row, 0], chosen[row, 1], r)
        if len(wall) > 0:
            x, y = _out_of_walls(wall, first, member, frame, solid, before[row, 0], before[row, 1], x, y, r)
        moves[row] = x != place[row, 0] or y != place[row, 1]
        out[row, 0], out[row, 1] = x, y


@kernel
def _push_sum(
    row: int, near: Rows, begin: int, place: Floats, before: Floats, radius: Floats, pushed: Bools, first: Ints,
    gain: float,
) -> tuple[float, float, int]:  # fmt: skip
    """Return the sum of the pushes of the neighbors that are discs, and their number."""
    px, py, count = 0.0, 0.0, 0
    for n in range(len(near)):
        other = begin + near[n]
        reach = radius[row] + radius[other]
        dx, dy = place[row, 0] - place[other, 0], place[row, 1] - place[other, 1]
        d2 = dx * dx + dy * dy
        if d2 >= (reach * TOUCH) ** 2 or first[near[n] + 1] > first[near[n]]:
            continue
        distance = math.sqrt(d2)
        if d2 == 0.0:
            dx, dy = _separation_direction(before, row, other)
        length = math.sqrt(dx * dx + dy * dy)
        share = 0.5 if pushed[other] or gain > 0.0 else 1.0
        px += share * (reach - distance) * dx / length
        py += share * (reach - distance) * dy / length
        count += 1
    return px, py, count


@kernel
def _push_off_outlines(
    row: int, near: Rows, begin: int, place: Floats, radius: Floats, heading: Floats, corner: Floats, first: Ints
) -> tuple[float, float, int]:
    """Return the sum of the pushes of the neighbors with an outline, which are never pushed, and their number."""
    px, py, count = 0.0, 0.0, 0
    for n in range(len(near)):
        other = begin + near[n]
        if first[near[n] + 1] == first[near[n]]:
            continue
        cos, sin = math.cos(heading[other]), math.sin(heading[other])
        x, y = to_frame(place[row, 0], place[row, 1], place[other, 0], place[other, 1], cos, sin)
        gap, bx, by = point_to_outline(x, y, corner, first[near[n]], first[near[n] + 1])
        if gap >= radius[row] * TOUCH:
            continue
        dx, dy = (x - bx, y - by) if gap > 0.0 else (bx - x, by - y)
        length = math.sqrt(dx * dx + dy * dy)
        if length == 0.0:  # on the border
            dx, dy = x, y
            length = max(math.sqrt(dx * dx + dy * dy), 1e-300)
        share = (radius[row] - gap) / length
        px, py, count = px + share * (cos * dx - sin * dy), py + share * (sin * dx + cos * dy), count + 1
    return px, py, count


@kernel
def _separation_direction(before: Floats, row: int, other: int) -> tuple[float, float]:
    """Return a direction that separates two agents at the same position, from previous positions or index."""
    dx, dy = before[row, 0] - before[other, 0], before[row, 1] - before[other, 1]
    if dx != 0.0 or dy != 0.0:
        return dx, dy
    side = 1.0 if row > other else -1.0
    angle = GOLDEN * abs(row - other)
    return side * math.cos(angle), side * math.sin(angle)


@kernel
def _apply_push(
    x: float, y: float, px: float, py: float, count: int, gain: float, cx: float, cy: float, r: float
) -> tuple[float, float]:
    """Return x, y after a push p of ``count`` bodies, at most r from c, the position chosen by the model.

    Position-based pushes (``gain`` 0) are averaged, with slight over-relaxation. Force-based pushes are added and
    damped to avoid overshoot.
    """
    share = 1.5 / (count + 0.5) if gain == 0.0 else 2.0 * gain / (1.0 + 2.0 * count * gain)
    x, y = x + share * px, y + share * py
    far = math.sqrt((x - cx) ** 2 + (y - cy) ** 2)
    if far > r:
        x, y = cx + (x - cx) * r / far, cy + (y - cy) * r / far
    return x, y


@kernel
def _out_of_walls(
    wall: Floats, first: Rows, member: Rows, frame: Floats, solid: Bools,
    bx: float, by: float, x: float, y: float, r: float,
) -> tuple[float, float]:  # fmt: skip
    """Return x, y moved out of walls. The body of radius r was at b before and stays on that side of the walls."""
    for _ in range(PASSES):
        m = first_crossing(wall, first, member, frame, solid, bx, by, x, y)
        if m < 0:
            m = _nearest_wall(wall, first, member, frame, x, y, r)
            if m < 0:
                return x, y
            x, y = project_off_wall(wall[m], solid[m], False, bx, by, x, y, r)
        else:
            x, y = project_off_wall(wall[m], solid[m], True, bx, by, x, y, r)
    return (x, y) if first_crossing(wall, first, member, frame, solid, bx, by, x, y) < 0 else (bx, by)


@kernel
def _nearest_wall(wall: Floats, first: Rows, member: Rows, frame: Floats, x: float, y: float, r: float) -> int:
    """Return the nearest wall with a distance below r, -1 for none."""
    cell = cell_index(frame, x, y)
    found, least = -1, (r * TOUCH) ** 2
    if cell >= 0:
        for k in range(first[cell], first[cell + 1]):
            m = member[k]
            nx, ny = nearest_on_segment(x, y, wall[m, 0], wall[m, 1], wall[m, 2], wall[m, 3])
            d2 = (x - nx) ** 2 + (y - ny) ** 2
            if d2 < least:
                found, least = m, d2
    return found


@dataclass(frozen=True)
class ContactModel:
    """Contact between people: overlapping bodies are pushed apart, and nobody is pushed into a wall.

    External agents push others but are not pushed. Invisible agents do not push. A person is moved by at most their
    radius per step and never through a wall, at any time step. The push changes the velocity, up to the maximum speed.

    Fields:
        variant: ``position`` resolves overlaps immediately, as far as there is space; ``force`` applies an acceleration
            of ``stiffness`` times the overlap, as in UMANS (van Toll et al. 2020), damped to avoid overshoot.
        stiffness: acceleration per metre of overlap [1/s^2], for ``force``.
        iterations: number of passes over all contacts per step, for ``position``.

    Raises:
        InputError: a value is not allowed.

    >>> near = Scene.of([[0.0, 0.0], [0.4, 0.0]], radius=0.25)
    >>> ContactModel().resolve_overlaps(near, near, dt=0.1).position.round(9).tolist()
    [[[-0.05, 0.0], [0.45, 0.0]]]
    """

    variant: str = attribute(
        "position",
        about="contact model: overlaps are resolved by position or by a force",
        choices=("position", "force"),
    )
    stiffness: float = attribute(62.5, about="stiffness per mass", unit="1/s2", exclusive_min=0.0, max=1e9)
    iterations: int = attribute(8, about="position iterations per step", min=1, max=1000)

    def __post_init__(self) -> None:
        check(self)

    def resolve_overlaps(
        self,
        before: Scene,
        after: Scene,
        dt: float,
        surfaces: ContactSurfaces | None = None,
        outlines: Outlines | None = None,
    ) -> Scene:
        """Return the scene ``after`` a step of ``dt`` [s] from ``before``, with overlaps resolved.

        Args:
            before, after: scenes before and after the step.
            dt: time step [s].
            surfaces: surfaces of the walls; None: of the walls of ``after``.
            outlines: outlines of external agents; others are discs.
        """
        shape = after.shape
        pairs, position = (*shape, 2), dense(after.position, (*shape, 2), FLOAT)
        start, place, radius, reach = np.empty(pairs), np.empty(pairs), np.empty(shape), np.empty(shape)
        pushed, seen = np.empty(shape, dtype=np.bool_), np.empty(shape, dtype=np.bool_)
        gather_bodies(
            dense(before.position, pairs, FLOAT),
            position,
            dense(after.radius, shape, FLOAT),
            dense(after.active, shape, BOOL),
            dense(after.external, shape, BOOL),
            dense(after.visible, shape, BOOL),
            *(start, place, radius, reach, pushed, seen),
        )
        if surfaces is None:
            surfaces = ContactSurfaces.of(after.walls, float(radius.max(initial=0.0)))
        near = find_close_bodies(position, reach, MOST, seen, pushed)
        now = place.reshape(-1, 2)
        heading = dense(after.heading, shape, FLOAT).reshape(-1)
        shapes = Outlines.of({}, shape[1]) if outlines is None else outlines
        bodies = _Bodies(start.reshape(-1, 2), now.copy(), radius.reshape(-1), pushed.reshape(-1), heading, *shapes)
        gain = self.stiffness * dt * dt if self.variant == "force" else 0.0
        now = _resolve(bodies, near, surfaces, gain, self.iterations if gain == 0.0 else 1, now)
        where, pace = np.empty(pairs), np.empty(pairs)
        velocity, limit = dense(after.velocity, pairs, FLOAT), dense(after.max_speed, shape, FLOAT)
        some = shift_bodies(now.reshape(pairs), position, velocity, limit, pushed, float(dt), where, pace)
        return after.replace(position=where, velocity=pace) if some else after


def _resolve(
    bodies: _Bodies, near: Neighbors, surfaces: ContactSurfaces, gain: float, iterations: int, now: Floats
) -> Floats:
    """Return the positions after some pushes: in one thread, one for each environment, or one for each part."""
    then, environments = now.copy(), len(near.number)
    # plain tuples: numba dispatches slowly on named tuples with similar fields
    common: Any = (tuple(bodies), tuple(near), tuple(surfaces.cells), surfaces.solid, float(gain))
    moved, moves = np.ones(len(now), dtype=np.bool_), np.zeros(len(now), dtype=np.bool_)
    whole: Any = (iterations, *common, now, moved, then, moves)
    if len(now) <= SMALL:
        _push_range(0, len(now), *whole)
        return now
    if environments >= ALONE:
        _push_environments(environments, *whole)
        return now
    for _ in range(iterations):
        step: Any = (*common, now, moved, then, moves)
        _push(*step)
        now, then, moved, moves = then, now, moves, moved
        if not np.any(moved):
            break
    return now
