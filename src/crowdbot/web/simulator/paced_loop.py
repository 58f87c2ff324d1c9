"""PacedLoop: a thread that advances something at a speed relative to real time."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

from crowdbot.core import InputError, PacedClock

Result = TypeVar("Result")
SPEEDS = (0.1, 100.0)
"""Lowest and highest speed relative to real time; None is as fast as possible."""
CALL = 120.0
"""Longest time [s] that a caller waits for the thread, which compiles kernels in a first run."""
RECENT = 5.0
"""Real time [s] for which the loop counts as late after a delay that it did not catch up."""


class PacedLoop:
    """A thread that advances in steps at a speed, and does other things between two steps.

    A pause, or time that the computer sleeps, is not made up for. All actions run in the same thread, so that they see
    a state between two steps.

    Args:
        step: simulated time of a step [s].
        advance: advances one step; False if there is nothing more to do.
        begin: called first, in the thread.
        end: called last, in the thread.
        paused: whether the loop waits at its start.
        settle: called in the thread before it waits, at a pause or at the end.
        monotonic: source of real time [s].

    >>> done = []
    >>> loop = PacedLoop(0.01, lambda: len(done) < 2 and not done.append(1))
    >>> loop.speed = None
    >>> loop.start()
    >>> loop.resume()
    >>> loop.ended.wait(5.0), len(done)
    (True, 2)
    >>> loop.close()
    """

    def __init__(
        self,
        step: float,
        advance: Callable[[], bool],
        begin: Callable[[], None] = lambda: None,
        end: Callable[[], None] = lambda: None,
        paused: bool = True,
        settle: Callable[[], None] = lambda: None,
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        self._advance, self._begin, self._end, self._settle = advance, begin, end, settle
        self._clock, self._monotonic = PacedClock(step, monotonic=monotonic, sleep=self._sleep), monotonic
        self._delayed = -math.inf  # when the latest delay was given up
        self._changed = threading.Condition()
        self._calls: list[Callable[[], None]] = []
        self._paused, self._closed, self._steps = paused, False, 0
        self._speed: float | None = 1.0
        self.ended = threading.Event()
        """Set while there is nothing more to do."""
        self._thread = threading.Thread(target=self._run, name="crowdbot-simulation", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    @property
    def speed(self) -> float | None:
        """Simulated time over real time; None: as fast as possible."""
        return self._speed

    @speed.setter
    def speed(self, speed: float | None) -> None:
        """Set the speed."""
        if speed is not None and not SPEEDS[0] <= speed <= SPEEDS[1]:
            raise InputError(f"speed = {speed:g}: expected {SPEEDS[0]:g} to {SPEEDS[1]:g}, or null for no limit")
        with self._changed:
            self._speed, self._delayed = speed, -math.inf
            if speed is not None:
                self._clock.rate = speed
            self._changed.notify_all()

    @property
    def late(self) -> bool:
        """Whether the steps take longer than the speed allows, so that simulated time stays behind."""
        return self._monotonic() - self._delayed < RECENT

    @property
    def paused(self) -> bool:
        """Whether the loop waits."""
        return self._paused

    @property
    def closed(self) -> bool:
        """Whether the thread ends after its current step."""
        return self._closed

    def pause(self) -> None:
        """Wait after the current step."""
        with self._changed:
            self._paused, self._steps = True, 0
            self._clock.pause()
            self._changed.notify_all()

    def resume(self) -> None:
        """Continue."""
        with self._changed:
            self._paused = False
            self._clock.resume()
            self._changed.notify_all()

    def take_steps(self, count: int) -> None:
        """Pause, and advance a number of steps at once."""
        self.pause()
        self.hurry(count)

    @property
    def hurries(self) -> bool:
        """Whether more steps follow at once, also in a pause."""
        return self._steps > 0

    def hurry(self, count: int) -> None:
        """Advance a number of steps at once, and go on as before; a pause ends it."""
        with self._changed:
            self._steps = max(self._steps, count)
            self._changed.notify_all()

    def restart(self) -> None:
        """Continue after the end, because there is something to do again."""
        with self._changed:
            self.ended.clear()
            self._changed.notify_all()

    def do(self, action: Callable[[], Result]) -> Result:
        """Run an action in the thread between two steps and return its result; its exceptions are raised here.

        Raises:
            InputError: the loop is closed, or is busy for a long time.
        """
        if threading.current_thread() is self._thread:
            return action()
        future: Future[Result] = Future()

        def call() -> None:
            try:
                future.set_result(action())
            except BaseException as error:
                future.set_exception(error)

        self.do_later(call)
        try:
            return future.result(CALL)
        except TimeoutError:
            raise InputError(f"the simulation has not answered for {CALL:g} s; it may still be compiling") from None

    def do_later(self, action: Callable[[], None]) -> None:
        """Run an action, which raises nothing, in the thread between two steps, and do not wait for it.

        Raises:
            InputError: the loop is closed.
        """
        with self._changed:
            if self._closed:
                raise InputError("the simulation has been closed")
            self._calls.append(action)
            self._changed.notify_all()

    def close(self, wait: float | None = None) -> None:
        """End the thread after its current step, and wait for it at most ``wait`` [s]."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        if threading.current_thread() is not self._thread and self._thread.ident is not None:
            self._thread.join(wait)

    def _run(self) -> None:
        try:
            self._begin()
            while not self._closed:
                self._do_calls()
                if self._may_advance():
                    self._step()
                else:
                    self._settle()
                    with self._changed:
                        if not (self._calls or self._closed or self._may_advance()):
                            self._changed.wait()
        finally:
            self._end()
            with self._changed:
                self._closed = True
            self._do_calls()

    def _may_advance(self) -> bool:
        return not self._closed and not self.ended.is_set() and (not self._paused or self._steps > 0)

    def _step(self) -> None:
        hurries = self.hurries
        self._steps = max(0, self._steps - 1)
        if not self._advance():
            self.ended.set()
        elif self._speed is not None and not self._paused and not hurries:
            before = self._clock.late
            self._clock.advance()
            if self._clock.late > before:
                self._delayed = self._monotonic()
        else:
            time.sleep(0)

    def _sleep(self, seconds: float) -> None:
        """Wait until a step is due, and do what is asked for in the meantime."""
        until = self._monotonic() + seconds
        while True:
            self._do_calls()
            with self._changed:
                rest = until - self._monotonic()
                if rest <= 0.0 or self._closed or self._paused or self._speed is None:
                    return
                if not self._calls:
                    self._changed.wait(rest)

    def _do_calls(self) -> None:
        with self._changed:
            calls, self._calls = self._calls, []
        for call in calls:
            call()
