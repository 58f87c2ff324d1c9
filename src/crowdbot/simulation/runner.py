"""Runs of a trial in memory, to the end."""

from __future__ import annotations

import contextlib
import signal
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from types import FrameType

from crowdbot.core import Clock, TrialError
from crowdbot.trials import Trial, check_trial

from .decision_timer import decision_times
from .episode import Episode
from .episode_log import EpisodeLog, EpisodeLogs
from .external_robots import has_own_source, warn_of_missing_source
from .failure import RunFailure, RunFailureWarning
from .simulation import Simulation
from .simulation_run import OrderSource, SimulationRun, Sink, StopRequest
from .variant_template import VariantTemplate

Progress = Callable[[float], None]


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
    return log.episode(outcome, simulation.tick, simulation.failures[0], decision_times(simulation.robots))


def simulate_seeds(trial: Trial, seeds: Sequence[int], progress: Progress | None = None) -> tuple[Episode, ...]:
    """Run a trial with several seeds as environments of one simulation, and return the episodes in their order.

    Each episode is bit-identical to a run of its seed alone. The first Ctrl-C ends all runs at their next
    recorded step.

    Args:
        trial: the trial, without sweeps.
        seeds: seeds of the runs.
        progress: called with the completed share, 0 to 1.

    Raises:
        InputError: the list of seeds is empty.
        TrialError: the trial is impossible with one of the seeds.

    >>> from crowdbot.trials import load_trial
    >>> trial = load_trial("frontal", duration=2.0)
    >>> [one.digest for one in simulate_seeds(trial, [3, 4])] == [simulate(trial, seed).digest for seed in (3, 4)]
    True
    """
    warn_of_missing_source(trial, ())
    if has_own_source(trial) and len(seeds) > 1:  # a program outside drives one run at a time
        return _one_by_one([trial] * len(seeds), seeds)
    simulation = _checked_simulation(trial, [int(seed) for seed in seeds])
    return _episodes(simulation, [EpisodeLog(trial, int(seed)) for seed in seeds], progress)


def _one_by_one(trials: Sequence[Trial], seeds: Sequence[int]) -> tuple[Episode, ...]:
    """Run each trial alone, one after the other."""
    episodes: list[Episode] = []
    for trial, seed in zip(trials, seeds, strict=True):
        episodes += [simulate(trial, int(seed))]
        if episodes[-1].outcome == "interrupted":
            raise KeyboardInterrupt
    return tuple(episodes)


def _episodes(
    simulation: Simulation, logs: Sequence[EpisodeLog], progress: Progress | None = None
) -> tuple[Episode, ...]:
    """Run all environments to their ends and return their episodes."""
    trial = simulation.trial
    with catch_interrupt() as stop:
        run = SimulationRun(simulation, [EpisodeLogs(logs)], stop=stop)
        told = -1
        while run.outcome is None:
            if 2 * run.ends.count(None) <= run.simulation.count:
                run.drop_inactive()
            run.step()
            share = int(run.simulation.ticks.max()) * 100 // trial.ticks
            if progress is not None and share > told:
                told = share
                progress(min(1.0, share / 100.0))
    ends = [end for end in run.ends if end is not None]
    for log, end in zip(logs, ends, strict=True):
        warn_of_failure_in(log.trial, end.failure)
    return tuple(log.episode(*end) for log, end in zip(logs, ends, strict=True))


def simulate_variants(trials: Sequence[Trial], seeds: Sequence[int]) -> tuple[Episode, ...]:
    """Run variants of a trial as environments of one simulation, and return the episodes in their order.

    Each episode is bit-identical to a run of its variant alone. Ctrl-C as in :func:`simulate_seeds`.

    Args:
        trials: variants of the same shape, see :class:`VariantTemplate`.
        seeds: seed of each variant.

    Raises:
        InputError: the variants differ in their shape, or there is not one seed for each.
        TrialError: a variant is impossible with its seed.

    >>> from crowdbot.trials import apply_values, load_trial
    >>> trial = load_trial("frontal", duration=2.0)
    >>> variants = [apply_values(trial, {"robot/goal/x": x}) for x in (3, 4)]
    >>> [one.digest for one in simulate_variants(variants, [1, 1])] == [simulate(one, 1).digest for one in variants]
    True
    """
    if any(map(has_own_source, trials)) and len(trials) > 1:
        return _one_by_one(trials, seeds)
    for trial, seed in zip(trials, seeds, strict=False):
        check_trial(trial, int(seed))
        warn_of_missing_source(trial, ())
    simulation = Simulation(VariantTemplate(trials), seeds)
    return _episodes(simulation, [EpisodeLog(trial, int(seed)) for trial, seed in zip(trials, seeds, strict=True)])


def _checked_simulation(trial: Trial, seeds: Sequence[int]) -> Simulation:
    """Return the simulation of a trial after its check; only the placement of people depends on the seed.

    Raises:
        InputError: the list of seeds is empty.
        TrialError: the trial is impossible with one of the seeds.
    """
    for seed in seeds[:1]:
        check_trial(trial, seed)
    try:
        return Simulation(trial, seeds)
    except TrialError:
        for seed in seeds[1:]:
            check_trial(trial, seed)
        raise


def warn_of_failure(simulation: Simulation) -> None:
    """Issue a :class:`RunFailureWarning` if an exception ended the first environment."""
    warn_of_failure_in(simulation.trial, simulation.failures[0], 1)


def warn_of_failure_in(trial: Trial, failure: RunFailure | None, levels: int = 0) -> None:
    """Issue a :class:`RunFailureWarning` if an exception ended a run of the trial."""
    if failure is not None:
        sentence = f"trial {trial.name!r} ended with an error: {failure}"
        warnings.warn(sentence, RunFailureWarning, stacklevel=3 + levels)


def run_to_end(
    simulation: Simulation,
    sinks: Sequence[Sink],
    stop: StopRequest,
    progress: Progress | None = None,
    ticks: int | None = None,
    sources: Sequence[OrderSource] = (),
) -> str:
    """Run a simulation of one environment to its end and return the outcome.

    Args:
        simulation: a new simulation, or one that another run has advanced.
        sinks: receive every step record.
        stop: ends the run at the next recorded step when set.
        progress: called with the completed share, 0 to 1.
        ticks: interrupt the run after this number of steps (default: no limit).
        sources: programs that steer the simulation.
    """
    total = simulation.trial.ticks
    warn_of_missing_source(simulation.trial, sources, 1)
    running = SimulationRun(simulation, sinks, sources, ticks=ticks, stop=stop)
    told = -1
    while (outcome := running.outcome) is None:
        running.step()
        share = simulation.tick * 100 // total
        if progress is not None and share > told:
            told = share
            progress(min(1.0, simulation.tick / total))
    if progress is not None and outcome != "interrupted":
        progress(1.0)
    return outcome


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
