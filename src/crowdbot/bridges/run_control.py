"""Control of a run from outside: its state, clock, repeated instants, and the latency of commands."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.trials import Trial

from .simulation_interfaces import STATE_PLAYING, STATE_QUITTING


@dataclass
class RunControl:
    """What other programs have asked of a run.

    Fields:
        state: a state of ``simulation_interfaces/SimulationState``: stopped, playing, paused or quitting.
        steps: steps that are still to do while paused.
        stepped: called after the last of them, or with False if the run has ended before.
        begun: the trial of the current run, as it began.
        restart: trial that runs next instead of the current one; None: none.
        restarted: called when it runs, with an empty text, or with the reason why it cannot.
        spawned: names of the entities that other programs have added.

    >>> control = RunControl()
    >>> control.may_step
    True
    """

    state: int = STATE_PLAYING
    steps: int = 0
    stepped: Callable[[bool], None] | None = None
    begun: Trial | None = None
    restart: Trial | None = None
    restarted: Callable[[str], None] | None = None
    spawned: list[str] = field(default_factory=list)

    @property
    def may_step(self) -> bool:
        """Whether a step is allowed: playing, or steps were asked for while paused."""
        return self.state == STATE_PLAYING or self.steps > 0

    @property
    def leaves(self) -> bool:
        """Whether the current run ends now."""
        return self.state == STATE_QUITTING or self.restart is not None

    def note_step(self) -> None:
        """Count a step that was asked for while paused, and answer after the last one."""
        if self.steps > 0:
            self.steps -= 1
            if self.steps == 0:
                self.finish_steps(True)

    def finish_steps(self, done: bool) -> None:
        """Answer the caller of the steps."""
        self.steps, answer, self.stepped = 0, self.stepped, None
        if answer is not None:
            answer(done)

    def finish_restart(self, problem: str = "") -> None:
        """Answer the caller of the restart."""
        self.restart, answer, self.restarted = None, self.restarted, None
        if answer is not None:
            answer(problem)


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


MOST = 100_000
"""Largest number of latencies that are kept; the oldest are dropped."""


class LatencySummary(NamedTuple):
    """Latency of commands in real time.

    Fields:
        commands: number of commands that answered a step.
        median, p99: median and 99th percentile [s]; NaN without commands.
    """

    commands: int
    median: float
    p99: float


class CommandLatency:
    """Measures the real time between the messages of a step and the first command of a robot after them.

    Args:
        monotonic: source of real time [s].

    >>> latency = CommandLatency(iter([1.0, 1.004, 2.0, 2.01]).__next__)
    >>> for _ in range(2):
    ...     latency.note_step()
    ...     latency.note_command("robot")
    >>> [round(value, 4) for value in latency.summary()]
    [2, 0.007, 0.0099]
    """

    def __init__(self, monotonic: Callable[[], float] = time.monotonic) -> None:
        self.monotonic = monotonic
        self._begin = 0.0
        self._answered: set[str] | None = None
        self._found: deque[float] = deque(maxlen=MOST)

    def note_step(self) -> None:
        """Note that the messages of a step are sent now."""
        self._begin, self._answered = self.monotonic(), set()

    def note_command(self, robot: str) -> None:
        """Note a command of a robot; only the first one after a step counts."""
        if self._answered is not None and robot not in self._answered:
            self._answered.add(robot)
            self._found.append(self.monotonic() - self._begin)

    def summary(self) -> LatencySummary:
        """Return the number of commands, median and 99th percentile."""
        found = np.array(self._found)
        if not len(found):
            return LatencySummary(0, float("nan"), float("nan"))
        return LatencySummary(len(found), float(np.median(found)), float(np.percentile(found, 99)))
