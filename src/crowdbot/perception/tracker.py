"""The contract of trackers: ``begin() -> state`` and ``update(detections, time, state) -> (Tracks, state)``."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError

from .detections import Detections
from .tracks import Tracks


@dataclass(frozen=True, kw_only=True)
class Tracker(ABC):
    """Follows people from detection to detection: a frozen specification and two pure functions.

    The state is never changed in place, so that a copy of a reference is a snapshot. It is a dataclass, tuple, list or
    dict of arrays and numbers.
    """

    @abstractmethod
    def begin(self) -> Any:
        """Return the state before the first detections."""

    @abstractmethod
    def update(self, detections: Detections, time: float, state: Any) -> tuple[Tracks, Any]:
        """Return the tracks at ``time`` [s] and the next state.

        Args:
            detections: detections at this time.
            time: time [s], not before that of the state.
            state: state of :meth:`begin` or of the last update.

        Raises:
            InputError: the time is not finite or before that of the state.
        """

    @staticmethod
    def check_time(time: float, last: float) -> None:
        """Raise :class:`InputError` if a time is not finite or before the last one, which is NaN at the beginning."""
        if not math.isfinite(time) or time < last:
            after = "" if math.isnan(last) else f" and not before the last update at {last:g} s"
            raise InputError(f"tracker: time = {time} s must be finite{after}")
