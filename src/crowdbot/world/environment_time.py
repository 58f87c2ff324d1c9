"""Time of each environment of a world: the steps since it began, on a common clock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import Clock, FreeClock, InputError, Storage, every
from crowdbot.typing import Floats, Ints


@dataclass
class EnvironmentTime:
    """The time of E environments that share a clock and may begin at different ticks; a tree.

    Fields:
        clock: the clock of the world.
        first_tick: ``[E]`` tick of the clock at which an environment began.
        begin: ``[E]`` time of the scene at that tick [s].

    >>> from crowdbot.core import FreeClock, tree
    >>> time = EnvironmentTime.of(FreeClock(0.5), 0.0, 2)
    >>> time.clock.advance()
    >>> time = tree.put(time, np.array([1]), EnvironmentTime.of(time.clock, 3.0, 1))
    >>> time.clock.advance()
    >>> time.ticks.tolist(), time.age.tolist(), time.now.tolist()
    ([2, 1], [1.0, 0.5], [1.0, 3.5])
    """

    clock: Clock
    first_tick: Ints
    begin: Floats
    storage = Storage(constants=("clock", "first_tick"), environments=("first_tick",), properties=("ticks",))

    @classmethod
    def of(cls, clock: Clock, begin: float | Floats, count: int) -> EnvironmentTime:
        """Return the time of environments that begin now, with scenes at a time [s]."""
        offset = np.broadcast_to(np.asarray(begin, dtype=np.float64), (count,)).copy()
        return cls(clock, np.full(count, clock.tick, dtype=np.int64), offset)

    @property
    def ticks(self) -> Ints:
        """Number of steps since each environment began, ``[E]``."""
        return self.clock.tick - self.first_tick

    @ticks.setter
    def ticks(self, ticks: Ints) -> None:
        """Set the number of steps, and the clock to the largest.

        Raises:
            InputError: a number is out of range.
        """
        if ticks.min() < 0 or ticks.max() > 2**53:
            raise InputError("a step number is outside 0 to 2^53")
        self.clock.tick = int(ticks.max())
        self.first_tick = self.clock.tick - ticks

    @property
    def age(self) -> Any:
        """Time since the beginning [s]: a number if all environments agree, otherwise ``[E]``."""
        tick = self.common_tick
        return (self.ticks if tick is None else tick) * self.clock.step_ns / 1e9

    @property
    def common_tick(self) -> int | None:
        """Number of steps since the environments began, None if they do not agree."""
        first = self.first_tick
        same = len(first) == 1 or every(first == first[0])
        return self.clock.tick - int(first[0]) if same else None

    @property
    def now(self) -> Any:
        """Time of the scenes [s]: a number if all environments agree, otherwise ``[E]``."""
        begin = self.begin
        same = len(begin) == 1 or every(begin == begin[0])
        return (float(begin[0]) if same else begin) + self.age

    def follow(self, clock: Clock | None = None) -> None:
        """Continue on another clock with the same time step (default: a free one); the time of environments stays."""
        clock = FreeClock(self.clock.dt, self.clock.tick) if clock is None else clock
        self.first_tick, self.clock = clock.tick - self.ticks, clock
