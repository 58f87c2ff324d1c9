"""Writes MCAP files of people_msgs and odometry message by message, as a ROS 2 recorder does."""

import numpy as np
from mcap.writer import CompressionType, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

PERSON = """string name
geometry_msgs/Point position
geometry_msgs/Point velocity
float64 reliability
string[] tagnames
string[] tags
"""
PEOPLE = "std_msgs/Header header\npeople_msgs/Person[] people\n"


def types():
    """Return a store that knows people_msgs."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(PERSON, "people_msgs/msg/Person"))
    store.register(get_types_from_msg(PEOPLE, "people_msgs/msg/People"))
    return store


class McapRecording:
    """Writes messages as a ROS 2 recorder does."""

    def __init__(self, path, finish=True):
        self.store, self.path, self.finish = types(), path, finish
        self.make = lambda kind, **fields: self.store.types[kind](**fields)

    def __enter__(self):
        self.file = self.path.open("wb")
        self.writer = Writer(self.file, compression=CompressionType.ZSTD)
        self.writer.start(profile="ros2", library="test")
        self.channels = {}
        return self

    def __exit__(self, *_):
        if self.finish:
            self.writer.finish()
        self.file.close()

    def write(self, topic, message, nanoseconds):
        kind = message.__msgtype__
        if topic not in self.channels:
            text = self.store.generate_msgdef(kind, ros_version=2)[0].encode()
            self.channels[topic] = self.writer.register_channel(
                topic, "cdr", self.writer.register_schema(kind, "ros2msg", text)
            )
        data = bytes(self.store.serialize_cdr(message, kind))
        self.writer.add_message(self.channels[topic], nanoseconds, data, nanoseconds)

    def header(self, nanoseconds):
        sec, nanosec = divmod(nanoseconds, 10**9)
        stamp = self.make("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id="map")

    def point(self, x, y):
        return self.make("geometry_msgs/msg/Point", x=float(x), y=float(y), z=0.0)

    def people(self, nanoseconds, persons):
        """Write {name: (x, y)}."""
        everyone = [
            self.make(
                "people_msgs/msg/Person",
                name=str(name),
                position=self.point(*place),
                velocity=self.point(0, 0),
                reliability=1.0,
                tagnames=[],
                tags=[],
            )
            for name, place in persons.items()
        ]
        message = self.make("people_msgs/msg/People", header=self.header(nanoseconds), people=everyone)
        self.write("/people", message, nanoseconds)

    def odometry(self, nanoseconds, x, y, topic="/robot/odom"):
        turn = self.make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
        pose = self.make("geometry_msgs/msg/Pose", position=self.point(x, y), orientation=turn)
        zero = self.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        message = self.make(
            "nav_msgs/msg/Odometry",
            header=self.header(nanoseconds),
            child_frame_id="robot/base_link",
            pose=self.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36)),
            twist=self.make(
                "geometry_msgs/msg/TwistWithCovariance",
                twist=self.make("geometry_msgs/msg/Twist", linear=zero, angular=zero),
                covariance=np.zeros(36),
            ),
        )
        self.write(topic, message, nanoseconds)

    def metadata(self, **values):
        self.writer.add_metadata("crowdbot", values)
