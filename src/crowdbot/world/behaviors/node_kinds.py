"""Kinds of nodes of behaviour trees, with the ports of each.

Control nodes and decorators are those of BehaviorTree.CPP (https://www.behaviortree.dev, versions 3 and 4). Conditions
and actions have the names of HuNavSim where it has them (Perez-Higueras et al. 2023, doi 10.1109/LRA.2023.3316072).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

CONTROLS = ("Sequence", "SequenceWithMemory", "ReactiveSequence", "Fallback", "ReactiveFallback", "Parallel")
DECORATORS = (
    "Inverter", "ForceSuccess", "ForceFailure", "Repeat", "RetryUntilSuccessful", "KeepRunningUntilFailure",
)  # fmt: skip
OTHER_NAMES = {
    "SequenceStar": "SequenceWithMemory",
    "RetryUntilSuccesful": "RetryUntilSuccessful",
    "SubTreePlus": "SubTree",
}
"""Names of version 3 for nodes that have another name in version 4."""


class Port(NamedTuple):
    """An input of a node.

    Fields:
        default: value without the attribute; None: the attribute is required.
        least, most: smallest and largest constant.
        whole: whether a constant must be a whole number.
    """

    default: float | None
    least: float = 0.0
    most: float = 86_400.0
    whole: bool = False


class NodeKind(NamedTuple):
    """A kind of node.

    Fields:
        about: what it does, one line.
        ports: inputs by name.
        reaction: kind of reaction that an action chooses, see :data:`crowdbot.world.REACTIONS`; empty for none.
        parameters: parameters of the reaction that the node may set.
        speed: speed of the reaction as a multiple of the preferred one, where it is not the default of the reaction.
    """

    about: str
    ports: Mapping[str, Port] = MappingProxyType({})
    reaction: str = ""
    parameters: tuple[str, ...] = ()
    speed: float | None = None


DISTANCE = {"distance": Port(None, 0.0, 1000.0)}
CYCLES = Port(None, -1.0, 1e6, True)

CONTROL_PORTS = {
    "Parallel": {"success_count": Port(-1.0, -1000.0, 1000.0, True), "failure_count": Port(1.0, -1000.0, 1000.0, True)},
    "Repeat": {"num_cycles": CYCLES},
    "RetryUntilSuccessful": {"num_attempts": CYCLES},
}
"""Inputs of control nodes and decorators; others have none."""
OTHER_PORTS = {"success_threshold": "success_count", "failure_threshold": "failure_count"}
"""Names of version 3 for ports that have another name in version 4."""

CONDITIONS = {
    "IsRobotVisible": NodeKind(
        "a robot is within `distance` [m], inside `field_of_view` [rad], and not behind a wall",
        {**DISTANCE, "field_of_view": Port(math.pi + 0.34, 0.0, 2.0 * math.pi)},
    ),
    "IsRobotNear": NodeKind("a robot is within `distance` [m]", DISTANCE),
    "IsPersonNear": NodeKind("another person is within `distance` [m]", DISTANCE),
    "IsGroupBehind": NodeKind(
        "a member of the group is farther than `distance` [m], and farther from the goal", DISTANCE
    ),
    "IsGoalReached": NodeKind("the person is at their current stop"),
    "TimeExpiredCondition": NodeKind(
        "the ticks of this node add up to `seconds`; then it begins again, unless `only_once`",
        {"seconds": Port(1.0), "ts": Port(None), "only_once": Port(0.0, 0.0, 1.0, True)},
    ),
    "AlwaysSuccess": NodeKind("always"),
    "AlwaysFailure": NodeKind("never"),
}
ACTIONS = {
    "RegularNav": NodeKind("walk to the goal"),
    "SurprisedNav": NodeKind("stop and turn to the robot", {}, "look", ("gesture",), 0.0),
    "CuriousNav": NodeKind("walk to the robot, stop at `gap` and look at it", {}, "curious", ("gap", "speed")),
    "ScaredNav": NodeKind(
        "keep away from the robot", {}, "scared", ("speed", "repulsion", "range")
    ),
    "ThreateningNav": NodeKind("walk in front of the robot and stay there", {}, "block", ("gap", "speed")),
    "FollowRobot": NodeKind("walk behind the robot", {}, "follow", ("gap", "speed")),
    "GiveWayNav": NodeKind("step out of the lane of the robot", {}, "give-way", ("gap", "speed")),
    "LookAtRobot": NodeKind("walk on and turn to the robot", {}, "look", ("speed", "gesture")),
    "IgnoreRobot": NodeKind("walk to the goal without seeing robots", {}, "ignore"),
    "ImpassiveNav": NodeKind("walk to the goal; robots are obstacles that stand still", {}, "impassive"),
    "UpdateGoal": NodeKind("take the next stop of the journey; fails without one"),
    "StandStill": NodeKind("stand in this step"),
    "Wait": NodeKind("stand for `seconds`; runs until then", {"seconds": Port(None)}),
    "TalkInGroup": NodeKind(
        "stand and turn to the others of the group, for `seconds` or one step; runs until then, fails without others",
        {"seconds": Port(0.0)},
    ),
    "QueueNav": NodeKind(
        "walk behind the nearest person who walks to the same stop and is nearer to it; without one, to the goal", {},
        "follow", ("gap", "speed"),
    ),
    "FollowPerson": NodeKind(
        "walk behind the nearest person, within `distance` [m]; fails without one",
        {"distance": Port(1000.0, 0.0, 1000.0)}, "follow", ("gap", "speed"),
    ),
    "ApproachPerson": NodeKind(
        "walk to the nearest person, within `distance` [m], and stop at `gap`; fails without one",
        {"distance": Port(1000.0, 0.0, 1000.0)}, "curious", ("gap", "speed"),
    ),
    "SetBlackboard": NodeKind("write `value` to the entry `output_key`"),
}  # fmt: skip
TIMED = ("RegularNav", "CuriousNav", "ScaredNav", "ThreateningNav", "SurprisedNav")
"""Actions of HuNavSim that take the time step as a port ``time_step``."""
NEEDS_ROBOT = (
    "SurprisedNav", "CuriousNav", "ScaredNav", "ThreateningNav", "FollowRobot", "GiveWayNav", "LookAtRobot",
)  # fmt: skip
"""Actions that fail without a robot."""
LEAVES = {**CONDITIONS, **ACTIONS}
KINDS = (*CONTROLS, *DECORATORS, "SubTree", *LEAVES)
"""Names of all nodes."""
