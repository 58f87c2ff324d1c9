"""Contact model of the crowd: resolves overlaps between people, and between people and walls, after a step."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, InputError, Neighbors, Scene, Walls, did_you_mean, kernel, prange
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.core.neighbors import nearest

from .wall_cells import WallCells, wall_cells

__all__ = ["ContactModel", "ContactSurfaces"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Rows = NDArray[np.int32]

VARIANTS = ("position", "force")
MOST = 24
"""Maximum number of neighbors that push a person at the same time, nearest first."""
SPARE = 0.25
"""Margin of the neighbor search, in radii; pushes change positions."""
TOUCH = 1.0 - 1e-4
"""Fraction of the contact distance at which two bodies, or a body and a wall, count as separated."""
PASSES = 4
"""Maximum number of walls that push a person one after the other."""
REACH = 0.5
"""Steps up to this length [m] are tested for wall crossings in grid cells, longer ones against all walls."""
GOLDEN = math.pi * (3.0 - math.sqrt(5.0))


class _Bodies(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    before: Floats
    chosen: Floats
    radius: Floats
    pushed: Bools
    """Whether a push can move the agent."""


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
    before, chosen, radius, pushed = bodies
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
        px, py, count = _push_sum(row, agent[e, a, : number[e, a]], row - a, place, before, radius, pushed, gain)
        if count > 0:
            x, y = _apply_push(x, y, px, py, count, gain, chosen[row, 0], chosen[row, 1], r)
        if len(wall) > 0:
            x, y = _out_of_walls(wall, first, member, frame, solid, before[row, 0], before[row, 1], x, y, r)
        moves[row] = x != place[row, 0] or y != place[row, 1]
        out[row, 0], out[row, 1] = x, y


@kernel
def _push_sum(
    row: int, near: Rows, begin: int, place: Floats, before: Floats, radius: Floats, pushed: Bools, gain: float
) -> tuple[float, float, int]:
    """Return the sum of the pushes of the neighbors, and their number."""
    px, py, count = 0.0, 0.0, 0
    for n in range(len(near)):
        other = begin + near[n]
        reach = radius[row] + radius[other]
        dx, dy = place[row, 0] - place[other, 0], place[row, 1] - place[other, 1]
        d2 = dx * dx + dy * dy
        if d2 >= (reach * TOUCH) ** 2:
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
        m = _first_crossing(wall, first, member, frame, solid, bx, by, x, y)
        if m < 0:
            m = _nearest_wall(wall, first, member, frame, x, y, r)
            if m < 0:
                return x, y
            x, y = _project_off_wall(wall[m], solid[m], False, bx, by, x, y, r)
        else:
            x, y = _project_off_wall(wall[m], solid[m], True, bx, by, x, y, r)
    return (x, y) if _first_crossing(wall, first, member, frame, solid, bx, by, x, y) < 0 else (bx, by)


@kernel
def _cell(frame: Floats, x: float, y: float) -> int:
    """Return the grid cell of x, y; -1 outside the grid."""
    i, j = math.floor((x - frame[0]) / frame[2]), math.floor((y - frame[1]) / frame[2])
    if i < 0.0 or j < 0.0 or i >= frame[3] or j >= frame[4]:
        return -1
    return int(j) * int(frame[3]) + int(i)


@kernel
def _first_crossing(
    wall: Floats, first: Rows, member: Rows, frame: Floats, solid: Bools, bx: float, by: float, x: float, y: float
) -> int:
    """Return the first wall crossed from b to x, y; -1 for none. Leaving a solid is allowed."""
    dx, dy = x - bx, y - by
    if dx == 0.0 and dy == 0.0:
        return -1
    short = dx * dx + dy * dy <= frame[5] * frame[5]
    begin, end = 0, len(wall)
    if short:
        cell = _cell(frame, x, y)
        if cell < 0:
            return -1
        begin, end = first[cell], first[cell + 1]
    found, soonest = -1, math.inf
    for k in range(begin, end):
        m = member[k] if short else k
        ax, ay, wx, wy = wall[m, 0], wall[m, 1], wall[m, 2] - wall[m, 0], wall[m, 3] - wall[m, 1]
        from_, to = wx * (by - ay) - wy * (bx - ax), wx * (y - ay) - wy * (x - ax)
        if not ((from_ < 0.0 <= to) or (to <= 0.0 < from_ and not solid[m])):
            continue
        t = from_ / (from_ - to)
        along = ((bx + t * dx - ax) * wx + (by + t * dy - ay) * wy) / (wx * wx + wy * wy)
        if 0.0 <= along <= 1.0 and t < soonest:
            found, soonest = m, t
    return found


@kernel
def _nearest_wall(wall: Floats, first: Rows, member: Rows, frame: Floats, x: float, y: float, r: float) -> int:
    """Return the nearest wall with a distance below r, -1 for none."""
    cell = _cell(frame, x, y)
    found, least = -1, (r * TOUCH) ** 2
    if cell >= 0:
        for k in range(first[cell], first[cell + 1]):
            m = member[k]
            nx, ny = nearest_on_segment(x, y, wall[m, 0], wall[m, 1], wall[m, 2], wall[m, 3])
            d2 = (x - nx) ** 2 + (y - ny) ** 2
            if d2 < least:
                found, least = m, d2
    return found


@kernel
def _project_off_wall(
    wall: Floats, solid: bool, crossed: bool, bx: float, by: float, x: float, y: float, r: float
) -> tuple[float, float]:
    """Return x, y moved to distance r from a wall.

    The side is that of b if the wall was crossed, otherwise the current one, and always outside a solid.
    """
    ax, ay, ex, ey = wall[0], wall[1], wall[2] - wall[0], wall[3] - wall[1]
    nx, ny = nearest_on_segment(x, y, ax, ay, wall[2], wall[3])
    dx, dy = x - nx, y - ny
    left = ex * (y - ay) - ey * (x - ax)
    inner = abs(dx * ex + dy * ey) <= 1e-9 * (abs(left) + 1e-300)
    length = math.sqrt(ex * ex + ey * ey)
    side = 1.0 if ex * (by - ay) - ey * (bx - ax) > 0.0 else -1.0
    if solid and (crossed or (inner and left > 0.0)):
        side = -1.0
    elif not crossed and (dx != 0.0 or dy != 0.0):
        distance = math.sqrt(dx * dx + dy * dy)
        return nx + dx / distance * r, ny + dy / distance * r
    return nx - side * ey / length * r, ny + side * ex / length * r


class ContactSurfaces(NamedTuple):
    """Walls, prepared for contact with bodies.

    Fields:
        walls: the walls.
        cells: the walls sorted into a grid.
        solid: ``[M]`` whether the left side of a wall is solid.
        reach: largest supported radius of a body [m].
    """

    walls: Walls
    cells: WallCells
    solid: Bools
    reach: float

    @classmethod
    def of(cls, walls: Walls, reach: float) -> ContactSurfaces:
        """Prepare walls for bodies up to a radius of ``reach`` [m]."""
        thin = walls.previous == walls.next
        once = ~thin | (np.arange(len(walls)) < walls.next)
        wide = max(REACH, float(reach))
        return cls(walls, wall_cells(walls.segments(), wide), ~thin[once], wide)


@dataclass(frozen=True)
class ContactModel:
    """Resolution of overlaps after a step of the crowd: people are pushed apart and out of walls.

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

    variant: str = "position"
    stiffness: float = 62.5
    iterations: int = 8

    def __post_init__(self) -> None:
        if self.variant not in VARIANTS:
            near = did_you_mean(str(self.variant), VARIANTS)
            raise InputError(f"ContactModel: variant {self.variant!r} is unknown{near}; use {' or '.join(VARIANTS)}")
        if not 0.0 < self.stiffness <= 1e9:
            raise InputError(f"ContactModel: stiffness {self.stiffness} 1/s^2 must be above 0 and at most 1e9 1/s^2")
        if not 1 <= self.iterations <= 1000:
            raise InputError(f"ContactModel: iterations = {self.iterations} must be from 1 to 1000")

    def resolve_overlaps(
        self, before: Scene, after: Scene, dt: float, surfaces: ContactSurfaces | None = None
    ) -> Scene:
        """Return the scene ``after`` a step of ``dt`` [s] from ``before``, with overlaps resolved."""
        here = after.active
        radius = np.where(here, after.radius, 0.0)
        largest = radius.max(axis=1, initial=0.0)
        if surfaces is None:
            surfaces = ContactSurfaces.of(after.walls, largest.max(initial=0.0))
        pushed = here & ~after.external
        seen = here & after.visible
        near = nearest(after.position, radius + (1.0 + SPARE) * largest[:, None], MOST, seen, pushed)
        place = np.where(here[..., None], after.position, 0.0)
        bodies = _Bodies(
            np.where(here[..., None], before.position, 0.0).reshape(-1, 2),
            place.reshape(-1, 2).copy(),
            radius.reshape(-1),
            pushed.reshape(-1),
        )
        gain = self.stiffness * dt * dt if self.variant == "force" else 0.0
        now, then = bodies.chosen.copy(), bodies.chosen.copy()
        moved, moves = np.ones(len(now), dtype=np.bool_), np.zeros(len(now), dtype=np.bool_)
        for _ in range(self.iterations if gain == 0.0 else 1):
            _push(bodies, near, surfaces.cells, surfaces.solid, gain, now, moved, then, moves)
            now, then, moved, moves = then, now, moves, moved
            if not np.any(moved):
                break
        return _displace(after, now.reshape(place.shape), pushed, dt)


def _displace(scene: Scene, place: Floats, pushed: Bools, dt: float) -> Scene:
    """Return the scene with people at new positions and with matching velocities."""
    shift = np.where(pushed[..., None], place - np.where(pushed[..., None], scene.position, 0.0), 0.0)
    changed = pushed & np.any(shift != 0.0, axis=-1)
    velocity = scene.velocity + shift / dt
    speed, old = np.hypot(velocity[..., 0], velocity[..., 1]), np.hypot(scene.velocity[..., 0], scene.velocity[..., 1])
    limit = np.maximum(old, scene.max_speed)
    velocity = velocity * np.minimum(1.0, limit / np.maximum(speed, 1e-300))[..., None]
    return scene.replace(
        position=np.where(changed[..., None], place, scene.position),
        velocity=np.where(changed[..., None], velocity, scene.velocity),
    )
