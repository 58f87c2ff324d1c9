"""ROS 2 message types (Humble, people_msgs and crowdbot_msgs) and their CDR encoding.

Frames follow REP-103 and REP-105: ``map``, ``<robot>/odom``, ``<robot>/base_link`` and the links of the robot,
``<robot>/<sensor>``. Ranges follow REP-117.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from crowdbot.core import Scene, SpatialPose

from .cdr import MAP, people_bytes

PERSON = """string name
geometry_msgs/Point position
geometry_msgs/Point velocity
float64 reliability
string[] tagnames
string[] tags
"""
PEOPLE = "std_msgs/Header header\npeople_msgs/Person[] people\n"
CONTACT = "string robot\nstring other\nfloat64 clearance\n"
CONTACTS = "std_msgs/Header header\ncrowdbot_msgs/Contact[] contacts\n"
ARRAY = "string name\nstring dtype\nuint32[] shape\nuint8[] data\n"
READING = "std_msgs/Header header\nstring kind\ncrowdbot_msgs/Array[] fields\n"
FORCE = """string first
string second
string first_part
string limb
string part
float64 force
geometry_msgs/Vector3 vector
float64 depth
geometry_msgs/Point point
"""
FORCES = "std_msgs/Header header\ncrowdbot_msgs/Force[] forces\n"
COLLISION = """string first
string second
float64 begin
float64 end
float64 duration
string cause
float64 impact_speed
float64 depth
float64 impulse
string limb
string part
string region
float64 peak_force
float64 steady_force
string steady_region
float64 simulated_peak
float64 severity
"""
COLLISIONS = "std_msgs/Header header\ncrowdbot_msgs/Collision[] collisions\n"
FALL = """string person
float64 begin
float64 end
string direction
string cause
float64 steps
float64 hand
float64 leg
float64 pelvis
float64 chest
float64 head
float64 hic15
"""
FALLS = "std_msgs/Header header\ncrowdbot_msgs/Fall[] falls\n"
FALL_POSE = """uint32 person
float32 direction
float32 tilt
float32 start
bool struck
bool down
bool rising
"""
FALL_POSES = "std_msgs/Header header\ncrowdbot_msgs/FallPose[] poses\n"
OWN = {
    "people_msgs/msg/Person": PERSON,
    "people_msgs/msg/People": PEOPLE,
    "crowdbot_msgs/msg/Contact": CONTACT,
    "crowdbot_msgs/msg/Contacts": CONTACTS,
    "crowdbot_msgs/msg/Array": ARRAY,
    "crowdbot_msgs/msg/Reading": READING,
    "crowdbot_msgs/msg/Force": FORCE,
    "crowdbot_msgs/msg/Forces": FORCES,
    "crowdbot_msgs/msg/Collision": COLLISION,
    "crowdbot_msgs/msg/Collisions": COLLISIONS,
    "crowdbot_msgs/msg/Fall": FALL,
    "crowdbot_msgs/msg/Falls": FALLS,
    "crowdbot_msgs/msg/FallPose": FALL_POSE,
    "crowdbot_msgs/msg/FallPoses": FALL_POSES,
}
"""Type definitions that are not part of ROS 2 Humble; they are stored in the file."""


EXACT = 1e-9
"""Variance of what is known exactly [m2], [rad2], [m2/s2] or [rad2/s2]."""


def _spatial_covariance(planar: NDArray[np.float64] | None, places: tuple[int, int, int]) -> NDArray[np.float64]:
    """Return the covariance ``[36]`` of x, y, z, roll, pitch, yaw from that of three of them ``[3, 3]``."""
    whole = np.eye(6) * EXACT
    if planar is not None:
        whole[np.ix_(places, places)] += planar
    return whole.ravel()


@functools.cache
def _store() -> Any:
    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, text in OWN.items():
        store.register(get_types_from_msg(text, name))
    return store


class Messages:
    """Creates and encodes messages."""

    def __init__(self) -> None:
        self.store = _store()

    def definition(self, kind: str) -> str:
        """Return the definition of a message type with all its parts, as in ``ros2msg`` schemas."""
        return str(self.store.generate_msgdef(kind, ros_version=2)[0])

    def encode_message(self, message: Any) -> bytes:
        """Return the CDR bytes of a message."""
        return bytes(self.store.serialize_cdr(message, message.__msgtype__))

    def decode_message(self, data: bytes, kind: str) -> Any:
        """Return the message from CDR bytes."""
        return self.store.deserialize_cdr(data, kind)

    def make(self, kind: str, /, **fields: Any) -> Any:
        """Return a message of a type such as ``geometry_msgs/msg/Point``."""
        return self.store.types[kind](**fields)

    def header(self, nanoseconds: int, frame: str = MAP) -> Any:
        """Return a header."""
        return self.make("std_msgs/msg/Header", stamp=self.stamp(nanoseconds), frame_id=frame)

    def stamp(self, nanoseconds: int) -> Any:
        """Return a time."""
        seconds, rest = divmod(nanoseconds, 1_000_000_000)
        return self.make("builtin_interfaces/msg/Time", sec=seconds, nanosec=rest)

    def clock(self, nanoseconds: int) -> Any:
        """Return ``rosgraph_msgs/Clock``."""
        return self.make("rosgraph_msgs/msg/Clock", clock=self.stamp(nanoseconds))

    def text(self, words: str) -> Any:
        """Return ``std_msgs/String``."""
        return self.make("std_msgs/msg/String", data=words)

    def contacts(self, nanoseconds: int, rows: Iterable[tuple[str, str, float]]) -> Any:
        """Return ``crowdbot_msgs/Contacts`` from rows of robot, other body and smallest clearance [m]."""
        found = [
            self.make("crowdbot_msgs/msg/Contact", robot=robot, other=other, clearance=float(gap))
            for robot, other, gap in rows
        ]
        return self.make("crowdbot_msgs/msg/Contacts", header=self.header(nanoseconds), contacts=found)

    def people(self, nanoseconds: int, scene: Scene, ids: NDArray[np.int64]) -> bytes:
        """Return the bytes of ``people_msgs/People``; radius [m] and heading [rad] are tags."""
        there = np.flatnonzero(scene.active[0] & ~scene.external[0])
        there = there[np.argsort(ids[there])]
        rows = (scene.position, scene.velocity, scene.radius, scene.heading)
        return people_bytes(nanoseconds, ids[there], *(row[0, there] for row in rows))

    def odometry(
        self,
        nanoseconds: int,
        name: str,
        x: float,
        y: float,
        heading: float,
        twist: Sequence[float],
        frame: str = MAP,
        child: str = "",
        covariances: Sequence[NDArray[np.float64] | None] = (None, None),
    ) -> Any:
        """Return ``nav_msgs/Odometry``: a pose in a frame, and the twist forward, turn, left in the child frame.

        The child frame is that of the robot (default: its ``base_link``). ``covariances`` are those of x, y, heading
        and of forward, turn, left, ``[3, 3]``; None: exact. :data:`EXACT` is added to all variances, those of z, roll
        and pitch, too, since programs take a covariance of zeros for an unknown one.

        >>> odometry = Messages().odometry(0, "robot", 1.0, 0.0, 0.0, [0.5, 0.0, 0.0], covariances=(np.eye(3), None))
        >>> odometry.pose.covariance.reshape(6, 6).diagonal().round(6).tolist()
        [1.0, 1.0, 0.0, 0.0, 0.0, 1.0]
        """
        forward, turn, left = map(float, twist)
        return self.make(
            "nav_msgs/msg/Odometry",
            header=self.header(nanoseconds, frame),
            child_frame_id=child or f"{name}/base_link",
            pose=self.make(
                "geometry_msgs/msg/PoseWithCovariance",
                pose=self.pose(x, y, heading),
                covariance=_spatial_covariance(covariances[0], (0, 1, 5)),
            ),
            twist=self.make(
                "geometry_msgs/msg/TwistWithCovariance",
                twist=self.twist(forward, turn, left),
                covariance=_spatial_covariance(covariances[1], (0, 5, 1)),
            ),
        )

    def joint_states(self, nanoseconds: int, states: Mapping[str, tuple[float, float]]) -> Any:
        """Return ``sensor_msgs/JointState`` from position [rad or m] and velocity of joints by name.

        >>> Messages().joint_states(0, {"HeadYaw": (0.5, 0.0)}).position.tolist()
        [0.5]
        """
        values = np.array(list(states.values()), dtype=np.float64).reshape(-1, 2)
        return self.make(
            "sensor_msgs/msg/JointState",
            header=self.header(nanoseconds, ""),
            name=list(states),
            position=values[:, 0].copy(),
            velocity=values[:, 1].copy(),
            effort=np.zeros(0),
        )

    def transforms(self, nanoseconds: int, rows: Iterable[tuple[str, str, float, float, float]]) -> Any:
        """Return ``tf2_msgs/TFMessage`` from rows of parent frame, child frame, x, y [m], heading [rad]."""
        return self._transforms(
            nanoseconds,
            ((parent, child, (x, y, 0.0), self.quaternion(heading)) for parent, child, x, y, heading in rows),
        )

    def fixed(self, nanoseconds: int, rows: Iterable[tuple[str, str, SpatialPose]]) -> Any:
        """Return ``tf2_msgs/TFMessage`` from rows of parent frame, child frame and pose of the child."""
        return self._transforms(
            nanoseconds,
            (
                (parent, child, tuple(pose.position[0].tolist()), self.rotation(pose.rotation[0]))
                for parent, child, pose in rows
            ),
        )

    def _transforms(self, nanoseconds: int, rows: Iterable[tuple[str, str, tuple[float, ...], Any]]) -> Any:
        return self.make(
            "tf2_msgs/msg/TFMessage",
            transforms=[
                self.make(
                    "geometry_msgs/msg/TransformStamped",
                    header=self.header(nanoseconds, parent),
                    child_frame_id=child,
                    transform=self.make(
                        "geometry_msgs/msg/Transform",
                        translation=self.vector(*place),
                        rotation=turn,
                    ),
                )
                for parent, child, place, turn in rows
            ],
        )

    def twist(self, forward: float, turn: float, left: float) -> Any:
        """Return ``geometry_msgs/Twist``."""
        return self.make(
            "geometry_msgs/msg/Twist",
            linear=self.vector(float(forward), float(left), 0.0),
            angular=self.vector(0.0, 0.0, float(turn)),
        )

    def point(self, x: float, y: float, z: float = 0.0) -> Any:
        """Return a point."""
        return self.make("geometry_msgs/msg/Point", x=float(x), y=float(y), z=float(z))

    def vector(self, x: float, y: float, z: float) -> Any:
        """Return a vector."""
        return self.make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)

    def quaternion(self, heading: float) -> Any:
        """Return the rotation about z."""
        half = 0.5 * heading
        return self.make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=math.sin(half), w=math.cos(half))

    def rotation(self, quaternion: NDArray[np.float64]) -> Any:
        """Return a rotation from w, x, y, z."""
        w, x, y, z = quaternion.tolist()
        return self.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)

    def pose(self, x: float, y: float, heading: float, z: float = 0.0) -> Any:
        """Return a pose."""
        return self.make("geometry_msgs/msg/Pose", position=self.point(x, y, z), orientation=self.quaternion(heading))
