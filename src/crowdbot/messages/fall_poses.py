"""Messages of the poses of people who are out of balance: 20 bytes for each person and record."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from crowdbot.humans import LYING, FallPose

if TYPE_CHECKING:
    from .message_store import Messages


FALL_POSES = "/crowdbot/fall_poses"
"""Topic of the poses of people who lean, fall, lie or get up, in recorded scenes."""
KIND = "crowdbot_msgs/msg/FallPoses"
WIDEST = LYING + 1e-3
"""Largest tilt [rad] that is read."""


def fall_pose_message(make: Messages, now: int, poses: Mapping[int, FallPose]) -> Any:
    """Return the message of poses by id of the person, at a simulated time [ns].

    >>> from crowdbot.messages import Messages
    >>> make = Messages()
    >>> message = fall_pose_message(make, 0, {3: FallPose(0.5, 1.25, 0.25, True, True)})
    >>> read_fall_poses(make.decode_message(make.encode_message(message), KIND))
    {3: FallPose(direction=0.5, tilt=1.25, start=0.25, struck=True, down=True, rising=False)}
    """
    rows = [
        make.make(
            "crowdbot_msgs/msg/FallPose", person=person, direction=pose.direction, tilt=pose.tilt, start=pose.start,
            struck=pose.struck, down=pose.down, rising=pose.rising,
        )
        for person, pose in poses.items()
    ]  # fmt: skip
    return make.make(KIND, header=make.header(now), poses=rows)


def read_fall_poses(message: Any) -> dict[int, FallPose]:
    """Return the poses of a message by id of the person.

    Raises:
        ValueError: an angle is not possible.
    """
    found = {}
    for one in message.poses:
        flags = bool(one.struck), bool(one.down), bool(one.rising)
        pose = FallPose(float(one.direction), float(one.tilt), float(one.start), *flags)
        if not (math.isfinite(pose.direction) and 0.0 <= pose.tilt <= WIDEST and 0.0 <= pose.start <= WIDEST):
            raise ValueError(f"person {one.person} has an impossible pose {tuple(pose)}")
        found[int(one.person)] = pose
    return found
