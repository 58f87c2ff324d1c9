"""Costs of VOG (Ren et al. 2017): collision, group, and deviation from the desired velocity.

Values that do not depend on the candidate velocity are computed once per agent: a cone for each neighbour, and a term
for each group member. Both are rows of numbers for the cost functions.
"""

from __future__ import annotations

import math

from crowdbot.core import kernel
from crowdbot.core.geometry import nearest_on_segment, time_to_segment
from crowdbot.typing import Floats

CONE = 10
"""Columns of a cone: direction to the neighbour (2), cap, radius, near tangent (normal 2, offset), far tangent (3)."""
FELLOW = 11
"""Columns of a group term: in range 1, centre, walking direction; out of range 0, direction, caps, tangents."""
DEEP = 0.5
"""Cost per depth [m/s] in the cone of a neighbour."""
OVERLAP = 50.0
"""Cost per depth [m/s] while two bodies overlap."""
SOLID = 2.5
"""Cost per excess speed [m/s] towards a wall."""
BACKWARDS = 10.0
"""Cost of walking away from the desired direction."""
STOPPING = 5.0
"""Cost of standing if the desired velocity is not standing."""
STANDING2 = 0.1
"""Squared speed [m2/s2] below which an agent counts as standing."""
DIRECTED = 1e-5
"""Below this length [m/s] a velocity has no direction."""
IN_RANGE = 1.2
"""Group members within this many group radii only have to be within one radius after one second."""


@kernel
def cone(
    cones: Floats, at: int, x: float, y: float, vx: float, vy: float, other_vx: float, other_vy: float,
    reach: float, horizon: float, reacts: bool, side: float,
) -> None:  # fmt: skip
    """Write the velocity obstacle of a neighbour at x, y (relative) to ``cones[at]``.

    Args:
        cones, at: output array and row.
        x, y: position of the neighbour relative to the agent [m].
        vx, vy, other_vx, other_vy: velocities of the agent and of the neighbour [m/s].
        reach: sum of the radii [m].
        horizon: time horizon [s].
        reacts: whether the neighbour gives way, too.
        side: 1 or -1, assumed direction along x of a neighbour at the same position.
    """
    distance = math.sqrt(x * x + y * y)
    nx, ny = (x / distance, y / distance) if distance > 0.0 else (side, 0.0)
    ax, ay = other_vx, other_vy
    if reacts:
        ax, ay = 0.5 * (vx + other_vx), 0.5 * (vy + other_vy)
    row = cones[at]
    row[0], row[1] = nx, ny
    if distance < reach:
        row[2], row[3] = ax * nx + ay * ny + distance - reach, -1.0
        return
    inverse = 1.0 / horizon
    row[2], row[3] = ax * nx + ay * ny + (distance - reach) * inverse, reach * inverse
    sine = reach / distance
    cosine = math.sqrt(1.0 - sine * sine)
    cx, cy = ax + x * inverse, ay + y * inverse
    # relative velocity on the right of the line to the neighbour (or on it): leave across the right tangent
    turn = 1.0 if x * (vy - other_vy) - y * (vx - other_vx) <= 0.0 else -1.0
    row[4], row[5] = -nx * sine + turn * ny * cosine, -ny * sine - turn * nx * cosine
    row[6] = row[3] + cx * row[4] + cy * row[5]
    row[7], row[8] = -nx * sine - turn * ny * cosine, -ny * sine + turn * nx * cosine
    row[9] = row[3] + cx * row[7] + cy * row[8]


@kernel
def companion(
    fellows: Floats, at: int, x: float, y: float, other_vx: float, other_vy: float, wx: float, wy: float,
    radius: float, horizon: float,
) -> None:  # fmt: skip
    """Write the constraint to stay with a group member at x, y (relative) that walks along w to ``fellows[at]``."""
    row = fellows[at]
    distance = math.sqrt(x * x + y * y)
    if distance < IN_RANGE * radius or distance == 0.0:
        row[0], row[1], row[2] = 1.0, other_vx + x, other_vy + y
        row[3], row[4] = wx, wy
        return
    nx, ny = x / distance, y / distance
    inverse = 1.0 / horizon
    along = other_vx * nx + other_vy * ny
    row[0], row[1], row[2] = 0.0, nx, ny
    row[3], row[4] = along + (distance - radius) * inverse, along + distance + radius
    sine = radius / distance
    cosine = math.sqrt(1.0 - sine * sine)
    cx, cy = other_vx + x * inverse, other_vy + y * inverse
    row[5], row[6] = -nx * sine + ny * cosine, -ny * sine - nx * cosine
    row[7] = radius * inverse + cx * row[5] + cy * row[6]
    row[8], row[9] = -nx * sine - ny * cosine, -ny * sine + nx * cosine
    row[10] = radius * inverse + cx * row[8] + cy * row[9]


@kernel
def walls_near(walls: Floats, x: float, y: float, reach: float, near: Floats) -> int:
    """Write the walls nearer than ``reach``, relative to x, y, to ``near``; return their number."""
    held = 0
    for k in range(len(walls)):
        ax, ay, bx, by = walls[k, 0] - x, walls[k, 1] - y, walls[k, 2] - x, walls[k, 3] - y
        nx, ny = nearest_on_segment(0.0, 0.0, ax, ay, bx, by)
        if nx * nx + ny * ny < reach * reach:
            near[held, 0], near[held, 1], near[held, 2], near[held, 3] = ax, ay, bx, by
            near[held, 4], near[held, 5] = nx, ny
            held += 1
    return held


@kernel
def collision(
    vx: float, vy: float, cones: Floats, count: int, walls: Floats, wall_count: int, radius: float, horizon: float
) -> float:
    """Return the cost of the worst cone or wall."""
    worst = 0.0
    for k in range(count):
        behind = vx * cones[k, 0] + vy * cones[k, 1] - cones[k, 2]
        if behind <= 0.0:
            continue
        if cones[k, 3] < 0.0:
            worst = max(worst, OVERLAP * behind)
            continue
        near = cones[k, 6] - vx * cones[k, 4] - vy * cones[k, 5]
        if near >= 0.0 and cones[k, 9] - vx * cones[k, 7] - vy * cones[k, 8] >= 0.0:
            worst = max(worst, DEEP * (behind if behind < cones[k, 3] else near))
    for k in range(wall_count):
        worst = max(worst, _wall_cost(vx, vy, walls[k], radius, horizon))
    return worst


@kernel
def _wall_cost(vx: float, vy: float, wall: Floats, radius: float, horizon: float) -> float:
    """Return the cost of the excess speed with which the wall is touched within ``horizon``."""
    nx, ny = float(wall[4]), float(wall[5])
    distance = math.sqrt(nx * nx + ny * ny)
    if distance == 0.0:
        return 0.0
    if distance <= radius:
        return OVERLAP * max(0.0, radius - distance + (vx * nx + vy * ny) / distance)
    t = time_to_segment(0.0, 0.0, vx, vy, radius, wall[0], wall[1], wall[2], wall[3])
    return SOLID * math.sqrt(vx * vx + vy * vy) * max(0.0, 1.0 - t / horizon)


@kernel
def fellowship(
    vx: float, vy: float, fellows: Floats, count: int, radius: float, depth: float, closeness: float
) -> float:
    """Return the mean violation of the group constraints; half as much in a perfect formation."""
    if count == 0:
        return 0.0
    total = 0.0
    talk = 1.0
    for k in range(count):
        if fellows[k, 0] > 0.0:
            qx, qy = vx - fellows[k, 1], vy - fellows[k, 2]
            apart = max(0.0, math.sqrt(qx * qx + qy * qy) - radius)
            if depth > 0.0:
                sx, sy = fellows[k, 3], fellows[k, 4]
                off = max(0.0, abs(qx * sx + qy * sy) - depth, abs(qx * sy - qy * sx) - radius)
                talk = min(talk, 0.5 + 0.5 * off)
                apart = 0.5 * (apart + off)
        else:
            along = vx * fellows[k, 1] + vy * fellows[k, 2]
            apart = max(0.0, fellows[k, 3] - along, along - fellows[k, 4])
            apart = max(apart, vx * fellows[k, 5] + vy * fellows[k, 6] - fellows[k, 7])
            apart = max(apart, vx * fellows[k, 8] + vy * fellows[k, 9] - fellows[k, 10])
        total += apart
    return closeness * talk * total / count


@kernel
def own_way(
    vx: float, vy: float, wish: tuple[float, float, float, float], now: tuple[float, float], calm: float
) -> tuple[float, float]:
    """Return the deviation from the desired velocity, and the penalties of turning, walking backwards and standing.

    ``wish`` is the desired velocity and its unit direction (x, y, unit x, unit y), ``now`` the current unit direction.
    """
    speed2 = vx * vx + vy * vy
    speed = math.sqrt(speed2)
    ux, uy = (vx / speed, vy / speed) if speed > DIRECTED else (0.0, 0.0)
    px, py, dx, dy = wish
    desired2 = px * px + py * py
    off = (ux - dx) ** 2 + (uy - dy) ** 2 + abs(speed - math.sqrt(desired2))
    penalty = ((ux - now[0]) ** 2 + (uy - now[1]) ** 2) / (calm * calm)
    if vx * px + vy * py < 0.0:
        penalty += BACKWARDS
    if speed2 < STANDING2 < desired2:
        penalty += STOPPING
    return off, penalty
