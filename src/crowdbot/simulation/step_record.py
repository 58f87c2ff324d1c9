"""StepRecord: what happened in one time step of one environment, for recorders and other consumers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene, storable
from crowdbot.sensors import Reading
from crowdbot.trials import Mount, RobotSpec

if TYPE_CHECKING:
    from crowdbot.humans import FallPose
    from crowdbot.world import BodyContactEvent, ContactForce, Fall

    from .orders.order import Order

WALL = -2
"""Code of a wall instead of an agent id, as in scans."""


@storable
class RobotContact(NamedTuple):
    """A contact of a robot during a step: ids of both agents (-2: a wall) and the smallest clearance [m], negative."""

    robot: int
    other: int
    clearance: float


@dataclass(frozen=True)
class StepRecord:
    """The record of one time step of one environment.

    Fields:
        tick: number of steps since the start.
        nanoseconds: simulated time [ns].
        scene: all agents, including absent ones; E = 1.
        ids: ``[A]`` ids of the agents; an index can be reused by another person.
        twists, commands: ``[R, 3]`` forward [m/s], turn [rad/s], left [m/s] of each robot: actual and commanded.
        readings: readings of this step with robot and mount; hits are person ids.
        due: whether the scene is recorded; otherwise only readings, contacts and orders.
        touches: contacts of the last step.
        forces: contact forces of the last step, in the physics world.
        collisions: contact events that ended since the last record, in the physics world.
        falls: falls of people that ended since the last record, in the physics world with balance.
        orders: orders from outside that were applied in this step.
        environment: number of the environment.
        robots, robot_ids: the robots of the rows of ``twists`` and ``commands``, and their ids.
        fall_poses: poses of people out of balance by agent, if the scene is recorded, in the physics world.
    """

    tick: int
    nanoseconds: int
    scene: Scene
    ids: NDArray[np.int64]
    twists: NDArray[np.float64]
    commands: NDArray[np.float64]
    readings: tuple[tuple[RobotSpec, Mount, Reading], ...]
    due: bool
    touches: tuple[RobotContact, ...] = ()
    forces: tuple[ContactForce, ...] = ()
    collisions: tuple[BodyContactEvent, ...] = ()
    falls: tuple[Fall, ...] = ()
    orders: tuple[Order, ...] = ()
    environment: int = 0
    robots: tuple[RobotSpec, ...] = ()
    robot_ids: tuple[int, ...] = ()
    fall_poses: Mapping[int, FallPose] = field(default_factory=dict)
