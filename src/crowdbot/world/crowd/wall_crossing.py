"""Crossing of walls in a step: nobody ends a step on the other side of a wall.

The test is that of the centre of a body, on the straight line of the step. :class:`ContactModel` uses it for its
pushes, and :func:`stop_at_walls` for everything else that moves people: crowd models, pushes and the physics engine.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import Scene, Walls, kernel
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.typing import Bools, Floats, Rows

from .agent_arrays import BOOL, FLOAT, dense
from .wall_cells import WallCells, distance2, wall_cells

SPARE = 0.25
"""Margin of the neighbor search, in radii; pushes change positions."""


@kernel
def gather_bodies(
    before: Floats, after: Floats, size: Floats, active: Bools, external: Bools, visible: Bools, start: Floats,
    place: Floats, radius: Floats, reach: Floats, pushed: Bools, seen: Bools,
) -> None:  # fmt: skip
    """Write the data of every agent: zeros for absent ones, and the distance within which neighbors are searched."""
    for e in range(len(active)):
        largest = 0.0
        for a in range(active.shape[1]):
            here = active[e, a]
            pushed[e, a], seen[e, a] = here and not external[e, a], here and visible[e, a]
            radius[e, a] = size[e, a] if here else 0.0
            largest = max(largest, radius[e, a])
            for k in range(2):
                start[e, a, k] = before[e, a, k] if here else 0.0
                place[e, a, k] = after[e, a, k] if here else 0.0
        for a in range(active.shape[1]):
            reach[e, a] = radius[e, a] + (1.0 + SPARE) * largest


@kernel
def shift_bodies(
    place: Floats, position: Floats, velocity: Floats, max_speed: Floats, pushed: Bools, dt: float, out: Floats,
    pace: Floats,
) -> bool:  # fmt: skip
    """Write positions and velocities after the push to ``place``; return whether somebody was pushed."""
    some = False
    for e in range(len(pushed)):
        for a in range(pushed.shape[1]):
            vx, vy = velocity[e, a, 0], velocity[e, a, 1]
            out[e, a, 0], out[e, a, 1] = position[e, a, 0], position[e, a, 1]
            pace[e, a, 0], pace[e, a, 1] = vx, vy
            if not pushed[e, a]:
                continue
            dx, dy = place[e, a, 0] - position[e, a, 0], place[e, a, 1] - position[e, a, 1]
            if dx != 0.0 or dy != 0.0:
                x, y = vx + dx / dt, vy + dy / dt
                limit = max(math.hypot(vx, vy), max_speed[e, a])
                share = min(1.0, limit / max(math.hypot(x, y), 1e-300))
                out[e, a, 0], out[e, a, 1] = place[e, a, 0], place[e, a, 1]
                pace[e, a, 0], pace[e, a, 1] = x * share, y * share
                some = True
    return some


PASSES = 4
"""Maximum number of walls that move a person one after the other."""
REACH = 0.5
"""Steps up to this length [m] are tested for wall crossings in grid cells, longer ones against all walls."""
SEAM = 1e-9
"""Walls are longer by this share at both ends: rounding opens no gap where two walls meet."""


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
        """Prepare walls for bodies up to a radius of ``reach`` [m]; up to :data:`REACH` once for the same walls."""
        return _surfaces(walls, float(reach)) if reach > REACH else walls.derive(_usual_surfaces)


def _surfaces(walls: Walls, reach: float) -> ContactSurfaces:
    thin = walls.previous == walls.next
    once = ~thin | (np.arange(len(walls)) < walls.next)
    return ContactSurfaces(walls, wall_cells(walls.segments(), reach), ~thin[once], reach)


def _usual_surfaces(walls: Walls) -> ContactSurfaces:
    return _surfaces(walls, REACH)


@kernel
def cell_index(frame: Floats, x: float, y: float) -> int:
    """Return the grid cell of x, y; -1 outside the grid."""
    i, j = math.floor((x - frame[0]) / frame[2]), math.floor((y - frame[1]) / frame[2])
    if i < 0.0 or j < 0.0 or i >= frame[3] or j >= frame[4]:
        return -1
    return int(j) * int(frame[3]) + int(i)


@kernel
def first_crossing(
    wall: Floats, first: Rows, member: Rows, frame: Floats, solid: Bools, bx: float, by: float, x: float, y: float
) -> int:
    """Return the first wall crossed from b to x, y; -1 for none. Leaving a solid is allowed."""
    dx, dy = x - bx, y - by
    if dx == 0.0 and dy == 0.0:
        return -1
    short = dx * dx + dy * dy <= frame[5] * frame[5]
    begin, end = 0, len(wall)
    if short:
        cell = cell_index(frame, x, y)
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
        if -SEAM <= along <= 1.0 + SEAM and t < soonest:
            found, soonest = m, t
    return found


@kernel
def project_off_wall(
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


def stop_at_walls(before: Scene, after: Scene, dt: float, walls: Walls) -> Scene:
    """Return the scene ``after`` a step of ``dt`` [s] from ``before`` in which nobody has crossed a wall.

    A person whose straight way crosses a wall ends the step beside it, at the distance of the radius, or at the earlier
    distance if that is smaller: the motion along the wall remains. If other walls do not permit that, the person stays.
    The velocity changes by the same displacement, up to the maximum speed. External agents, such as robots and people
    on recorded tracks, may cross walls. Without a crossing, ``after`` itself is returned.

    >>> start = Scene.of([[0.0, 0.0]], velocity=[[9.0, 1.0]], radius=0.3, max_speed=9.0, walls=[[(1, -9), (1, 9)]])
    >>> end = stop_at_walls(start, start.advance(start.velocity, 0.2), 0.2, start.walls)
    >>> end.position.round(9).tolist(), end.velocity.round(9).tolist()
    ([[[0.7, 0.2]]], [[[3.5, 1.0]]])
    """
    if not len(walls.start):
        return after
    pairs = after.position.shape
    start, position = dense(before.position, pairs, FLOAT), dense(after.position, pairs, FLOAT)
    _, (wall, first, member, frame), solid, _ = walls.derive(_usual_surfaces)
    if not _may_cross(start, position, wall, first, member, frame):
        return after
    shape = after.shape
    held = dense(after.active & ~after.external, shape, BOOL)
    place = position.copy()
    _stop(start, dense(after.radius, shape, FLOAT), held, wall, first, member, frame, solid, place)
    where, pace = np.empty(pairs), np.empty(pairs)
    velocity, limit = dense(after.velocity, pairs, FLOAT), dense(after.max_speed, shape, FLOAT)
    some = shift_bodies(place, position, velocity, limit, held, float(dt), where, pace)
    return after.replace(position=where, velocity=pace) if some else after


@kernel
def _may_cross(before: Floats, after: Floats, wall: Floats, first: Rows, member: Rows, frame: Floats) -> bool:
    """Return whether the way of any agent crosses a wall; absent and external agents and ways out of solids count.

    It uses one thread: a person takes about 7 ns, so that starting threads would cost more.
    """
    x0, y0, each, columns, rows = frame[0], frame[1], 1.0 / frame[2], int(frame[3]), int(frame[4])
    reach2 = frame[5] * frame[5]
    for e in range(len(before)):
        for a in range(before.shape[1]):
            bx, by, x, y = before[e, a, 0], before[e, a, 1], after[e, a, 0], after[e, a, 1]
            dx, dy = x - bx, y - by
            length2 = dx * dx + dy * dy
            short = length2 <= reach2
            begin, end = 0, len(wall)
            if short:  # written out: in a function it takes three times as long
                i, j = (x - x0) * each, (y - y0) * each
                if length2 == 0.0 or not (0.0 <= i < columns and 0.0 <= j < rows):
                    continue
                cell = int(j) * columns + int(i)
                begin, end = first[cell], first[cell + 1]
            for k in range(begin, end):
                m = member[k] if short else k
                ax, ay, wx, wy = wall[m, 0], wall[m, 1], wall[m, 2] - wall[m, 0], wall[m, 3] - wall[m, 1]
                from_, to = wx * (by - ay) - wy * (bx - ax), wx * (y - ay) - wy * (x - ax)
                if (from_ < 0.0 <= to) or (to <= 0.0 < from_):
                    t = from_ / (from_ - to)
                    along = ((bx + t * dx - ax) * wx + (by + t * dy - ay) * wy) / (wx * wx + wy * wy)
                    if -SEAM <= along <= 1.0 + SEAM:
                        return True
    return False


@kernel
def _stop(
    before: Floats, radius: Floats, held: Bools, wall: Floats, first: Rows, member: Rows, frame: Floats, solid: Bools,
    place: Floats,
) -> None:  # fmt: skip
    """Move everybody who has crossed a wall to the end of the step on the former side, in ``place``."""
    for e in range(len(held)):
        for a in range(held.shape[1]):
            if not held[e, a]:
                continue
            bx, by, x, y = before[e, a, 0], before[e, a, 1], place[e, a, 0], place[e, a, 1]
            m = first_crossing(wall, first, member, frame, solid, bx, by, x, y)
            passes = 0
            while m >= 0 and passes < PASSES:
                ax, ay, ex, ey = wall[m, 0], wall[m, 1], wall[m, 2], wall[m, 3]
                gap = min(radius[e, a], math.sqrt(distance2(bx, by, ax, ay, ex, ey)))
                x, y = project_off_wall(wall[m], solid[m], True, bx, by, x, y, gap)
                m = first_crossing(wall, first, member, frame, solid, bx, by, x, y)
                passes += 1
            place[e, a, 0], place[e, a, 1] = (x, y) if m < 0 else (bx, by)
