"""RobotModel: links and joints of a robot, forward kinematics and mass properties."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, did_you_mean
from crowdbot.core.outlines import convex_hull
from crowdbot.typing import Floats

from .shapes import Shape
from .transforms import across, axis_rotation, frame, from_quaternion, transform_points

JOINT_KINDS = {"fixed": 0, "revolute": 1, "continuous": 1, "prismatic": 1, "planar": 3, "floating": 7}
"""Joint types and their number of position coordinates."""


@dataclass(frozen=True, eq=False)
class LinkInertia:
    """Mass [kg], centre of mass ``[3]`` [m], and inertia ``[3, 3]`` [kg m2] about the centre, in the axes of a
    frame.
    """

    mass: float
    center: Floats
    tensor: Floats


@dataclass(frozen=True, eq=False)
class LinkShape:
    """A shape of a link: its pose ``[4, 4]`` in the frame of the link, and its colour (red, green, blue, alpha)."""

    shape: Shape
    origin: Floats
    name: str = ""
    color: tuple[float, float, float, float] | None = None


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid part of a robot, with visual shapes (``visuals``) and colliders (``collisions``).

    ``inertial`` is None for a link without mass. ``friction`` is the coefficient of sliding friction, or None.
    """

    name: str
    inertial: LinkInertia | None = None
    visuals: tuple[LinkShape, ...] = ()
    collisions: tuple[LinkShape, ...] = ()
    friction: float | None = None


@dataclass(frozen=True)
class Mimic:
    """A joint whose position follows another joint: ``multiplier * position + offset``."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Motor:
    """Motor of a joint: maximum force [N or N m], maximum speed [m/s or rad/s] and command type.

    ``kind`` is ``position``, ``velocity`` or ``effort``; empty if the URDF does not define it.
    """

    effort: float = math.inf
    velocity: float = math.inf
    kind: str = ""


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint between a parent and a child link.

    Fields:
        name, kind: name and type, see :data:`JOINT_KINDS`.
        parent, child: names of links.
        origin: frame ``[4, 4]`` of the joint in the parent, which is the frame of the child at position 0.
        axis: unit vector ``[3]`` in the frame of the joint; the normal of a planar joint.
        lower, upper: limits of the position [rad or m]; infinite without limits.
        motor: motor with maximum force and speed.
        damping: viscous damping [N s/m or N m s/rad].
        friction: dry friction [N or N m].
        stiffness, rest: spring stiffness [N/m or N m/rad] and equilibrium position.
        mimic: the joint that this joint follows, or None.
    """

    name: str
    kind: str
    parent: str
    child: str
    origin: Floats
    axis: Floats
    lower: float = -math.inf
    upper: float = math.inf
    motor: Motor = field(default_factory=Motor)
    damping: float = 0.0
    friction: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    mimic: Mimic | None = None

    @property
    def size(self) -> int:
        """Number of position coordinates."""
        return JOINT_KINDS[self.kind]

    def motion(self, position: ArrayLike) -> Floats:
        """Return the frame ``[4, 4]`` of the child in the frame of the joint.

        Args:
            position: a number [rad or m]; planar: x, y [m] in the plane and the angle [rad]; floating: x, y, z [m] and
                the quaternion w, x, y, z.

        Raises:
            InputError: the number of values is wrong, or a value is not finite.
        """
        values = np.atleast_1d(np.asarray(position, dtype=np.float64))
        if values.shape != (max(self.size, 1),) or not np.all(np.isfinite(values)):
            raise InputError(
                f"joint {self.name!r}: position {values.tolist()} must be {max(self.size, 1)} finite numbers"
                f" ({self.kind})"
            )
        if self.kind == "prismatic":
            return frame(values[0] * self.axis)
        if self.kind == "planar":
            return frame(across(self.axis)[:, :2] @ values[:2], axis_rotation(self.axis, float(values[2])))
        if self.kind == "floating":
            return frame(values[:3], from_quaternion(values[3:]))
        return np.eye(4) if self.kind == "fixed" else frame(rotation=axis_rotation(self.axis, float(values[0])))

    def rest_position(self) -> Floats:
        """Return the position ``[size]`` at which the frame of the child equals the frame of the joint."""
        return np.array([0.0] * 3 + [1.0] + [0.0] * 3) if self.kind == "floating" else np.zeros(max(self.size, 1))


class Remark(NamedTuple):
    """A remark of the parser: something was ``replaced``, ``repaired``, ``ignored`` or ``noted``."""

    kind: str
    text: str


@dataclass(frozen=True, eq=False)
class RobotModel:
    """Links and joints of a robot as a kinematic tree.

    Fields:
        name: name of the robot.
        links, joints: by name; parents come before their children.
        root: name of the root link.
        remarks: what was replaced, repaired or ignored.
        meshes: paths of the mesh files, by their name in the URDF.
        source: the URDF text, with xacro and SDF converted; empty for a robot that was made without a file.
        mesh_files: paths of their material files and textures, by the name of the mesh and the name in it.

    >>> from crowdbot.world import read_urdf
    >>> arm = read_urdf(\"\"\"<robot name="arm"><link name="foot"/><link name="arm"><inertial><mass value="2"/>
    ... <origin xyz="1 0 0"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    ... <joint name="hinge" type="continuous"><parent link="foot"/><child link="arm"/><axis xyz="0 0 1"/></joint>
    ... </robot>\"\"\")
    >>> arm.mass, arm.inertial({"hinge": math.pi / 2}).center.round(6).tolist()
    (2.0, [0.0, 1.0, 0.0])
    """

    name: str
    links: Mapping[str, Link]
    joints: Mapping[str, Joint]
    root: str
    remarks: tuple[Remark, ...] = ()
    meshes: Mapping[str, Path] = field(default_factory=dict)
    source: str = field(default="", repr=False)
    mesh_files: Mapping[str, Mapping[str, Path]] = field(default_factory=dict)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences of :attr:`remarks`."""
        return tuple(remark.text for remark in self.remarks)

    @property
    def replaced_colliders(self) -> int:
        """Number of links whose shape for contacts is not that of the file, since a mesh is missing or broken."""
        return sum(remark.kind == "replaced" and "; for contacts, " in remark.text for remark in self.remarks)

    @property
    def mass(self) -> float:
        """Total mass [kg]."""
        return sum(link.inertial.mass for link in self.links.values() if link.inertial)

    @property
    def movable(self) -> tuple[Joint, ...]:
        """Joints that move freely, excluding fixed and mimic joints."""
        return tuple(joint for joint in self.joints.values() if joint.kind != "fixed" and joint.mimic is None)

    def positions(self, given: Mapping[str, ArrayLike] | None = None) -> dict[str, Floats]:
        """Return the positions of all joints: given, following another joint, or at rest.

        Raises:
            InputError: a name is not a joint, or the joint is fixed or follows another.
        """
        given = given or {}
        for name in given:
            if name not in self.joints:
                raise InputError(f"{self.name} has no joint {name!r}{did_you_mean(name, self.joints)}")
            leader = self.joints[name].mimic
            if leader or self.joints[name].kind == "fixed":
                why = f"follows {leader.joint!r}" if leader else "is fixed"
                raise InputError(f"the joint {name!r} of {self.name} {why}; its position cannot be set")
        result: dict[str, Floats] = {}

        def resolve(name: str) -> Floats:
            if name not in result:
                joint = self.joints[name]
                if joint.mimic:
                    result[name] = joint.mimic.multiplier * resolve(joint.mimic.joint) + joint.mimic.offset
                else:
                    result[name] = np.atleast_1d(np.asarray(given.get(name, joint.rest_position()), dtype=np.float64))
            return result[name]

        for name in self.joints:
            resolve(name)
        return result

    def poses(self, positions: Mapping[str, ArrayLike] | None = None) -> dict[str, Floats]:
        """Return the frames ``[4, 4]`` of all links in the frame of the root.

        Args:
            positions: joint positions by name, see :meth:`Joint.motion` (default: at rest).

        Raises:
            InputError: a name is not a movable joint, or a position is not finite. Limits are not checked.
        """
        places = self.positions(positions)
        result = {self.root: np.eye(4)}
        for joint in self.joints.values():
            result[joint.child] = result[joint.parent] @ joint.origin @ joint.motion(places[joint.name])
        return result

    def inertial(self, positions: Mapping[str, ArrayLike] | None = None) -> LinkInertia:
        """Return total mass, centre of mass and inertia in the frame of the root."""
        poses = self.poses(positions)
        bodies = [(link.inertial, poses[name]) for name, link in self.links.items() if link.inertial]
        return _joined(bodies)

    def points(self, positions: Mapping[str, ArrayLike] | None = None) -> Floats:
        """Return points ``[N, 3]`` [m] in the frame of the root whose convex hull contains all colliders."""
        poses = self.poses(positions)
        rows = [
            transform_points(poses[name] @ part.origin, part.shape.points())
            for name, link in self.links.items()
            for part in link.collisions
        ]
        return np.concatenate(rows) if rows else np.zeros((0, 3))

    def footprint(self, positions: Mapping[str, ArrayLike] | None = None) -> Floats:
        """Return the corners ``[N, 2]`` [m] of the convex outline of all colliders from above, in the root frame.

        >>> from crowdbot.world import read_urdf
        >>> box = '<collision><geometry><box size="2 1 1"/></geometry></collision>'
        >>> read_urdf(f'<robot name="r"><link name="b">{box}</link></robot>').footprint().tolist()
        [[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]]
        """
        return convex_hull(self.points(positions)[:, :2])


def _joined(bodies: list[tuple[LinkInertia, Floats]]) -> LinkInertia:
    mass = sum(inertial.mass for inertial, _ in bodies)
    if mass <= 0.0:
        return LinkInertia(0.0, np.zeros(3), np.zeros((3, 3)))
    places = [transform_points(matrix, inertial.center[None])[0] for inertial, matrix in bodies]
    center = sum((b.mass * place for (b, _), place in zip(bodies, places, strict=True)), np.zeros(3)) / mass
    tensor = np.zeros((3, 3))
    for (inertial, matrix), place in zip(bodies, places, strict=True):
        rotation, shift = matrix[:3, :3], place - center
        tensor += rotation @ inertial.tensor @ rotation.T
        tensor += inertial.mass * (np.eye(3) * (shift @ shift) - np.outer(shift, shift))
    return LinkInertia(mass, center, tensor)
