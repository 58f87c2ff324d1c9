"""LinkFrames: names and fixed poses of the frames of one robot in a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from crowdbot.core import SpatialPose
from crowdbot.messages import mount_pose
from crowdbot.sensors import WheelGeometry
from crowdbot.trials import RobotSpec
from crowdbot.typing import Floats
from crowdbot.world import quaternion

Row = tuple[str, str, SpatialPose]
"""Parent frame, child frame, and pose of the child."""
BASE, ODOM = "base_link", "odom"


def spatial_row(parent: str, child: str, matrix: Floats) -> Row:
    """Return the row of a frame ``[4, 4]`` of ``child`` in ``parent``."""
    return parent, child, SpatialPose(matrix[None, :3, 3].copy(), np.asarray(quaternion(matrix[:3, :3]))[None])


@dataclass(eq=False)
class LinkFrames:
    """Frames of a robot: ``<robot>/odom``, its links, and its sensors.

    The frame that moves in ``<robot>/odom`` is the root link of the URDF. It is ``<robot>/base_link``, unless
    ``base_link`` is a link below the root, such as ``base_footprint``. Other links have the names of the URDF after
    ``<robot>/``; a link with the name of a sensor that is elsewhere gets the ending ``_link``.

    Args:
        robot: the robot.

    >>> from crowdbot.navigation import Straight
    >>> from crowdbot.trials import RobotGoal
    >>> spec = RobotSpec(name="bot", type="turtlebot2", x=0, y=0, goal=RobotGoal(5, 0), navigator=Straight())
    >>> frames = LinkFrames(spec)
    >>> frames.odom, frames.base, frames.names["wheel_left"]
    ('bot/odom', 'bot/base_link', 'bot/wheel_left')
    """

    robot: RobotSpec
    names: dict[str, str] = field(init=False)
    base: str = field(init=False)
    wheels: WheelGeometry | None = field(init=False)

    def __post_init__(self) -> None:
        name, model = self.robot.name, self.robot.body.model
        sensors = {mount.name: mount for mount in self.robot.sensors}
        self._shared = {
            word
            for word, mount in sensors.items()
            if word == mount.link and np.allclose(mount.origin, np.eye(4), rtol=0.0, atol=1e-12)
        }
        root_is_base = model.root == BASE or BASE in model.links
        taken = ({*sensors} - self._shared) | {ODOM} | (set() if root_is_base else {BASE})
        self.names = {}
        for link in model.links:
            word = link
            while word in taken or (word != link and word in model.links):
                word += "_link"
            self.names[link] = f"{name}/{word}"
        self.base = self.names[model.root] if root_is_base else f"{name}/{BASE}"

    @property
    def odom(self) -> str:
        """The frame in which odometry measures."""
        return f"{self.robot.name}/{ODOM}"

    def fixed(self) -> list[Row]:
        """Return the frames that do not move in their parent: links behind fixed joints, and sensors."""
        model = self.robot.body.model
        rows = []
        if self.base != self.names[model.root]:
            rows.append(spatial_row(self.base, self.names[model.root], np.eye(4)))
        for joint in model.joints.values():
            if joint.kind == "fixed":
                rows.append(spatial_row(self.names[joint.parent], self.names[joint.child], joint.origin))
        for mount in self.robot.sensors:
            frame = f"{self.robot.name}/{mount.name}"
            if mount.name in self._shared or frame == self.odom:
                continue
            if mount.link:
                rows.append(spatial_row(self.names[mount.link], frame, mount.origin))
            else:
                rows.append((self.base, frame, mount_pose(self.robot, mount)))
        return rows

    def moving(self, states: Mapping[str, tuple[float, float]], links: Mapping[str, Floats] | None = None) -> list[Row]:
        """Return the frames of links behind joints that move.

        Args:
            states: position [rad or m] and velocity of joints by name.
            links: frames ``[4, 4]`` of links in the world, for joints with several coordinates (default: at rest).
        """
        rows = []
        for joint in self.robot.body.model.joints.values():
            if joint.kind == "fixed":
                continue
            if joint.name in states:
                matrix = joint.origin @ joint.motion(states[joint.name][0])
            elif links is not None:
                matrix = np.linalg.inv(links[joint.parent]) @ links[joint.child]
            else:
                matrix = joint.origin @ joint.motion(joint.rest_position())
            rows.append(spatial_row(self.names[joint.parent], self.names[joint.child], matrix))
        return rows
