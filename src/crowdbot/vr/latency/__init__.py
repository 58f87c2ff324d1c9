"""Latency of a headset: offset of its clock, delays as they happen, and those of a recorded trial."""

from .clock_sync import ClockSync
from .headset_latency import HeadsetLatency, read_headset_latency
from .latency_log import LatencyLog

__all__ = ["ClockSync", "HeadsetLatency", "LatencyLog", "read_headset_latency"]
