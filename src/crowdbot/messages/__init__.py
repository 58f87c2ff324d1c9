"""ROS 2 messages: types, CDR encoding, their form in ROS 1, and codecs of sensor readings."""

from .cdr import KIND as MARKERS
from .cdr import MAP, Shape, marker_bytes, markers, people_bytes
from .codec import Codec, MeasuredReading, mount_pose, unpack_arrays
from .contacts import (
    COLLISIONS,
    FALL_POSES,
    FALLS,
    FORCES,
    ContactEventRecord,
    ContactForceRecord,
    FallRecord,
    contact_messages,
    fall_pose_message,
    read_contact_events,
    read_fall_poses,
    read_falls,
    read_forces,
)
from .images import image_in, picture_codec
from .message_store import Messages
from .point_clouds import points_in
from .reading_codecs import (
    CODECS,
    KIND,
    REST,
    codec_of,
    decode_reading,
    encode_reading,
    reading_table,
    reading_topics,
)
from .ros1 import Ros1Messages

__all__ = [
    "CODECS",
    "COLLISIONS",
    "FALLS",
    "FALL_POSES",
    "FORCES",
    "KIND",
    "MAP",
    "MARKERS",
    "REST",
    "Codec",
    "ContactEventRecord",
    "ContactForceRecord",
    "FallRecord",
    "MeasuredReading",
    "Messages",
    "Ros1Messages",
    "Shape",
    "codec_of",
    "contact_messages",
    "decode_reading",
    "encode_reading",
    "fall_pose_message",
    "image_in",
    "marker_bytes",
    "markers",
    "mount_pose",
    "people_bytes",
    "picture_codec",
    "points_in",
    "read_contact_events",
    "read_fall_poses",
    "read_falls",
    "read_forces",
    "reading_table",
    "reading_topics",
    "unpack_arrays",
]
