"""PaceRequest: the speed of a run in real time, and the time to which it hurries, as viewers ask for them."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core import InputError

SLOWEST, FASTEST = 0.001, 100.0
"""Speeds that may be asked for, in simulated seconds per real second."""
NO_PACE = "the time of this run is that of another clock, of motion capture or of a real robot"


@dataclass
class PaceRequest:
    """What viewers have asked of the pace of a run. It changes when steps are taken, never their result.

    Fields:
        rate: simulated seconds per real second; None: the run is not in real time.
        until: simulated time [ns] up to which the run takes steps as fast as it can.

    >>> pace = PaceRequest(1.0)
    >>> pace.set_rate(2.0)
    >>> pace.rate
    2.0
    """

    rate: float | None = None
    until: int = 0

    def set_rate(self, rate: float) -> None:
        """Set the speed.

        Raises:
            InputError: the run is not in real time, or the speed is not possible.
        """
        if self.rate is None:
            raise InputError(f"the speed cannot be set: {NO_PACE}")
        if not SLOWEST <= rate <= FASTEST:
            raise InputError(f"the speed {rate:g} must be from {SLOWEST:g} to {FASTEST:g} times real time")
        self.rate = rate

    def hurry_to(self, nanoseconds: int, now: int) -> None:
        """Go to a later time as fast as possible.

        Args:
            nanoseconds: the time to reach [ns].
            now: the current time [ns].

        Raises:
            InputError: the time is over, or the run is not in real time.
        """
        if nanoseconds < now:
            raise InputError(
                f"a live run cannot go back from {now / 1e9:g} s to {nanoseconds / 1e9:g} s; it can begin again, at 0 s"
            )
        if self.rate is None:
            raise InputError(f"the time cannot be set: {NO_PACE}")
        self.until = nanoseconds
