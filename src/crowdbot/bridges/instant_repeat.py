"""InstantRepeat: an instant that nobody answers is sent again, and no answer to it is taken for one to the next."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

REPEAT, LONGEST, SETTLED = 1.0, 5.0, 0.3
"""Shortest real time [s] until an instant is sent again, the longest unless the latest answer took longer, and the time
without commands after which a repeated instant is over."""
PATIENCE, CAUTION = 4.0, 1.5
"""Times of the latest answer until the next instant is sent again, and of the first answer until one is over."""


@dataclass
class InstantRepeat:
    """Decides when a run that waits for commands sends its instant again, and when all answers to it have come.

    With DDS, a program can know the simulation before the simulation knows the program. Its command is then lost, and
    without another message both would wait forever. But a program that gets an instant twice answers twice, and plain
    commands do not say which instant they answer. So the step is taken when each message has its answer, or when no
    answer has come for longer than the first one needed. Programs that compute longer are sent the next instants
    again later.

    Args:
        monotonic: source of real time [s].

    >>> repeat = InstantRepeat(iter([0.0, 0.5, 1.5, 1.6, 1.7, 2.1]).__next__)
    >>> repeat.begin(heard=True)
    >>> repeat.must_send(heard=True), repeat.must_send(heard=True)
    (False, True)
    >>> repeat.is_settled(1), repeat.is_settled(2), repeat.is_settled(2)
    (False, False, True)
    """

    monotonic: Callable[[], float] = time.monotonic
    _sends: int = field(default=1, init=False)
    _robots: int = field(default=1, init=False)
    _heard: float | None = field(default=None, init=False)
    _sent: float = field(default=0.0, init=False)
    _delay: float = field(default=REPEAT, init=False)
    _patience: float = field(default=REPEAT, init=False)
    _first: float | None = field(default=None, init=False)
    _latest: float = field(default=0.0, init=False)
    _before: int = field(default=0, init=False)
    _received: int = field(default=0, init=False)

    def begin(self, heard: bool, received: int = 0, robots: int = 1, unasked: bool = False) -> None:
        """Note that an instant is sent for the first time.

        Args:
            heard: whether anybody has subscribed.
            received: number of commands received until now.
            robots: number of robots whose commands are awaited.
            unasked: whether programs may send a command before they get this instant, as at the start of a run.
        """
        now = self.monotonic()
        self._sent, self._heard = now, now if heard else None
        self._sends, self._robots = 1 + unasked, robots
        self._delay, self._first = self._patience, None
        self._before = self._received = received

    def must_send(self, heard: bool) -> bool:
        """Return whether the instant must be sent again now.

        Args:
            heard: whether anybody has subscribed; without, nothing is sent again, and the first subscriber gets it.
        """
        now = self.monotonic()
        if not heard:
            self._heard = None
            return False
        if self._heard is None:
            self._heard, self._delay = now, self._patience
        elif now - self._sent <= self._delay:
            return False
        else:
            self._delay = min(2.0 * self._delay, max(self._patience, LONGEST))
        self._sent = now
        self._sends += 1
        return True

    def is_settled(self, received: int) -> bool:
        """Return whether the step can be taken, now that all robots have a command.

        Args:
            received: number of commands received until now.
        """
        now = self.monotonic()
        if self._first is None:
            self._first = self._latest = now
            self._patience = max(REPEAT, PATIENCE * (now - self._sent))
        answers, expected = received - self._before, self._sends * self._robots
        if self._sends == 1 or answers > expected:  # a program that sends more than answers commands at its own rate
            return True
        if received != self._received:
            self._received, self._latest = received, now
        quiet = SETTLED
        if answers < expected and self._heard is not None:
            quiet = max(SETTLED, CAUTION * (self._first - self._heard))
        return now - self._latest > quiet
