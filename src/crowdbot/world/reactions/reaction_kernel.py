"""Kernels of reactions to robots: who reacts, and how they want to move. One pass over all people of all environments.

A row of ``state`` holds the code of the reaction in force (0: none), the time that is left of it or of the pause [s],
the index of the robot, and the time for which the robot has been out of sight [s]. A row of ``number`` holds distance,
duration, pause, speed, gap, repulsion, range, and the cosine of half the field of view.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.core.geometry import ray_to_segment
from crowdbot.typing import Bools, Floats

from .reaction import REACTIONS

Numbers = NDArray[np.int64]

IGNORE, IMPASSIVE, CURIOUS, SCARED, BLOCK, FOLLOW, GIVE_WAY, LOOK = range(1, len(REACTIONS))
LOST = 1.0
"""A robot that has been out of sight for this time [s] ends a reaction."""
FARTHER = 1.5
"""A robot at this multiple of the distance is out of sight."""
RELAXATION = 0.5
"""Time in which a person closes the distance to the place that they aim at [s]."""
AHEAD = 1.0
"""Time [s] within which a person would enter the lane of a robot, and stops instead."""
SLOW = 0.1
"""Speed [m/s] below which a robot counts as standing: it has no lane, and its heading is its direction."""


@kernel
def is_clear(x: float, y: float, dx: float, dy: float, length: float, edges: Floats) -> bool:
    """Return whether no edge ``[S, 4]`` lies between x, y and the point at ``length`` along the unit vector."""
    for s in range(len(edges)):
        if ray_to_segment(x, y, dx, dy, edges[s, 0], edges[s, 1], edges[s, 2], edges[s, 3]) < length:
            return False
    return True


@kernel
def is_seen(
    place: Floats, robot: Floats, reach: float, ahead: Floats, narrow: float, edges: Floats
) -> bool:  # fmt: skip
    """Return whether a robot is seen within ``reach``, in the field of view and without a wall in between."""
    dx, dy = robot[0] - place[0], robot[1] - place[1]
    far = math.sqrt(dx * dx + dy * dy)
    if far > reach:
        return False
    if far < 1e-9:
        return True
    dx, dy = dx / far, dy / far
    return dx * ahead[0] + dy * ahead[1] >= narrow and is_clear(place[0], place[1], dx, dy, far, edges)


@kernel
def find_robot(
    e: int, a: int, row: Floats, position: Floats, ahead: Floats, active: Bools, visible: Bools, robots: Numbers,
    edges: Floats,
) -> int:  # fmt: skip
    """Return the nearest robot that a person sees, -1 if there is none."""
    best, found = math.inf, -1
    for robot in robots:
        if not active[e, robot] or not visible[e, robot]:
            continue
        dx, dy = position[e, robot, 0] - position[e, a, 0], position[e, robot, 1] - position[e, a, 1]
        far = dx * dx + dy * dy
        if far < best and is_seen(position[e, a], position[e, robot], row[0], ahead[e, a], row[7], edges):
            best, found = far, robot
    return found


@kernel
def update_states(
    code: Numbers, number: Floats, rule: Floats, position: Floats, ahead: Floats, active: Bools, external: Bools,
    visible: Bools, robots: Numbers, edges: Floats, dt: float, state: Floats,
) -> bool:  # fmt: skip
    """Begin, continue and end reactions; return whether somebody reacts with a motion of their own.

    Args:
        code, number: ``[K]`` and ``[K, 8]`` kinds and parameters.
        rule: ``[E, A]`` 1 + the index of the parameters of a person; 0 or less for none.
        position, ahead: ``[E, A, 2]`` positions [m] and unit vectors of the headings.
        active, external, visible: ``[E, A]``.
        robots: indices of the robots.
        edges: ``[S, 4]`` walls.
        dt: time step [s].
        state: ``[E, A, 4]``, modified in place.
    """
    some = False
    for e in range(len(rule)):
        for a in range(rule.shape[1]):
            k = int(rule[e, a]) - 1
            if k < 0 or not active[e, a] or external[e, a]:
                continue
            if code[k] <= IMPASSIVE:
                state[e, a, 0] = code[k]
                continue
            row, own = number[k], state[e, a]
            own[1] = max(0.0, own[1] - dt)
            if own[0] == 0.0:
                robot = -1
                if own[1] == 0.0:
                    robot = find_robot(e, a, row, position, ahead, active, visible, robots, edges)
                if robot >= 0:
                    own[0], own[1], own[2], own[3] = code[k], row[1], robot, 0.0
                    some = True
                continue
            robot = int(own[2])
            seen = active[e, robot] and visible[e, robot]
            seen = seen and is_seen(position[e, a], position[e, robot], FARTHER * row[0], ahead[e, a], -2.0, edges)
            own[3] = 0.0 if seen else own[3] + dt
            if own[1] == 0.0 or own[3] > LOST or not active[e, robot]:
                own[0], own[1], own[3] = 0.0, row[2], 0.0
            else:
                some = True
    return some


@kernel
def choose_motion(
    number: Floats, rule: Floats, state: Floats, position: Floats, velocity: Floats, ahead: Floats, radius: Floats,
    speed: Floats, top: Floats, active: Bools, wish: Floats, steers: Bools, toward: Floats,
) -> None:  # fmt: skip
    """Replace the desired velocities of people who react to a robot.

    Args:
        number, rule, state: as in :func:`update_states`.
        position, velocity, ahead: ``[E, A, 2]``.
        radius, speed, top: ``[E, A]`` radii [m], preferred and largest speeds [m/s].
        active: ``[E, A]``.
        wish: ``[E, A, 2]`` desired velocities [m/s], modified in place.
        steers: ``[E, A]`` whose desired velocity is replaced.
        toward: ``[E, A, 2]`` vector to the robot for people who look at it, otherwise 0.
    """
    for e in range(len(rule)):
        for a in range(rule.shape[1]):
            code = int(state[e, a, 0])
            if code <= IMPASSIVE or not active[e, a] or rule[e, a] < 1.0:
                continue
            steers[e, a] = True
            row, robot = number[int(rule[e, a]) - 1], int(state[e, a, 2])
            dx, dy = position[e, robot, 0] - position[e, a, 0], position[e, robot, 1] - position[e, a, 1]
            gap, most = radius[e, a] + radius[e, robot], row[3] * speed[e, a]
            if code == SCARED:
                vx, vy = keep_away(row, dx, dy, gap, wish[e, a])
                most = top[e, a]
            elif code == CURIOUS:
                vx, vy = approach(dx, dy, gap + row[4], most)
            elif code == GIVE_WAY:
                vx, vy = give_way(dx, dy, velocity[e, robot], gap + row[4], most, wish[e, a])
            elif code == LOOK:
                vx, vy = row[3] * wish[e, a, 0], row[3] * wish[e, a, 1]
            else:
                side = 1.0 if code == BLOCK else -1.0
                vx, vy = accompany(dx, dy, velocity[e, robot], ahead[e, robot], side * (gap + row[4]))
            most = min(most, top[e, a])
            length = math.sqrt(vx * vx + vy * vy)
            share = most / length if length > most else 1.0
            wish[e, a, 0], wish[e, a, 1] = share * vx, share * vy
            if code in (CURIOUS, BLOCK, FOLLOW, LOOK):
                toward[e, a, 0], toward[e, a, 1] = dx, dy


@kernel
def approach(dx: float, dy: float, gap: float, most: float) -> tuple[float, float]:
    """Return the velocity to a robot at dx, dy, 0 at the distance ``gap`` [m] and below."""
    far = math.sqrt(dx * dx + dy * dy)
    if far <= gap:
        return 0.0, 0.0
    size = min(most, (far - gap) / RELAXATION) / far
    return size * dx, size * dy


@kernel
def keep_away(row: Floats, dx: float, dy: float, gap: float, wish: Floats) -> tuple[float, float]:
    """Return the desired velocity at another speed, plus a repulsion that decays with the clearance."""
    far = max(math.sqrt(dx * dx + dy * dy), 1e-9)
    size = row[5] * math.exp(-max(0.0, far - gap) / row[6]) / far
    return row[3] * wish[0] - size * dx, row[3] * wish[1] - size * dy


@kernel
def accompany(dx: float, dy: float, moving: Floats, ahead: Floats, offset: float) -> tuple[float, float]:
    """Return the velocity to a place in front of a robot, or behind it for a negative offset [m]."""
    fast = math.sqrt(moving[0] * moving[0] + moving[1] * moving[1])
    ux, uy = ahead[0], ahead[1]
    if fast > SLOW:
        ux, uy = moving[0] / fast, moving[1] / fast
    return moving[0] + (dx + offset * ux) / RELAXATION, moving[1] + (dy + offset * uy) / RELAXATION


@kernel
def give_way(
    dx: float, dy: float, moving: Floats, half: float, most: float, wish: Floats
) -> tuple[float, float]:  # fmt: skip
    """Return the velocity out of the lane of a robot with half the width ``half`` [m], or 0 beside the lane.

    People walk on if the robot stands or has passed, or if their way does not lead into the lane within a second.
    """
    fast = math.sqrt(moving[0] * moving[0] + moving[1] * moving[1])
    if fast <= SLOW:
        return wish[0], wish[1]
    ux, uy = moving[0] / fast, moving[1] / fast
    along, aside = -(dx * ux + dy * uy), -(ux * dy - uy * dx)
    if along < -half:
        return wish[0], wish[1]
    side = -1.0 if aside < 0.0 else 1.0
    room = half - abs(aside)
    if room > 0.0:
        size = side * min(most, room / RELAXATION + SLOW)
        return -uy * size, ux * size
    inward = -side * (ux * wish[1] - uy * wish[0])
    if inward > 0.0 and inward * AHEAD > -room:
        return 0.0, 0.0
    return wish[0], wish[1]
