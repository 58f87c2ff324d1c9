"""Virtual reality: a person in a headset moves an avatar of a running simulation."""

from .body_estimate import BodyEstimator, BodyMeasure, BodySize, measure_pose
from .capture import Suit
from .headset_sample import (
    HeadsetClock,
    HeadsetRecord,
    HeadsetRecorder,
    HeadsetSample,
    read_headset_clock,
    read_headset_recording,
)
from .headset_stream import HeadsetStream, StreamSettings
from .latency import ClockSync, HeadsetLatency, LatencyLog, read_headset_latency
from .rigid_transform import RigidFit, RigidTransform, fit_rigid
from .server_address import certificate_files, link_picture, link_text, local_addresses, tls_context
from .shared_rooms import RealRoom, RoomLimits, SharedRooms
from .trial_seats import RobotStop, TrialSeats
from .vr_desk import VrDesk
from .vr_participant import AvatarContacts, VrParticipant
from .vr_server import (
    HEADSET_COMMANDS,
    VR_DESKS,
    HeadsetWindow,
    VrServer,
    headset_frame,
    pack_triples,
    session_of_token,
    token_of_session,
    with_captures,
)

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
