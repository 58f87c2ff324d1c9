"""HeadsetStream: the samples of a headset in the time of the server, with artificial delay and noise."""

from __future__ import annotations

import bisect
import dataclasses
import math
from dataclasses import dataclass

from crowdbot.core import InputError, stream

from .headset_sample import PARTS, HeadsetSample
from .latency import ClockSync, LatencyLog

HISTORY = 2.0
"""Samples older than the longest delay by this time [s] are left out."""
LONGEST = 2.0
"""Longest artificial delay [s]."""


@dataclass(frozen=True)
class StreamSettings:
    """Settings of the path from headset to simulation and back; delay and noise are factors of experiments.

    Fields:
        motion_delay: artificial delay [s] of the motion of the participant.
        picture_delay: artificial delay [s] of the picture of everybody else in the headset.
        noise: standard deviation [m] of artificial noise in each coordinate of head and hands.
        buffer: age [s] at which samples are used, so that they can be interpolated; a little above the interval between
            two samples.
        timeout: longest time [s] without a sample of the head before tracking counts as lost.
        pause_when_lost: whether the run pauses then.

    Raises:
        InputError: a value is out of range.
    """

    motion_delay: float = 0.0
    picture_delay: float = 0.0
    noise: float = 0.0
    buffer: float = 0.02
    timeout: float = 0.5
    pause_when_lost: bool = True

    def __post_init__(self) -> None:
        limits = {"motion_delay": LONGEST, "picture_delay": LONGEST, "noise": 1.0, "buffer": 0.2, "timeout": 10.0}
        for name, most in limits.items():
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value <= most:
                raise InputError(f"{name} = {value!r}: expected 0 to {most:g}")


class HeadsetStream:
    """Samples of a headset by their time in the clock of the server.

    :meth:`at` interpolates, so that a simulation with another rate sees smooth motion, and the age of what it sees is
    constant: ``buffer`` plus the artificial delay, or the age of the newest sample if the network is slower.

    Args:
        settings: delays and noise.
        seed: seed of the noise.

    >>> import numpy as np
    >>> moving = HeadsetStream()
    >>> for k in range(10):
    ...     clock = (0.01 * k, 50.0 + 0.01 * k, 50.0 + 0.01 * k, 0.01 * k)
    ...     moving.add(HeadsetSample(0.01 * k, np.array([0.01 * k, 0, 1.6, 1, 0, 0, 0]), clock=clock, number=k), 50.1)
    >>> moving.settings = StreamSettings(motion_delay=0.03, buffer=0.015)
    >>> round(float(moving.at(50.09).head[0]), 6), round(moving.latency.median("motion"), 6)
    (0.045, 0.045)
    """

    def __init__(self, settings: StreamSettings | None = None, seed: int = 0) -> None:
        self.settings = settings or StreamSettings()
        self.trial_delay, self.trial_noise = 0.0, 0.0
        """``delay`` [s] of the avatar, which the simulation adds itself, and its ``noise`` [m]."""
        self.age = math.nan
        """Age of the sample that was used last, with the delay of the trial [s]."""
        self.clock, self.latency = ClockSync(), LatencyLog()
        self.last = -math.inf
        """Time of the server at which the head was tracked last [s]."""
        self._times: list[float] = []
        self._samples: list[HeadsetSample] = []
        self._number = -1
        self._random = stream(seed, "headset-noise")

    def add(self, sample: HeadsetSample, arrival: float) -> None:
        """Add a sample that arrived at a time of the server [s]; before the first exchange of clocks none counts."""
        if sample.clock is not None:
            self.clock.add(*sample.clock)
        self.latency.lost += max(0, sample.number - self._number - 1) if self._number >= 0 else 0
        self._number, self.latency.dropped = max(self._number, sample.number), sample.dropped
        if not self.clock:
            return
        for stamp, drawn in sample.pictures.tolist():
            self.latency.add("picture", self.clock.to_server(drawn) - stamp)
        time = self.clock.to_server(sample.time)
        if sample.head is None or not sample.visible or not abs(time - arrival) < HISTORY:
            return
        noise = math.hypot(self.settings.noise, self.trial_noise)
        if noise > 0.0:
            sample = self._with_noise(sample, noise)
        k = bisect.bisect(self._times, time)
        self._times.insert(k, time)
        self._samples.insert(k, sample)
        self.last = max(self.last, arrival)
        old = bisect.bisect(self._times, arrival - LONGEST - HISTORY)
        del self._times[:old], self._samples[:old]

    def at(self, now: float) -> HeadsetSample | None:
        """Return the sample that the simulation uses at a time of the server [s], and note its age; or None."""
        if not self._times or self.is_lost(now):
            return None
        wish = now - self.settings.buffer - self.settings.motion_delay
        k = bisect.bisect_right(self._times, wish)
        if k == 0:
            return None
        used, found = self._times[k - 1], self._samples[k - 1]
        if k < len(self._times):
            share = (wish - used) / (self._times[k] - used)
            used, found = wish, found.blend(self._samples[k], share)
        self.age = now - used + self.trial_delay
        self.latency.add("motion", self.age)
        return found

    def is_lost(self, now: float) -> bool:
        """Return whether the head has not been tracked for longer than the timeout."""
        return now - self.last > self.settings.timeout

    def _with_noise(self, sample: HeadsetSample, noise: float) -> HeadsetSample:
        parts = {}
        for name in PARTS:
            pose = getattr(sample, name)
            if pose is not None:
                parts[name] = pose.copy()
                parts[name][:3] += noise * self._random.standard_normal(3)
        return dataclasses.replace(sample, **parts)
