"""A small reference planner: laser scan and goal in, velocity out. It needs NumPy and SciPy only, no ROS.

A costmap of 6 x 6 m around the robot is made from each scan. Dijkstra's algorithm finds the cheapest path to the goal,
or to the edge of the costmap towards it; cells near obstacles cost more. The robot follows the path by pure pursuit.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import distance_transform_edt

CELL, HALF = 0.1, 30
"""Size of a cell [m], and cells from the robot to the edge of the costmap."""
STEPS = [(dx, dy, math.hypot(dx, dy)) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if dx or dy]


def in_robot_frame(pose, point):
    """Return a point x, y of the map [m] in the frame of a robot with a pose x, y [m], heading [rad]."""
    dx, dy = point[0] - pose[0], point[1] - pose[1]
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    return cos * dx + sin * dy, cos * dy - sin * dx


@dataclass
class LocalPlanner:
    """Plans in the frame of the robot: x forward, y left.

    Fields:
        radius: radius of the robot [m].
        margin: distance to obstacles [m] below which cells cost more.
        max_speed, max_turn: limits of the command [m/s], [rad/s].
        ahead: distance of the pursued point on the path [m].
    """

    radius: float = 0.3
    margin: float = 0.7
    max_speed: float = 0.8
    max_turn: float = 1.2
    ahead: float = 0.7

    def command(self, ranges, angle_min, increment, goal):
        """Return speed [m/s] and turn rate [rad/s] for a scan and a goal (x, y) [m] in the frame of the robot."""
        clearance = self.clearance(np.asarray(ranges, dtype=float), angle_min, increment)
        path = self.path(clearance, goal)
        if path is None:
            return 0.0, 0.6  # look for a way
        distance = math.hypot(*goal)
        target = next((cell for cell in path if CELL * math.hypot(*cell) >= self.ahead), path[-1])
        x, y = goal if distance < self.ahead else (CELL * target[0], CELL * target[1])
        bearing = math.atan2(y, x)
        turn = max(-self.max_turn, min(self.max_turn, 1.8 * bearing))
        free = min(float(clearance[HALF + k, HALF]) for k in range(1, 8)) - self.radius
        speed = self.max_speed * max(0.0, math.cos(bearing)) ** 2 * max(0.0, min(1.0, free / 0.4))
        if speed < 0.05 and abs(turn) < 0.2:
            turn = math.copysign(0.4, bearing or 1.0)
        return min(speed, distance), turn

    def clearance(self, ranges, angle_min, increment):
        """Return the distance [m] from each cell ``[2 * HALF + 1, 2 * HALF + 1]`` to the nearest point of the scan."""
        angles = angle_min + increment * np.arange(len(ranges))
        hit = np.isfinite(ranges) & (ranges < CELL * HALF * 1.5)
        rows = np.round(ranges[hit] * np.cos(angles[hit]) / CELL).astype(int) + HALF
        columns = np.round(ranges[hit] * np.sin(angles[hit]) / CELL).astype(int) + HALF
        inside = (rows >= 0) & (rows <= 2 * HALF) & (columns >= 0) & (columns <= 2 * HALF)
        free = np.ones((2 * HALF + 1, 2 * HALF + 1), dtype=bool)
        free[rows[inside], columns[inside]] = False
        if free.all():
            return np.full(free.shape, np.inf)
        return CELL * distance_transform_edt(free)

    def path(self, clearance, goal):
        """Return the cells (x, y) of the cheapest path, or None if there is none."""
        scale = min(1.0, CELL * (HALF - 1) / max(abs(goal[0]), abs(goal[1]), 1e-9))
        end = (round(goal[0] * scale / CELL), round(goal[1] * scale / CELL))
        cost = 1.0 + 6.0 * np.clip(1.0 - (clearance - self.radius) / self.margin, 0.0, 1.0) ** 2
        closed = clearance < self.radius
        closed[HALF - 2 : HALF + 3, HALF - 2 : HALF + 3] = False
        best, before, queue = {(0, 0): 0.0}, {}, [(0.0, (0, 0))]
        nearest, gap = (0, 0), math.dist((0, 0), end)
        while queue:
            price, cell = heapq.heappop(queue)
            if price > best[cell]:
                continue
            if math.dist(cell, end) < gap:
                nearest, gap = cell, math.dist(cell, end)
            if cell == end:
                break
            for dx, dy, length in STEPS:
                x, y = cell[0] + dx, cell[1] + dy
                if max(abs(x), abs(y)) > HALF or closed[x + HALF, y + HALF]:
                    continue
                new = price + length * cost[x + HALF, y + HALF]
                if new < best.get((x, y), math.inf):
                    best[x, y], before[x, y] = new, cell
                    heapq.heappush(queue, (new, (x, y)))
        if nearest == (0, 0):
            return None
        cells = [nearest]
        while cells[-1] in before:
            cells.append(before[cells[-1]])
        return cells[::-1]
