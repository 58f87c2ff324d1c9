"""Threats of Tangent (Pettré et al. 2009): constraints by neighbours and walls, and the smallest velocity change.

A threat is a row of numbers: kind, apex (2), first tangent (2), second tangent or best velocity (2), position (2),
allowed side, clearance, time to contact. Tangents are rays in velocity space that begin at the apex.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.core.geometry import nearest_on_segment, time_to_contact, time_to_segment

__all__ = ["MOST", "RETREAT", "THREAT", "insert", "least_change", "retreat", "threat_of_neighbor", "threat_of_wall"]

Floats = NDArray[np.float64]

CONTACT = 0.5
"""Who passes first reacts only when contact is this near [s] (measured on the original)."""
STILL = 0.1
"""Agents slower than this [m/s] count as at rest; others pass on the nearer side."""
ALONG, AGAINST = math.cos(math.radians(15.0)), math.cos(math.radians(165.0))
"""Crossing angles beyond these have no first and second agent."""
FACING = math.cos(math.radians(112.5))
"""Beyond this crossing angle both react early."""
CROSSING = np.radians(np.array([45.0, 90.0, 135.0]))
"""Crossing angles [rad] at which the reactions of the agent that gives way were measured:"""
CLEARANCE = np.array([1.35, 0.92, 0.94])
"""share of the clearance that is kept,"""
BRAKING = np.array([0.5, 0.0, 0.35])
"""share of braking; the rest is the least change."""
RETREAT = 1.0
"""Time [s] in which a walker may reach the goal."""
HASTE = 0.1
"""Whoever steps out of another's personal area goes so much faster [m/s] than it walks (measured on the original)."""
MOST = 8
"""Maximum number of neighbours avoided at a time, the most urgent first; the same for walls."""
THREAT = 12
"""Numbers of a threat."""
CONE, LINE, WALL = 0.0, 1.0, 2.0
"""Kinds of threats: pass on either side, on one side, or stay on the near side of a straight line."""
SLACK = 1e-9


@kernel
def _between(knots: Floats, x: float) -> float:
    """Return the value at a crossing angle, straight between the measured ones."""
    cell = 0 if x < CROSSING[1] else 1
    share = (x - CROSSING[cell]) / (CROSSING[cell + 1] - CROSSING[cell])
    share = min(1.0, max(0.0, share))
    value: float = knots[cell] + share * (knots[cell + 1] - knots[cell])
    return value


@kernel
def threat_of_neighbor(
    out: Floats, x: float, y: float, bx: float, by: float, ox: float, oy: float, clearance: float, reaction: float,
    horizon: float, external: bool, top: float,
) -> bool:  # fmt: skip
    """Write the constraint by a neighbour at x, y (relative) with velocity o; False if there is none."""
    wx, wy = bx - ox, by - oy
    w2, closing = wx * wx + wy * wy, x * wx + y * wy
    if closing <= 0.0 or x * bx + y * by < 0.0:
        return False
    b2, o2 = bx * bx + by * by, ox * ox + oy * oy
    dot, cross = bx * ox + by * oy, bx * oy - by * ox
    length = math.sqrt(b2 * o2)
    one_sided = not external and o2 > STILL * STILL and b2 > STILL * STILL
    one_sided = one_sided and AGAINST * length < dot < ALONG * length
    second = False
    keep = clearance
    angle = 0.0
    if one_sided:
        mine, its = (x * oy - y * ox) / cross, (x * by - y * bx) / cross  # when each is at the crossing
        tie = abs(mine - its) <= SLACK * (abs(mine) + abs(its))
        second = bx * y - by * x < 0.0 if tie else mine > its  # at a tie, who has the other on the right gives way
        if second:
            angle = math.atan2(abs(cross), dot)
            keep = clearance * _between(CLEARANCE, angle)
    miss2 = (x * wy - y * wx) ** 2 / w2
    if miss2 >= keep * keep:
        return False
    contact = (closing - math.sqrt((keep * keep - miss2) * w2)) / w2
    late = one_sided and not second and dot > FACING * length
    if contact >= (CONTACT if late else min(horizon, reaction * math.pow(clearance / 0.66, 0.79))):
        return False
    speed = math.sqrt(w2)
    nx, ny = -wy / speed * keep, wx / speed * keep
    out[1], out[2], out[7], out[8], out[10], out[11] = ox, oy, x, y, keep, contact
    out[3], out[4] = _direction(x + nx, y + ny)
    out[5], out[6] = _direction(x - nx, y - ny)
    out[0], out[9] = CONE, 1.0
    if one_sided:
        # where the other comes from seen along the relative velocity: there is behind
        left_is_behind = wx * oy - wy * ox < 0.0
        if left_is_behind != second:
            out[3], out[4], out[9] = out[5], out[6], -1.0
        out[0] = LINE
        along = max(0.0, wx * out[3] + wy * out[4])
        out[5], out[6] = ox + along * out[3], oy + along * out[4]
        if second:
            _brake(out, bx, by, _between(BRAKING, angle), top)
    return True


@kernel
def _direction(x: float, y: float) -> tuple[float, float]:
    length = math.sqrt(x * x + y * y)
    return x / length, y / length


@kernel
def _brake(threat: Floats, bx: float, by: float, share: float, top: float) -> None:
    """Move the candidate along its tangent towards the velocity that only changes speed."""
    across = bx * threat[4] - by * threat[3]
    if share == 0.0 or across == 0.0:
        return
    factor = (threat[1] * threat[4] - threat[2] * threat[3]) / across
    if factor >= 0.0 and factor * factor * (bx * bx + by * by) <= top * top:
        threat[5] += share * (factor * bx - threat[5])
        threat[6] += share * (factor * by - threat[6])


@kernel
def retreat(x: float, y: float, bx: float, by: float, side: float) -> tuple[float, float]:
    """Return the velocity straight away from a neighbour at x, y, along ``side`` when it is at the same place."""
    distance, pace = math.sqrt(x * x + y * y), math.sqrt(bx * bx + by * by) + HASTE
    return (-pace * x / distance, -pace * y / distance) if distance > 0.0 else (-pace * side, 0.0)


@kernel
def _line(out: Floats, px: float, py: float, nx: float, ny: float, gap: float, contact: float) -> None:
    """Write a straight border through p that velocities may not pass towards n."""
    out[0], out[1], out[2], out[3], out[4], out[7], out[8] = WALL, px, py, -ny, nx, nx, ny
    out[10], out[11] = gap, contact


@kernel
def threat_of_wall(
    out: Floats, wall: Floats, x: float, y: float, bx: float, by: float, radius: float, horizon: float
) -> bool:
    """Write the constraint by a wall on a walker at x, y with velocity b; False if none."""
    nx, ny = nearest_on_segment(x, y, wall[0], wall[1], wall[2], wall[3])
    nx, ny = nx - x, ny - y
    distance = math.sqrt(nx * nx + ny * ny)
    reach = math.sqrt(bx * bx + by * by) * horizon + radius
    if distance == 0.0 or distance > reach:
        return False
    nx, ny = nx / distance, ny / distance
    allowed = (distance - radius) / horizon
    if bx * nx + by * ny <= allowed + SLACK:
        return False
    contact = time_to_segment(x, y, bx, by, radius, wall[0], wall[1], wall[2], wall[3])
    if contact >= horizon:
        return False
    _line(out, allowed * nx, allowed * ny, nx, ny, distance - radius, contact)
    return True


@kernel
def _is_free(threats: Floats, count: int, vx: float, vy: float) -> bool:
    """Return whether a velocity passes all threats."""
    for k in range(count):
        wx, wy = vx - threats[k, 1], vy - threats[k, 2]
        ahead = wx * threats[k, 7] + wy * threats[k, 8]
        if threats[k, 0] == WALL:
            if ahead > SLACK:
                return False
            continue
        if ahead <= 0.0:
            continue
        first = threats[k, 9] * (threats[k, 3] * wy - threats[k, 4] * wx)
        if first >= -SLACK:
            continue
        if threats[k, 0] == LINE or threats[k, 5] * wy - threats[k, 6] * wx > SLACK:
            return False
    return True


@kernel
def _offer(best: Floats, threats: Floats, count: int, vx: float, vy: float, bx: float, by: float, top: float) -> None:
    """Accept a velocity as the best if it is a smaller change than the current best and satisfies all constraints."""
    change2 = (vx - bx) ** 2 + (vy - by) ** 2
    if change2 < best[0] and vx * vx + vy * vy <= top * top and _is_free(threats, count, vx, vy):
        best[0], best[1], best[2] = change2, vx, vy


@kernel
def _lines_of(threats: Floats, count: int, lines: Floats) -> int:
    """Write the borders of all threats as point, direction, lowest place along; return how many."""
    held = 0
    for k in range(count):
        for c in range(2 if threats[k, 0] == CONE else 1):
            lines[held, 0], lines[held, 1] = threats[k, 1], threats[k, 2]
            lines[held, 2], lines[held, 3] = threats[k, 3 + 2 * c], threats[k, 4 + 2 * c]
            lines[held, 4] = -math.inf if threats[k, 0] == WALL else 0.0
            held += 1
    return held


@kernel
def _offer_corners(
    best: Floats, threats: Floats, count: int, lines: Floats, held: int, bx: float, by: float, pace: float, top: float
) -> None:
    """Offer where borders meet each other, and where they meet the circle of walking at the own pace."""
    for a in range(held):
        px, py, ux, uy, low = lines[a, 0], lines[a, 1], lines[a, 2], lines[a, 3], lines[a, 4]
        along = px * ux + py * uy
        inside = along * along - px * px - py * py + pace * pace
        if inside >= 0.0:
            for t in (-along - math.sqrt(inside), -along + math.sqrt(inside)):
                if t >= low:
                    _offer(best, threats, count, px + t * ux, py + t * uy, bx, by, top)
        for b in range(a):
            qx, qy = lines[b, 0] - px, lines[b, 1] - py
            turn = ux * lines[b, 3] - uy * lines[b, 2]
            if turn == 0.0:
                continue
            t = (qx * lines[b, 3] - qy * lines[b, 2]) / turn
            if t >= low and (qx * uy - qy * ux) / turn >= lines[b, 4]:
                _offer(best, threats, count, px + t * ux, py + t * uy, bx, by, top)


@kernel
def _first_contact(threats: Floats, count: int, vx: float, vy: float) -> float:
    """Return when the first threat is hit with a velocity."""
    first = math.inf
    for k in range(count):
        wx, wy = vx - threats[k, 1], vy - threats[k, 2]
        if threats[k, 0] != WALL:
            first = min(first, time_to_contact(-threats[k, 7], -threats[k, 8], wx, wy, threats[k, 10]))
        elif wx * threats[k, 7] + wy * threats[k, 8] > SLACK:
            towards = vx * threats[k, 7] + vy * threats[k, 8]
            first = min(first, max(0.0, threats[k, 10]) / towards if towards > 0.0 else 0.0)
    return first


@kernel
def least_change(
    threats: Floats, count: int, lines: Floats, best: Floats, bx: float, by: float, pace: float, top: float
) -> tuple[float, float]:
    """Return the velocity nearest to b that passes all threats; when there is none, the one that hits latest."""
    best[0] = math.inf
    held = _lines_of(threats, count, lines)
    latest, sx, sy = _first_contact(threats, count, 0.0, 0.0), 0.0, 0.0
    n = 0
    for k in range(count):
        for _ in range(2 if threats[k, 0] == CONE else 1):
            if threats[k, 0] == LINE:
                x, y = threats[k, 5], threats[k, 6]
            else:
                along = max(lines[n, 4], (bx - lines[n, 0]) * lines[n, 2] + (by - lines[n, 1]) * lines[n, 3])
                x, y = lines[n, 0] + along * lines[n, 2], lines[n, 1] + along * lines[n, 3]
            n += 1
            _offer(best, threats, count, x, y, bx, by, top)
            if best[0] == math.inf and x * x + y * y <= top * top:
                contact = _first_contact(threats, count, x, y)
                if contact > latest:
                    latest, sx, sy = contact, x, y
    if count > 1:
        _offer_corners(best, threats, count, lines, held, bx, by, pace, top)
    return (best[1], best[2]) if best[0] < math.inf else (sx, sy)


@kernel
def insert(threats: Floats, held: int, new: Floats) -> int:
    """Insert a threat among the most urgent ones; return how many there are."""
    if held == len(threats):
        if new[11] >= threats[held - 1, 11]:
            return held
        held -= 1
    n = held
    while n > 0 and new[11] < threats[n - 1, 11]:
        threats[n] = threats[n - 1]
        n -= 1
    threats[n] = new
    return held + 1
