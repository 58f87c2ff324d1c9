"""Motion capture: people and robots of a trial that move as Xsens, OptiTrack or a file says."""

from .bvh import read_bvh
from .clock_offset import ClockOffset
from .csv_take import read_csv
from .motion_capture import MotionBinding, MotionCapture
from .motion_recording import MotionRecording, RecordedSubject
from .mvnx import read_mvnx
from .natnet import NatNetStream
from .pose_receiver import PoseReceiver
from .pose_stream import MotionSample, PoseStream, StreamStatistics
from .retargeting import Retargeting
from .source_skeleton import SourceSkeleton
from .stream_address import open_stream, parse_captures
from .xsens import XsensStream

__all__ = [
    "ClockOffset",
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
    "XsensStream",
    "open_stream",
    "parse_captures",
    "read_bvh",
    "read_csv",
    "read_mvnx",
]
