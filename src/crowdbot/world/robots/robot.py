"""Robot: URDF model with drive, sensors and footprint, loaded from a folder."""

from __future__ import annotations

import functools
import importlib.resources
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from crowdbot.core import InputError, Pose, RobotError, SpatialPose, Twist, did_you_mean
from crowdbot.core.outlines import outline_of
from crowdbot.typing import Floats
from crowdbot.world.robots.drives.drive import Drive
from crowdbot.world.robots.drives.servo import CommandDelay
from crowdbot.world.urdf import Cylinder, Link, LinkInertia, LinkShape, RobotModel
from crowdbot.world.urdf.transforms import axis_rotation, frame, quaternion

from .link_dynamics import LinkDynamics, link_problem
from .mount import SensorMount
from .robot_file import FILE, read_robot_file
from .wheel import Wheel, weak_motor

SUNK = 2e-3
"""Depth [m] of colliders below the root above which the root is not on the ground."""
CLEAR = 0.01
"""Ground clearance [m] of a robot made by :meth:`Robot.disc`, which avoids friction."""


STEP, SLOPE = 0.2, 0.1
"""Default step that a robot with wheels passes, relative to the radius of a driven wheel, and default slope."""


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot for a world.

    Fields:
        name: name of the robot.
        model: links and joints; the root is on the ground below the centre, x forward.
        drive: motion model of the base with limits of speed and acceleration.
        latency: delay between a command and the wheels [s], see :class:`CommandDelay`.
        base: actuation in the physics world: ``wheels`` (motors turn the wheels) or ``planar`` (the base is pulled, for
            omnidirectional wheels).
        footprint: corners of the outline on the ground ``[N, 2]`` [m], counter-clockwise.
        mounts: sensors.
        wheels: wheels that drive, steer, or roll freely on a fixed axle; no castors.
        posture: joint positions while driving [rad, m]; 0 for joints left out.
        about: description, one line.
        seat: whether it has the seat of a wheelchair.
        rider: kind or body of the person in the seat, in trials that name no other; empty for none.
        links: drag of links, and links that contacts do not move.
        max_step: height [m] of the largest step that it passes in the physics world (default: a fifth of the radius
            of its smallest driven wheel; 0 with a planar base).
        max_slope: largest slope that it passes, as rise over length (default: 0.1; 0 with a planar base).

    >>> robot = Robot.load("turtlebot2")
    >>> robot.drive.max_speed, round(robot.radius, 3), [mount.name for mount in robot.mounts][:3]
    (0.65, 0.232, ['laser', 'kinect_depth', 'kinect_rgb'])
    """

    name: str
    model: RobotModel
    drive: Drive
    latency: float = 0.0
    base: str = "wheels"
    footprint: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    mounts: tuple[SensorMount, ...] = ()
    wheels: tuple[Wheel, ...] = ()
    posture: Mapping[str, float] = field(default_factory=dict)
    about: str = ""
    seat: bool = False
    rider: str = ""
    links: tuple[LinkDynamics, ...] = ()
    max_step: float = math.nan
    max_slope: float = math.nan

    def __post_init__(self) -> None:
        CommandDelay(self.latency)
        if self.base not in ("wheels", "planar"):
            raise InputError(f"Robot: base = {self.base!r} must be wheels or planar")
        shape = np.asarray(self.footprint, dtype=np.float64)
        if shape.size == 0:
            shape = self.model.footprint(self.posture)
        if shape.ndim != 2 or shape.shape[1] != 2 or len(shape) < 3 or not np.all(np.isfinite(shape)):
            has = (
                f"{len(shape)} corners" if len(shape) else 'no colliders to take it from; add <footprint radius="0.3"/>'
            )
            raise InputError(
                f"Robot: the footprint of {self.name} must be at least 3 points x, y [m]; its model has {has}"
            )
        object.__setattr__(self, "footprint", shape)
        try:
            outline_of(shape)
        except InputError as error:
            raise InputError(f"Robot: {self.name}: {error}") from None
        self.model.positions(self.posture)
        for link in self.links:
            if problem := link_problem(link, self.model):
                raise InputError(f"Robot: <link> {problem}")
        if self.rider and not self.seat:
            raise InputError(f'Robot: rider={self.rider[:60]!r} needs a seat: extends="wheelchair"')
        self._set_ground_limits()
        names = [mount.name for mount in self.mounts]
        for mount in self.mounts:
            if names.count(mount.name) > 1:
                raise InputError(f"Robot: two sensors of {self.name} have the name {mount.name!r}; names must differ")
            if mount.link not in self.model.links:
                meant = did_you_mean(mount.link, self.model.links)
                raise InputError(
                    f"Robot: the sensor {mount.name!r} is mounted on {mount.link!r}, which is not a link{meant}"
                )
        turning_joints = {joint.name for joint in self.model.movable if joint.size == 1}
        for wheel in self.wheels:
            for what, name in (("wheel", wheel.joint), ("steering", wheel.steering or wheel.joint)):
                if name not in turning_joints:
                    meant = did_you_mean(name, self.model.joints)
                    raise InputError(f"Robot: the {what} joint {name!r} is not a rotating joint{meant}")

    def _set_ground_limits(self) -> None:
        """Set the largest step and slope that are not given, and check them."""
        wheels = [wheel.radius for wheel in self.wheels if wheel.driven] if self.base == "wheels" else []
        usual = {"max_step": STEP * min(wheels, default=0.0), "max_slope": SLOPE if wheels else 0.0}
        for name, value in usual.items():
            given = getattr(self, name)
            if math.isnan(given):
                object.__setattr__(self, name, value)
            elif not 0.0 <= given < math.inf:
                raise InputError(f"Robot: {name} = {given} of {self.name} must be finite and at least 0")

    @classmethod
    def load(cls, source: str | Path, *, trust: bool = False) -> Robot:
        """Read a robot.

        Args:
            source: a built-in name, the folder of a robot, or its ``robot.xml``; a folder in the working directory
                takes precedence over a built-in name.
            trust: whether sensors and drives named by address may be loaded from outside the folder.

        Raises:
            RobotError: the robot does not exist or has errors; one sentence per error.
        """
        folder = _folder(source)
        values = read_robot_file(folder, trust=trust)
        try:
            return cls(**values)
        except InputError as error:
            raise RobotError(f"{folder / FILE}: {error}") from None

    @classmethod
    def disc(cls, name: str, drive: Drive, radius: float, *, height: float = 1.0, mass: float = 50.0) -> Robot:
        """Return a robot with the shape of an upright cylinder, whose base is pulled along the floor.

        Args:
            name: name of the robot.
            drive: motion model of the base.
            radius, height: size of the cylinder [m].
            mass: mass [kg].

        Raises:
            InputError: a size or the mass is not finite and above 0.

        >>> from crowdbot.world import DifferentialDrive
        >>> round(Robot.disc("puck", DifferentialDrive(), 0.3).radius, 3)
        0.3
        """
        for what, value in (("radius", radius), ("height", height), ("mass", mass)):
            if not 0.0 < value < math.inf:
                raise InputError(f"Robot.disc: {what} = {value} must be finite and above 0")
        origin = frame((0.0, 0.0, 0.5 * height + CLEAR))
        column = Cylinder(radius, height)
        whole = LinkInertia(mass, origin[:3, 3], column.solid().inertia(mass))
        link = Link("base_link", whole, (LinkShape(column, origin),), (LinkShape(column, origin),))
        return cls(name, RobotModel(name, {"base_link": link}, {}, "base_link"), drive, base="planar")

    @property
    def radius(self) -> float:
        """Radius [m] of the disc around the origin that contains the footprint."""
        return float(np.hypot(self.footprint[:, 0], self.footprint[:, 1]).max())

    @functools.cached_property
    def outline(self) -> Floats | None:
        """Convex outline ``[K, 2]`` [m] of the footprint, counter-clockwise, in the robot frame; None for a disc.

        A footprint is a disc if its inscribed radius is at least 0.98 of its circumscribed radius.

        >>> Robot.load("cuybot").outline.tolist()
        [[-0.2865, -0.266], [0.2865, -0.266], [0.2865, 0.266], [-0.2865, 0.266]]
        """
        result = outline_of(self.footprint)
        if result is not None:
            result.flags.writeable = False
        return result

    @property
    def half_width(self) -> float:
        """Largest distance [m] of the outline from its forward axis: the smallest radius of a straight passage."""
        return self.radius if self.outline is None else float(np.abs(self.outline[:, 1]).max())

    @functools.cached_property
    def posture_poses(self) -> Mapping[str, Floats]:
        """Frames ``[4, 4]`` of all links in the frame of the root, in the default posture; read-only.

        >>> Robot.load("turtlebot2").posture_poses["wheel_left"][:3, 3].tolist()
        [0.0, 0.115, 0.035]
        """
        poses = self.model.poses(self.posture)
        for pose in poses.values():
            pose.flags.writeable = False
        return poses

    @functools.cached_property
    def height(self) -> float:
        """Height [m] of the highest collider above the root, in the default posture."""
        points = self.model.points(self.posture)
        return float(points[:, 2].max()) if len(points) else 0.0

    @property
    def lift(self) -> float:
        """Height of the root above the floor in the default posture [m]; 0 for a root on the ground."""
        points = self.model.points(self.posture)
        lowest = float(points[:, 2].min()) if len(points) else 0.0
        return -lowest if lowest < -SUNK else 0.0

    @property
    def weak_motors(self) -> tuple[str, ...]:
        """Sentences about motors that do not turn their wheels at the maximum speed in the physics world.

        >>> Robot.load("turtlebot2").weak_motors
        ()
        """
        speed, joints = float(getattr(self.drive, "max_speed", 0.0)), self.model.joints
        motors = [] if self.base == "planar" else [wheel for wheel in self.wheels if wheel.driven]
        found = [
            weak_motor(joints[wheel.joint], joints[wheel.joint].motor.effort, speed / wheel.radius)
            for wheel in motors
            if joints[wheel.joint].motor.effort > 0.0
        ]
        return tuple(sentence for sentence in found if sentence)

    def mount(self, name: str) -> SensorMount:
        """Return the sensor of this name.

        Raises:
            InputError: there is no such sensor.
        """
        for mount in self.mounts:
            if mount.name == name:
                return mount
        names = [mount.name for mount in self.mounts]
        raise InputError(
            f"{self.name} has no sensor {name!r}{did_you_mean(name, names)}; it has {', '.join(names) or 'none'}"
        )

    def sensor_frame(self, name: str, positions: Mapping[str, float] | None = None) -> Floats:
        """Return the frame ``[4, 4]`` of a sensor in the robot frame, in its posture or at other joint positions."""
        mount = self.mount(name)
        return np.asarray(self.model.poses({**self.posture, **(positions or {})})[mount.link] @ mount.origin)

    def sensor_pose(self, name: str, pose: Pose, positions: Mapping[str, float] | None = None) -> SpatialPose:
        """Return the spatial pose of a sensor for a robot on the floor at ``pose`` ``[E]``.

        >>> Robot.load("qolo").sensor_pose("lidar_rear", Pose.of((1.0, 0.0), 0.0)).position.round(3).tolist()
        [[0.484, 0.0, 0.364]]
        """
        seat = self.sensor_frame(name, positions)
        found = [spatial(frame((x, y, self.lift), axis_rotation((0.0, 0.0, 1.0), a)) @ seat) for (x, y), a in zip(
            pose.position.tolist(), pose.heading.tolist(), strict=True)]  # fmt: skip
        return SpatialPose(
            np.concatenate([one.position for one in found]), np.concatenate([one.rotation for one in found])
        )

    def wheel_speeds(self, twist: Twist) -> dict[str, float]:
        """Return the wheel speeds [rad/s] by joint without slip along the rolling directions.

        Rollers slide across their axes: a wheel with rollers at an angle ``a`` also turns for motion along its axle.

        >>> Robot.load("turtlebot2").wheel_speeds(Twist(0.35, 0.0))
        {'wheel_left_joint': 10.0, 'wheel_right_joint': 10.0}
        """
        steered = self.steering(twist)
        poses = self.model.poses({**self.posture, **steered}) if steered else self.posture_poses
        speeds = {}
        for wheel in self.wheels:
            if wheel.driven:
                joint = self.model.joints[wheel.joint]
                matrix = poses[joint.parent] @ joint.origin
                axle = matrix[:3, :3] @ joint.axis
                rolling = np.array([axle[1], -axle[0]])  # axle x up
                if wheel.rollers:
                    rolling += math.tan(wheel.rollers) * np.array([axle[0], axle[1]])
                speeds[wheel.joint] = round(float(_carried(twist, matrix) @ rolling) / wheel.radius, 12)
        return speeds

    def steering(self, twist: Twist) -> dict[str, float]:
        """Return the steering angles [rad] by joint for which all wheels roll around the same point.

        The angles are 0 at rest. Backwards, they are those of forward motion on the same circle.
        """
        angles = {}
        for wheel in self.wheels:
            if wheel.steering:
                joint = self.model.joints[wheel.steering]
                matrix = self.posture_poses[joint.parent] @ joint.origin
                x, y = (_carried(twist, matrix) * (-1.0 if twist.forward < 0.0 else 1.0)).tolist()
                sense = 1.0 if (matrix[:3, :3] @ joint.axis)[2] > 0.0 else -1.0
                angles[wheel.steering] = round(sense * math.atan2(y, x), 12)
        return angles


def _carried(twist: Twist, matrix: Floats) -> Floats:
    """Return the velocity ``[2]`` [m/s] over the floor of the origin of a frame ``[4, 4]`` of the robot."""
    x, y = matrix[:2, 3].tolist()
    return np.array([twist.forward - twist.turn * y, twist.left + twist.turn * x])


def spatial(matrix: Floats) -> SpatialPose:
    """Return a frame ``[4, 4]`` in the world as a pose, E = 1."""
    return SpatialPose(matrix[None, :3, 3].copy(), np.asarray(quaternion(matrix[:3, :3]))[None])


def builtin_robots() -> tuple[str, ...]:
    """Return the names of the built-in robots.

    >>> builtin_robots()
    ('cuybot', 'differential', 'pepper', 'qolo', 'turtlebot2', 'wheelchair', 'wheelchair-3d', 'wheelchair-rider')
    """
    return tuple(sorted(entry.name for entry in _assets().iterdir() if (entry / FILE).is_file()))


def _assets() -> Path:
    return Path(str(importlib.resources.files("crowdbot").joinpath("assets", "robots")))


def _folder(source: str | Path) -> Path:
    """Return the folder that contains the robot file."""
    path = Path(source)
    known = builtin_robots()
    if path.is_dir():
        if (path / FILE).is_file():
            return path
        if str(source) not in known:
            raise RobotError(f"the folder {path} has no {FILE}; a robot is a folder with a URDF and a {FILE}")
    if str(source) in known:
        return _assets() / str(source)
    if path.name == FILE and path.is_file():
        return path.parent
    if path.suffix == ".urdf":
        raise RobotError(f"{path} does not define drive and sensors; give the folder with its {FILE}")
    raise RobotError(
        f"there is no robot {str(source)!r}{did_you_mean(str(source), known)}: it is neither a folder"
        f" nor a built-in robot ({', '.join(known)})"
    )
