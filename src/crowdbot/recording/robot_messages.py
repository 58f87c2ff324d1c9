"""Messages of robots, and the frames of their links."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from crowdbot.core import Pose, SpatialPose
from crowdbot.messages import MAP, Messages, codec_of, mount_pose
from crowdbot.sensors import Odometry, Reading, WheelGeometry, planar_pose
from crowdbot.simulation import Simulation, StepRecord
from crowdbot.trials import RobotSpec
from crowdbot.typing import Floats
from crowdbot.world import RobotBody, joint_states, quaternion, robot_description, simulated_body

from .metadata import GROUND_TRUTH

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


STATIC = "/tf_static"


class RobotMessages:
    """Messages about robots, in the frames of REP-105: ``map``, ``<robot>/odom``, ``<robot>/base_link``, links.

    The odometry frame starts at the map. At each reading of the first odometry of a robot, the transform from map to
    odom is the true pose times the inverse of the estimate, as that of a perfect localisation; until the next
    reading, the true motion continues the estimate. Without odometry, odom is the map.

    Args:
        make: creates the messages.
        simulation: the simulation that is recorded, for joints; None: robots are in their postures.
    """

    def __init__(self, make: Messages, simulation: Simulation | None) -> None:
        self.make, self.simulation = make, simulation
        self._frames: dict[str, LinkFrames] = {}
        self._static: dict[str, Row] = {}
        self._corrections: dict[str, Pose] = {}
        self._measured: dict[str, Odometry] = {}
        self._sensors: dict[str, str] = {}
        self._begin = True

    def latched(self, frame: StepRecord) -> Iterator[tuple[str, Any]]:
        """Yield descriptions of robots that are new, and all fixed frames if there are new ones."""
        rows: list[Row] = []
        for robot in frame.robots:
            if robot.name not in self._frames or self._frames[robot.name].robot is not robot:
                self._frames[robot.name] = frames = LinkFrames(robot)
                rows += frames.fixed()
                if self.has_topic(robot, "robot_description"):
                    text = robot_description(robot.body)
                    yield f"/{robot.name}/robot_description", self.make.text(text)
        for robot, mount, reading in frame.readings:
            topic = f"{robot.name}/{mount.name}"
            rows += codec_of(type(reading), topic).frames(robot.name, topic)
        new = [row for row in rows if not _same(self._static.get(row[1]), row)]
        if new:
            self._static |= {row[1]: row for row in new}
            yield STATIC, self.make.fixed(frame.nanoseconds, self._static.values())

    def transforms(self, frame: StepRecord) -> list[Any]:
        """Return ``tf2_msgs/TFMessage`` of the robots, with the links that move if the scene is recorded."""
        self._listen(frame)
        rows: list[Row] = []
        for k, robot in enumerate(frame.robots):
            frames, body, truth = self._frames[robot.name], self._body(frame, k), self._truth(frame, k)
            correction = self._correction(robot)
            rows.append((MAP, frames.odom, correction.to_spatial(0.0)))
            rows.append((frames.odom, frames.base, _upright(relative(correction, truth), body)))
            if frame.due:
                rows += frames.moving(self.states(frame, k), None if body is None else body.frames())
        return [self.make.fixed(frame.nanoseconds, rows)] if rows else []

    def scene(self, frame: StepRecord) -> Iterator[tuple[str, Any]]:
        """Yield odometry, ground truth, commands and joints of each robot."""
        now, make = frame.nanoseconds, self.make
        for k, robot in enumerate(frame.robots):
            name, base, truth = robot.name, self._frames[robot.name].base, self._truth(frame, k)
            x, y, heading = _numbers(truth)
            yield f"/{name}{GROUND_TRUTH}", make.odometry(now, name, x, y, heading, frame.twists[k], MAP, base)
            if self.has_topic(robot, "odom"):
                estimate = _numbers(relative(self._correction(robot), truth))
                measured = self._measured.get(name)
                twist = frame.twists[k] if measured is None else measured.twist[0]
                covariances = (None, None) if measured is None else measured.covariances(0)
                odometry = make.odometry(now, name, *estimate, twist, f"{name}/odom", base, covariances)
                yield f"/{name}/odom", odometry
            yield f"/{name}/cmd_vel", make.twist(*frame.commands[k])
            if robot.body.model.movable and self.has_topic(robot, "joint_states"):
                yield f"/{name}/joint_states", make.joint_states(now, self.states(frame, k))

    def states(self, frame: StepRecord, k: int) -> dict[str, tuple[float, float]]:
        """Return position and velocity of the joints of the robot in row ``k``."""
        robot, simulation = frame.robots[k], self.simulation
        if simulation is None:
            return joint_states(None, 0, robot.body)
        targets = next((one.joint_targets(0) for one in simulation.robots if one.robot.name == robot.name), {})
        return joint_states(simulation.world, _agent(frame, k), robot.body, targets=targets)

    @staticmethod
    def has_topic(robot: RobotSpec, name: str) -> bool:
        """Return whether no sensor of the robot has taken the topic ``/<robot>/name``."""
        return all(mount.name != name for mount in robot.sensors)

    def _listen(self, frame: StepRecord) -> None:
        """Take the readings of the first odometry of each robot; a branch begins after earlier ones."""
        if self._begin and self.simulation is not None:
            for control in self.simulation.robots:
                for sensor in (sensor for sensor in control.sensors if sensor.mount.sensor.encoders):
                    self._take(control.robot.name, sensor.name, sensor.reading(0))
        self._begin = False
        for robot, mount, reading in frame.readings:
            self._take(robot.name, mount.name, reading)

    def _take(self, name: str, sensor: str, reading: Reading | None) -> None:
        if not isinstance(reading, Odometry) or self._sensors.setdefault(name, sensor) != sensor:
            return
        true, estimate = planar_pose(reading.pose), reading.estimate
        turn = true.heading - estimate.heading
        cos, sin = np.cos(turn), np.sin(turn)
        x, y = estimate.position.T
        place = true.position - np.stack([cos * x - sin * y, sin * x + cos * y], axis=1)
        self._corrections[name], self._measured[name] = Pose(place, turn), reading

    def _correction(self, robot: RobotSpec) -> Pose:
        return self._corrections.get(robot.name, HERE)

    def _truth(self, frame: StepRecord, k: int) -> Pose:
        agent, scene = _agent(frame, k), frame.scene
        return Pose(scene.position[:, agent].copy(), scene.heading[:, agent].copy())

    def _body(self, frame: StepRecord, k: int) -> RobotBody | None:
        return None if self.simulation is None else simulated_body(self.simulation.world, _agent(frame, k), 0)


def relative(frame: Pose, pose: Pose) -> Pose:
    """Return a pose of the map in another frame, E = 1.

    >>> relative(Pose.of((1.0, 0.0), math.pi / 2), Pose.of((1.0, 2.0), 0.0)).position.round(3).tolist()
    [[2.0, 0.0]]
    """
    if frame is HERE:
        return pose
    (dx, dy), turn = (pose.position[0] - frame.position[0]).tolist(), float(frame.heading[0])
    cos, sin = math.cos(turn), math.sin(turn)
    return Pose(np.array([[cos * dx + sin * dy, cos * dy - sin * dx]]), pose.heading - turn)


HERE = Pose(np.zeros((1, 2)), np.zeros(1))
"""The map in itself."""


def _upright(pose: Pose, body: RobotBody | None) -> SpatialPose:
    """Return a planar pose in space, with the height and the tilt of a simulated body."""
    if body is None:
        return pose.to_spatial(0.0)
    root = body.frame(body.robot.model.root)
    heading = math.atan2(root[1, 0], root[0, 0])
    level = SpatialPose.of((0.0, 0.0, 0.0), yaw=heading).matrix[0]
    tilt = level.T @ root[:3, :3]
    w, x, y, z = np.asarray(quaternion(tilt)).tolist()
    half = 0.5 * float(pose.heading[0])
    c, s = math.cos(half), math.sin(half)
    turn = np.array([[c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w]])
    place = np.array([[*pose.position[0].tolist(), float(root[2, 3])]])
    return SpatialPose(place, turn)


def _agent(frame: StepRecord, k: int) -> int:
    return int(np.flatnonzero(frame.ids == frame.robot_ids[k])[0])


def _numbers(pose: Pose) -> tuple[float, float, float]:
    x, y = pose.position[0].tolist()
    return x, y, float(pose.heading[0])


def _same(old: Row | None, row: Row) -> bool:
    if old is None or old[0] != row[0]:
        return False
    return np.array_equal(old[2].position, row[2].position) and np.array_equal(old[2].rotation, row[2].rotation)
