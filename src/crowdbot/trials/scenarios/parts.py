"""Parts of scenarios: boxes, corridors, robots, flows of people."""

from __future__ import annotations

import math
from typing import Any

from crowdbot import navigation
from crowdbot.core.fields import Points
from crowdbot.models import ORCA
from crowdbot.sensors import Gaussian, Lidar2D
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.people import Group, Spawner
from crowdbot.trials.stage import Stage, Wall
from crowdbot.trials.trial import Mount, RobotGoal, RobotSpec, Trial
from crowdbot.world import DifferentialDrive, Drive

CROWD = ORCA(neighbor_distance=5.0, max_neighbors=10.0, time_horizon=2.0, time_horizon_walls=1.0)

STILL = 0.01
"""Speed [m/s] of people who stand and do not step aside; speeds must be above 0."""


def box(left: float, low: float, right: float, high: float) -> Points:
    """Return the corners of a rectangle.

    >>> str(box(0, 0, 4, 2))
    '0,0 4,0 4,2 0,2'
    """
    return Points.of([(left, low), (right, low), (right, high), (left, high)])


def corridor(length: float, width: float) -> Stage:
    """Return two walls along x, centred at the origin."""
    x, y = length / 2.0, width / 2.0
    return Stage(walls=(Wall(Points.of([(-x, -y), (x, -y)])), Wall(Points.of([(-x, y), (x, y)]))))


def robot(
    start: tuple[float, float],
    goal: tuple[float, float],
    speed: float = 1.0,
    *,
    radius: float = 0.3,
    tolerance: float = 0.3,
    drive: Drive | None = None,
    visible: bool = True,
) -> RobotSpec:
    """Return a robot with a laser scanner that faces its goal."""
    return RobotSpec(
        x=start[0],
        y=start[1],
        heading=math.atan2(goal[1] - start[1], goal[0] - start[0]),
        radius=radius,
        visible=visible,
        goal=RobotGoal(goal[0], goal[1], tolerance),
        drive=drive or DifferentialDrive(max_speed=speed, max_turn_rate=1.5),
        navigator=navigation.ORCANavigator(speed=speed),
        sensors=(Mount(sensor=Lidar2D(rays=360, range_max=10.0, noise=Gaussian(0.01))),),
    )


def scenario(name: str, duration: float, stage: Stage, **parts: Any) -> Trial:
    """Return a trial with the default crowd, and with heading jitter against symmetric deadlocks."""
    whole: dict[str, Any] = {"crowd": CROWD, "heading_jitter": 0.001} | parts
    return Trial(name=name, duration=duration, stage=stage, **whole)


def pairs(share: float) -> tuple[Group, ...]:
    """Return group sizes such that about this share of people is in pairs and threes; none for 0."""
    if share <= 0.0:
        return ()
    # shares of people, divided by the group size, are shares of groups
    alone = (Group(1, 1.0 - share),) if share < 1.0 else ()
    return (Group(3, share * 0.25 / 3.0), Group(2, share * 0.75 / 2.0), *alone)


def flow(name: str, count: int, zone: Points, journey: str, **more: Any) -> Spawner:
    """Return people in a zone who follow a journey."""
    return Spawner(name=name, count=count, zone=zone, journey=journey, **more)


def uniform(low: float, high: float) -> Distribution:
    """Return a uniform distribution, a constant if ``low`` equals ``high``."""
    return Distribution("uniform", (low, high)) if low < high else Distribution("number", (low,))


def number(value: float) -> Distribution:
    """Return a constant as a distribution."""
    return Distribution("number", (value,))
