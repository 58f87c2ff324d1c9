"""Runs of a simulation, to its end or step by step."""

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
    """A consumer of step records."""

    def take(self, frame: StepRecord) -> None:
        """Process a step record."""


class Bridge(Protocol):
    """A connection to another program (ROS, a headset) that reads the simulation and may command robots."""

    def exchange(self, simulation: Simulation, readings: Measured) -> None:
        """Process a step and its new readings; send commands with :meth:`Simulation.ask`."""


class StopRequest:
    """A request to stop the run."""

    asked: bool = False


@dataclass
class SimulationRun:
    """A run that the caller advances step by step.

    Args:
        simulation: a new simulation, or one that another run has advanced.
        sinks: receive every step record.
        bridges: called in every step.
        ticks: interrupt the run after this number of steps (default: no limit).

    Attributes:
        outcome: None while the run continues; ``error`` after an exception in a model, sensor, navigator or bridge.
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
        """Advance one step (parts 1 to 8) and return the outcome, None if the run continues.

        Raises:
            InputError: the run has ended.
        """
        return run_step(self.step_requests())

    def step_requests(self) -> StepGenerator[str | None]:
        """Advance one step as :meth:`step`, and yield the requests to the crowd model."""
        if self.outcome is not None:
            raise InputError(f"the run has ended ({self.outcome}) at {self.simulation.world.clock.time:g} s")
        try:
            yield from self.simulation.step_requests()
        except MissingExtra:
            raise
        except Exception as error:  # crowd models may raise anything
            self._fail(error)
            return self.outcome
        self._observe()
        return self.outcome

    def until(self, nanoseconds: int) -> int:
        """Advance to an external time [ns] and return the number of steps.

        Raises:
            InputError: the time is earlier than the previous one.
        """
        clock = self.simulation.world.clock
        due = clock.due(nanoseconds) if isinstance(clock, ExternalClock) else nanoseconds // clock.step_ns - clock.tick
        for done in range(due):
            if self.outcome is not None:
                return done
            self.step()
        return max(0, due)

    def _observe(self) -> None:
        """Sense, decide, call bridges and record (parts 6 to 8)."""
        simulation = self.simulation
        readings: Measured = ()
        try:
            readings = simulation.sense()
            simulation.decide()
            for bridge in self.bridges:
                bridge.exchange(simulation, readings)
        except MissingExtra:
            raise
        except Exception as error:  # sensors, navigators and bridges may raise anything
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
    """Run a trial in memory; see :func:`crowdbot.recording.run`, which can also record to a file.

    Raises:
        TrialError: the trial is impossible; the exception lists all problems.

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
    """Run a simulation to its end and return the outcome.

    Args:
        simulation: a new simulation, or one that another run has advanced.
        sinks: receive every step record.
        stop: ends the run at the next recorded step when set.
        progress: called with the completed share, 0 to 1.
        ticks: interrupt the run after this number of steps (default: no limit).
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
    """Return the outcome, None while the run continues."""
    end, event = simulation.trial.end, simulation.event
    if (event == "collision" and end.collision) or (event == "success" and end.goal):
        return event
    if simulation.ended is not None:
        return simulation.ended
    if simulation.tick < simulation.trial.ticks:
        return None
    return event or ("timeout" if simulation.robots else "finished")


@contextlib.contextmanager
def catch_interrupt() -> Iterator[StopRequest]:
    """Set ``stop.asked`` at the first Ctrl-C, which ends the run; a second one interrupts immediately.

    No effect outside the main thread, since Python delivers no signals there.
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
