"""Joint trajectories of other programs, followed as ``joint_trajectory_controller`` of ros2_control does."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError
from crowdbot.simulation import JointOrder, Simulation
from crowdbot.typing import Floats, Ints
from crowdbot.world import joint_states


@dataclass(frozen=True, eq=False)
class JointTrajectory:
    """A ``trajectory_msgs/JointTrajectory`` for a robot, with N points of J joints.

    Fields:
        robot: name of the robot.
        joints: names of the joints.
        begin: time [ns] from which the times of the points count; 0: the instant at which it is taken.
        times: ``[N]`` times of the points after ``begin`` [ns], strictly increasing.
        positions: ``[N, J]`` [rad or m].
        velocities: ``[N, J]`` [rad/s or m/s], NaN at points without velocities.
        source: name of the program.

    Raises:
        InputError: a time is below 0, the times do not increase, or it ends with a velocity.

    >>> JointTrajectory("pepper", ("HeadYaw",), 0, np.zeros(2, np.int64), np.zeros((2, 1)), np.zeros((2, 1)))
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: joint trajectory: time_from_start of points[1] is 0 s, but it must be later than \
the 0 s of points[0]; give each point its time
    """

    robot: str
    joints: tuple[str, ...]
    begin: int
    times: Ints
    positions: Floats
    velocities: Floats
    source: str = ""

    def __post_init__(self) -> None:
        if self.times[0] < 0:
            raise InputError(f"joint trajectory: time_from_start of points[0] is {self.times[0] / 1e9:g} s, below 0")
        early = np.flatnonzero(np.diff(self.times) <= 0)
        if early.size:
            before, after = (float(self.times[early[0] + k]) / 1e9 for k in (0, 1))
            raise InputError(
                f"joint trajectory: time_from_start of points[{early[0] + 1}] is {after:g} s, but it must be later than"
                f" the {before:g} s of points[{early[0]}]; give each point its time"
            )
        for joint, velocity in zip(self.joints, self.velocities[-1].tolist(), strict=True):
            if velocity != 0.0 and not math.isnan(velocity):
                raise InputError(
                    f"joint trajectory: the last velocity of {joint!r} is {velocity:g}, but it must be 0: the joint"
                    " stays at the last position"
                )

    def is_over(self, now: int) -> bool:
        """Whether the last point is before a time [ns]."""
        return bool((self.begin or now) + self.times[-1] < now)


@dataclass(frozen=True, eq=False)
class JointMotion:
    """The motion of one joint: ``[N]`` absolute times [ns], positions and velocities, within limits."""

    times: Ints
    positions: Floats
    velocities: Floats
    lower: float
    upper: float
    source: str
    taken: int
    """Time [ns] at which it was taken."""

    def at(self, now: int) -> tuple[float, float]:
        """Position and velocity at a time [ns], from the first point on; the last position is kept.

        Between two points with velocities, the position is a cubic spline, otherwise linear.
        """
        if now >= self.times[-1]:
            return float(self.positions[-1]), 0.0
        k = int(np.searchsorted(self.times, now, side="right")) - 1
        (p0, p1), (v0, v1) = self.positions[k : k + 2].tolist(), self.velocities[k : k + 2].tolist()
        span = float(self.times[k + 1] - self.times[k]) / 1e9
        share = float(now - self.times[k]) / 1e9 / span
        slope = (p1 - p0) / span
        if math.isnan(v0 + v1):
            v0 = v1 = slope
        a, b = v0 + v1 - 2.0 * slope, 3.0 * slope - 2.0 * v0 - v1  # p0 + span * (v0 s + b s^2 + a s^3)
        position = p0 + span * share * (v0 + share * (b + share * a))
        return min(max(position, self.lower), self.upper), v0 + share * (2.0 * b + 3.0 * share * a)


class JointMotions:
    """The joints of a running simulation that follow trajectories: a target of each joint for each step.

    A joint goes from its state at the instant at which the trajectory is taken to the first point. It leaves its
    trajectory at a new one, or at another target (:meth:`stop`).
    """

    def __init__(self) -> None:
        self._motions: dict[tuple[str, str], JointMotion] = {}
        self._sent = -1

    def begin(self, trajectory: JointTrajectory, simulation: Simulation) -> dict[str, JointMotion]:
        """Begin to follow a trajectory at the current instant, and return the motions by joint.

        Raises:
            InputError: the robot or a joint does not exist, a position is not allowed, or the trajectory is over.
        """
        control, now = simulation.control_of(trajectory.robot), simulation.world.clock.nanoseconds
        body = control.robot.body
        times = (trajectory.begin or now) + trajectory.times
        if trajectory.is_over(now):
            raise InputError(
                f"joint trajectory: it ends at {times[-1] / 1e9:g} s, before the current time {now / 1e9:g} s;"
                " give a later header.stamp, or none"
            )
        if trajectory.begin > (end := round(simulation.trial.duration * 1e9)):
            raise InputError(
                f"joint trajectory: header.stamp is {trajectory.begin / 1e9:g} s, after the end of the trial at"
                f" {end / 1e9:g} s; stamps are simulated time, as on /clock"
            )
        for k, joint in enumerate(trajectory.joints):
            for position in (trajectory.positions[:, k].min(), trajectory.positions[:, k].max()):
                JointOrder(robot=trajectory.robot, joint=joint, position=float(position)).check(simulation)
        states = joint_states(simulation.world, control.agent, body, targets=control.joint_targets(0))
        for k, joint in enumerate(trajectory.joints):
            earlier = self._motions.get((trajectory.robot, joint))
            position, velocity = states[joint] if earlier is None or now >= earlier.times[-1] else earlier.at(now)
            old = 1 if times[0] > now else 0
            self._motions[trajectory.robot, joint] = JointMotion(
                np.concatenate([[now][:old], times]),
                np.concatenate([[position][:old], trajectory.positions[:, k]]),
                np.concatenate([[velocity][:old], trajectory.velocities[:, k]]),
                body.model.joints[joint].lower,
                body.model.joints[joint].upper,
                trajectory.source,
                now,
            )
        self._sent = -1
        return {joint: self._motions[trajectory.robot, joint] for joint in trajectory.joints}

    def follows(self, robot: str, joint: str, motion: JointMotion) -> bool:
        """Whether a motion is the latest of its joint, also after its last point."""
        return self._motions.get((robot, joint)) is motion

    def stop(self, robot: str, joint: str) -> None:
        """Leave the trajectory of a joint."""
        self._motions.pop((robot, joint), None)

    def targets(self, simulation: Simulation) -> Iterator[JointOrder]:
        """Yield the targets for the step that follows: the positions at its end, once for each instant."""
        now = simulation.world.clock.nanoseconds
        if self._sent == now:
            return
        self._sent, then = now, now + simulation.world.clock.step_ns
        for (robot, joint), motion in list(self._motions.items()):
            if now < motion.times[-1] or now == motion.taken:
                yield JointOrder(robot=robot, joint=joint, position=motion.at(then)[0], source=motion.source)
