"""Run: from a trial and a seed to an episode, in memory and as a file."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import FrameType
from typing import Protocol

from crowdbot.core import InputError

from .episode import Episode, Log
from .simulation import Frame, Simulation
from .trial import Trial

__all__ = ["Sink", "Stop", "drive", "run", "stopping"]

Progress = Callable[[float], None]


class Sink(Protocol):
    """Something that is told what is recorded, as it happens."""

    def take(self, frame: Frame) -> None:
        """Take an instant."""


class Stop:
    """Whether somebody asked the run to stop."""

    asked: bool = False


def run(
    trial: Trial, seed: int | None = None, out: Path | str | None = None, progress: Progress | None = None
) -> Episode:
    """Run a trial; see :mod:`crowdbot.trials.simulation` for the order of a step.

    Contacts and arrivals are judged in every step; the run then ends at the next recorded instant, so that instants
    are evenly spaced. The first Ctrl-C ends it there too: the episode so far has the outcome ``interrupted`` and is
    kept, in the file too. A second one raises :class:`KeyboardInterrupt` and leaves no file.

    Args:
        trial: what to run.
        seed: of everything random; None is the trial's own.
        out: file to record to, or a folder for ``episode.mcap``; it appears when it is complete.
        progress: called with the share of the duration that is done, 0 to 1.

    Raises:
        TrialError: the trial is impossible; every problem is named, and nothing is written.

    >>> from crowdbot.models import ORCA
    >>> episode = run(Trial(name="empty", duration=1.0, crowd=ORCA()))
    >>> episode.outcome, episode.steps, len(episode.times)
    ('finished', 20, 11)
    """
    chosen = trial.seed if seed is None else int(seed)
    trial.check(chosen)
    log = Log(trial, chosen)
    simulation = Simulation(trial, chosen)
    with contextlib.ExitStack() as stack:
        stop = stack.enter_context(stopping())
        if out is None:
            return log.episode(drive(simulation, [log], stop, progress), simulation.tick)
        from .recording import Recorder

        recorder = stack.enter_context(Recorder(_file(out), trial, chosen))
        episode = log.episode(drive(simulation, [log, recorder], stop, progress), simulation.tick)
        recorder.complete(episode)
        return episode


def drive(
    simulation: Simulation,
    sinks: Sequence[Sink],
    stop: Stop,
    progress: Progress | None = None,
    ticks: int | None = None,
) -> str:
    """Run a simulation to its end, tell the sinks, and return the outcome.

    Args:
        simulation: at tick 0.
        sinks: who is told.
        stop: asked from outside.
        progress: called with the share that is done.
        ticks: stop after as many steps, as an interrupted run did; None runs on.
    """
    total = simulation.trial.ticks
    every = simulation.world.clock.every(simulation.trial.recording.period)
    outcome = _observe(simulation, sinks, every, stop.asked or ticks == 0)
    told = -1
    while outcome is None:
        simulation.step()
        stopped = stop.asked or (ticks is not None and simulation.tick >= ticks)
        outcome = _observe(simulation, sinks, every, stopped)
        share = simulation.tick * 100 // total
        if progress is not None and share > told:
            told = share
            progress(min(1.0, simulation.tick / total))
    if progress is not None and outcome != "interrupted":
        progress(1.0)
    return outcome


def _observe(simulation: Simulation, sinks: Sequence[Sink], every: int, stopped: bool) -> str | None:
    """Do what follows a step: sense, decide, record; return the outcome when this was the last recorded instant."""
    readings = simulation.sense()
    simulation.decide()
    due = simulation.tick % every == 0
    outcome = (_outcome(simulation) or ("interrupted" if stopped else None)) if due else None
    if due or readings:
        frame = simulation.frame(readings, due)
        for sink in sinks:
            sink.take(frame)
    return outcome


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
def stopping() -> Iterator[Stop]:
    """Turn the first Ctrl-C into ``stop.asked``, so that no step and no file is torn; a second one interrupts.

    Outside the main thread, where Python delivers no signals, it changes nothing.
    """
    stop = Stop()
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


def _file(out: Path | str) -> Path:
    """Return the file to write: ``out`` itself when it is called .mcap, otherwise episode.mcap in it."""
    path = Path(out)
    file = path if path.suffix == ".mcap" else path / "episode.mcap"
    if file.is_dir():
        raise InputError(f"{file} is a folder; give the name of a file, or of the folder for episode.mcap")
    if file.parent.exists() and not file.parent.is_dir():
        raise InputError(f"{file.parent} is a file, so no episode can be written in it; give a folder")
    return file
