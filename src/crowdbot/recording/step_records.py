"""Recorded steps of an episode file."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import Pose
from crowdbot.data import McapReader
from crowdbot.humans import FallPose
from crowdbot.messages import (
    COLLISIONS,
    FALL_POSES,
    FALLS,
    FORCES,
    KIND,
    MAP,
    REST,
    ContactEventRecord,
    ContactForceRecord,
    FallRecord,
    decode_reading,
    read_contact_events,
    read_fall_poses,
    read_falls,
    read_forces,
)
from crowdbot.metrics import AgentStates
from crowdbot.sensors import Reading, Scan
from crowdbot.simulation import ScanRow, scan_row

from .metadata import CONTACTS, DIGEST, GROUND_TRUTH, ORDERS, REACTION_TOPIC, heading_of


class RecordedContact(NamedTuple):
    """A recorded contact: time [s], robot, other body (an id, a robot or ``wall``) and smallest clearance [m]."""

    time: float
    robot: str
    other: str
    clearance: float


class RobotState(NamedTuple):
    """State of a robot: position [m], heading [rad], velocity [m/s] in the world, and twist in its own frame."""

    x: float
    y: float
    heading: float
    vx: float
    vy: float
    twist: tuple[float, float, float]


@dataclass
class RecordedStep:
    """A recorded step.

    Fields:
        nanoseconds: simulated time.
        people: the people present, without robots; None if only readings or contacts were due.
        robots: robots by name.
        commands: commands by robot name: forward [m/s], turn [rad/s], left [m/s].
        readings: readings by ``robot/sensor``.
        scans: scans of planar laser scanners, by ``robot/sensor``.
        joints: position [rad or m] and velocity of joints by robot and name.
        transforms: parent frame, child frame, position [m] and rotation w, x, y, z.
        forces, collisions, falls: contact forces of this step, and contact events and falls that ended, in the
            physics world.
        fall_poses: poses of people out of balance by id.
        contacts: contacts of this step.
        orders: orders from outside in this step, as JSON.
        reactions: ids of the people who react to robots, by kind of reaction; None if nobody can.
        digest: digest of the episode as if it was interrupted here.
    """

    nanoseconds: int
    people: AgentStates | None = None
    robots: dict[str, RobotState] = field(default_factory=dict)
    commands: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    readings: dict[str, Reading] = field(default_factory=dict)
    scans: dict[str, ScanRow] = field(default_factory=dict)
    joints: dict[str, dict[str, tuple[float, float]]] = field(default_factory=dict)
    transforms: list[tuple[str, str, tuple[float, ...]]] = field(default_factory=list)
    forces: list[ContactForceRecord] = field(default_factory=list)
    collisions: list[ContactEventRecord] = field(default_factory=list)
    falls: list[FallRecord] = field(default_factory=list)
    fall_poses: dict[int, FallPose] = field(default_factory=dict)
    contacts: list[RecordedContact] = field(default_factory=list)
    orders: list[str] = field(default_factory=list)
    reactions: dict[str, list[int]] | None = None
    digest: str = ""

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.nanoseconds / 1e9

    def largest_ids(self) -> set[int]:
        """Return the largest id of people in this step, if any."""
        seen = [] if self.people is None else [int(self.people.ids.max(initial=-1))]
        hits = [getattr(reading, "hit", None) for reading in self.readings.values()]
        hits += [scan.hit for scan in self.scans.values()]
        return {*seen, *(int(hit.max(initial=-1)) for hit in hits if hit is not None)}

    def everyone(self, robots: Mapping[str, tuple[int, float]]) -> AgentStates:
        """Return people and robots together.

        Args:
            robots: id and radius [m] of robots by name.
        """
        people = self.people
        assert people is not None
        states = [(robots[name], state) for name, state in self.robots.items() if name in robots]
        rows = np.array([(s.x, s.y, s.vx, s.vy, s.heading, own[1]) for own, s in states]).reshape(-1, 6)
        ids = np.concatenate([people.ids, np.array([own[0] for own, _ in states], dtype=np.int64)])
        order = np.argsort(ids)
        return AgentStates(
            self.time,
            ids[order],
            np.concatenate([people.position, rows[:, 0:2]])[order],
            np.concatenate([people.velocity, rows[:, 2:4]])[order],
            np.concatenate([people.heading, rows[:, 4]])[order],
            np.concatenate([people.radius, rows[:, 5]])[order],
        )


def read_steps(tape: McapReader) -> Iterator[RecordedStep]:
    """Yield the steps of a file.

    Raises:
        McapError: the file is damaged; invalid content raises other errors.
    """
    from crowdbot.messages import Messages

    messages = Messages()
    fixed: Poses = {}
    for stamp, group in itertools.groupby(tape.messages(), key=lambda heard: heard.stamp):
        decoded = [
            (heard.topic.topic, messages.decode_message(heard.data, heard.topic.kind))
            for heard in group
            if heard.topic.topic != "/crowd/markers" and heard.topic.kind in messages.store.types
        ]
        yield _moment(stamp, decoded, fixed)


Poses = dict[str, tuple[str, float, float, float]]
"""Parent frame, x, y [m] and heading [rad] by frame."""


def _moment(stamp: int, messages: list[tuple[str, Any]], fixed: Poses | None = None) -> RecordedStep:
    moment = RecordedStep(stamp)
    topics = dict(messages)
    sensors = {topic.removesuffix(REST) for topic, message in messages if message.__msgtype__ == KIND}
    for topic in sorted(sensors):
        others = {name.removeprefix(topic): one for name, one in topics.items() if name.startswith(topic)}
        reading = decode_reading(topics[topic + REST], others)
        moment.readings[topic.strip("/")] = reading
        if isinstance(reading, Scan):
            moment.scans[topic.strip("/")] = scan_row(reading)
    fixed = {} if fixed is None else fixed
    poses: Poses = {}
    for topic, message in messages:
        if topic == "/tf_static":
            _take(moment, fixed, topic, message, sensors)
            continue
        _take(moment, poses, topic, message, sensors)
    for topic, message in messages:
        if message.__msgtype__ == "sensor_msgs/msg/LaserScan" and topic not in sensors:
            name = topic.strip("/")
            moment.scans[name] = _scan({**fixed, **poses}, name, moment.time, message)
    return moment


def _take(moment: RecordedStep, poses: Poses, topic: str, message: Any, sensors: set[str]) -> None:
    """Process a message that is not a reading."""
    robot = topic.strip("/").rpartition("/")[0]
    kind = message.__msgtype__
    if topic == "/people":
        moment.people = _people(moment.time, message.people)
    elif topic == DIGEST:
        moment.digest = str(message.data)
    elif topic == ORDERS:
        moment.orders.append(str(message.data))
    elif topic == REACTION_TOPIC:
        moment.reactions = json.loads(message.data)
    elif topic == CONTACTS:
        moment.contacts = [RecordedContact(moment.time, c.robot, c.other, c.clearance) for c in message.contacts]
    elif topic == FORCES:
        moment.forces = read_forces(moment.time, message)
    elif topic == COLLISIONS:
        moment.collisions = read_contact_events(message)
    elif topic == FALLS:
        moment.falls = read_falls(message)
    elif topic == FALL_POSES:
        moment.fall_poses = read_fall_poses(message)
    elif kind == "tf2_msgs/msg/TFMessage":
        for row in message.transforms:
            shift, turn = row.transform.translation, row.transform.rotation
            poses[row.child_frame_id] = row.header.frame_id, shift.x, shift.y, heading_of(turn)
            values = (shift.x, shift.y, shift.z, turn.w, turn.x, turn.y, turn.z)
            moment.transforms.append((row.header.frame_id, row.child_frame_id, values))
    elif kind == "nav_msgs/msg/Odometry" and topic not in sensors:
        if topic.endswith(GROUND_TRUTH):
            moment.robots[topic.removesuffix(GROUND_TRUTH).strip("/")] = _robot(message)
    elif kind == "sensor_msgs/msg/JointState":
        moment.joints[robot] = dict(
            zip(message.name, zip(message.position.tolist(), message.velocity.tolist(), strict=True), strict=True)
        )
    elif kind == "geometry_msgs/msg/Twist":
        moment.commands[robot] = message.linear.x, message.angular.z, message.linear.y


def _people(time: float, people: Any) -> AgentStates:
    numbers = np.empty((len(people), 6))
    ids = np.empty(len(people), dtype=np.int64)
    for k, person in enumerate(people):
        tags = dict(zip(person.tagnames, person.tags, strict=True))
        place, moving = person.position, person.velocity
        ids[k] = int(person.name)
        numbers[k] = place.x, place.y, moving.x, moving.y, float(tags["heading"]), float(tags["radius"])
    return AgentStates(time, ids, numbers[:, 0:2], numbers[:, 2:4], numbers[:, 4], numbers[:, 5])


def _robot(message: Any) -> RobotState:
    pose, twist = message.pose.pose, message.twist.twist
    heading = heading_of(pose.orientation)
    cos, sin = math.cos(heading), math.sin(heading)
    forward, left = twist.linear.x, twist.linear.y
    return RobotState(
        pose.position.x,
        pose.position.y,
        heading,
        cos * forward - sin * left,
        sin * forward + cos * left,
        (forward, twist.angular.z, left),
    )


def _scan(poses: Poses, topic: str, time: float, message: Any) -> ScanRow:
    pose = _pose_in_map(poses, topic)
    return ScanRow(
        time,
        (float(pose.position[0, 0]), float(pose.position[0, 1]), float(pose.heading[0])),
        message.angle_min + message.angle_increment * np.arange(len(message.ranges)),
        message.ranges.astype(np.float64),
        message.intensities.astype(np.int64),
    )


def _pose_in_map(poses: Poses, frame: str) -> Pose:
    """Return the pose of a frame from the transforms of its parents.

    Raises:
        ValueError: the frame is not below the map.
    """
    chain: list[tuple[float, float, float]] = []
    name = frame
    while name != MAP:
        if name not in poses or len(chain) > len(poses):
            raise ValueError(f"frame {frame!r} is not in {MAP!r}")
        name, x, y, heading = poses[name]
        chain.append((x, y, heading))
    pose = Pose.of(chain[-1][:2], chain[-1][2])
    for place in reversed(chain[:-1]):
        pose = pose.offset(*place)
    return pose
