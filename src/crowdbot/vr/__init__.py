"""Virtual reality: a person in a headset moves an avatar of a running simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from .body_estimate import BodyEstimator as BodyEstimator
    from .body_estimate import BodyMeasure as BodyMeasure
    from .body_estimate import BodySize as BodySize
    from .body_estimate import measure_pose as measure_pose
    from .capture import Suit as Suit
    from .headset_sample import HeadsetClock as HeadsetClock
    from .headset_sample import HeadsetRecord as HeadsetRecord
    from .headset_sample import HeadsetRecorder as HeadsetRecorder
    from .headset_sample import HeadsetSample as HeadsetSample
    from .headset_sample import read_headset_clock as read_headset_clock
    from .headset_sample import read_headset_recording as read_headset_recording
    from .headset_stream import HeadsetStream as HeadsetStream
    from .headset_stream import StreamSettings as StreamSettings
    from .latency import ClockSync as ClockSync
    from .latency import HeadsetLatency as HeadsetLatency
    from .latency import LatencyLog as LatencyLog
    from .latency import read_headset_latency as read_headset_latency
    from .rigid_transform import RigidFit as RigidFit
    from .rigid_transform import RigidTransform as RigidTransform
    from .rigid_transform import fit_rigid as fit_rigid
    from .server_address import certificate_files as certificate_files
    from .server_address import link_picture as link_picture
    from .server_address import link_text as link_text
    from .server_address import local_addresses as local_addresses
    from .server_address import tls_context as tls_context
    from .shared_rooms import RealRoom as RealRoom
    from .shared_rooms import RoomLimits as RoomLimits
    from .shared_rooms import SharedRooms as SharedRooms
    from .trial_seats import RobotStop as RobotStop
    from .trial_seats import TrialSeats as TrialSeats
    from .vr_desk import VrDesk as VrDesk
    from .vr_participant import AvatarContacts as AvatarContacts
    from .vr_participant import VrParticipant as VrParticipant
    from .vr_server import HEADSET_COMMANDS as HEADSET_COMMANDS
    from .vr_server import VR_DESKS as VR_DESKS
    from .vr_server import HeadsetWindow as HeadsetWindow
    from .vr_server import VrServer as VrServer
    from .vr_server import headset_frame as headset_frame
    from .vr_server import pack_triples as pack_triples
    from .vr_server import session_of_token as session_of_token
    from .vr_server import token_of_session as token_of_session
    from .vr_server import with_captures as with_captures

__getattr__, __dir__, __all__ = lazy_exports(__name__)
