"""Threats of Tangent (Pettré et al. 2009): constraints by neighbours and walls, and the smallest velocity change.

A threat is a row of numbers: kind, apex (2), first tangent (2), second tangent or best velocity (2), position (2),
permitted side, clearance, time to contact. Tangents are rays in velocity space that start at the apex.
"""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.core.geometry import nearest_on_segment, time_to_contact, time_to_segment
from crowdbot.typing import Floats

CONTACT = 0.5
"""Time to contact [s] at which the agent that passes first reacts (measured on the original)."""
STILL = 0.1
"""Agents slower than this [m/s] count as at rest; others pass on the nearer side."""
ALONG, AGAINST = math.cos(math.radians(15.0)), math.cos(math.radians(165.0))
"""Cosines of the crossing angles outside of which no agent passes first."""
FACING = math.cos(math.radians(112.5))
"""Cosine of the crossing angle beyond which both agents react early."""
CROSSING = np.radians(np.array([45.0, 90.0, 135.0]))
"""Crossing angles [rad] of :data:`CLEARANCE` and :data:`BRAKING`, measured for the agent that gives way."""
CLEARANCE = np.array([1.35, 0.92, 0.94])
"""Factors of the clearance."""
BRAKING = np.array([0.5, 0.0, 0.35])
"""Fractions of braking; the rest is the smallest change."""
RETREAT = 1.0
"""Minimum time [s] to the goal, which limits the speed."""
HASTE = 0.1
"""Additional speed [m/s] of an agent that leaves another's personal area (measured on the original)."""
MOST = 8
"""Maximum number of threats (neighbours and walls), the most urgent first."""
THREAT = 12
"""Number of columns of a threat."""
CONE, LINE, WALL = 0.0, 1.0, 2.0
"""Kinds of threats: pass on either side, on one side, or stay on the near side of a straight line."""
SLACK = 1e-9


@kernel
def _interpolate(knots: Floats, x: float) -> float:
    """Return the value at crossing angle ``x`` by linear interpolation of ``knots``."""
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
    """Write the constraint by a neighbour at x, y (relative) with velocity o; return False if there is none."""
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
        mine, its = (x * oy - y * ox) / cross, (x * by - y * bx) / cross  # times at the crossing
        tie = abs(mine - its) <= SLACK * (abs(mine) + abs(its))
        second = bx * y - by * x < 0.0 if tie else mine > its  # tie: the agent with the other on its right gives way
        if second:
            angle = math.atan2(abs(cross), dot)
            keep = clearance * _interpolate(CLEARANCE, angle)
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
    out[3], out[4] = _unit(x + nx, y + ny)
    out[5], out[6] = _unit(x - nx, y - ny)
    out[0], out[9] = CONE, 1.0
    if one_sided:
        # behind the neighbour is the side from which it comes, seen along the relative velocity
        left_is_behind = wx * oy - wy * ox < 0.0
        if left_is_behind != second:
            out[3], out[4], out[9] = out[5], out[6], -1.0
        out[0] = LINE
        along = max(0.0, wx * out[3] + wy * out[4])
        out[5], out[6] = ox + along * out[3], oy + along * out[4]
        if second:
            _brake(out, bx, by, _interpolate(BRAKING, angle), top)
    return True


@kernel
def _unit(x: float, y: float) -> tuple[float, float]:
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
    """Return the velocity directly away from a neighbour at x, y, or along ``side`` if it is at the same position."""
    distance, pace = math.sqrt(x * x + y * y), math.sqrt(bx * bx + by * by) + HASTE
    return (-pace * x / distance, -pace * y / distance) if distance > 0.0 else (-pace * side, 0.0)


@kernel
def _write_border(out: Floats, px: float, py: float, nx: float, ny: float, gap: float, contact: float) -> None:
    """Write a straight border through p; velocities beyond it, towards n, are not permitted."""
    out[0], out[1], out[2], out[3], out[4], out[7], out[8] = WALL, px, py, -ny, nx, nx, ny
    out[10], out[11] = gap, contact


@kernel
def threat_of_wall(
    out: Floats, wall: Floats, x: float, y: float, bx: float, by: float, radius: float, horizon: float
) -> bool:
    """Write the constraint by a wall on an agent at x, y with velocity b; return False if there is none."""
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
    _write_border(out, allowed * nx, allowed * ny, nx, ny, distance - radius, contact)
    return True


@kernel
def _is_free(threats: Floats, count: int, vx: float, vy: float) -> bool:
    """Return whether a velocity satisfies the constraints of all threats."""
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
def _keep_if_best(
    best: Floats, threats: Floats, count: int, vx: float, vy: float, bx: float, by: float, top: float
) -> None:
    """Replace the best velocity if the new one is a smaller change and satisfies all constraints."""
    change2 = (vx - bx) ** 2 + (vy - by) ** 2
    if change2 < best[0] and vx * vx + vy * vy <= top * top and _is_free(threats, count, vx, vy):
        best[0], best[1], best[2] = change2, vx, vy


@kernel
def _write_borders(threats: Floats, count: int, lines: Floats) -> int:
    """Write the borders of all threats (point, direction, lower limit along it); return their number."""
    held = 0
    for k in range(count):
        for c in range(2 if threats[k, 0] == CONE else 1):
            lines[held, 0], lines[held, 1] = threats[k, 1], threats[k, 2]
            lines[held, 2], lines[held, 3] = threats[k, 3 + 2 * c], threats[k, 4 + 2 * c]
            lines[held, 4] = -math.inf if threats[k, 0] == WALL else 0.0
            held += 1
    return held


@kernel
def _try_intersections(
    best: Floats, threats: Floats, count: int, lines: Floats, held: int, bx: float, by: float, pace: float, top: float
) -> None:
    """Try the intersections of borders with each other, and with the circle of radius ``pace``."""
    for a in range(held):
        px, py, ux, uy, low = lines[a, 0], lines[a, 1], lines[a, 2], lines[a, 3], lines[a, 4]
        along = px * ux + py * uy
        inside = along * along - px * px - py * py + pace * pace
        if inside >= 0.0:
            for t in (-along - math.sqrt(inside), -along + math.sqrt(inside)):
                if t >= low:
                    _keep_if_best(best, threats, count, px + t * ux, py + t * uy, bx, by, top)
        for b in range(a):
            qx, qy = lines[b, 0] - px, lines[b, 1] - py
            turn = ux * lines[b, 3] - uy * lines[b, 2]
            if turn == 0.0:
                continue
            t = (qx * lines[b, 3] - qy * lines[b, 2]) / turn
            if t >= low and (qx * uy - qy * ux) / turn >= lines[b, 4]:
                _keep_if_best(best, threats, count, px + t * ux, py + t * uy, bx, by, top)


@kernel
def _first_contact(threats: Floats, count: int, vx: float, vy: float) -> float:
    """Return the time to the first contact at a velocity."""
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
    """Return the velocity nearest to b that satisfies all constraints, otherwise the one with the latest contact."""
    best[0] = math.inf
    held = _write_borders(threats, count, lines)
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
            _keep_if_best(best, threats, count, x, y, bx, by, top)
            if best[0] == math.inf and x * x + y * y <= top * top:
                contact = _first_contact(threats, count, x, y)
                if contact > latest:
                    latest, sx, sy = contact, x, y
    if count > 1:
        _try_intersections(best, threats, count, lines, held, bx, by, pace, top)
    return (best[1], best[2]) if best[0] < math.inf else (sx, sy)


@kernel
def insert(threats: Floats, held: int, new: Floats) -> int:
    """Insert a threat in the list of the most urgent ones; return its new length."""
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
