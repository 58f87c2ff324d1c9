"""Robot of a trial: start, goal, type, drive, sensors and navigator."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot import world
from crowdbot.core import (
    MOUNT_HEIGHT,
    Clock,
    InputError,
    Pose,
    RobotError,
    TickSchedule,
    Twist,
    Walls,
    did_you_mean,
    reads_only,
)
from crowdbot.core.fields import NAME, attribute, check, child, children, mounted_field, plugin_field, quote_value
from crowdbot.messages import reading_topics
from crowdbot.navigation import ExternalNavigator, GestureLayer, Navigator, PathPlanner, SafetyLayer
from crowdbot.prediction import Predictor
from crowdbot.sensors import Lidar2D, Lidar3D, Sensor, SensorSchedule
from crowdbot.typing import Floats
from crowdbot.world import Drive, Twists, builtin_robots, check_joint, frame, roll_pitch_yaw

from .fault import FaultSpec, fault_problems
from .files.trial_files import resolve_file
from .human_kinds import ABOUT_RIDER, rider_problems
from .robots.predictor import RobotPredictor, forecast_problems
from .robots.robot_pose import RobotPose, mirrored_pose

if TYPE_CHECKING:
    from crowdbot.world import Robot

LINE = r"\S.{0,199}"


@dataclass(frozen=True, kw_only=True)
class JointTarget:
    """A target of a joint: it moves there from ``at`` on, within ``over``, and keeps the position.

    >>> wave = JointTarget(name="LShoulderPitch", target=-1.0, at=2.0, over=0.5)
    >>> wave.end
    2.5
    """

    name: str = attribute(about="name of the joint", pattern=LINE)
    target: float = attribute(about="position of the joint [rad or m], within its limits")
    at: float = attribute(0.0, about="time at which the motion begins", unit="s", min=0.0)
    over: float = attribute(0.0, about="duration of the motion at constant speed", unit="s", min=0.0)

    def __post_init__(self) -> None:
        check(self)

    @property
    def end(self) -> float:
        """Time at which the joint is at its target [s]."""
        return self.at + self.over


def joint_problems(targets: Sequence[JointTarget], robot: Robot) -> Iterator[str]:
    """Yield why the joints of a robot cannot follow targets.

    >>> from crowdbot.world import Robot
    >>> list(joint_problems([JointTarget(name="HeadYaw", target=9.0)], Robot.load("pepper")))
    ["<joint>: the joint 'HeadYaw' of pepper cannot be at 9 rad; it moves from -2.08567 to 2.08567 rad"]
    """
    last: dict[str, JointTarget] = {}
    for target in targets:
        try:
            check_joint(robot, target.name, target.target)
        except InputError as error:
            yield f"<joint>: {error}"
        before = last.get(target.name)
        if before is not None and target.at < before.end:
            yield (
                f'<joint>: the target of {target.name!r} at="{target.at:g}" begins before the one before ends at'
                f" {before.end:g} s"
            )
        last[target.name] = target


def joint_positions(
    targets: Sequence[JointTarget], posture: Mapping[str, float], before: int, now: int
) -> dict[str, float]:
    """Return the positions of the joints that move in the time after ``before`` up to ``now`` [ns].

    Args:
        targets: targets; those of one joint do not overlap.
        posture: positions of joints before their first target; 0 for others.
        before, now: interval [ns].

    >>> rise = [JointTarget(name="a", target=1.0, at=0.1, over=0.2), JointTarget(name="b", target=3.0, at=0.5)]
    >>> [joint_positions(rise, {}, k * 100_000_000, (k + 1) * 100_000_000) for k in (-1, 0, 1, 2, 3, 4)]
    [{}, {'a': 0.0}, {'a': 0.5}, {'a': 1.0}, {}, {'b': 3.0}]
    """
    result: dict[str, float] = {}
    start: dict[str, float] = {}
    for target in targets:
        begin, end = round(target.at * 1e9), round(target.end * 1e9)
        first = start.get(target.name, float(posture.get(target.name, 0.0)))
        start[target.name] = target.target
        if begin <= now and end > before:
            share = 1.0 if now >= end else (now - begin) / (end - begin)
            result[target.name] = target.target if share == 1.0 else first + share * (target.target - first)
    return result


def safety_problems(safety: Any, navigator: Any) -> Iterator[str]:
    """Yield why a robot cannot have its safety layer."""
    if safety is not None and isinstance(navigator, ExternalNavigator):
        yield 'has <safety> in addition to <navigator type="external"/>, which decides nothing; leave it out'


def gesture_problems(gestures: str, people: str, navigator: Any) -> Iterator[str]:
    """Yield why a robot cannot obey gestures.

    >>> from crowdbot.navigation import Straight
    >>> list(gesture_problems("obey", "tracked", Straight()))
    ['has gestures="obey" but people="tracked", which shows no gestures; take people="seen" or "true"']
    """
    if gestures == "obey" and people == "tracked":
        yield 'has gestures="obey" but people="tracked", which shows no gestures; take people="seen" or "true"'
    if gestures == "obey" and isinstance(navigator, ExternalNavigator):
        yield 'has gestures="obey" in addition to <navigator type="external"/>, which decides nothing; leave it out'


LASER_SCAN = "sensor_msgs/msg/LaserScan"
PEOPLE_INPUTS = ("seen", "true", "tracked")
ABOUT_PEOPLE = (
    "people in observations: seen (true states of those in the latest readings), true (everybody), or tracked (found in"
    " laser scans)"
)


def people_problems(people: str, mounts: Sequence[Any]) -> Iterator[str]:
    """Yield why a robot cannot have such an input.

    >>> list(people_problems("tracked", []))
    ['has people="tracked" but no laser scanner; add <sensor type="lidar2d"/> or <sensor type="lidar3d"/>']
    """
    if people == "tracked" and not any(isinstance(mount.sensor, Lidar2D | Lidar3D) for mount in mounts):
        yield ('has people="tracked" but no laser scanner; add <sensor type="lidar2d"/> or <sensor type="lidar3d"/>')


def scan_problems(navigator: Any, mounts: Sequence[Any]) -> Iterator[str]:
    """Yield why a robot cannot have a navigator that needs scans; a sensor with unknown readings may give them.

    >>> from crowdbot.navigation import ScanMapNavigator
    >>> list(scan_problems(ScanMapNavigator(), []))
    ['has the navigator ScanMapNavigator but no planar laser scanner; add <sensor type="lidar2d"/>']
    """
    topics = [reading_topics(mount.sensor) for mount in mounts]
    if getattr(navigator, "needs_scan", False) and not any(not t or LASER_SCAN in t.values() for t in topics):
        name = type(navigator).__name__
        yield f'has the navigator {name} but no planar laser scanner; add <sensor type="lidar2d"/>'


def robot_folder_of(name: str, folder: Path | None, trust: bool) -> Path | None:
    """Return the robot folder next to the trial, None for a built-in robot.

    Raises:
        InputError: there is no robot of this name, or its folder lies outside the folder of the trial.
    """
    root = folder or Path.cwd()
    known = builtin_robots()
    try:
        place = (root / name).resolve()
        there, is_file = (place / "robot.xml").is_file(), place.is_file()
    except (OSError, ValueError, RuntimeError):
        there = is_file = False
    if there and not trust and not place.is_relative_to(root.resolve()):
        raise InputError(
            f"type={quote_value(name)}: the robot lies outside {root.resolve()}; move its folder there, or pass"
            " --trust to allow it"
        )
    if there:
        return place
    if name in known:
        return None
    if is_file and place.name == "robot.xml":
        raise InputError(
            f"type={quote_value(name)} is a file of a robot folder; give the folder: {name.rpartition('/')[0] or '.'}"
        )
    if is_file and place.suffix in (".urdf", ".xacro", ".sdf"):
        raise InputError(
            f"type={quote_value(name)} is a file of a maker, not a robot folder; make the folder with"
            f" crowdbot new robot {name}, and give its name"
        )
    raise InputError(
        f"type={quote_value(name)} is not a robot{did_you_mean(name, known)}: no folder {name[:60]!r} with a robot.xml"
        f" is in {root.resolve()}; built-in robots are {', '.join(known)}"
    )


def robot_of_type(name: str, folder: Path | None, trust: bool) -> world.Robot:
    """Return the robot of a type.

    Raises:
        InputError: there is no such robot, or its folder has errors.
    """
    place = robot_folder_of(name, folder, trust)
    if place is None:
        return _load_builtin(name)
    return _load_folder(place, trust, (place / "robot.xml").stat().st_mtime_ns, reads_only())


@functools.cache
def _load_builtin(name: str) -> world.Robot:
    return world.Robot.load(_assets(name))


def _assets(name: str) -> Path:
    import importlib.resources

    return Path(str(importlib.resources.files("crowdbot").joinpath("assets", "robots", name)))


@functools.lru_cache(maxsize=16)
def _load_folder(place: Path, trust: bool, stamp: int, described: bool) -> world.Robot:
    try:
        return world.Robot.load(place, trust=trust)
    except RobotError as error:
        more = f" (and {len(error.problems) - 1} more; see crowdbot check)" if len(error.problems) > 1 else ""
        raise InputError(f"type={quote_value(place.name)}: {error.problems[0]}{more}") from None


RADIUS, HEIGHT, MASS = 0.3, 1.0, 40.0
"""Defaults of a robot without a type [m, m, kg]."""
MOST_FILES = 500


@dataclass(frozen=True)
class RobotGoal:
    """Goal of a robot, reached when the robot's centre is within the tolerance."""

    x: float = attribute(about="x coordinate", unit="m")
    y: float = attribute(about="y coordinate", unit="m")
    tolerance: float = attribute(0.3, about="arrival tolerance of the robot's centre", unit="m", exclusive_min=0.0)

    def __post_init__(self) -> None:
        check(self)

    @property
    def position(self) -> tuple[float, float]:
        """``x, y`` [m]."""
        return self.x, self.y


@dataclass(frozen=True)
class Planner:
    """Path planner of a robot: the navigator receives the next point of the shortest path around walls.

    >>> Planner().margin
    0.1
    """

    margin: float = attribute(
        0.1, about="distance between the robot on its path and walls", unit="m", min=0.0, max=10.0
    )

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, kw_only=True)
class Mount:
    """A sensor and its pose on the robot or on one of its links (x forward, y left, z up).

    >>> from crowdbot.sensors import Lidar2D
    >>> Mount(sensor=Lidar2D()).z, Mount(sensor=Lidar2D(), link="head").z
    (0.4, 0.0)
    """

    name: str = attribute("scan", about="name of the sensor, the last part of its topic", pattern=NAME)
    sensor: Sensor = mounted_field("sensors", "Sensor", about="sensor")
    link: str = attribute("", about="link that the sensor is mounted on (default: the robot frame)")
    x: float = attribute(0.0, about="x in the frame of the robot or of the link, forward", unit="m")
    y: float = attribute(0.0, about="y in the frame of the robot or of the link, left", unit="m")
    z: float = attribute(None, about="z above the floor (default: 0.4) or above the link (default: 0)", unit="m")
    roll: float = attribute(0.0, about="roll about x, as in URDF", unit="rad")
    pitch: float = attribute(0.0, about="pitch about y, as in URDF", unit="rad")
    heading: float = attribute(0.0, about="yaw about z, counter-clockwise from forward", unit="rad")

    def __post_init__(self) -> None:
        if getattr(self, "z", None) is None:
            object.__setattr__(self, "z", self.usual["z"])
        check(self)

    @property
    def usual(self) -> Mapping[str, Any]:
        """Defaults of fields that depend on others."""
        return {"z": 0.0 if self.link else MOUNT_HEIGHT}

    @functools.cached_property
    def origin(self) -> Floats:
        """Frame ``[4, 4]`` of the sensor relative to the robot or the link."""
        return frame((self.x, self.y, self.z), roll_pitch_yaw(self.roll, self.pitch, self.heading))


@dataclass(frozen=True, kw_only=True)
class RobotSpec:
    """A robot: start, goal, type, drive, sensors and navigator.

    The type defines drive, size and sensors (colour cameras only with ``cameras``). Fields given here override those of
    the type; sensors are added, or replace the sensor of the type with the same name. A robot without a type is an
    upright cylinder with a drive.

    Raises:
        InputError: a value is not allowed, the type does not exist, or a sensor is on an unknown link.

    >>> from crowdbot.navigation import Straight
    >>> robot = RobotSpec(type="turtlebot2", x=0, y=0, goal=RobotGoal(5, 0), navigator=Straight())
    >>> robot.drive.max_speed, round(robot.radius, 3), robot.sensors[0].name
    (0.65, 0.232, 'laser')
    """

    name: str = attribute("robot", about="name of the robot, the first part of its topics", pattern=NAME)
    type: str = attribute("", about="built-in robot such as pepper, or a robot folder next to the trial file")
    x: float = attribute(about="start x", unit="m")
    y: float = attribute(about="start y", unit="m")
    heading: float = attribute(0.0, about="start heading, counter-clockwise from +x", unit="rad")
    radius: float = attribute(
        None, about="radius of the bounding disc (default: from the type, or 0.3)", unit="m", min=0.001,
        max=10.0,
    )  # fmt: skip
    height: float = attribute(
        None, about="height of a robot without a type (default: 1)", unit="m", min=0.001, max=10.0
    )
    mass: float = attribute(None, about="mass of a robot without a type (default: 40)", unit="kg", min=0.001, max=1e5)
    latency: float = attribute(
        None, about="delay from command to actuation (default: from the type, or 0)", unit="s", min=0.0,
        max=10.0,
    )  # fmt: skip
    default_sensors: bool = attribute(True, about="whether the robot has the sensors of its type")
    cameras: bool = attribute(
        False, about="whether the robot has the colour cameras of its type, which are rendered (slow)"
    )
    sensor_rates: str = attribute(
        "nearest",
        about="sensor rates of the type: rounded to the time step, or exact",
        choices=("nearest", "exact"),
    )
    rider: str = attribute("", about=ABOUT_RIDER)
    visible: bool = attribute(True, about="whether people react to the robot")
    ghost: bool = attribute(
        False, about="whether the robot is absent to people, other robots and their sensors, and has no contacts"
    )
    control_period: float = attribute(0.1, about="control period", unit="s", exclusive_min=0.0)
    deadline: float | None = attribute(
        None, unit="s", exclusive_min=0.0,
        about="compute time of a decision above which it is missed: the previous command stays (default: no limit)",
    )  # fmt: skip
    decision_limit: float = attribute(
        60.0,
        about="real time after which a decision of an own navigator that has not returned ends the run with an error",
        unit="s",
        exclusive_min=0.0,
    )
    people: str = attribute("seen", about=ABOUT_PEOPLE, choices=PEOPLE_INPUTS)
    gestures: str = attribute(
        "ignore",
        about="gestures of people in observations: left to the navigator, or obeyed: the robot stands when it is told"
        " to wait, and goes when it is told to proceed",
        choices=("ignore", "obey"),
    )
    tracks: float | None = attribute(
        None, unit="s", exclusive_min=0.0, max=600.0,
        about="time span of the past positions of visible people for the navigator (default: none)",
    )  # fmt: skip
    holonomic: bool = attribute(
        False, about="whether the navigator moves in every direction, with an omnidirectional drive"
    )
    goal: RobotGoal = child(about="goal")
    planner: Planner | None = child(None, about="path planner around walls (default: straight to the goal)")
    pose: RobotPose | None = child(None, about="pose from outside (default: the drive moves the robot)")
    safety: SafetyLayer | None = child(None, about="safety layer between navigator and drive (default: none)")
    predictor: RobotPredictor | None = child(None, about="predictor of the observation's forecast (default: none)")
    drive: Drive = plugin_field("world", "Drive", about="drive (default: from the type)", default=None)
    navigator: Navigator = plugin_field("navigation", "Navigator", about="navigator")
    sensors: tuple[Mount, ...] = children("sensor", about="sensors", max=50)
    joints: tuple[JointTarget, ...] = children("joint", about="targets of joints over time", max=1000)
    faults: tuple[FaultSpec, ...] = children("fault", about="faults of sensors, localization, commands, wheels", max=50)
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    trust: bool = dataclasses.field(default=True, compare=False, repr=False)
    """Folder of the robot folder, and whether that may lie outside; not part of the XML."""

    def __post_init__(self) -> None:
        usual = self.usual
        for name in ("radius", "height", "mass", "latency", "drive"):
            if getattr(self, name) is None:
                object.__setattr__(self, name, usual.get(name))
        if self.drive is None:
            raise InputError(f"needs the element <drive>, or a type such as {builtin_robots()[0]}")
        if isinstance(self.sensors, list | tuple):
            object.__setattr__(self, "sensors", _merge_sensors(self.type_sensors, self.sensors))
        given: Any = self.predictor
        if isinstance(given, Predictor):
            object.__setattr__(self, "predictor", RobotPredictor(predictor=given))
        check(self)
        if self.type and (self.height, self.mass) != (usual["height"], usual["mass"]):
            raise InputError(
                f"has height or mass in addition to type={quote_value(self.type)}, which defines them; leave them out"
            )
        if self.cameras and not any(_is_rendered(mount) for mount in self.type_sensors):
            raise InputError(
                'has cameras="true" but no such cameras: it needs a type with colour cameras, such as pepper, and its'
                " sensors; leave it out"
            )
        if self.holonomic and not _moves_sideways(self.drive):
            raise InputError(
                'has holonomic="true" but its drive cannot move sideways; take <drive type="omnidirectional"/>, or'
                " leave it out"
            )
        if isinstance(self.navigator, ExternalNavigator) and self.deadline is not None and not self.navigator.source:
            raise InputError(
                'has a deadline in addition to <navigator type="external"/>, which decides nothing; set its timeout'
            )
        if self.pose is not None and not isinstance(self.navigator, ExternalNavigator):
            raise InputError('has <pose>, so no navigator moves it; take <navigator type="external"/>')
        forecasts = forecast_problems(self.predictor, self.tracks, self.control_period, self.navigator)
        inputs = (*people_problems(self.people, self.sensors), *scan_problems(self.navigator, self.sensors))
        others = (*inputs, *rider_problems(self.rider_kind, self.body.seat))
        signs = gesture_problems(self.gestures, self.people, self.navigator)
        for problem in (*safety_problems(self.safety, self.navigator), *signs, *forecasts, *others):
            raise InputError(problem)
        _ = self._with_files  # reads them
        for problem in fault_problems(self.faults, self.sensors):
            raise InputError(problem)
        for problem in joint_problems(self.joints, self.body) if self.joints else ():
            raise InputError(problem)
        for mount in self.sensors:
            links = self.body.model.links
            if mount.link and mount.link not in links:
                raise InputError(f"sensor {mount.name!r} is on link={quote_value(mount.link)}, which does not exist"
                                 f"{did_you_mean(mount.link, links)}")  # fmt: skip

    @property
    def usual(self) -> Mapping[str, Any]:
        """Defaults of fields that depend on others."""
        if not self.type:
            return {"radius": RADIUS, "height": HEIGHT, "mass": MASS, "latency": 0.0, "sensors": ()}
        kind = self._kind
        return {
            "radius": round(kind.radius, 9),
            "height": round(kind.height, 9),
            "mass": round(kind.model.mass, 9),
            "latency": kind.latency,
            "drive": kind.drive,
            "sensors": self.type_sensors,
        }

    @property
    def type_sensors(self) -> tuple[Mount, ...]:
        """The sensors of the type that the robot has."""
        if not (self.type and self.default_sensors):
            return ()
        return tuple(
            Mount(name=m.name, sensor=m.sensor, link=m.link, x=m.x, y=m.y, z=m.z, roll=m.roll, pitch=m.pitch,
                  heading=m.yaw)
            for m in self._kind.mounts
            if self.cameras or not _is_rendered(m)
        )  # fmt: skip

    @functools.cached_property
    def body(self) -> world.Robot:
        """The robot of a world, with the drive and the latency of this robot."""
        if not self.type:
            made = world.Robot.disc(self.name, self.drive, self.radius, height=self.height, mass=self.mass)
        else:
            made = dataclasses.replace(self._kind, drive=self.drive)
        return dataclasses.replace(made, latency=self.latency)

    @functools.cached_property
    def controller(self) -> Navigator:
        """The navigator that decides, behind the layers of the robot: first that of gestures, then that of safety."""
        inner = GestureLayer().around(self._with_files) if self.gestures == "obey" else self._with_files
        return inner if self.safety is None else self.safety.around(inner)

    @functools.cached_property
    def _with_files(self) -> Navigator:
        """The navigator with the paths of its files, which have been read."""
        navigator = self.navigator
        for name in navigator.file_parameters:
            value = getattr(navigator, name)
            try:
                if value:
                    path = resolve_file(str(value), self.folder, self.trust)
                    navigator = dataclasses.replace(navigator, **{name: str(path)})
                    navigator.check_files()
            except InputError as error:
                raise InputError(f"navigator {name}={quote_value(value)}: {error}") from None
        return navigator

    @property
    def mirror(self) -> RobotPose | None:
        """Where the robot is if its drive does not move it: ``pose``, or the poses of a real robot."""
        return mirrored_pose(self.pose, self.navigator)

    @property
    def rider_kind(self) -> str:
        """Body or kind of the person in the seat: the rider given here, or that of the type; empty for none."""
        return self.rider or (self._kind.rider if self.type else "")

    def frame_of(self, mount: Mount, joints: Mapping[str, float] | None = None) -> Floats:
        """Return the frame ``[4, 4]`` of a sensor relative to the robot (on the floor).

        The robot is in its driving posture, except for other joint positions [rad or m].
        """
        if not mount.link:
            return mount.origin
        return np.asarray(self.body.model.poses({**self.body.posture, **(joints or {})})[mount.link] @ mount.origin)

    def sensor_pose(
        self, mount: Mount, joints: Mapping[str, float] | None = None
    ) -> tuple[float, float, float, float, float, float]:
        """Return x, y, z [m], roll, pitch and yaw [rad] of a sensor in the frame of the robot, as :meth:`frame_of`.

        >>> from crowdbot.navigation import Straight
        >>> robot = RobotSpec(type="qolo", x=0, y=0, goal=RobotGoal(5, 0), navigator=Straight())
        >>> [round(value, 3) for value in robot.sensor_pose(robot.sensors[0])][:2]
        [0.035, 0.0]
        """
        if not mount.link:
            return mount.x, mount.y, mount.z, mount.roll, mount.pitch, mount.heading
        found = self.frame_of(mount, joints)
        x, y, z = (round(float(value), 12) for value in found[:3, 3])
        pitch = math.atan2(-found[2, 0], math.hypot(found[0, 0], found[1, 0]))
        roll, yaw = math.atan2(found[2, 1], found[2, 2]), math.atan2(found[1, 0], found[0, 0])
        return x, y, z, round(roll, 12), round(pitch, 12), round(yaw, 12)

    def path_planner(self, walls: Walls) -> PathPlanner | None:
        """Return the path planner among the walls of a stage, None without a planner.

        Raises:
            InputError: no space between the walls is wide enough for the robot.
        """
        if self.planner is None:
            return None
        return PathPlanner.for_stage(walls, self.radius, self.planner.margin, self.body.half_width)

    def stage_planner(self, stage: Any) -> PathPlanner | None:
        """Return the path planner of :meth:`path_planner` on a stage, around ground that the robot cannot pass."""
        if self.planner is None:
            return None
        return self.path_planner(stage.driving_walls(self.body.max_step, self.body.max_slope))

    def schedule(self, mount: Mount, clock: Clock) -> SensorSchedule:
        """Return the schedule of a sensor; see the attribute ``sensor_rates``.

        Raises:
            InputError: the period is shorter than the time step.
        """
        if self.sensor_rates == "exact" or mount not in self.type_sensors:
            return SensorSchedule.of(mount.sensor, clock)
        period, delay = 1.0 / mount.sensor.rate, mount.sensor.delay
        every = max(1, round(period / clock.dt))
        return SensorSchedule(TickSchedule(clock.step_ns, every * clock.step_ns), round(delay / clock.dt))

    @property
    def position(self) -> tuple[float, float]:
        """Start ``x, y`` [m]."""
        return self.x, self.y

    def files(self) -> tuple[Path, ...]:
        """Return the files of the navigator and of the robot folder; a built-in robot has none."""
        navigator = self._with_files
        named = (getattr(navigator, name) for name in navigator.file_parameters)
        own = tuple(Path(file) for file in named if file)
        place = robot_folder_of(self.type, self.folder, self.trust) if self.type else None
        if place is None:
            return own
        return own + tuple(sorted(path for path in place.rglob("*") if path.is_file()))[:MOST_FILES]

    @property
    def _kind(self) -> world.Robot:
        if not isinstance(self.type, str):
            raise InputError(f"Robot: type={quote_value(self.type)} is not a str")
        return robot_of_type(self.type, self.folder, self.trust)


def _moves_sideways(drive: Drive) -> bool:
    """Return whether a drive at rest follows a command to the left."""
    still, left = (Twists.of(twist, 1) for twist in (Twist(), Twist(left=0.1)))
    return bool(drive.step(Pose.of((0.0, 0.0), 0.0), still, left, 0.1)[1].left[0] > 0.0)


def _is_rendered(mount: Mount | world.SensorMount) -> bool:
    """Return whether a sensor needs a renderer."""
    return mount.sensor.renders


def _merge_sensors(carried: tuple[Mount, ...], own: Any) -> tuple[Mount, ...]:
    """Return the sensors of a type, each replaced by the given one of its name, then the other given ones."""
    named = {getattr(mount, "name", ""): mount for mount in own}
    names = {mount.name for mount in carried}
    others = [mount for mount in own if getattr(mount, "name", "") not in names]
    return (*(named.get(mount.name, mount) for mount in carried), *others)
