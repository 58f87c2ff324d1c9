"""Avoidance of robots: the kernel that changes the desired velocity of people who would come close to a robot."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, kernel, prange
from crowdbot.models.agent_rows import RADIUS, VX, VY, WISH_X, WISH_Y, X, Y
from crowdbot.models.speed_models.collision_free_speed import is_hidden, nearest_on_segment, within
from crowdbot.typing import Floats, Ints

AVOIDANCE = ("robot_gap", "robot_horizon", "robot_weight", "robot_slowing", "robot_behind", "robot_caution")
"""Parameters of the layer, in the order of the columns that the kernel gets; the caution is not read in a step."""
TURNS, SPEEDS = 16, 5
"""Number of turns to each side and of speeds that are compared first; standing is one more."""
FINER = 8
"""Number of parts of a turn and of a speed in the finest comparison; a power of 2."""
TURN = math.radians(7.5)
"""Turn between two of the directions that are compared first [rad]."""
MOST_TURNS = TURNS * FINER + FINER
ANGLES = np.array([k * TURN / FINER for k in range(-MOST_TURNS, MOST_TURNS + 1)])
DIRECTIONS = np.array([(math.cos(angle), math.sin(angle)) for angle in ANGLES.tolist()])
"""Turns [rad], and their cosines and sines."""
INERTIA = 0.1
"""Cost of a change of velocity by the desired speed: people keep what they have begun."""
LEFT = 0.02
"""Cost of passing on the left where both sides are equal."""
IMPATIENCE = 2.0
"""Least cost of standing in the way of a robot, or before one that stands: waiting pays only if the robot passes."""
MOVING = 0.5
"""Speed [m/s] from which on a robot moves for this."""
BACK = -0.17
"""Cosine of the angle to the way ahead from which on a robot is behind: 100 degrees."""
WALL_TIME = 1.5
"""Time [s] for which the way must be free of walls."""
WALL_GAP = 0.1
"""Clearance [m] to walls below which a way costs more."""
WALL_WEIGHT = 4.0


def robots_in(robot: NDArray[np.bool_]) -> Ints:
    """Return the indices ``[E, R]`` of the True agents of a mask ``[E, A]``, -1 for none.

    >>> robots_in(np.array([[False, True], [False, False]])).tolist()
    [[1], [-1]]
    """
    most = int(robot.sum(axis=1).max(initial=0))
    order = np.argsort(~robot, axis=1, kind="stable")[:, :most]
    return np.where(np.take_along_axis(robot, order, axis=1), order, -1)


@kernel(parallel=True)
def avoid_robots(
    agents: Floats, walking: NDArray[np.bool_], robots: Ints, laws: Floats, walls: Floats, out: Floats
) -> None:
    """Write the desired velocity [m/s] of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        avoid_robots_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), agents, walking, robots, laws, walls, out)


@kernel
def avoid_robots_part(
    begin: int, end: int, agents: Floats, walking: NDArray[np.bool_], robots: Ints, laws: Floats, walls: Floats,
    out: Floats,
) -> None:  # fmt: skip
    """Write the desired velocity [m/s] of the rows ``begin`` to ``end``."""
    A = len(agents) // len(robots)
    # of each robot that matters: relative position, velocity, sum of the radii, gap, horizon and speed
    near = np.empty((robots.shape[1], 8))
    wall = np.empty(len(walls), dtype=np.int64)
    for row in range(begin, end):
        wx, wy = agents[row, WISH_X], agents[row, WISH_Y]
        out[row, 0], out[row, 1] = wx, wy
        wish = math.sqrt(wx * wx + wy * wy)
        law = row if len(laws) > 1 else 0
        if not walking[row] or wish < 1e-6 or laws[law, 0] <= 0.0:
            continue
        count = _robots_near(agents, robots[row // A], row, row - row % A, laws[law], wish, walls, wall, near)
        if count == 0 or _closeness(near, count, wx, wy) == 0.0:
            continue
        reach = agents[row, RADIUS] + WALL_GAP + WALL_TIME * wish
        held = within(walls, agents[row, X], agents[row, Y], reach, wall)
        out[row, 0], out[row, 1] = _best_velocity(agents[row], laws[law], near, count, walls, wall, held, wish)


@kernel
def _robots_near(
    agents: Floats, robots: Ints, row: int, first: int, law: Floats, wish: float, walls: Floats, wall: Ints,
    near: Floats,
) -> int:  # fmt: skip
    """Write the robots that a person sees and may come close to within the horizon; return their number."""
    count = int(np.int64(0))  # a literal 0 has its own type, which compiles the callees twice
    for number in range(len(robots)):
        if robots[number] < 0:
            continue
        other = first + robots[number]
        dx, dy = agents[other, X] - agents[row, X], agents[other, Y] - agents[row, Y]
        distance = math.sqrt(dx * dx + dy * dy)
        ahead = dx * agents[row, WISH_X] + dy * agents[row, WISH_Y]
        share = law[4] if ahead < BACK * distance * wish else 1.0
        gap, horizon = law[0] * share, law[1] * share
        contact = agents[row, RADIUS] + agents[other, RADIUS]
        fast = math.sqrt(agents[other, VX] ** 2 + agents[other, VY] ** 2)
        if gap <= 0.0 or distance - contact - gap > horizon * (wish + fast):
            continue
        held = within(walls, agents[row, X], agents[row, Y], distance, wall)
        if held > 0 and is_hidden(walls, wall, held, agents[row, X], agents[row, Y], dx, dy):
            continue
        near[count, 0], near[count, 1] = dx, dy
        near[count, 2], near[count, 3] = agents[other, VX], agents[other, VY]
        near[count, 4], near[count, 5], near[count, 6], near[count, 7] = contact, gap, horizon, fast
        count += 1
    return count


@kernel
def _closeness(near: Floats, count: int, vx: float, vy: float) -> float:
    """Return how close a person comes to the robots with a velocity: squares of the missing shares of the gap.

    A robot that comes close later counts less, down to 0 at the horizon.
    """
    total = 0.0
    for n in range(count):
        ux, uy, horizon = vx - near[n, 2], vy - near[n, 3], near[n, 6]
        square = ux * ux + uy * uy
        time = 0.0
        if square > 1e-12:
            time = min(max((near[n, 0] * ux + near[n, 1] * uy) / square, 0.0), horizon)
        mx, my = near[n, 0] - time * ux, near[n, 1] - time * uy
        missing = 1.0 - (math.sqrt(mx * mx + my * my) - near[n, 4]) / near[n, 5]
        if missing > 0.0:
            total += missing * missing * (1.0 - time / horizon)
    return total


@kernel
def _wall_cost(person: Floats, vx: float, vy: float, walls: Floats, wall: Ints, held: int) -> float:
    """Return the cost of walls on the way of a person with a velocity."""
    x, y, radius = person[X], person[Y], person[RADIUS] + WALL_GAP
    total = 0.0
    for n in range(held):
        m = wall[n]
        ax, ay, bx, by = walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3]
        least = math.inf
        for k in range(1, 4):
            px, py = x + vx * WALL_TIME * k / 3.0, y + vy * WALL_TIME * k / 3.0
            nx, ny = nearest_on_segment(px, py, ax, ay, bx, by)
            least = min(least, math.sqrt((px - nx) ** 2 + (py - ny) ** 2))
        ex, ey, dx, dy = bx - ax, by - ay, vx * WALL_TIME, vy * WALL_TIME
        before, after = ex * (y - ay) - ey * (x - ax), ex * (y + dy - ay) - ey * (x + dx - ax)
        left, right = dx * (ay - y) - dy * (ax - x), dx * (by - y) - dy * (bx - x)
        if before * after < 0.0 and left * right < 0.0:
            least = 0.0
        if least < radius:
            total += WALL_WEIGHT * (1.0 - least / radius) ** 2
    return total


@kernel
def _best_velocity(
    person: Floats, law: Floats, near: Floats, count: int, walls: Floats, wall: Ints, held: int, wish: float
) -> tuple[float, float]:
    """Return the velocity [m/s] of least cost: turn, loss of speed, closeness to robots and walls."""
    most = SPEEDS * FINER
    slowing = law[3] + max(IMPATIENCE - law[3], 0.0) * (1.0 - _gain_of_waiting(near, count))
    best, turn, speed = (
        _cost(MOST_TURNS, 0, person, law[2], slowing, near, count, walls, wall, held, wish),
        MOST_TURNS,
        0,
    )
    for k in range(MOST_TURNS - TURNS * FINER, MOST_TURNS + TURNS * FINER + 1, FINER):
        for n in range(FINER, most + 1, FINER):
            cost = _cost(k, n, person, law[2], slowing, near, count, walls, wall, held, wish)
            if cost < best:
                best, turn, speed = cost, k, n
    step = FINER
    while speed > 0 and step > 1:
        step //= 2
        middle, pace = turn, speed
        for k in range(middle - step, middle + step + 1, step):
            for n in range(max(pace - step, 1), min(pace + step, most) + 1, step):
                cost = _cost(k, n, person, law[2], slowing, near, count, walls, wall, held, wish)
                if cost < best:
                    best, turn, speed = cost, k, n
    return _turned(person, turn, speed)


@kernel
def _gain_of_waiting(near: Floats, count: int) -> float:
    """Return how far all robots pass a person who stands: 1 if they keep the gap, 0 if one stands or drives there."""
    least = 1.0
    for n in range(count):
        fast = near[n, 7]
        time = 0.0
        if fast > 1e-6:
            time = max(0.0, -(near[n, 0] * near[n, 2] + near[n, 1] * near[n, 3]) / (fast * fast))
        x, y = near[n, 0] + time * near[n, 2], near[n, 1] + time * near[n, 3]
        free = (math.sqrt(x * x + y * y) - near[n, 4]) / near[n, 5]
        least = min(least, max(0.0, min(1.0, free)) * min(1.0, fast / MOVING))
    return least


@kernel
def _turned(person: Floats, turn: int, speed: int) -> tuple[float, float]:
    """Return the desired velocity of a person after a turn, in parts of the speed."""
    wx, wy, c, s = person[WISH_X], person[WISH_Y], DIRECTIONS[turn, 0], DIRECTIONS[turn, 1]
    share = speed / (SPEEDS * FINER)
    return share * (c * wx - s * wy), share * (s * wx + c * wy)


@kernel
def _cost(
    turn: int, speed: int, person: Floats, weight: float, slowing: float, near: Floats, count: int, walls: Floats,
    wall: Ints, held: int, wish: float,
) -> float:  # fmt: skip
    """Return the cost of a turn and of a share of the desired speed."""
    vx, vy = _turned(person, turn, speed)
    total: float = float(ANGLES[turn]) ** 2 + slowing * (1.0 - speed / (SPEEDS * FINER)) ** 2
    total += LEFT if turn > MOST_TURNS else 0.0
    total += INERTIA * ((vx - person[VX]) ** 2 + (vy - person[VY]) ** 2) / (wish * wish)
    total += weight * _closeness(near, count, vx, vy)
    if held > 0:
        total += _wall_cost(person, vx, vy, walls, wall, held)
    return total
