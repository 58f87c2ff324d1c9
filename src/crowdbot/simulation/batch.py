"""Batch: one trial with many seeds at once; every run is that of its seed alone, to the last bit."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from crowdbot.core import InputError, Scene
from crowdbot.trials import Trial, check_trial
from crowdbot.world import CrowdStepRequest, StepGenerator, compute_together

from .episode import Episode, EpisodeLog
from .runner import SimulationRun, catch_interrupt
from .simulation import Simulation

__all__ = ["run_batch"]


def run_batch(
    trial: Trial, seeds: Sequence[int], progress: Callable[[float], None] | None = None
) -> tuple[Episode, ...]:
    """Run a trial with several seeds in step with each other, and return their episodes in the order of the seeds.

    In each step of time the crowd model is asked once for all runs that go on: their scenes are the environments of one
    scene. Everything else of a run (robots, contacts, sensors, bodies) is its own. A model that is not built in is
    asked for each run alone. The first Ctrl-C ends all runs at their next recorded instant.

    Args:
        trial: without sweeps.
        seeds: of the runs.
        progress: called with the share that is done, 0 to 1.

    Raises:
        InputError: there is no seed.
        TrialError: the trial is impossible with one of the seeds.

    >>> from crowdbot.trials import load_trial
    >>> trial = load_trial("frontal", duration=2.0)
    >>> [episode.digest for episode in run_batch(trial, [3, 4])] == [trial.run(seed).digest for seed in (3, 4)]
    True
    """
    if not seeds:
        raise InputError("run_batch: there are no seeds; give at least one, such as range(8)")
    for seed in seeds:
        check_trial(trial, int(seed))
    logs = [EpisodeLog(trial, int(seed)) for seed in seeds]
    with catch_interrupt() as stop:
        runs = [SimulationRun(Simulation(trial, log.seed), [log], stop=stop) for log in logs]
        told = -1
        while going := [running for running in runs if running.outcome is None]:
            _step([running.step_requests() for running in going])
            share = max(running.simulation.tick for running in going) * 100 // trial.ticks
            if progress is not None and share > told:
                told = share
                progress(min(1.0, share / 100.0))
    return tuple(
        log.episode(running.outcome or "interrupted", running.simulation.tick)
        for log, running in zip(logs, runs, strict=True)
    )


def _step(steps: Sequence[StepGenerator[str | None]]) -> None:
    """Let all go one step, their questions answered together."""
    asking = [(one, next(one)) for one in steps]
    while asking:
        answers = compute_together([walk for _, walk in asking])
        asking = [
            (one, walk)
            for (one, _), answer in zip(asking, answers, strict=True)
            if (walk := _next(one, answer)) is not None
        ]


def _next(one: StepGenerator[str | None], answer: Scene) -> CrowdStepRequest | None:
    """Return the next question of a step, None when it is done."""
    try:
        return one.send(answer)
    except StopIteration:
        return None
