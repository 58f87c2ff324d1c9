"""Writes bags of ROS 2 and ROS 1: people in any frame, odometry and transforms, for tests of readers."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Ros2Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

SECOND = 10**9
DEFINITIONS = {
    "people_msgs/msg/Person": "string name\ngeometry_msgs/Point position\ngeometry_msgs/Point velocity\n"
    "float64 reliability\nstring[] tagnames\nstring[] tags\n",
    "people_msgs/msg/People": "std_msgs/Header header\npeople_msgs/Person[] people\n",
    "pedsim_msgs/msg/TrackedPerson": "uint64 track_id\nbool is_occluded\ngeometry_msgs/PoseWithCovariance pose\n",
    "pedsim_msgs/msg/AgentState": "std_msgs/Header header\nuint64 id\nuint16 type\nstring social_state\n"
    "geometry_msgs/Pose pose\ngeometry_msgs/Twist twist\n",
    "pedsim_msgs/msg/AgentStates": "std_msgs/Header header\npedsim_msgs/AgentState[] agent_states\n",
    "hunav_msgs/msg/Agent": "int32 id\nuint8 type\nuint8 skin\nstring name\nint8 group_id\n"
    "geometry_msgs/Pose position\nfloat32 yaw\n",
    "hunav_msgs/msg/Agents": "std_msgs/Header header\nhunav_msgs/Agent[] agents\n",
    "people_msgs/msg/PositionMeasurement": "std_msgs/Header header\nstring name\nstring object_id\n"
    "geometry_msgs/Point pos\nfloat64 reliability\nfloat64[9] covariance\nbyte initialization\n",
    "people_msgs/msg/PositionMeasurementArray": "std_msgs/Header header\n"
    "people_msgs/PositionMeasurement[] people\nfloat32[] cooccurrence\n",
    "pedsim_msgs/msg/TrackedPersons": "std_msgs/Header header\npedsim_msgs/TrackedPerson[] tracks\n",
    "vision_msgs/msg/ObjectHypothesis": "string class_id\nfloat64 score\n",
    "vision_msgs/msg/ObjectHypothesisWithPose": "vision_msgs/ObjectHypothesis hypothesis\n"
    "geometry_msgs/PoseWithCovariance pose\n",
    "vision_msgs/msg/BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size\n",
    "vision_msgs/msg/Detection3D": "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
    "vision_msgs/BoundingBox3D bbox\nstring id\n",
    "vision_msgs/msg/Detection3DArray": "std_msgs/Header header\nvision_msgs/Detection3D[] detections\n",
}


class BagWriter:
    """Writes messages to a bag: ``storage`` is ``mcap``, ``sqlite3`` or ``ros1``."""

    def __init__(self, path: Path, storage: str = "mcap") -> None:
        self.ros1 = storage == "ros1"
        self.store = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_HUMBLE)
        for kind, text in DEFINITIONS.items():
            types = get_types_from_msg(text, kind)
            self.store.register({name: rows for name, rows in types.items() if name not in self.store.types})
        kinds = {"mcap": StoragePlugin.MCAP, "sqlite3": StoragePlugin.SQLITE3}
        self.path = path
        self.writer = Ros1Writer(path) if self.ros1 else Ros2Writer(path, version=9, storage_plugin=kinds[storage])
        self.topics = {}

    def __enter__(self):
        self.writer.open()
        return self

    def __exit__(self, *_):
        self.writer.close()

    @property
    def file(self) -> Path:
        """The file with the messages."""
        return self.path if self.ros1 else next(file for file in self.path.iterdir() if file.suffix != ".yaml")

    def make(self, kind, **values):
        return self.store.types[kind](**values)

    def write(self, topic, time, message):
        kind = message.__msgtype__
        if topic not in self.topics:
            self.topics[topic] = self.writer.add_connection(topic, kind, typestore=self.store)
        encode = self.store.serialize_ros1 if self.ros1 else self.store.serialize_cdr
        self.writer.write(self.topics[topic], round(time * SECOND), encode(message, kind))

    def header(self, time, frame):
        sec, nanosec = divmod(round(time * SECOND), SECOND)
        more = {"seq": 0} if self.ros1 else {}
        stamp = self.make("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **more)

    def vector(self, kind, x, y, z=0.0):
        return self.make(f"geometry_msgs/msg/{kind}", x=float(x), y=float(y), z=float(z))

    def turn(self, yaw=0.0, roll=0.0):
        """A quaternion of a roll, then a yaw [rad]."""
        a, b = 0.5 * yaw, 0.5 * roll
        x, y, z, w = math.cos(a) * math.sin(b), math.sin(a) * math.sin(b), math.sin(a) * math.cos(b), math.cos(a) * math.cos(b)  # fmt: skip # noqa: E501
        return self.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)

    def people(self, time, frame, places, topic="/people"):
        """Write {name: (x, y) or (x, y, z)} as people_msgs."""
        rows = [
            self.make("people_msgs/msg/Person", name=str(name), position=self.vector("Point", *place),
                      velocity=self.vector("Point", 0, 0), reliability=1.0, tagnames=[], tags=[])
            for name, place in places.items()
        ]  # fmt: skip
        self.write(topic, time, self.make("people_msgs/msg/People", header=self.header(time, frame), people=rows))

    def tracked(self, time, frame, places, topic="/tracked_persons"):
        """Write {id: (x, y)} as TrackedPersons of pedsim."""
        rows = [
            self.make("pedsim_msgs/msg/TrackedPerson", track_id=id, is_occluded=False, pose=self.pose(*place))
            for id, place in places.items()
        ]
        message = self.make("pedsim_msgs/msg/TrackedPersons", header=self.header(time, frame), tracks=rows)
        self.write(topic, time, message)

    def detections(self, time, frame, rows, topic="/detections"):
        """Write (id, class, x, y) as Detection3DArray of ROS 2 Humble."""
        found = []
        for id, kind, x, y in rows:
            likely = self.make("vision_msgs/msg/ObjectHypothesis", class_id=kind, score=0.8)
            pose = self.pose(x, y)
            box = self.make("vision_msgs/msg/BoundingBox3D", center=pose.pose, size=self.vector("Vector3", 0.6, 0.6))
            results = [self.make("vision_msgs/msg/ObjectHypothesisWithPose", hypothesis=likely, pose=pose)]
            header = self.header(time, frame)
            found.append(self.make("vision_msgs/msg/Detection3D", header=header, results=results, bbox=box, id=id))
        message = self.make("vision_msgs/msg/Detection3DArray", header=self.header(time, frame), detections=found)
        self.write(topic, time, message)

    def agents(self, time, frame, places, kind):
        """Write {id: (x, y)} as agents of pedsim, HuNavSim, or measurements of people."""
        header, rows = self.header(time, frame), []
        for id, place in places.items():
            pose = self.make(
                "geometry_msgs/msg/Pose", position=self.vector("Point", *place), orientation=self.turn(0.0)
            )
            zero = self.vector("Vector3", 0, 0)
            twist = self.make("geometry_msgs/msg/Twist", linear=zero, angular=zero)
            values = {
                "AgentStates": {
                    "header": header, "id": id, "type": 0, "social_state": "", "pose": pose, "twist": twist,
                },
                "Agents": {"id": id, "type": 1, "skin": 0, "name": "", "group_id": -1, "position": pose, "yaw": 0.0},
                "PositionMeasurementArray": {
                    "header": header, "name": "leg", "object_id": str(id), "pos": pose.position, "reliability": 1.0,
                    "covariance": np.zeros(9), "initialization": 0,
                },
            }[kind.rpartition("/")[2]]  # fmt: skip
            rows.append(self.make(kind.replace("Array", "").removesuffix("s"), **values))
        more = {"cooccurrence": np.zeros(0, dtype=np.float32)} if kind.endswith("Array") else {}
        field = {"AgentStates": "agent_states", "Agents": "agents"}.get(kind.rpartition("/")[2], "people")
        self.write("/crowd", time, self.make(kind, header=header, **{field: rows}, **more))

    def pose(self, x, y, yaw=0.0):
        pose = self.make("geometry_msgs/msg/Pose", position=self.vector("Point", x, y), orientation=self.turn(yaw))
        return self.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36))

    def odometry(self, time, x, y, yaw=0.0, parent="odom", child="base_link", topic="/odom"):
        zero = self.vector("Vector3", 0, 0)
        twist = self.make("geometry_msgs/msg/Twist", linear=zero, angular=zero)
        message = self.make(
            "nav_msgs/msg/Odometry", header=self.header(time, parent), child_frame_id=child, pose=self.pose(x, y, yaw),
            twist=self.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=np.zeros(36)),
        )  # fmt: skip
        self.write(topic, time, message)

    def transform(self, time, parent, child, x=0.0, y=0.0, z=0.0, yaw=0.0, roll=0.0, topic="/tf"):
        place = self.make(
            "geometry_msgs/msg/Transform", translation=self.vector("Vector3", x, y, z), rotation=self.turn(yaw, roll)
        )
        row = self.make(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(time, parent),
            child_frame_id=child,
            transform=place,
        )
        self.write(topic, time, self.make("tf2_msgs/msg/TFMessage", transforms=[row]))
