"""LinkDynamics: drag of a link in air, and links that contacts do not move."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from crowdbot.core import InputError, attribute_problems, did_you_mean, from_attributes
from crowdbot.world.urdf import RobotModel


@dataclass(frozen=True)
class LinkDynamics:
    """How a link moves in the physics world.

    Fields:
        name: name of the link.
        drag: rate [1/s] at which the velocity of the link decays without other forces.
        angular_drag: the same for its rotation.
        kinematic: whether the joint above the link moves to its target at up to its maximum speed, whatever is in its
            way; for a link without a motor, the joint keeps its position.

    Raises:
        InputError: a drag is not finite or below 0.

    >>> LinkDynamics("pole", drag=0.5).kinematic
    False
    """

    name: str
    drag: float = 0.0
    angular_drag: float = 0.0
    kinematic: bool = False

    def __post_init__(self) -> None:
        for name in ("drag", "angular_drag"):
            value = getattr(self, name)
            if not 0.0 <= value < math.inf:
                raise InputError(f"{name.replace('_', '-')} = {value} 1/s must be finite and at least 0")


def read_link(row: Mapping[str, str]) -> LinkDynamics:
    """Return the dynamics of a link from the attributes of ``<link>`` in a robot file.

    Raises:
        InputError: an attribute is unknown, missing or not allowed.

    >>> read_link({"name": "pole", "angular-drag": "2"}).angular_drag
    2.0
    """
    for problem in attribute_problems(LinkDynamics, dict(row), ()).values():
        raise InputError(problem)
    link_dynamics: LinkDynamics = from_attributes(LinkDynamics, dict(row))
    return link_dynamics


def link_problem(link: LinkDynamics, model: RobotModel) -> str:
    """Return why a robot cannot have a link with these dynamics, empty if it can.

    >>> from crowdbot.world import Robot
    >>> link_problem(LinkDynamics("Hed"), Robot.load("pepper").model)
    "name='Hed' is not a link of the robot, did you mean 'Head'?"
    """
    if link.name not in model.links:
        return f"name={link.name[:60]!r} is not a link of the robot{did_you_mean(link.name, model.links)}"
    above = [joint for joint in model.joints.values() if joint.child == link.name]
    if link.kinematic and not (above and above[0].size == 1):
        joint = f"joint {above[0].name!r} is {above[0].kind}" if above else "it is the root of the robot"
        return f'kinematic="true" needs a joint that turns or slides above the link {link.name!r}: {joint}'
    return ""
