"""Motion capture: people and robots of a trial that move as Xsens, OptiTrack, a VRPN server or a file says."""

from .motion_capture import CaptureSet, MotionBinding, MotionCapture, open_stream, parse_binding, parse_captures
from .motion_files import MotionRecording, RecordedSubject, read_bvh, read_csv, read_mvnx
from .natnet import NatNetStream
from .pose_stream import ClockOffset, MotionSample, PoseReceiver, PoseStream, StreamStatistics
from .retargeting import FootLock, Retargeting, SourceSkeleton
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
