"""BridgeClock: when a run with a bridge may take its next step."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from crowdbot.core import InputError

MODES = {
    "paced": "real time, or a multiple of it",
    "free": "as fast as possible",
    "step": "steps on the service step_simulation only",
    "follow": "follows the time received on /clock",
    "commands": "steps when all robots have a command for the current instant",
}
"""Modes of a clock, with a line for people."""
LATE, TOLD = 0.25, 5.0
"""Delay [s] that is caught up, and shortest real time [s] between two remarks."""


@dataclass(frozen=True)
class BridgeClock:
    """The clock of a run with a bridge. No mode changes the result of a run with the same orders.

    Fields:
        mode: one of :data:`MODES`.
        rate: simulated seconds per real second of the mode ``paced``.

    Raises:
        InputError: the mode does not exist, or the rate is not above 0.

    >>> BridgeClock("step").mode
    'step'
    """

    mode: str = "paced"
    rate: float = 1.0

    def __post_init__(self) -> None:
        if self.mode not in MODES:
            raise InputError(f"there is no clock {self.mode!r}; clocks are {', '.join(MODES)}")
        if not 0.0 < self.rate < float("inf"):
            raise InputError(f"rate {self.rate} must be above 0 and finite")


@dataclass
class Pace:
    """Real time of the steps of a paced run.

    Args:
        step: time step [s].
        rate: simulated seconds per real second.
        monotonic: source of real time [s].

    >>> pace = Pace(0.1, 1.0, monotonic=iter([0.0, 0.05, 0.12]).__next__)
    >>> pace.wait_time(), round(pace.wait_time(), 3), pace.wait_time()
    (0.1, 0.05, 0.0)
    """

    step: float
    rate: float
    monotonic: Callable[[], float] = time.monotonic
    _due: float | None = field(default=None, init=False)
    _lost: float = field(default=0.0, init=False)
    _since: float = field(default=0.0, init=False)

    def wait_time(self) -> float:
        """Return the real time [s] until the next step is due, 0 if it is."""
        now = self.monotonic()
        if self._due is None:
            self._due = self._since = now
            self._due += self.step / self.rate
        return max(0.0, self._due - now)

    def note_step(self) -> str | None:
        """Count a step, and return a remark if the run cannot keep up, at most every 5 s."""
        now = self.monotonic()
        if self._due is None:
            self._due = self._since = now
        self._due += self.step / self.rate
        if now - self._due > LATE:
            self._lost += now - self._due
            self._due = now
        if self._lost == 0.0 or now - self._since < TOLD:
            return None
        share = 1.0 - min(1.0, self._lost / (now - self._since))
        self._lost, self._since = 0.0, now
        return f"the run cannot keep up: {share * self.rate:.2f} instead of {self.rate:g} times real time"

    def restart(self) -> None:
        """Begin anew from now, after a pause."""
        self._due = None
