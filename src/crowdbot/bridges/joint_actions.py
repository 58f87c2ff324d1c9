"""The action ``control_msgs/FollowJointTrajectory``: goals of other programs, followed on simulated time.

Codes, tolerances and feedback are those of ``control_msgs/action/FollowJointTrajectory`` as
``joint_trajectory_controller`` of ros2_control answers it with its default parameters.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.simulation import Simulation
from crowdbot.world import joint_states, simulated_body

from .fields import stamp_fields
from .inbox import ServiceCall
from .interface import Fields, read_duration, read_number, read_trajectory
from .joint_trajectory import JointMotion, JointMotions, JointTrajectory

REJECTED, SUCCEEDED, CANCELED, ABORTED = 0, 4, 5, 6
"""States of goals at their end, as in ``action_msgs/GoalStatus``; a rejected goal has none there."""
SUCCESSFUL, INVALID_GOAL, INVALID_JOINTS, OLD_STAMP, PATH_VIOLATED, GOAL_VIOLATED = 0, -1, -2, -3, -4, -5
"""Error codes of the result."""
FEEDBACK = 50_000_000
"""Shortest simulated time [ns] between two feedback messages of a goal: 20 Hz, as ``action_monitor_rate``."""


def goal_end(state: int, code: int, text: str = "") -> dict[str, Any]:
    """Return the answer to a goal: its state, and the fields of its result.

    >>> goal_end(SUCCEEDED, SUCCESSFUL)
    {'status': 4, 'result': {'error_code': 0, 'error_string': ''}}
    """
    return {"status": state, "result": {"error_code": code, "error_string": text}}


@dataclass(frozen=True)
class _Tolerance:
    """Largest error of position and velocity of a joint; infinite: any."""

    position: float = math.inf
    velocity: float = math.inf

    def broken_by(self, position: float, velocity: float) -> bool:
        return abs(position) > self.position or abs(velocity) > self.velocity


def _tolerances(fields: Fields, key: str, joints: Iterable[str]) -> dict[str, _Tolerance]:
    """Tolerances by joint: 0 is the default, a number below 0 is none, which is the same here."""
    rows, known = fields.get(key) or [], {*joints}
    if not isinstance(rows, list | tuple) or not all(isinstance(row, Mapping) for row in rows):
        raise InputError(f"{key} must be a list of control_msgs/JointTolerance")
    found = {}
    for row in rows:
        name = str(row.get("name", ""))
        if name not in known:
            raise InputError(f"{key}: {name[:40]!r} is no joint of the trajectory{did_you_mean(name, known)}")
        limits = (read_number({key: row}, key, part) for part in ("position", "velocity"))
        found[name] = _Tolerance(*(limit if limit > 0.0 else math.inf for limit in limits))
    return found


@dataclass(eq=False)
class _Goal:
    """A goal that a robot follows."""

    call: ServiceCall
    trajectory: JointTrajectory
    motions: Mapping[str, JointMotion]
    path: Mapping[str, _Tolerance]
    end: Mapping[str, _Tolerance]
    patience: int
    """Time [ns] after the last point until which the joints must be within their tolerances; 0: no limit."""
    told: int = field(default=-FEEDBACK, init=False)
    checked: int = field(default=-1, init=False)


class JointActions:
    """Goals of a running simulation, and the joint motions that they and trajectories of topics share."""

    def __init__(self) -> None:
        self.motions = JointMotions()
        self._goals: list[_Goal] = []

    def begin(self, call: ServiceCall, robot: str, simulation: Simulation) -> None:
        """Begin to follow a goal at the current instant, or answer that it is rejected or was canceled meanwhile."""
        if call.canceled:  # it ends no other goal
            call.answer(goal_end(CANCELED, SUCCESSFUL, "canceled"))
            return
        code = INVALID_GOAL
        try:
            trajectory = _read(call, robot)
            known = simulation.control_of(robot).robot.body.model.joints
            if unknown := [joint for joint in trajectory.joints if joint not in known]:
                code = INVALID_JOINTS
                raise InputError(f"{robot} has no joint {unknown[0][:40]!r}{did_you_mean(unknown[0], known)}")
            if trajectory.is_over(simulation.world.clock.nanoseconds):
                code = OLD_STAMP
            path, end = (_tolerances(call.request, f"{key}_tolerance", trajectory.joints) for key in ("path", "goal"))
            patience = read_duration(call.request, "goal_time_tolerance")
            motions = self.motions.begin(trajectory, simulation)
        except InputError as error:
            call.answer(goal_end(REJECTED, code, str(error)))
            return
        self._goals.append(_Goal(call, trajectory, motions, path, end, max(0, patience)))
        self.check(simulation)

    def check(self, simulation: Simulation) -> None:
        """Send feedback of the goals at the current instant, and end those that are over."""
        now = simulation.world.clock.nanoseconds
        for goal in list(self._goals):
            if goal.call.canceled:
                self._end(goal, CANCELED, SUCCESSFUL, "canceled")
            elif goal.checked != now:
                goal.checked = now
                try:
                    self._check(goal, simulation, now)
                except InputError as error:  # the robot was removed
                    self._end(goal, ABORTED, INVALID_GOAL, str(error))
        for goal in [goal for goal in self._goals if not self._is_followed(goal)]:
            self._end(goal, CANCELED, INVALID_GOAL, "another goal or target moves its joints, or the robot refuses it")

    def end_all(self, text: str) -> None:
        """Abort all goals, since the run ends or begins again."""
        for goal in list(self._goals):
            self._end(goal, ABORTED, INVALID_GOAL, text)

    def _is_followed(self, goal: _Goal) -> bool:
        robot = goal.trajectory.robot
        return all(self.motions.follows(robot, joint, motion) for joint, motion in goal.motions.items())

    def _check(self, goal: _Goal, simulation: Simulation, now: int) -> None:
        robot, joints = goal.trajectory.robot, goal.trajectory.joints
        control = simulation.control_of(robot)
        states = joint_states(simulation.world, control.agent, control.robot.body, targets=control.joint_targets(0))
        desired = np.array([goal.motions[joint].at(now) for joint in joints])
        actual = np.array([states[joint] for joint in joints])
        if simulated_body(simulation.world, control.agent, 0) is None:  # in the plane, joints have no velocity
            actual[:, 1] = desired[:, 1]
        error = desired - actual
        if now - goal.told >= FEEDBACK:
            goal.told = now
            goal.call.feedback(_feedback(goal, now, desired, actual, error))
        over = now - max(int(motion.times[-1]) for motion in goal.motions.values())
        limits = goal.end if over >= 0 else goal.path
        broken = [
            f"{joint} is off by {row[0]:.3g} and {row[1]:.3g}/s"
            for joint, row in zip(joints, error.tolist(), strict=True)
            if joint in limits and limits[joint].broken_by(*row)
        ]
        if over < 0 and broken:
            self._end(goal, ABORTED, PATH_VIOLATED, f"path tolerance: {', '.join(broken)[:200]}")
        elif over >= 0 and not broken:
            self._end(goal, SUCCEEDED, SUCCESSFUL)
        elif broken and goal.patience and over > goal.patience:
            self._end(goal, ABORTED, GOAL_VIOLATED, f"goal tolerance: {', '.join(broken)[:200]}")

    def _end(self, goal: _Goal, state: int, code: int, text: str = "") -> None:
        """Answer a goal; its joints keep their latest targets."""
        self._goals.remove(goal)
        if state != SUCCEEDED:
            for joint, motion in goal.motions.items():
                if self.motions.follows(goal.trajectory.robot, joint, motion):
                    self.motions.stop(goal.trajectory.robot, joint)
        goal.call.answer(goal_end(state, code, text))


def _read(call: ServiceCall, robot: str) -> JointTrajectory:
    trajectory = call.request.get("trajectory")
    if not isinstance(trajectory, Mapping):
        raise InputError("a goal needs trajectory, as in control_msgs/action/FollowJointTrajectory")
    (read,) = read_trajectory(trajectory, robot, call.sender)
    assert isinstance(read, JointTrajectory)
    return read


def _feedback(goal: _Goal, now: int, *rows: Any) -> dict[str, Any]:
    begin = min(int(motion.times[0]) for motion in goal.motions.values())
    elapsed = stamp_fields(max(0, now - begin))
    points = {
        name: {"positions": values[:, 0].tolist(), "velocities": values[:, 1].tolist(), "time_from_start": elapsed}
        for name, values in zip(("desired", "actual", "error"), rows, strict=True)
    }
    header = {"stamp": stamp_fields(now), "frame_id": ""}
    return {"header": header, "joint_names": [*goal.trajectory.joints], **points}
