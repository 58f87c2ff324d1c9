"""Motion capture: people and robots of a trial that move as Xsens, OptiTrack, a VRPN server or a file says."""

from .bvh import read_bvh
from .capture_set import CaptureSet
from .clock_offset import ClockOffset
from .csv_take import read_csv
from .foot_lock import FootLock
from .motion_capture import MotionBinding, MotionCapture
from .motion_recording import MotionRecording, RecordedSubject
from .mvnx import read_mvnx
from .natnet import NatNetStream
from .pose_receiver import PoseReceiver
from .pose_stream import MotionSample, PoseStream, StreamStatistics
from .retargeting import Retargeting
from .source_skeleton import SourceSkeleton
from .stream_address import open_stream, parse_binding, parse_captures
from .vrpn import VrpnStream
from .xsens import XsensStream

__all__ = [
    "CaptureSet",
    "ClockOffset",
    "FootLock",
    "MotionBinding",
    "MotionCapture",
    "MotionRecording",
    "MotionSample",
    "NatNetStream",
    "PoseReceiver",
    "PoseStream",
    "RecordedSubject",
    "Retargeting",
    "SourceSkeleton",
    "StreamStatistics",
    "VrpnStream",
    "XsensStream",
    "open_stream",
    "parse_binding",
    "parse_captures",
    "read_bvh",
    "read_csv",
    "read_mvnx",
]
