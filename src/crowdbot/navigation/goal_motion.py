"""Kernels of the motion to a goal, equal to the last bit to the methods of :class:`crowdbot.navigation.Observation`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.typing import Floats

TURN_GAIN = 3.0
"""Turn rate [rad/s] per rad of heading error."""
SLOWING_TIME = 0.5
"""Near the goal the speed is limited to the distance over this time [s]."""
STANDING = 0.05
"""Speed [m/s] below which a holonomic robot keeps its heading."""
LARGEST = 1e8
"""Values above this [m], [m/s] are left to the crowd model, which rejects them."""
SPLIT = 134217729.0
"""Factor 2^27 + 1, which splits a number into two halves of 26 bits."""


@kernel
def _add(total: float, value: float) -> tuple[float, float]:
    """Return the sum and its rounding error, for a total above the value."""
    after = total + value
    return after, (total - after) + value


@kernel
def _add_square(total: float, x: float, sign: float) -> tuple[float, float, float, float]:
    """Return the total plus or minus x * x, and three parts of the rounding error."""
    spread = x * SPLIT
    high = spread - (spread - x)
    low = x - high
    total, first = _add(total, sign * high * high)
    total, second = _add(total, sign * 2.0 * high * low)
    return total, first, second, sign * low * low


@kernel
def exact_distance(ax: float, ay: float, bx: float, by: float) -> float:
    """Return the distance [m] of two points with the bits of ``math.dist``, which is more exact than ``sqrt``.

    Both compute the sum of squares with twice the digits and correct the root once (differential correction).
    """
    dx, dy = abs(ax - bx), abs(ay - by)
    largest = max(dx, dy)
    if largest == 0.0:
        return 0.0
    scale = math.ldexp(1.0, -math.frexp(largest)[1])
    total, a1, a2, a3 = _add_square(1.0, dx * scale, 1.0)
    total, b1, b2, b3 = _add_square(total, dy * scale, 1.0)
    first, second, third = a1 + b1, a2 + b2, a3 + b3
    root = math.sqrt(total - 1.0 + (first + second + third))
    total, c1, c2, c3 = _add_square(total, root, -1.0)
    rest = total - 1.0 + ((first + c1) + (second + c2) + (third + c3))
    return (root + rest / (2.0 * root)) / scale


@kernel
def braking_speed(distance: float, acceleration: float) -> float:
    """Return the speed [m/s] from which the drive stops within ``distance`` [m], with 20 % reserve."""
    if math.isinf(acceleration):
        return math.inf
    return math.sqrt(1.6 * acceleration * max(0.0, distance))


@kernel
def slow_speed(top: float, remaining: float, acceleration: float) -> float:
    """Return the largest speed [m/s] at ``remaining`` [m] before the goal."""
    return min(top, remaining / SLOWING_TIME, braking_speed(remaining, acceleration))


@kernel
def direction_to(x: float, y: float, heading: float, tx: float, ty: float) -> float:
    """Return the direction to a point in the robot frame, -pi to pi [rad]; 0 at the point."""
    if x == tx and y == ty:
        return 0.0
    return math.pi - (math.pi - (math.atan2(ty - y, tx - x) - heading)) % (2.0 * math.pi)


@kernel
def turn_towards(angle: float, most: float, acceleration: float) -> float:
    """Return the turn rate [rad/s] that turns the robot by ``angle`` [rad] without overshoot."""
    size = min(TURN_GAIN * abs(angle), most)
    if math.isfinite(acceleration):
        size = min(size, math.sqrt(1.6 * acceleration * abs(angle)))
    return math.copysign(size, angle)


@kernel
def twists_towards(
    asking: NDArray[np.bool_], pose: Floats, goal: Floats, waypoint: Floats, limits: Floats, out: Floats
) -> None:
    """Write the twists ``[N, 3]`` towards the waypoints; limits are speed, turn rate and their accelerations."""
    for e in range(len(pose)):
        if not asking[e]:
            continue
        x, y, heading, tx, ty = pose[e, 0], pose[e, 1], pose[e, 2], waypoint[e, 0], waypoint[e, 1]
        bearing = direction_to(x, y, heading, tx, ty)
        remaining = exact_distance(x, y, tx, ty) + exact_distance(tx, ty, goal[e, 0], goal[e, 1])
        ahead = max(0.0, 2.0 * math.cos(bearing) - 1.0)
        out[e, 0] = slow_speed(limits[0], remaining, limits[2]) * ahead
        out[e, 1] = turn_towards(bearing, limits[1], limits[3])
        out[e, 2] = 0.0


@kernel
def velocities_towards(
    asking: NDArray[np.bool_], pose: Floats, goal: Floats, waypoint: Floats, limits: Floats, out: Floats
) -> None:
    """Write the velocities ``[N, 2]`` of the world towards the waypoints; limits as in :func:`twists_towards`."""
    for e in range(len(pose)):
        if not asking[e]:
            continue
        x, y, tx, ty = pose[e, 0], pose[e, 1], waypoint[e, 0], waypoint[e, 1]
        away = exact_distance(x, y, tx, ty)
        remaining = away + exact_distance(tx, ty, goal[e, 0], goal[e, 1])
        speed = slow_speed(limits[0], remaining, limits[2]) / max(away, 1e-9)
        out[e, 0], out[e, 1] = (tx - x) * speed, (ty - y) * speed


@kernel
def holonomic_twists(
    asking: NDArray[np.bool_], pose: Floats, velocity: Floats, limits: Floats, dt: float, out: Floats
) -> None:
    """Write the twists ``[N, 3]`` of a holonomic drive that moves with velocities ``[N, 2]`` of the world.

    The robot turns towards its motion. The velocity is expressed in the frame in the middle of the turn, so that the
    chord of the arc has the direction of the velocity.
    """
    for e in range(len(pose)):
        if not asking[e]:
            continue
        vx, vy, heading, turn = velocity[e, 0], velocity[e, 1], pose[e, 2], 0.0
        speed = math.sqrt(vx * vx + vy * vy)
        if speed > limits[0]:
            vx, vy = vx * (limits[0] / speed), vy * (limits[0] / speed)
        if speed > STANDING:
            turn = turn_towards(direction_to(0.0, 0.0, heading, vx, vy), limits[1], limits[3])
        middle = heading + 0.5 * turn * dt
        cos, sin = math.cos(middle), math.sin(middle)
        out[e, 0], out[e, 1], out[e, 2] = cos * vx + sin * vy, turn, cos * vy - sin * vx


@kernel
def regular_rows(
    pose: Floats, goal: Floats, waypoint: Floats, twist: Floats, radius: Floats,
    position: Floats, velocity: Floats, size: Floats, seen: NDArray[np.bool_], out: NDArray[np.bool_],
) -> None:  # fmt: skip
    """Write which rows have only finite values and radii above 0.

    The people count if they are seen; give arrays without people to leave them out.
    """
    for e in range(len(pose)):
        fits = 0.0 < radius[e] <= LARGEST
        for c in range(3):
            fits = fits and abs(pose[e, c]) <= LARGEST and abs(twist[e, c]) <= LARGEST
        for c in range(2):
            fits = fits and abs(goal[e, c]) <= LARGEST and abs(waypoint[e, c]) <= LARGEST
        for a in range(size.shape[1]):
            if seen[e, a]:
                fits = fits and 0.0 < size[e, a] <= LARGEST
                for c in range(2):
                    fits = fits and abs(position[e, a, c]) <= LARGEST and abs(velocity[e, a, c]) <= LARGEST
        out[e] = fits
