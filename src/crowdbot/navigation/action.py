"""Action: the output of a navigator until its next decision."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from crowdbot.core import Twist


@dataclass(frozen=True)
class Action:
    """The decision of a navigator.

    Fields:
        twist: velocity asked of the drive [m/s], [rad/s].
        joints: target positions of joints by name [rad] or [m], clipped to the limits of each joint. A joint that is
            left out keeps its target.

    >>> Action(Twist(0.5), {"HeadYaw": 0.3}).joints
    {'HeadYaw': 0.3}
    """

    twist: Twist = field(default_factory=Twist)
    joints: Mapping[str, float] = field(default_factory=dict)
