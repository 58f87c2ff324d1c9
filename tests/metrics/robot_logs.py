"""Logs of a robot among people for tests: from paths, and random ones."""

import numpy as np

from crowdbot.metrics import AgentLog, BodyRegion, RobotLog

R = 0.3
"""Radius of everyone [m]."""
REGIONS = {"thigh": BodyRegion(50e3, 75.0, 220.0), "lower leg": BodyRegion(60e3, 75.0, 130.0)}


def walk(start, velocity, steps, dt=0.1):
    return np.array(start, float) + dt * np.arange(steps + 1)[:, None] * np.array(velocity, float)


def agents_of(*paths, dt=0.1, radius=R):
    """Return the log of agents with paths ``[T, 2]``, velocities by backward differences."""
    position = np.stack([np.asarray(path, float) for path in paths], axis=1)
    velocity = np.diff(position, axis=0, prepend=2 * position[:1] - position[1:2]) / dt
    heading = np.arctan2(velocity[..., 1], velocity[..., 0])
    shape = position.shape[:2]
    return AgentLog(
        dt * np.arange(len(position)), position, velocity, heading, np.full(shape, radius), np.ones(shape, bool)
    )


def log_of_paths(robot, *people, goal=None, dt=0.1, **fields):
    return RobotLog.of(agents_of(robot, *people, dt=dt), 0, goal, **fields)


def random_log(seed, people=6, steps=60, dt=0.1, **fields):
    """Return a log of random smooth walks; people come and go."""
    rng = np.random.default_rng(seed)
    velocity = rng.normal(0.0, 1.0, (1, people + 1, 2)) + np.cumsum(
        rng.normal(0.0, 0.15, (steps, people + 1, 2)), axis=0
    )
    position = rng.uniform(-4.0, 4.0, (1, people + 1, 2)) + dt * np.cumsum(velocity, axis=0)
    active = np.ones((steps, people + 1), bool)
    for k in range(1, people + 1):
        first, last = sorted(rng.integers(0, steps, 2))
        active[:first, k] = False
        active[last + 1 :, k] = False
    radius = np.broadcast_to(rng.uniform(0.2, 0.4, people + 1), active.shape)
    heading = np.arctan2(velocity[..., 1], velocity[..., 0])
    agents = AgentLog(dt * np.arange(steps), position, velocity, heading, radius, active)
    fields = {"mass": 60.0, "height": 0.8, "regions": REGIONS, "max_speed": 2.0} | fields
    return RobotLog.of(agents, 0, rng.uniform(-9.0, 9.0, 2), **fields)
