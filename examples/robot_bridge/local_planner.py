"""A small reference planner: laser scan and goal in, velocity out. It needs the standard library only.

A costmap of 6 x 6 m around the robot is made from each scan. A* finds the cheapest path to the goal, or to the edge
of the costmap towards it; cells near obstacles cost more. The robot follows the path by pure pursuit.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass

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
        clearance = self.clearance(ranges, angle_min, increment)
        path = self.path(clearance, goal)
        if path is None:
            return 0.0, 0.6  # look for a way
        distance = math.hypot(*goal)
        target = next((cell for cell in path if CELL * math.hypot(*cell) >= self.ahead), path[-1])
        x, y = goal if distance < self.ahead else (CELL * target[0], CELL * target[1])
        bearing = math.atan2(y, x)
        turn = max(-self.max_turn, min(self.max_turn, 1.8 * bearing))
        free = min(clearance.get((k, 0), math.inf) for k in range(1, 8)) - self.radius
        speed = self.max_speed * max(0.0, math.cos(bearing)) ** 2 * max(0.0, min(1.0, free / 0.4))
        if speed < 0.05 and abs(turn) < 0.2:
            turn = math.copysign(0.4, bearing or 1.0)
        return min(speed, distance), turn

    def clearance(self, ranges, angle_min, increment):
        """Return the distance [m] to the nearest point of the scan, by cell (x, y), for cells that are near to one.

        Cells that are further away than the radius and the margin of the robot are left out.
        """
        hits = set()
        for k, distance in enumerate(ranges):
            if 0.0 < distance < CELL * HALF * 1.5:  # false for NaN
                angle = angle_min + k * increment
                hits.add((round(distance * math.cos(angle) / CELL), round(distance * math.sin(angle) / CELL)))
        hits = [cell for cell in hits if max(map(abs, cell)) <= HALF]
        reach = math.ceil((self.radius + self.margin) / CELL)
        disc = [(CELL * math.hypot(x, y), x, y) for x in range(-reach, reach + 1) for y in range(-reach, reach + 1)]
        found = {}
        for distance, dx, dy in sorted(disc, reverse=True):  # nearer points replace farther ones
            if distance <= self.radius + self.margin:
                found.update({(x + dx, y + dy): distance for x, y in hits})
        return found

    def costs(self, clearance):
        """Return what cells near obstacles cost, infinity where the robot would touch; all others cost 1."""
        found = {}
        for cell, distance in clearance.items():
            touches = distance < self.radius and max(abs(cell[0]), abs(cell[1])) > 2
            found[cell] = (
                math.inf if touches else 1.0 + 6.0 * min(1.0, 1.0 - (distance - self.radius) / self.margin) ** 2
            )
        return found

    def path(self, clearance, goal):
        """Return the cells (x, y) of the cheapest path, or None if there is none."""
        scale = min(1.0, CELL * (HALF - 1) / max(abs(goal[0]), abs(goal[1]), 1e-9))
        end = (round(goal[0] * scale / CELL), round(goal[1] * scale / CELL))
        costs = self.costs(clearance)
        best, before, queue = {(0, 0): 0.0}, {}, [(math.dist((0, 0), end), 0.0, (0, 0))]
        nearest, gap = (0, 0), math.dist((0, 0), end)
        while queue:
            _, price, cell = heapq.heappop(queue)
            if price > best[cell]:
                continue
            if math.dist(cell, end) < gap:
                nearest, gap = cell, math.dist(cell, end)
            if cell == end:
                break
            x, y = cell
            for dx, dy, length in STEPS:
                near = x + dx, y + dy
                if not (-HALF <= near[0] <= HALF and -HALF <= near[1] <= HALF):
                    continue
                new = price + length * costs.get(near, 1.0)
                if new < best.get(near, math.inf):
                    best[near], before[near] = new, cell
                    heapq.heappush(queue, (new + math.dist(near, end), new, near))  # the rest costs at least this
        if nearest == (0, 0):
            return None
        cells = [nearest]
        while cells[-1] in before:
            cells.append(before[cells[-1]])
        return cells[::-1]
