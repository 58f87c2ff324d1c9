"""Run: from a trial and a seed to an episode, in memory and as a file; free, or stepped from outside."""

from __future__ import annotations

import contextlib
import signal
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from types import FrameType
from typing import Protocol, TypeVar

from crowdbot.core import Clock, ExternalClock, InputError, MissingExtra
from crowdbot.sensors import Reading
from crowdbot.trials import Mount, RobotSpec, Trial, check_trial
from crowdbot.world import StepGenerator, run_step

from .episode import Episode, EpisodeLog
from .failure import RunFailure, RunFailureWarning
from .simulation import Simulation, StepRecord
from .statistics import EpisodeStatistics

__all__ = [
    "Bridge",
    "SimulationRun",
    "Sink",
    "StopRequest",
    "catch_interrupt",
    "run_to_end",
    "simulate",
    "warn_of_failure",
]

Progress = Callable[[float], None]
Measured = tuple[tuple[RobotSpec, Mount, Reading], ...]
T = TypeVar("T", bound=EpisodeStatistics)


class Sink(Protocol):
    """Something that is told what is recorded, as it happens."""

    def take(self, frame: StepRecord) -> None:
        """Take an instant."""


class Bridge(Protocol):
    """Something that passes on what happens, and may steer robots: ROS, a headset, a program of yours."""

    def exchange(self, simulation: Simulation, readings: Measured) -> None:
        """Pass on a step, with what was measured now; commands go to :meth:`Simulation.ask`."""


class StopRequest:
    """Whether somebody asked the run to stop."""

    asked: bool = False


@dataclass
class SimulationRun:
    """A run that is stepped from outside.

    Args:
        simulation: at tick 0 with nothing sensed yet, or later, where another run has left it.
        sinks: who is told what is recorded.
        bridges: who is told every step.
        ticks: it is interrupted after so many steps; None: it is not.

    Attributes:
        outcome: how it ended, None while it goes on; ``error`` after an exception in the code of a model, sensor,
            navigator or bridge.
        failure: that exception.

    >>> from crowdbot.models import ORCA
    >>> clock = ExternalClock(0.05)
    >>> running = SimulationRun(Simulation(Trial(name="empty", duration=1.0, crowd=ORCA()), 0, clock))
    >>> running.until(520_000_000)
    10
    >>> running.until(7_000_000_000), running.outcome
    (10, 'finished')
    """

    simulation: Simulation
    sinks: Sequence[Sink] = ()
    bridges: Sequence[Bridge] = ()
    ticks: int | None = None
    stop: StopRequest = field(default_factory=StopRequest)
    outcome: str | None = field(default=None, init=False)
    _every: int = field(init=False)

    def __post_init__(self) -> None:
        self._every = self.simulation.world.clock.every(self.simulation.trial.recording.period)
        if not self.simulation.begun:
            self.simulation.begun = True
            self._observe()
        elif self.simulation.tick % self._every == 0:
            self.outcome = _outcome(self.simulation)

    def step(self) -> str | None:
        """Go one step on, parts 1 to 8 of the order, and return the outcome when this was the last.

        Raises:
            InputError: it has ended before.
        """
        return run_step(self.step_requests())

    def step_requests(self) -> StepGenerator[str | None]:
        """Go one step on as :meth:`step` does, and ask somebody else how the crowd walks."""
        if self.outcome is not None:
            raise InputError(f"the run has ended ({self.outcome}) at {self.simulation.world.clock.time:g} s")
        try:
            yield from self.simulation.step_requests()
        except MissingExtra:
            raise
        except Exception as error:  # the code of a model may raise anything
            self._fail(error)
            return self.outcome
        self._observe()
        return self.outcome

    def until(self, nanoseconds: int) -> int:
        """Do every step that an external time [ns] makes due, and return how many; none once it has ended.

        Raises:
            InputError: time ran backwards.
        """
        clock = self.simulation.world.clock
        due = clock.due(nanoseconds) if isinstance(clock, ExternalClock) else nanoseconds // clock.step_ns - clock.tick
        for done in range(due):
            if self.outcome is not None:
                return done
            self.step()
        return max(0, due)

    def _observe(self) -> None:
        """Do what follows a step: sense, decide, pass on, record; this may be the last recorded instant."""
        simulation = self.simulation
        readings: Measured = ()
        try:
            readings = simulation.sense()
            simulation.decide()
            for bridge in self.bridges:
                bridge.exchange(simulation, readings)
        except MissingExtra:
            raise
        except Exception as error:  # the code of sensors, navigators and bridges may raise anything
            self._fail(error)
        due = simulation.tick % self._every == 0
        if due and self.outcome is None:
            stopped = self.stop.asked or (self.ticks is not None and simulation.tick >= self.ticks)
            self.outcome = _outcome(simulation) or ("interrupted" if stopped else None)
        if due or readings or simulation.eventful:
            frame = simulation.frame(readings, due, last=self.outcome is not None)
            for sink in self.sinks:
                sink.take(frame)

    @property
    def failure(self) -> RunFailure | None:
        """The exception that ended the run."""
        return self.simulation.failure

    def _fail(self, error: Exception) -> None:
        simulation = self.simulation
        simulation.failure = RunFailure.of(error, simulation.world.clock.time, simulation.trial.folder)
        self.outcome = "error"


def simulate(
    trial: Trial,
    seed: int | None = None,
    progress: Progress | None = None,
    clock: Clock | None = None,
) -> Episode:
    """Run a trial in memory; see :func:`crowdbot.recording.run`, which can record to a file too.

    Raises:
        TrialError: the trial is impossible; every problem is named.

    >>> from crowdbot.models import ORCA
    >>> simulate(Trial(name="empty", duration=1.0, crowd=ORCA())).outcome
    'finished'
    """
    chosen = trial.seed if seed is None else int(seed)
    check_trial(trial, chosen)
    log = EpisodeLog(trial, chosen)
    simulation = Simulation(trial, chosen, clock)
    with catch_interrupt() as stop:
        outcome = run_to_end(simulation, [log], stop, progress)
    warn_of_failure(simulation)
    return log.episode(outcome, simulation.tick, simulation.failure)


def warn_of_failure(simulation: Simulation) -> None:
    """Issue a :class:`RunFailureWarning` if an exception ended the run."""
    if simulation.failure is not None:
        sentence = f"trial {simulation.trial.name!r} ended with an error: {simulation.failure}"
        warnings.warn(sentence, RunFailureWarning, stacklevel=3)


def run_to_end(
    simulation: Simulation,
    sinks: Sequence[Sink],
    stop: StopRequest,
    progress: Progress | None = None,
    ticks: int | None = None,
) -> str:
    """Run a simulation to its end, tell the sinks, and return the outcome.

    Args:
        simulation: at tick 0, or later where somebody else left it.
        sinks: who is told.
        stop: asked from outside.
        progress: called with the share that is done.
        ticks: stop after as many steps, as an interrupted run did; None runs on.
    """
    total = simulation.trial.ticks
    running = SimulationRun(simulation, sinks, ticks=ticks, stop=stop)
    told = -1
    while running.outcome is None:
        running.step()
        share = simulation.tick * 100 // total
        if progress is not None and share > told:
            told = share
            progress(min(1.0, simulation.tick / total))
    if progress is not None and running.outcome != "interrupted":
        progress(1.0)
    return running.outcome


def _outcome(simulation: Simulation) -> str | None:
    """Return how the run has ended, None while it goes on."""
    end, event = simulation.trial.end, simulation.event
    if (event == "collision" and end.collision) or (event == "success" and end.goal):
        return event
    if simulation.ended is not None:
        return simulation.ended
    if simulation.tick < simulation.trial.ticks:
        return None
    return event or ("timeout" if simulation.carriers else "finished")


@contextlib.contextmanager
def catch_interrupt() -> Iterator[StopRequest]:
    """Turn the first Ctrl-C into ``stop.asked``, so that no step and no file is torn; a second one interrupts.

    Outside the main thread, where Python delivers no signals, it changes nothing.
    """
    stop = StopRequest()
    if threading.current_thread() is not threading.main_thread():
        yield stop
        return
    before = signal.getsignal(signal.SIGINT)

    def ask(number: int, frame: FrameType | None) -> None:
        if stop.asked:
            raise KeyboardInterrupt
        stop.asked = True

    signal.signal(signal.SIGINT, ask)
    try:
        yield stop
    finally:
        signal.signal(signal.SIGINT, before)
