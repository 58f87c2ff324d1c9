"""Gradients of the cost of VBM: visible objects and desired velocity."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.typing import Floats

FIELD = math.radians(150.0)
"""Width of the field of view [rad]."""
FAN = 15
"""Number of rays for walls in the variant ``agents``."""
STILL = 1e-3
"""Speed [m/s] below which an agent looks along its heading, and squared relative speed that counts as 0."""
FORESIGHT = 10.0
"""Maximum time of closest approach [s]; later ones are ignored."""
FAINT = 1e-3
"""Minimum slopes of a ray (both) in the variant ``crowdbot``, and minimum cost of a term in ``agents``."""
SQUEEZED = 0.05
"""Minimum distance of bodies as a fraction of the distance of their centres, which keeps the direction defined."""
EXACT = 1e-9
"""A closest approach below this distance [m] has no side."""
STEEP = 0.1
"""Slope added in the variant ``crowdbot`` if left and right have nearly equal costs."""


@kernel
def slopes(
    x: float, y: float, wx: float, wy: float, hx: float, hy: float, speed: float, late: float, near: float, ridge: float
) -> tuple[float, float, float]:  # fmt: skip
    """Return the cost of an object at x, y with relative velocity w, and its slopes over the agent's angle and speed.

    ``h`` is the direction of the agent, ``late`` and ``near`` are the scales of time and distance. The result is 0 if
    the object moves away or its closest approach is too late. For a closest approach below ``ridge``, the slope is
    that at ``ridge``.
    """
    w2 = wx * wx + wy * wy
    if w2 < STILL:
        return 0.0, 0.0, 0.0
    t = -(x * wx + y * wy) / w2
    if t < 0.0 or t > FORESIGHT:
        return 0.0, 0.0, 0.0
    cx, cy = x + t * wx, y + t * wy
    cost = math.exp(-0.5 * ((t / late) ** 2 + (cx * cx + cy * cy) / (near * near)))
    miss = math.sqrt(cx * cx + cy * cy)
    if miss < ridge:
        if miss > EXACT:
            cx, cy = cx * ridge / miss, cy * ridge / miss
        else:  # no side is preferred: keep right
            right = math.copysign(ridge / math.sqrt(w2), -(wx * hx + wy * hy))
            cx, cy = right * wy, -right * wx
    px, py = speed * hy, -speed * hx  # derivative of w over the angle
    qx, qy = (x + 2.0 * t * wx) / w2, (y + 2.0 * t * wy) / w2
    # c is perpendicular to w: its length does not depend on t
    of_angle = -(qx * px + qy * py) * t / (late * late) + t * (cx * px + cy * py) / (near * near)
    of_speed = (qx * hx + qy * hy) * t / (late * late) - t * (cx * hx + cy * hy) / (near * near)
    return cost, -cost * of_angle, -cost * of_speed


@kernel
def _first_ray(sines: Floats, value: float) -> int:
    """Return the first ray whose sine is not below ``value``."""
    low, high = 0, len(sines)
    while low < high:
        middle = (low + high) // 2
        if sines[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low


@kernel
def look_at_walls(
    walls: Floats, x: float, y: float, hx: float, hy: float, reach: float, rays: Floats, depth: Floats
) -> None:
    """Write the distance to the nearest wall along each ray to ``depth``; inf without a wall within ``reach``."""
    for k in range(len(depth)):
        depth[k] = math.inf
    sines = rays[0]
    for m in range(len(walls)):
        ax, ay, bx, by = walls[m, 0] - x, walls[m, 1] - y, walls[m, 2] - x, walls[m, 3] - y
        nx, ny = nearest_on_segment(0.0, 0.0, ax, ay, bx, by)
        before, after = hx * ax + hy * ay, hx * bx + hy * by
        if nx * nx + ny * ny >= reach * reach or (before <= 0.0 and after <= 0.0):
            continue
        turn = ax * by - ay * bx  # above 0: b is on the left of a, seen from x, y
        if turn == 0.0:
            continue
        left = math.copysign(1.0, turn)  # an end behind the agent is outside of the field of view
        sine_a = -left if before < 0.0 else (hx * ay - hy * ax) / math.sqrt(ax * ax + ay * ay)
        sine_b = left if after < 0.0 else (hx * by - hy * bx) / math.sqrt(bx * bx + by * by)
        for k in range(_first_ray(sines, min(sine_a, sine_b)), _first_ray(sines, max(sine_a, sine_b))):
            ux, uy = hx * rays[1, k] - hy * sines[k], hy * rays[1, k] + hx * sines[k]
            along = ux * (by - ay) - uy * (bx - ax)
            if along != 0.0 and turn / along > 0.0:
                depth[k] = min(depth[k], turn / along)


@kernel
def sum_slopes(
    row: int,
    others: NDArray[np.int32],
    place: Floats,
    velocity: Floats,
    radius: Floats,
    hx: float,
    hy: float,
    speed: float,
    late: float,
    near: float,
    rays: Floats,
    depth: Floats,
    taken: NDArray[np.bool_],
    field: bool,
    ridge: float,
    sums: Floats,
) -> None:
    """Sum the slopes of visible objects: over angle, over speed, positive ones over angle, weights.

    With ``field``, each ray has the same weight and shows the nearest object; otherwise agents are weighted by their
    visual angle, and distances are between bodies.
    """
    sums[:] = 0.0
    taken[:] = False
    x0, y0, vx, vy = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1]
    widest = rays[0, len(depth) - 1]
    for n in range(len(others)):  # sorted by distance
        other = others[n]
        x, y = place[other, 0] - x0, place[other, 1] - y0
        distance = math.sqrt(x * x + y * y)
        ahead, across = hx * x + hy * y, hx * y - hy * x
        if distance == 0.0 or ahead < 0.0 or not distance < math.inf:
            continue
        side = radius[other] / distance
        if field:
            edge = math.sqrt(1.0 + side * side) * distance
            weight = 0.0
            last = _first_ray(rays[0], (across + side * ahead) / edge)
            for k in range(_first_ray(rays[0], (across - side * ahead) / edge), last):
                if not taken[k] and distance < depth[k]:
                    taken[k] = True
                    weight += 1.0
        else:
            weight = 2.0 * math.atan(side) if abs(across) <= widest * distance else 0.0
            shorter = max(1.0 - (radius[row] + radius[other]) / distance, SQUEEZED)
            x, y = shorter * x, shorter * y
        if weight > 0.0:
            wx, wy = velocity[other, 0] - vx, velocity[other, 1] - vy
            cost, turn, change = slopes(x, y, wx, wy, hx, hy, speed, late, near, 0.0 if field else ridge)
            _add(sums, cost, turn, change, weight, field)
    for k in range(len(depth)):
        if not taken[k] and depth[k] < math.inf:
            gap = depth[k] if field else depth[k] * max(1.0 - radius[row] / depth[k], SQUEEZED)
            x, y = gap * (hx * rays[1, k] - hy * rays[0, k]), gap * (hy * rays[1, k] + hx * rays[0, k])
            cost, turn, change = slopes(x, y, -vx, -vy, hx, hy, speed, late, near, 0.0)
            _add(sums, cost, turn, change, 1.0 if field else FIELD / FAN, field)


@kernel
def _add(sums: Floats, cost: float, turn: float, change: float, weight: float, field: bool) -> None:
    if (field and abs(turn) > FAINT and abs(change) > FAINT) or (not field and cost > FAINT):
        sums[0] += weight * turn
        sums[1] += weight * change
        sums[2] += weight * max(0.0, turn)
        sums[3] += weight


@kernel
def mean_slopes(sums: Floats, push: float) -> tuple[float, float]:
    """Return the mean slopes over angle and speed, with a ``push`` to one side if no side is preferred."""
    turn, change, rising, weight = sums[0], sums[1], sums[2], sums[3]
    if weight == 0.0:
        return 0.0, 0.0
    if abs(turn) < STEEP and rising > 0.1 * STEEP:
        turn += math.copysign(push, turn)
    return turn / weight, change / weight


@kernel
def desire_slopes(
    hx: float, hy: float, speed: float, px: float, py: float, slow: float, wide: float, most: float
) -> tuple[float, float]:
    """Return the slopes over angle and speed of the cost of deviations from the desired velocity.

    They are steeper for slow agents, limited such that a step with gain ``1 / most`` does not overshoot.
    """
    desired = math.sqrt(px * px + py * py)
    steeper = max(1.0, 1.0 / max(STILL, speed))
    off = speed - desired
    change = off * min(steeper / (2.0 * slow * slow), most) * math.exp(-off * off / (2.0 * slow * slow))
    angle = math.atan2(hx * py - hy * px, hx * px + hy * py) if desired > 0.0 else 0.0
    return -angle * min(steeper / (2.0 * wide * wide), most) * math.exp(-angle * angle / (2.0 * wide * wide)), change
