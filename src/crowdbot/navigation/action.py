"""Action: the output of a navigator until its next decision."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from crowdbot.core import Twist

__all__ = ["Action"]


@dataclass(frozen=True)
class Action:
    """The decision of a navigator.

    Fields:
        twist: velocity asked of the drive [m/s], [rad/s].
        joints: target positions of joints by name [rad] or [m]; must be empty, since only orders move joints.

    >>> Action(Twist(0.5))
    Action(twist=Twist(forward=0.5, turn=0.0, left=0.0), joints={})
    """

    twist: Twist = field(default_factory=Twist)
    joints: Mapping[str, float] = field(default_factory=dict)
