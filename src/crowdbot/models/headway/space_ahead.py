"""Speed by the space ahead: the kernels of the headway layer."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, kernel, prange
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.typing import Floats

SLOWEST = 1e-9
"""Speeds below this [m/s] have no direction."""
SMALLEST_SHARE = 1e-3
"""Lower limit of the share of the time gap, against division by zero."""
SIDESTEP = 0.3
"""Speed [m/s] of a step past somebody who walks the same way, of people who slide and whom the space ahead stops."""
ATTEMPTS = 20
"""Passes over the neighbours in which a sliding person looks for a free velocity."""
LEEWAY = 1e-2
"""Speed away from others [m/s] that each pass adds, so that the search ends."""
STUCK = 0.05
"""People slower than this [m/s] step back from those whom they touch ahead."""
CONTACT = 0.01
"""Gap [m] below which people touch."""
STANDING = 0.1
"""People slower than this [m/s] do not count as oncoming."""


class HeadwayRows(NamedTuple):
    """Data of every agent for the kernels, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    chosen: Floats
    wish: Floats
    radius: Floats
    time_gap: Floats
    spacing: Floats
    width: Floats
    taper: Floats
    anticipation: Floats
    oncoming: Floats
    sidestep: Floats
    back: Floats
    reaction: Floats
    sliding: Floats
    walking: NDArray[np.bool_]


@kernel(parallel=True)
def limit_speeds(crowd: HeadwayRows, near: Neighbors, walls: Floats, dt: float, out: Floats) -> None:
    """Limit the speed of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        limit_speeds_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, dt, out)


@kernel
def limit_speeds_part(
    begin: int, end: int, crowd: HeadwayRows, near: Neighbors, walls: Floats, dt: float, out: Floats
) -> None:
    """Limit the speed of the agents ``begin`` to ``end`` in spatial order."""
    # unpack the tuples outside of the loop: each access counts references
    (
        place, velocity, chosen, wish, radius, gap, spacing, width, taper, look, oncoming, sidestep, back, reaction,
        sliding, walking,
    ) = crowd  # fmt: skip
    agent, number, order = near
    A = agent.shape[1]
    aside = np.empty((agent.shape[2] + len(walls), 3))  # direction of neighbours and walls, and speed towards them
    for k in range(begin, end):
        row = order[k]
        vx, vy = chosen[row, 0], chosen[row, 1]
        out[row, 0], out[row, 1] = vx, vy
        speed = math.sqrt(vx * vx + vy * vy)
        if not walking[row] or speed < SLOWEST:
            continue
        ux, uy = vx / speed, vy / speed
        # b is the person who limits the speed most, meets: whether this person wants to walk the other way
        limit, way, bx, by, meets = math.inf, math.inf, 0.0, 0.0, False
        e, a = row // A, row % A
        for n in range(number[e, a]):
            other = row - a + agent[e, a, n]
            dx, dy = place[other, 0] - place[row, 0], place[other, 1] - place[row, 1]
            contact = radius[row] + radius[other]
            free, side = _space(dx, dy, ux, uy, contact)
            if side < 1.0:
                way = min(way, max(free, 0.0))
            if side < width[row]:
                toward = velocity[other, 0] * ux + velocity[other, 1] * uy
                free += look[row] * max(toward, 0.0) - spacing[row]
                share = 1.0 - taper[row] * (side / width[row]) ** 2
                if toward < 0.0:
                    fast = math.sqrt(velocity[other, 0] ** 2 + velocity[other, 1] ** 2)
                    share *= 1.0 - (1.0 - oncoming[row]) * min(1.0, -toward / max(fast, STANDING))
                bound = max(free, 0.0) / (gap[row] * max(share, SMALLEST_SHARE))
                if bound < limit:
                    limit, bx, by = bound, dx, dy
                    meets = wish[other, 0] * wish[row, 0] + wish[other, 1] * wish[row, 1] < 0.0
        if limit < math.inf and reaction[row] > 0.0:
            now = max(0.0, velocity[row, 0] * ux + velocity[row, 1] * uy)
            free_speed = math.sqrt(wish[row, 0] ** 2 + wish[row, 1] ** 2)
            limit = now + (min(limit, max(free_speed, now)) - now) * -math.expm1(-dt / reaction[row])
        wanted = min(limit, speed)
        if sliding[row] > 0.0:
            step = sidestep[row] if meets else SIDESTEP
            for n in range(number[e, a]):
                _aside(place, radius, row, row - a + agent[e, a, n], dt, aside[n])
            count = _near_walls(
                walls, place[row, 0], place[row, 1], radius[row], wanted + step, dt, aside[number[e, a] :]
            )
            wx, wy = _step_aside(ux, uy, bx, by, wanted, sliding[row] * (min(step, speed) - wanted), meets)
            out[row, 0], out[row, 1] = _find_way(
                aside[: number[e, a] + count], number[e, a], ux, uy, wx, wy, sliding[row], back[row], dt
            )
            continue
        limit = min(limit, way / dt)
        if limit < speed:
            out[row, 0], out[row, 1] = limit * ux, limit * uy


@kernel
def _step_aside(
    ux: float, uy: float, bx: float, by: float, wanted: float, step: float, meets: bool
) -> tuple[float, float]:
    """Return the velocity in direction u, and in addition a step past the person at bx, by if it is above 0.

    The step is across the line to this person. If both want to walk the other way (``meets``) it has its full length,
    and goes to the right of a person straight ahead; otherwise it is shorter the less this person is aside.
    """
    distance = math.sqrt(bx * bx + by * by)
    if distance == 0.0 or step <= 0.0:
        return wanted * ux, wanted * uy
    ahead = (ux * bx + uy * by) / distance
    px, py = ux - ahead * bx / distance, uy - ahead * by / distance
    long = math.sqrt(px * px + py * py) if meets else 1.0
    if long < SLOWEST:
        px, py, long = by / distance, -bx / distance, 1.0
    return wanted * ux + step * px / long, wanted * uy + step * py / long


@kernel
def _find_way(
    aside: Floats, people: int, ux: float, uy: float, wx: float, wy: float, sliding: float, back: float, dt: float
) -> tuple[float, float]:
    """Return the velocity of a person who slides: the wanted one alongside others, a step back if it leads nowhere."""
    sx, sy = _slide(aside, wx, wy, sliding, False)
    if back > 0.0 and sx * sx + sy * sy < STUCK * STUCK:
        rx, ry = _step_back(aside[:people], ux, uy, dt, back)
        if rx != 0.0 or ry != 0.0:
            return _slide(aside, rx, ry, 1.0, True)
    return sx, sy


@kernel
def _step_back(aside: Floats, ux: float, uy: float, dt: float, speed: float) -> tuple[float, float]:
    """Return the velocity away from the people in contact ahead, 0 if there are none."""
    bx, by = 0.0, 0.0
    for n in range(len(aside)):
        if 2.0 * aside[n, 2] * dt < CONTACT and aside[n, 0] * ux + aside[n, 1] * uy > 0.0:
            bx -= aside[n, 0]
            by -= aside[n, 1]
    length = math.sqrt(bx * bx + by * by)
    if length < SLOWEST:
        return 0.0, 0.0
    return speed * bx / length, speed * by / length


@kernel
def _near_walls(walls: Floats, x: float, y: float, radius: float, speed: float, dt: float, found: Floats) -> int:
    """Write direction of the walls in reach of a step, and largest speed towards them; return their number."""
    count = int(np.int64(0))  # a literal 0 has its own type, which compiles the callees twice
    for m in range(len(walls)):
        nx, ny = nearest_on_segment(x, y, walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3])
        dx, dy = nx - x, ny - y
        distance = math.sqrt(dx * dx + dy * dy)
        if 0.0 < distance <= radius + speed * dt:
            found[count, 0], found[count, 1] = dx / distance, dy / distance
            found[count, 2] = max(distance - radius, 0.0) / dt
            count += 1
    return count


@kernel
def _aside(place: Floats, radius: Floats, row: int, other: int, dt: float, found: Floats) -> None:
    """Write the direction to another person, and the largest speed towards them: half of the gap in a step."""
    dx, dy = place[other, 0] - place[row, 0], place[other, 1] - place[row, 1]
    distance = math.sqrt(dx * dx + dy * dy)
    if distance > 0.0:
        found[0], found[1] = dx / distance, dy / distance
        found[2] = 0.5 * max(distance - radius[row] - radius[other], 0.0) / dt
    else:
        found[0], found[1], found[2] = 0.0, 0.0, 0.0


@kernel
def _slide(aside: Floats, vx: float, vy: float, share: float, any_way: bool) -> tuple[float, float]:
    """Return a velocity within the largest speeds towards others and walls: a shorter one, and one alongside them.

    The second is found by repeated projection, and is 0 if none is found; if it leads back, only with ``any_way``.
    """
    scale = 1.0
    for n in range(len(aside)):
        toward = vx * aside[n, 0] + vy * aside[n, 1]
        if toward > aside[n, 2]:
            scale = min(scale, aside[n, 2] / toward)
    if scale == 1.0:
        return vx, vy
    sx, sy = vx, vy
    for attempt in range(ATTEMPTS):
        free = True
        for n in range(len(aside)):
            toward = sx * aside[n, 0] + sy * aside[n, 1]
            if toward > aside[n, 2]:
                free = False
                sx -= (toward - aside[n, 2] + LEEWAY) * aside[n, 0]
                sy -= (toward - aside[n, 2] + LEEWAY) * aside[n, 1]
        if free:
            break
        if attempt == ATTEMPTS - 1:
            sx, sy = 0.0, 0.0
    if sx * vx + sy * vy < 0.0 and not any_way:
        sx, sy = 0.0, 0.0
    return (1.0 - share) * scale * vx + share * sx, (1.0 - share) * scale * vy + share * sy


@kernel
def _space(dx: float, dy: float, ux: float, uy: float, contact: float) -> tuple[float, float]:
    """Return the way [m] to contact with a disc at dx, dy in direction u, and its lateral offset in sums of radii.

    For a disc at the side that is never met, the way ends abreast of it. A disc behind has an infinite offset.
    """
    along, side = dx * ux + dy * uy, abs(dx * uy - dy * ux) / contact if contact > 0.0 else math.inf
    if along <= 0.0:
        return math.inf, math.inf
    inside = min(side, 1.0)
    return along - contact * math.sqrt(1.0 - inside * inside), side
