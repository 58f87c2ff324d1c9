"""Functions that run a trial and record it, in memory or to a file."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

from crowdbot.core import Clock, InputError
from crowdbot.simulation import (
    Episode,
    EpisodeDigest,
    EpisodeLog,
    EpisodeStatistics,
    OrderSource,
    RunSummary,
    Simulation,
    SimulationRun,
    Sink,
    catch_interrupt,
    decision_times,
    run_to_end,
    simulate,
    warn_of_failure,
)
from crowdbot.trials import Trial, check_trial

from .episode_writer import Recorder

Progress = Callable[[float], None]
T = TypeVar("T", bound=EpisodeStatistics)


def run(
    trial: Trial,
    seed: int | None = None,
    out: Path | str | None = None,
    progress: Progress | None = None,
    clock: Clock | None = None,
    force: bool = False,
) -> Episode:
    """Run a trial; the order of a step is described in :mod:`crowdbot.simulation.simulation`.

    Contacts and arrivals are evaluated in every step; the run ends at the next recorded step. The first Ctrl-C ends the
    run at the next recorded step with the outcome ``interrupted``. A second one raises :class:`KeyboardInterrupt`; the
    file is then incomplete but readable, without at most the last second of simulated time.

    An exception in a navigator, sensor or crowd model also ends the run. The episode then has the outcome ``error`` and
    the exception in ``failure``, and a :class:`~crowdbot.simulation.RunFailureWarning` is issued.

    Args:
        trial: the trial.
        seed: random seed (default: the seed of the trial).
        out: file to record to, or a folder for ``episode.mcap``; the file can be read during the run.
        progress: called with the completed fraction, 0 to 1.
        clock: :class:`~crowdbot.core.PacedClock` for real time; None runs as fast as possible.
        force: whether an existing episode file may be overwritten.

    Raises:
        TrialError: the trial is impossible; the exception lists all problems, and nothing is written.
        InputError: ``out`` exists and ``force`` is false, or another run is writing to it.

    >>> from crowdbot.models import ORCA
    >>> episode = run(Trial(name="empty", duration=1.0, crowd=ORCA()))
    >>> episode.outcome, episode.steps, len(episode.times)
    ('finished', 20, 11)
    """
    if out is None:
        return simulate(trial, seed, progress, clock)
    log, outcome, simulation = _record(EpisodeLog, trial, seed, out, progress, clock, force)
    warn_of_failure(simulation)
    return log.episode(outcome, simulation.tick, simulation.failures[0], decision_times(simulation.robots))


def record(
    trial: Trial,
    seed: int | None = None,
    out: Path | str | None = None,
    progress: Progress | None = None,
    clock: Clock | None = None,
    force: bool = False,
    sources: Sequence[OrderSource] = (),
) -> RunSummary:
    """Run a trial like :func:`run`, but without arrays: memory does not grow with the duration.

    Args:
        trial, seed, out, progress, clock, force: see :func:`run`.
        sources: programs that steer the simulation.

    >>> from crowdbot.models import ORCA
    >>> record(Trial(name="empty", duration=1.0, crowd=ORCA())).outcome
    'finished'
    """
    tally, outcome, simulation = _record(EpisodeStatistics, trial, seed, out, progress, clock, force, sources)
    warn_of_failure(simulation)
    path = None if out is None else episode_path(out)
    return tally.summary(outcome, simulation.tick, path, simulation.failures[0])


def _record(
    kind: type[T],
    trial: Trial,
    seed: int | None,
    out: Path | str | None,
    progress: Progress | None,
    clock: Clock | None,
    force: bool,
    sources: Sequence[OrderSource] = (),
) -> tuple[T, str, Simulation]:
    chosen = trial.seed if seed is None else int(seed)
    check_trial(trial, chosen)
    tally = kind(trial, chosen, None if out is None else EpisodeDigest({}))
    simulation = Simulation(trial, chosen, clock)
    with contextlib.ExitStack() as stack:
        stop = stack.enter_context(catch_interrupt())
        sinks: list[Sink] = [tally]
        if out is None:
            return tally, run_to_end(simulation, sinks, stop, progress, sources=sources), simulation
        recorder = stack.enter_context(Recorder(episode_path(out), tally, force=force, simulation=simulation))
        outcome = run_to_end(simulation, [tally, recorder], stop, progress, sources=sources)
        recorder.complete(outcome, simulation.tick, simulation.failures[0])
        return tally, outcome, simulation


@contextlib.contextmanager
def open_run(
    trial: Trial,
    seed: int | None = None,
    out: Path | str | None = None,
    clock: Clock | None = None,
    sources: Sequence[OrderSource] = (),
    force: bool = False,
    sinks: Sequence[Sink] = (),
) -> Iterator[SimulationRun]:
    """Open a run that the caller advances; leaving the context before its end interrupts it.

    Args:
        trial, seed, out, clock, force: see :func:`run`.
        sources: programs that steer the simulation.
        sinks: further consumers of the step records.

    >>> from crowdbot.models import ORCA
    >>> with open_run(Trial(name="empty", duration=1.0, crowd=ORCA())) as running:
    ...     while running.outcome is None:
    ...         _ = running.step()
    >>> running.outcome
    'finished'
    """
    chosen = trial.seed if seed is None else int(seed)
    check_trial(trial, chosen)
    tally = EpisodeStatistics(trial, chosen, None if out is None else EpisodeDigest({}))
    with contextlib.ExitStack() as stack:
        takers: list[Sink] = [tally, *sinks]
        recorder, simulation = None, Simulation(trial, chosen, clock)
        if out is not None:
            recorder = stack.enter_context(Recorder(episode_path(out), tally, force=force, simulation=simulation))
            takers.append(recorder)
        running = SimulationRun(simulation, takers, sources)
        yield running
        running.close()
        if recorder is not None:
            recorder.complete(running.outcome or "interrupted", running.simulation.tick, running.failure)


def episode_path(out: Path | str) -> Path:
    """Return the output file: ``out`` if its extension is .mcap, otherwise ``episode.mcap`` in it."""
    path = Path(out)
    file = path if path.suffix == ".mcap" else path / "episode.mcap"
    if file.is_dir():
        raise InputError(f"{file} is a folder; give a file name, or the folder for episode.mcap")
    if file.parent.exists() and not file.parent.is_dir():
        raise InputError(f"{file.parent} is a file; give a folder for the episode")
    return file
