"""Motion of a robot alone in an empty hall, in the plane and in the physics world."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError, Pose, Scene, Twist
from crowdbot.humans import People, names
from crowdbot.models import ORCA
from crowdbot.typing import Floats
from crowdbot.world import CommandDelay, Pending, PhysicsStage, PhysicsWorld, Robot, Twists

SAMPLE = 0.02
"""Time [s] between two samples of a trace, in which the command is constant."""


class DriveTrace(NamedTuple):
    """Motion after each sample of :data:`SAMPLE` seconds.

    Fields:
        position: ``[N, 2]`` [m]; the robot starts at the origin.
        heading: ``[N]`` [rad] without jumps, 0 at the start.
        twist: ``[N, 3]`` forward, left [m/s] and turn rate [rad/s].
        tilt: ``[N]`` angle from the vertical [rad].
    """

    position: Floats
    heading: Floats
    twist: Floats
    tilt: Floats


def trace_planar(robot: Robot, commands: Sequence[Twist], step: float) -> DriveTrace:
    """Return the motion in the plane: exactly the drive, with the latency of the robot.

    Args:
        robot: the robot.
        commands: command of each sample.
        step: time step [s]; a sample is a whole number of steps.

    Raises:
        InputError: a sample is not a whole number of steps.

    >>> from crowdbot.world import Robot
    >>> trace = trace_planar(Robot.load("differential"), [Twist(1.0, 0.0)] * 100, 0.01)
    >>> round(float(trace.twist[-1, 0]), 3), round(float(trace.position[-1, 0]), 3)
    (1.0, 1.505)
    """
    pose, twist = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1)
    delay, now = CommandDelay(robot.latency), Twist()
    pending: tuple[Pending, ...] = ()
    heading, rows = 0.0, []
    for command in commands:
        for _ in range(_steps(step)):
            pending, current = delay.step(pending, now, command, step)
            now = current.at(0) if isinstance(current, Twists) else current
            old = float(pose.heading[0])
            pose, twist = robot.drive.step(pose, twist, now, step)
            heading += _turned(old, float(pose.heading[0]))
        rows.append((*pose.position[0], heading, twist.forward[0], twist.left[0], twist.turn[0], 0.0))
    return _trace(rows)


def trace_physics(robot: Robot, commands: Sequence[Twist], step: float, friction: float = 1.0) -> DriveTrace:
    """Return the motion in a :class:`PhysicsWorld` without people, walls and props.

    Args:
        robot: the robot; a rider that is no single body is the heaviest person.
        commands: command of each sample.
        step: time step of the engine [s]; a sample is a whole number of steps.
        friction: friction coefficient of the floor.

    Raises:
        InputError: a sample is not a whole number of steps.
        MissingExtra: mujoco is not installed.

    >>> from crowdbot.world import Robot
    >>> trace = trace_physics(Robot.load("differential"), [Twist(1.0, 0.0)] * 100, 0.01)
    >>> round(float(trace.twist[-1, 0]), 2)
    1.0
    """
    _steps(step)
    scene = Scene.of([[0.0, 0.0]], heading=[0.0], external=[True], radius=[robot.radius])
    stage = PhysicsStage(friction=friction)
    riders, people = _rider(robot)
    world = PhysicsWorld(
        scene, ORCA(), {0: robot}, dt=SAMPLE, physics_dt=step, stage=stage, riders=riders, people=people
    )
    heading, old, rows = 0.0, 0.0, []
    for command in commands:
        world.step({0: command})
        body, twist = world.robot_body(0), world.twists[0]
        pose = body.pose
        heading, old = heading + _turned(old, float(pose.heading[0])), float(pose.heading[0])
        rows.append((*pose.position[0], heading, twist.forward[0], twist.left[0], twist.turn[0], body.tilt))
    return _trace(rows)


def _rider(robot: Robot) -> tuple[tuple[int, ...], People | None]:
    """Return the robots with a rider and the bodies of riders."""
    if not robot.rider:
        return (), None
    people = People.of([robot.rider] if robot.rider in names() else list(names()))
    return (0,), People.of([people.persons[int(people.mass.argmax())].name])


def _steps(step: float) -> int:
    count = round(SAMPLE / step) if step > 0.0 else 0
    if count < 1 or abs(count * step - SAMPLE) > 1e-9:
        raise InputError(f"time step {step} s: {SAMPLE} s must be a whole number of steps")
    return count


def _turned(old: float, new: float) -> float:
    return (new - old + math.pi) % (2.0 * math.pi) - math.pi


def _trace(rows: Sequence[Sequence[float]]) -> DriveTrace:
    table = np.array(rows, dtype=np.float64).reshape(-1, 7)
    return DriveTrace(table[:, :2], table[:, 2], table[:, 3:6], table[:, 6])
