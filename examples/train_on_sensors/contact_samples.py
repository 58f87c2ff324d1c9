"""Training samples from running simulations: laser scans, and whether a person comes near within 2 s."""

from __future__ import annotations

from collections import deque
from pathlib import Path

import numpy as np

from crowdbot.core import Twist
from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial

TRIAL = Path(__file__).with_name("street.xml")
HORIZON, NEAR = 2.0, 0.3
"""Time ahead [s], and gap between robot and person [m] below which a person is near."""
LAGS = (0, 3, 6, 9)
"""Ages of the scans of a sample, in scans."""
POOL, REACH = 6, 6.0
"""Neighbouring beams of which the shortest is taken, and largest distance [m]."""


def shorten(ranges):
    """Return scans ``[E, R]`` [m] as inputs of the network ``[E, R / POOL]``: 0 is near, 1 is :data:`REACH` or more."""
    pooled = ranges.reshape(len(ranges), -1, POOL).min(axis=-1)
    return (np.clip(pooled, 0.0, REACH) / REACH).astype(np.float32)


def wander(ranges, angles):
    """Return the command of a robot that drives straight and turns to the freer side of an obstacle."""
    ahead, left = np.abs(angles) < 0.7, angles > 0.0
    near = np.minimum(ranges, REACH)
    if near[ahead].min() > 0.9:
        return Twist(0.6, 0.0, 0.0)
    side = 1.0 if near[ahead & left].mean() > near[ahead & ~left].mean() else -1.0
    return Twist(0.15, 1.2 * side, 0.0)


class SampleStream:
    """Simulations of several seeds that advance together and give samples.

    Args:
        seeds: one seed for each environment E.
    """

    def __init__(self, seeds):
        self.simulation = Simulation(load_trial(str(TRIAL)), seeds=list(seeds))
        self.simulation.begin()
        self.robot = self.simulation.agent_of("robot")
        self.scans, self.waiting, self.gaps = deque(maxlen=LAGS[-1] + 1), deque(), deque()

    def advance(self):
        """Advance by one scan (two steps), and return the finished samples.

        Returns:
            Inputs ``[E, lags, beams]``, labels ``[E]`` and true distances ``[E]`` [m] to the nearest return at the
            instant of the scan; or None in the first seconds.
        """
        gap = np.full(self.simulation.count, np.inf)
        for _ in range(2):
            self.simulation.advance()
            gap = np.minimum(gap, self.gap_to_people())
        ranges, angles = self.read_scans()
        for e, row in enumerate(ranges):
            self.simulation.command("robot", wander(row, angles), e)
        self.scans.append(shorten(ranges))
        self.gaps.append(gap)
        if len(self.scans) > LAGS[-1]:
            inputs = np.stack([self.scans[-1 - lag] for lag in LAGS], axis=1)
            self.waiting.append((inputs, ranges.min(axis=1), len(self.gaps)))
        ahead = round(HORIZON / 0.1)
        if not self.waiting or len(self.gaps) - self.waiting[0][2] < ahead:
            return None
        inputs, nearest, begin = self.waiting.popleft()
        labels = np.min([self.gaps[begin + k] for k in range(ahead)], axis=0) < NEAR
        self.forget(begin)
        return inputs, labels, nearest

    def forget(self, count):
        """Drop the gaps that no waiting sample needs."""
        for _ in range(count):
            self.gaps.popleft()
        self.waiting = deque((inputs, nearest, begin - count) for inputs, nearest, begin in self.waiting)

    def read_scans(self):
        """Return the new scans ``[E, R]`` [m] and the angles ``[R]`` [rad]."""
        found = [self.simulation.new_readings(e)[0][2] for e in range(self.simulation.count)]
        return np.concatenate([scan.ranges for scan in found]), found[0].angles

    def gap_to_people(self):
        """Return the smallest gap ``[E]`` [m] between the robot and a person."""
        scene = self.simulation.world.scene
        away = np.linalg.norm(scene.position - scene.position[:, self.robot, None], axis=-1)
        gaps = away - scene.radius - scene.radius[:, self.robot, None]
        others = scene.active.copy()
        others[:, self.robot] = False
        return np.where(others, gaps, np.inf).min(axis=1)


def collect(seeds, scans):
    """Return inputs ``[N, lags, beams]``, labels ``[N]`` and distances ``[N]`` of a number of scans of each seed."""
    stream = SampleStream(seeds)
    found = [one for one in (stream.advance() for _ in range(scans)) if one is not None]
    return tuple(np.concatenate(parts) for parts in zip(*found, strict=True))
