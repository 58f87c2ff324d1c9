"""Virtual reality: a person in a headset moves an avatar of a running simulation."""

from .avatar_contacts import AvatarContacts
from .body_estimate import BodyEstimator, BodySize
from .calibration_pose import BodyMeasure, measure_pose
from .capture import Suit
from .certificate import certificate_files, local_addresses, tls_context
from .headset_access import session_of_token, token_of_session
from .headset_recording import HeadsetClock, HeadsetRecord, HeadsetRecorder, read_headset_clock, read_headset_recording
from .headset_sample import HeadsetSample
from .headset_stream import HeadsetStream, StreamSettings
from .headset_window import HEADSET_COMMANDS, HeadsetWindow, headset_frame, pack_triples
from .latency import ClockSync, HeadsetLatency, LatencyLog, read_headset_latency
from .link_code import link_picture, link_text
from .rigid_transform import RigidFit, RigidTransform, fit_rigid
from .robot_stop import RobotStop
from .room_limits import RoomLimits
from .shared_rooms import RealRoom, SharedRooms
from .trial_seats import TrialSeats
from .vr_desk import VrDesk
from .vr_participant import VrParticipant
from .vr_server import VR_DESKS, VrServer, with_captures

__all__ = [
    "HEADSET_COMMANDS",
    "VR_DESKS",
    "AvatarContacts",
    "BodyEstimator",
    "BodyMeasure",
    "BodySize",
    "ClockSync",
    "HeadsetClock",
    "HeadsetLatency",
    "HeadsetRecord",
    "HeadsetRecorder",
    "HeadsetSample",
    "HeadsetStream",
    "HeadsetWindow",
    "LatencyLog",
    "RealRoom",
    "RigidFit",
    "RigidTransform",
    "RobotStop",
    "RoomLimits",
    "SharedRooms",
    "StreamSettings",
    "Suit",
    "TrialSeats",
    "VrDesk",
    "VrParticipant",
    "VrServer",
    "certificate_files",
    "fit_rigid",
    "headset_frame",
    "link_picture",
    "link_text",
    "local_addresses",
    "measure_pose",
    "pack_triples",
    "read_headset_clock",
    "read_headset_latency",
    "read_headset_recording",
    "session_of_token",
    "tls_context",
    "token_of_session",
    "with_captures",
]
