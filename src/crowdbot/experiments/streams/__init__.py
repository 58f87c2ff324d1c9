"""Clocks of a session, and streams of other programs in and out over the Lab Streaming Layer."""

from .recorded_stream import RecordedStream, read_streams
from .stream_outlets import StreamOutlets
from .stream_recorder import StreamRecorder
from .trial_clock import TrialClock, TrialClockLog, read_trial_clock

__all__ = [
    "RecordedStream",
    "StreamOutlets",
    "StreamRecorder",
    "TrialClock",
    "TrialClockLog",
    "read_streams",
    "read_trial_clock",
]
