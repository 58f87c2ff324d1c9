"""TrackerPlausibility: what in a stream of tracked people can hardly be true, each kind reported once."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable
from statistics import median

import numpy as np

from crowdbot.typing import Floats, Ints

SPEED_TIME = 0.4
"""Shortest time over which the speed of people is measured [s]; over less, noise of positions looks like speed."""
MOVING = 0.2
"""People above this speed move [m/s]."""
SPEEDS, MOST_SPEEDS = 3, 8
"""Speeds of the crowd before units are judged, and the largest number that counts. Three quarters must be implausible:
jumps must not look like a wrong unit."""
CENTIMETRES, MILLIMETRES = 25.0, 400.0
"""Median speeds above which positions are probably in these units [m/s]: people walk at 0.5 to 2 m/s."""
LONGEST_STEP = 5.0
"""Median time between frames above which stamps are probably not in seconds [s]: a tracker has 1 to 200 Hz."""
STEPS = 4
"""Steps of time before the unit of stamps is judged: a tracker may be silent while nobody is there."""
STAMP_UNITS = ((2e3, "milliseconds", "0.001"), (2e6, "microseconds", "1e-6"), (np.inf, "nanoseconds", "1e-9"))
"""Largest median step [s], the unit of the stamps, and its factor."""


class TrackerWarning(UserWarning):
    """A tracker sends data that can hardly be true, or too late; each kind is reported once for a stream.

    >>> import warnings
    >>> from crowdbot.prediction import ConstantVelocity, Live
    >>> live = Live(ConstantVelocity(), dt=0.1)
    >>> with warnings.catch_warnings(record=True) as reports:
    ...     warnings.simplefilter("always", TrackerWarning)
    ...     for row in range(20):
    ...         live.update([7], [[130.0 * 0.1 * row, 0.0]])
    >>> [str(report.message)[:62] for report in reports]
    ['live: people who move have a median speed of 130 m/s (at last ']
    """


class TrackerPlausibility:
    """Judges a stream of people.

    Args:
        max_speed: largest plausible speed of anybody [m/s]; most people who move have at most half of it.
    """

    def __init__(self, max_speed: float) -> None:
        self.max_speed = max_speed
        self._reported: set[str] = set()
        self._pending: list[str] = []
        self._steps: deque[float] = deque(maxlen=9)
        self._reference: tuple[float, Ints, Floats] | None = None
        self._speeds: deque[float] = deque(maxlen=MOST_SPEEDS)

    def take_reports(self) -> list[str]:
        """Return the sentences that were not returned before."""
        pending, self._pending = self._pending, []
        return pending

    def judge_step(self, step: float) -> None:
        """Judge the time [s] from the newest time stamp to a newer one."""
        if "stamps" in self._reported:
            return
        self._steps.append(step)
        if step < LONGEST_STEP or len(self._steps) < STEPS or (middle := median(self._steps)) < LONGEST_STEP:
            return
        unit, factor = next((unit, factor) for largest, unit, factor in STAMP_UNITS if middle < largest)
        self._report(
            "stamps",
            f"live: time stamps are {middle:.4g} s apart (median of {len(self._steps)}), so that everybody seems to"
            f" stand: they are probably in {unit} or count frames; multiply them by {factor}, or by the time between"
            " frames",
        )

    def judge_speeds(self, time: float, who: Ints, place: Floats) -> None:
        """Judge positions ``[N, 2]`` [m] of people with numbers ``[N]``, sorted, at a time [s] after earlier ones."""
        if "units" in self._reported or np.isinf(self.max_speed):
            return
        if self._reference is None:
            self._reference = (time, who, place)
            return
        gap = time - self._reference[0]
        if gap < SPEED_TIME - 1e-6:
            return
        _, before, now = np.intersect1d(self._reference[1], who, assume_unique=True, return_indices=True)
        if not len(now) and gap < LONGEST_STEP:  # the frame of another camera, which sees others
            return
        length = np.hypot(*(place[now] - self._reference[2][before]).T)
        self._reference = (time, who, place)
        moving = length > MOVING * gap
        if not moving.any():
            return
        middle = float(np.median(length[moving]))
        self._speeds.append(middle / gap)
        if len(self._speeds) < SPEEDS or sorted(self._speeds)[len(self._speeds) // 4] <= 0.5 * self.max_speed:
            return
        speed = median(self._speeds)
        unit, remedy = "not in metres, or dt or the time stamps are too short", "convert them"
        if speed > CENTIMETRES:
            unit, remedy = "in centimetres or pixels", "multiply centimetres by 0.01"
        if speed > MILLIMETRES:
            unit, remedy = "in millimetres", "multiply them by 0.001"
        self._report(
            "units",
            f"live: people who move have a median speed of {speed:.3g} m/s (at last {middle:.3g} m in"
            f" {gap:.3g} s): positions are probably {unit}; {remedy}. If people are so fast, set max_speed"
            f" to more than {2.0 * speed:.3g} m/s",
        )

    def report_jump(self, label: Hashable, length: float, gap: float) -> None:
        """Report that somebody moved faster than possible; not if the units are wrong."""
        if "units" not in self._reported:
            self._report(
                "jump",
                f"live: {label!r} moved {length:.3g} m in {gap:.3g} s, faster than max_speed = {self.max_speed:g} m/s:"
                " the tracker probably gave the identity to somebody else or mistook the position; the track begins"
                " again there, and forecasts do not continue the jump. Give another person another identity; if people"
                " are so fast, raise max_speed",
            )

    def report_late(self, stamp: float, newest: float, allowed: float) -> None:
        """Report that a frame is left out since its stamp is too old."""
        self._report(
            "late",
            f"live: a frame of {stamp:.10g} s came {newest - stamp:.4g} s after that of {newest:.10g} s, more than"
            f" allowed_lateness = {allowed:g} s: it is dropped, as will be others (Live.drop_count counts them). For"
            " messages of longer delay raise allowed_lateness; if the clock was set back, as at the begin of a"
            " recording, make a new Live",
        )

    def _report(self, kind: str, sentence: str) -> None:
        if kind not in self._reported:
            self._reported.add(kind)
            self._pending.append(sentence)
