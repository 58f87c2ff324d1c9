"""Linear programs of ORCA (van den Berg et al. 2011): the best velocity on the left of all lines.

A line is a row ``x, y, ux, uy``: a point and a unit direction in velocity space; velocities on its left are permitted.
"""

from __future__ import annotations

import math

from crowdbot.core import kernel
from crowdbot.typing import Floats

PARALLEL = 1e-5
"""Lines count as parallel if the sine of their angle is at most this."""


@kernel
def best_velocity(
    lines: Floats, fixed: int, count: int, speed: float, wish_x: float, wish_y: float, spare: Floats
) -> tuple[float, float]:
    """Return the velocity nearest to the desired one, at most ``speed``, on the left of every line.

    If no velocity is on the left of all lines, the largest violation of the lines from ``fixed`` on is minimised; the
    first ``fixed`` lines (walls) are hard constraints. ``spare`` is working memory for as many lines.
    """
    x, y = clip_speed(wish_x, wish_y, speed)
    failed, x, y = _solve_plane(lines, count, speed, wish_x, wish_y, False, x, y)
    if failed < count:
        x, y = _minimize_violation(lines, fixed, count, failed, speed, x, y, spare)
    return x, y


@kernel
def clip_speed(x: float, y: float, speed: float) -> tuple[float, float]:
    """Return a desired velocity, shortened to at most ``speed``."""
    if x * x + y * y > speed * speed:
        length = math.sqrt(x * x + y * y)
        return x / length * speed, y / length * speed
    return x, y


@kernel
def _solve_on_line(
    lines: Floats, k: int, speed: float, wish_x: float, wish_y: float, along: bool
) -> tuple[bool, float, float]:
    """Return whether line k has a permitted point, and the best: nearest to the desired, or farthest ``along`` it."""
    x, y, ux, uy = lines[k, 0], lines[k, 1], lines[k, 2], lines[k, 3]
    across = ux * y - uy * x
    half2 = speed * speed - across * across
    if half2 < 0.0:
        return False, 0.0, 0.0
    middle = -(x * ux + y * uy)
    half = math.sqrt(half2)
    low, high, failed = middle - half, middle + half, False
    for i in range(k):  # no branch: none could foresee it
        vx, vy = lines[i, 2], lines[i, 3]
        turn = ux * vy - uy * vx
        side = vx * (y - lines[i, 1]) - vy * (x - lines[i, 0])
        t = side / turn
        failed |= (side < 0.0) & (abs(turn) <= PARALLEL)
        high = t if (turn > PARALLEL) & (t < high) else high
        low = t if (turn < -PARALLEL) & (t > low) else low
    if low > high or failed:
        return False, 0.0, 0.0
    if along:
        t = high if wish_x * ux + wish_y * uy > 0.0 else low
    else:
        t = min(high, max(low, ux * (wish_x - x) + uy * (wish_y - y)))
    return True, x + t * ux, y + t * uy


@kernel
def _solve_plane(
    lines: Floats, count: int, speed: float, wish_x: float, wish_y: float, along: bool, x: float, y: float
) -> tuple[int, float, float]:
    """Add the lines one by one, from the best point x, y of the disc; return the first that fails, or ``count``."""
    for k in range(count):
        if lines[k, 2] * (lines[k, 1] - y) - lines[k, 3] * (lines[k, 0] - x) > 0.0:
            found, new_x, new_y = _solve_on_line(lines, k, speed, wish_x, wish_y, along)
            if not found:
                return k, x, y
            x, y = new_x, new_y
    return count, x, y


@kernel
def _minimize_violation(
    lines: Floats, fixed: int, count: int, failed: int, speed: float, x: float, y: float, spare: Floats
) -> tuple[float, float]:
    """Minimise the violation of each worst line, from the failed one on; earlier lines are not violated more."""
    for k in range(fixed):
        for c in range(4):
            spare[k, c] = lines[k, c]
    worst = 0.0
    for i in range(failed, count):
        ux, uy = lines[i, 2], lines[i, 3]
        if ux * (lines[i, 1] - y) - uy * (lines[i, 0] - x) <= worst:
            continue
        held = fixed
        for j in range(fixed, i):
            held += _write_bisector(lines, i, j, spare, held)
        passed, new_x, new_y = _solve_plane(spare, held, speed, -uy, ux, True, -uy * speed, ux * speed)
        if passed == held:  # otherwise, failed by rounding only: keep the velocity
            x, y = new_x, new_y
        worst = ux * (lines[i, 1] - y) - uy * (lines[i, 0] - x)
    return x, y


@kernel
def _write_bisector(lines: Floats, i: int, j: int, spare: Floats, at: int) -> int:
    """Write the line on which lines i and j are equally violated to ``spare[at]``; return 1, or 0 if there is none."""
    x, y, ux, uy = lines[i, 0], lines[i, 1], lines[i, 2], lines[i, 3]
    ox, oy, vx, vy = lines[j, 0], lines[j, 1], lines[j, 2], lines[j, 3]
    turn = ux * vy - uy * vx
    if abs(turn) <= PARALLEL:
        if ux * vx + uy * vy > 0.0:
            return 0
        spare[at, 0], spare[at, 1] = 0.5 * (x + ox), 0.5 * (y + oy)
    else:
        t = (vx * (y - oy) - vy * (x - ox)) / turn
        spare[at, 0], spare[at, 1] = x + t * ux, y + t * uy
    dx, dy = vx - ux, vy - uy
    length = math.sqrt(dx * dx + dy * dy)
    spare[at, 2], spare[at, 3] = dx / length, dy / length
    return 1
