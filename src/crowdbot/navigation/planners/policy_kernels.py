"""Kernels of the learned policy: its inputs, and its network as loops with a fixed order of sums.

The result of an environment has the same bits alone and among others, on every machine. Inputs are expressed in the
goal frame: origin at the robot, x axis towards the waypoint.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.navigation.goal_motion import exact_distance, slow_speed
from crowdbot.typing import Floats

OWN_VALUES = ("waypoint_distance", "goal_distance", "vx", "vy", "max_speed", "radius")
"""Inputs about the robot; distances are divided by SCALE and cut off at SIGHT."""
PERSON_VALUES = (
    "x", "y", "vx", "vy", "radii", "distance", "clearance",
    "time_standing", "clearance_standing", "time_moving", "clearance_moving",
)  # fmt: skip
"""Inputs about a person: state, and time and clearance of the closest approach, if the robot stands and if it moves
straight to the waypoint at its maximum speed."""
SIGHT = 10.0
"""Distance [m] beyond which people are ignored."""
SCALE = 5.0
"""Distances are divided by it [m]."""
LONGEST = 5.0
"""Largest time of a closest approach [s]."""
RINGS, DIRECTIONS = 5, 32
"""Speeds and directions of the velocities among which contacts are avoided."""
NEAR, CONTACT = 1.0, 5.0
"""Penalties [m/s] of an immediate clearance of 0 and of a contact; they fade with time."""


@kernel
def closest_approach(x: float, y: float, vx: float, vy: float, radii: float) -> tuple[float, float]:
    """Return time [s] and clearance [m] of the closest approach of a point with constant velocity to the origin."""
    square = vx * vx + vy * vy
    time = 0.0
    if square > 1e-9:
        time = min(max(-(x * vx + y * vy) / square, 0.0), LONGEST)
    dx, dy = x + time * vx, y + time * vy
    return time, math.sqrt(dx * dx + dy * dy) - radii


@kernel
def write_inputs(
    asking: NDArray[np.bool_], pose: Floats, goal: Floats, waypoint: Floats, twist: Floats, radius: Floats, top: float,
    position: Floats, velocity: Floats, size: Floats, seen: NDArray[np.bool_],
    axis: Floats, own: Floats, people: Floats, count: NDArray[np.int64],
) -> None:  # fmt: skip
    """Write the inputs of the policy for N environments.

    Args:
        asking: ``[N]`` rows to fill.
        pose, goal, waypoint, twist, radius: state of the robot, as in an :class:`ObservationBatch`.
        top: maximum speed [m/s].
        position, velocity, size, seen: people ``[N, A, ...]``.
        axis: ``[N, 2]`` x axis of the goal frame, in the world.
        own: ``[N, 6]`` OWN_VALUES.
        people: ``[N, K, 11]`` PERSON_VALUES, nearest first.
        count: ``[N]`` number of people, up to K.
    """
    K = people.shape[1]
    chosen = np.empty(K, dtype=np.int64)
    gaps = np.empty(K)
    for e in range(len(pose)):
        if not asking[e]:
            continue
        x, y, heading = pose[e, 0], pose[e, 1], pose[e, 2]
        dx, dy = waypoint[e, 0] - x, waypoint[e, 1] - y
        away = math.sqrt(dx * dx + dy * dy)
        cos, sin = math.cos(heading), math.sin(heading)
        ax, ay = cos, sin
        if away > 1e-6:
            ax, ay = dx / away, dy / away
        axis[e, 0], axis[e, 1] = ax, ay
        gx, gy = goal[e, 0] - waypoint[e, 0], goal[e, 1] - waypoint[e, 1]
        left = away + math.sqrt(gx * gx + gy * gy)
        wx, wy = cos * twist[e, 0] - sin * twist[e, 2], sin * twist[e, 0] + cos * twist[e, 2]
        own[e, 0], own[e, 1] = min(away, SIGHT) / SCALE, min(left, SIGHT) / SCALE
        own[e, 2], own[e, 3] = ax * wx + ay * wy, ax * wy - ay * wx
        own[e, 4], own[e, 5] = top, radius[e]
        n = int(np.int64(0))
        for a in range(size.shape[1]):
            if not seen[e, a]:
                continue
            dx, dy = position[e, a, 0] - x, position[e, a, 1] - y
            gap = math.sqrt(dx * dx + dy * dy) - size[e, a] - radius[e]
            if gap > SIGHT or (n == K and gap >= gaps[K - 1]):
                continue
            k = min(n, K - 1)
            while k > 0 and gaps[k - 1] > gap:
                gaps[k], chosen[k] = gaps[k - 1], chosen[k - 1]
                k -= 1
            gaps[k], chosen[k] = gap, a
            n = min(n + 1, K)
        count[e] = n
        for k in range(n):
            a = chosen[k]
            dx, dy = position[e, a, 0] - x, position[e, a, 1] - y
            px, py = ax * dx + ay * dy, ax * dy - ay * dx
            vx = ax * velocity[e, a, 0] + ay * velocity[e, a, 1]
            vy = ax * velocity[e, a, 1] - ay * velocity[e, a, 0]
            radii = size[e, a] + radius[e]
            row = people[e, k]
            row[0], row[1], row[2], row[3], row[4] = px / SCALE, py / SCALE, vx, vy, radii
            row[5], row[6] = min(gaps[k] + radii, SIGHT) / SCALE, min(max(gaps[k], -0.5), 1.0)
            time, clearance = closest_approach(px, py, vx, vy, radii)
            row[7], row[8] = time / LONGEST, min(max(clearance, -0.5), 2.0)
            time, clearance = closest_approach(px, py, vx - top, vy, radii)
            row[9], row[10] = time / LONGEST, min(max(clearance, -0.5), 2.0)


@kernel
def apply_layer(values: Floats, size: int, weight: Floats, bias: Floats, rectify: bool, out: Floats) -> None:
    """Write a fully connected layer of ``size`` values, for a weight ``[in, out]``, with rectification or without."""
    width = weight.shape[1]
    for j in range(width):
        out[j] = bias[j]
    for i in range(size):
        value = values[i]
        if value != 0.0:
            for j in range(width):
                out[j] += value * weight[i, j]
    if rectify:
        for j in range(width):
            out[j] = max(out[j], 0.0)


@kernel
def apply_network(
    asking: NDArray[np.bool_], own: Floats, people: Floats, count: NDArray[np.int64], out: Floats,
    w1: Floats, b1: Floats, w2: Floats, b2: Floats, w3: Floats, b3: Floats, w4: Floats, b4: Floats,
    w5: Floats, b5: Floats,
) -> None:  # fmt: skip
    """Write the outputs ``[N, 2]`` of the network for inputs of :func:`write_inputs`.

    Two layers for each person, the maximum over people, then two layers and a linear one.
    """
    F, G = own.shape[1], people.shape[2]
    person, first, second = np.empty(G + F), np.empty(len(b1)), np.empty(len(b2))
    pooled = np.empty(len(b2) + F)
    third, fourth = np.empty(len(b3)), np.empty(len(b4))
    for e in range(len(own)):
        if not asking[e]:
            continue
        pooled[: len(b2)] = 0.0
        pooled[len(b2) :] = own[e]
        person[G:] = own[e]
        for k in range(count[e]):
            person[:G] = people[e, k]
            apply_layer(person, G + F, w1, b1, True, first)
            apply_layer(first, len(b1), w2, b2, True, second)
            for j in range(len(b2)):
                pooled[j] = max(pooled[j], second[j])
        apply_layer(pooled, len(pooled), w3, b3, True, third)
        apply_layer(third, len(b3), w4, b4, True, fourth)
        apply_layer(fourth, len(b4), w5, b5, False, out[e])


@kernel
def limit_velocities(
    asking: NDArray[np.bool_], pose: Floats, goal: Floats, waypoint: Floats, axis: Floats, limits: Floats,
    velocity: Floats,
) -> None:  # fmt: skip
    """Turn outputs ``[N, 2]`` of the network, shares of the maximum speed in the goal frame, into velocities [m/s].

    The speed is limited near the goal, as for every navigator; limits are speed, turn rate and their accelerations.
    """
    for e in range(len(pose)):
        if not asking[e]:
            continue
        x, y = velocity[e, 0], velocity[e, 1]
        size = math.sqrt(x * x + y * y)
        away = exact_distance(pose[e, 0], pose[e, 1], waypoint[e, 0], waypoint[e, 1])
        left = away + exact_distance(waypoint[e, 0], waypoint[e, 1], goal[e, 0], goal[e, 1])
        speed = min(limits[0] * min(size, 1.0), slow_speed(limits[0], left, limits[2]))
        scale = speed / max(size, 1e-9)
        x, y = x * scale, y * scale
        velocity[e, 0] = axis[e, 0] * x - axis[e, 1] * y
        velocity[e, 1] = axis[e, 1] * x + axis[e, 0] * y


@kernel
def _penalty(
    vx: float, vy: float, x: float, y: float, radius: float, position: Floats, velocity: Floats, size: Floats,
    seen: NDArray[np.bool_], horizon: float, margin: float,
) -> float:  # fmt: skip
    """Return the penalty [m/s] of a velocity: of the most critical person within the time horizon."""
    worst = 0.0
    for a in range(len(size)):
        if not seen[a]:
            continue
        px, py = position[a, 0] - x, position[a, 1] - y
        radii = size[a] + radius
        reach = radii + margin + 3.0 * horizon
        if px * px + py * py > reach * reach:
            continue
        wx, wy = velocity[a, 0] - vx, velocity[a, 1] - vy
        square, time = wx * wx + wy * wy, 0.0
        if square > 1e-9:
            time = min(max(-(px * wx + py * wy) / square, 0.0), horizon)
        dx, dy = px + time * wx, py + time * wy
        clearance = math.sqrt(dx * dx + dy * dy) - radii
        if clearance >= margin:
            continue
        soon = 1.0 - 0.8 * time / horizon
        value = NEAR * soon * (1.0 - max(clearance, 0.0) / margin)
        if clearance < 0.0:
            value += soon * (CONTACT - 10.0 * clearance)
        worst = max(worst, value)
    return worst


@kernel
def avoid_contacts(
    asking: NDArray[np.bool_], pose: Floats, radius: Floats, position: Floats, velocity: Floats, size: Floats,
    seen: NDArray[np.bool_], top: float, horizon: float, margin: float, out: Floats,
) -> None:  # fmt: skip
    """Replace velocities ``[N, 2]`` of the world [m/s] by near ones that keep a margin to people.

    The cost of a velocity is its distance from the original one plus a penalty for people, at constant velocity, who
    come closer than the margin within the time horizon. The candidates are the original velocity and a polar grid.
    """
    for e in range(len(pose)):
        if not asking[e]:
            continue
        x, y, wx, wy = pose[e, 0], pose[e, 1], out[e, 0], out[e, 1]
        best = _penalty(wx, wy, x, y, radius[e], position[e], velocity[e], size[e], seen[e], horizon, margin)
        if best == 0.0:
            continue
        angle = math.atan2(wy, wx)
        for i in range(RINGS + 1):
            speed = top * i / RINGS
            for j in range(DIRECTIONS if i else 1):
                direction = angle + 2.0 * math.pi * j / DIRECTIONS
                vx, vy = speed * math.cos(direction), speed * math.sin(direction)
                cost = math.sqrt((vx - wx) * (vx - wx) + (vy - wy) * (vy - wy))
                if cost < best:
                    cost += _penalty(
                        vx, vy, x, y, radius[e], position[e], velocity[e], size[e], seen[e], horizon, margin
                    )
                    if cost < best:
                        best, out[e, 0], out[e, 1] = cost, vx, vy
