"""Who leads in a trial of the leader-follower experiment: the robot or the participant."""

from __future__ import annotations

from typing import NamedTuple

from crowdbot.core import InputError
from crowdbot.navigation import FollowerNavigator, SinusoidNavigator
from crowdbot.trials import Avatar, RobotSpec, Trial


class Roles(NamedTuple):
    """The two of a trial, and whether the robot leads."""

    robot: RobotSpec
    participant: Avatar
    robot_leads: bool

    @property
    def leader(self) -> str:
        """``robot`` or ``participant``."""
        return "robot" if self.robot_leads else "participant"


def roles_of(trial: Trial) -> Roles:
    """Return the robot and the participant of a trial, and who leads.

    The robot leads if its navigator is ``sinusoid`` and follows if it is ``follower``.

    Raises:
        InputError: the trial does not have one robot with such a navigator and one avatar.
    """
    if len(trial.robots) != 1 or len(trial.avatars) != 1:
        raise InputError(
            f"trial {trial.name!r} has {len(trial.robots)} robots and {len(trial.avatars)} avatars; a leader-follower "
            "trial has one of each"
        )
    robot = trial.robots[0]
    if not isinstance(robot.navigator, SinusoidNavigator | FollowerNavigator):
        raise InputError(
            f"trial {trial.name!r}: the navigator of the robot {robot.name!r} is neither 'sinusoid' (it leads) nor "
            "'follower' (it follows)"
        )
    return Roles(robot, trial.avatars[0], isinstance(robot.navigator, SinusoidNavigator))
