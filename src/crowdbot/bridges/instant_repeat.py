"""InstantRepeat: an instant that nobody answers is sent again, since DDS can lose the first commands of a program."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

__all__ = ["InstantRepeat"]

REPEAT, SETTLED = 1.0, 0.3
"""Real time [s] after which an instant is sent again, and without messages before a repeated instant is over."""


@dataclass
class InstantRepeat:
    """Decides when a run that waits for commands sends its instant again.

    With DDS, a program can know the simulation before the simulation knows the program. Its command is then lost, and
    without another message both would wait forever. The answers to the first and the repeated messages can both come;
    so the step is taken when they have ceased, and none of them answers the next instant.

    Args:
        monotonic: source of real time [s].

    >>> repeat = InstantRepeat(iter([0.0, 0.5, 1.5, 1.6, 1.7, 2.1]).__next__)
    >>> repeat.begin()
    >>> repeat.must_send(), repeat.must_send()
    (False, True)
    >>> repeat.is_settled(1), repeat.is_settled(2), repeat.is_settled(2)
    (False, False, True)
    """

    monotonic: Callable[[], float] = time.monotonic
    _sent: float = field(default=0.0, init=False)
    _repeated: bool = field(default=False, init=False)
    _received: int = field(default=-1, init=False)
    _latest: float = field(default=0.0, init=False)

    def begin(self) -> None:
        """Note that an instant is sent for the first time."""
        self._sent, self._repeated, self._received = self.monotonic(), False, -1

    def must_send(self) -> bool:
        """Return whether the instant must be sent again now."""
        now = self.monotonic()
        if now - self._sent <= REPEAT:
            return False
        self._sent, self._repeated = now, True
        return True

    def is_settled(self, received: int) -> bool:
        """Return whether the step can be taken.

        Args:
            received: number of messages received until now.
        """
        if not self._repeated:
            return True
        now = self.monotonic()
        if received != self._received:
            self._received, self._latest = received, now
        return now - self._latest > SETTLED
