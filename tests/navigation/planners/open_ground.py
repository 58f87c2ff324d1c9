"""A robot on open ground: what it knows, and how a navigator drives it."""

import math

import numpy as np

from crowdbot.core import Pose, Twist, Walls
from crowdbot.navigation import DriveLimits, Observation, VisiblePeople
from crowdbot.world import DifferentialDrive, Omnidirectional, Twists

WHEELS = DriveLimits(1.0, 1.5, 1.0, 3.0)
ANY_WAY = WHEELS._replace(holonomic=True)


def observe(people=(), **changes):
    """Return what a robot at the origin knows, looking along x; people are x, y, vx, vy."""
    rows = np.array(people, dtype=float).reshape(-1, 4)
    known = {"pose": (0.0, 0.0, 0.0), "goal": (9.0, 0.0), "radius": 0.3, "limits": WHEELS, "dt": 0.1}
    known["people"] = VisiblePeople(rows[:, :2], rows[:, 2:], np.full(len(rows), 0.25))
    return Observation(**(known | changes))


def drive(navigator, limits, goal, seconds, people=(), walls=()):
    """Return the path ``[T, 2]`` of a robot from the origin, and the smallest clearance to people."""
    vehicle = (Omnidirectional if limits.holonomic else DifferentialDrive)(1.0, 1.5, 1.0, 3.0)
    pose, twist, path, gap, memory = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), [], math.inf, None
    rows, known = (
        np.array(people, dtype=float).reshape(-1, 4),
        {"goal": goal, "limits": limits, "walls": Walls.of(walls)},
    )
    for k in range(round(seconds / 0.1)):
        there = rows + 0.1 * k * np.hstack([rows[:, 2:], np.zeros((len(rows), 2))])
        place = (*pose.position[0].tolist(), float(pose.heading[0]))
        seen = observe(there, pose=place, twist=twist.at(0), time=0.1 * k, **known)
        gap = min(gap, seen.nearest)
        memory = navigator.first_memory(seen) if k == 0 else memory
        action, memory = navigator.decide(seen, memory)
        pose, twist = vehicle.step(pose, twist, action.twist, 0.1)
        path.append(pose.position[0].copy())
    return np.array(path), gap
