"""Messages: ROS 2 message types, CDR encoding, and the codecs of sensor readings."""

from .cdr import MAP, Shape, marker_bytes, people_bytes
from .codec import Codec, Told, arrays_of, mounted
from .contacts import COLLISIONS, FORCES, Collided, Pushed, collided, pushed, pushes
from .images import image_in, picture_codec
from .marker_array import markers
from .message_store import Messages
from .point_clouds import points_in
from .reading_codecs import CODECS, KIND, REST, codec_of, reading_of, said, unsaid

__all__ = [
    "CODECS",
    "COLLISIONS",
    "FORCES",
    "KIND",
    "MAP",
    "REST",
    "Codec",
    "Collided",
    "Messages",
    "Pushed",
    "Shape",
    "Told",
    "arrays_of",
    "codec_of",
    "collided",
    "image_in",
    "marker_bytes",
    "markers",
    "mounted",
    "people_bytes",
    "picture_codec",
    "points_in",
    "pushed",
    "pushes",
    "reading_of",
    "said",
    "unsaid",
]
