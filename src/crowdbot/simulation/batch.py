"""Batch runs: one trial with many seeds in lockstep; each episode is bit-identical to a run of its seed alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from crowdbot.core import InputError, Scene
from crowdbot.trials import Trial, check_trial
from crowdbot.world import CrowdStepRequest, StepGenerator, compute_together

from .episode import Episode, EpisodeLog
from .runner import SimulationRun, catch_interrupt, warn_of_failure
from .simulation import Simulation

__all__ = ["run_batch"]


def run_batch(
    trial: Trial, seeds: Sequence[int], progress: Callable[[float], None] | None = None
) -> tuple[Episode, ...]:
    """Run a trial with several seeds and return the episodes in the order of the seeds.

    In each time step, the crowd model is called once for all active runs, whose scenes are the environments of one
    scene. Robots, contacts, sensors and bodies are computed per run. Models that are not built-in are called once per
    run. The first Ctrl-C ends all runs at their next recorded step.

    Args:
        trial: the trial, without sweeps.
        seeds: seeds of the runs.
        progress: called with the completed share, 0 to 1.

    Raises:
        InputError: the list of seeds is empty.
        TrialError: the trial is impossible with one of the seeds.

    >>> from crowdbot.trials import load_trial
    >>> from crowdbot.simulation import simulate
    >>> trial = load_trial("frontal", duration=2.0)
    >>> [episode.digest for episode in run_batch(trial, [3, 4])] == [simulate(trial, seed).digest for seed in (3, 4)]
    True
    """
    if not seeds:
        raise InputError("run_batch: seeds is empty; give at least one seed, such as range(8)")
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
    for running in runs:
        warn_of_failure(running.simulation)
    return tuple(
        log.episode(running.outcome or "interrupted", running.simulation.tick, running.failure)
        for log, running in zip(logs, runs, strict=True)
    )


def _step(steps: Sequence[StepGenerator[str | None]]) -> None:
    """Advance all runs by one step; their crowd requests are computed together."""
    asking = [(one, request) for one in steps if (request := _next(one, None)) is not None]
    while asking:
        answers = _compute([request for _, request in asking])
        asking = [
            (one, request)
            for (one, _), answer in zip(asking, answers, strict=True)
            if (request := _next(one, answer)) is not None
        ]


def _compute(requests: Sequence[CrowdStepRequest]) -> Sequence[Scene | Exception]:
    """Return the results; if the model raises, compute each request separately to find those that fail."""
    states = [request.rng.bit_generator.state for request in requests]
    try:
        return compute_together(requests)
    except Exception:  # raised again below, for the request that causes it
        for request, state in zip(requests, states, strict=True):
            request.rng.bit_generator.state = state
        return [_attempt(request) for request in requests]


def _attempt(request: CrowdStepRequest) -> Scene | Exception:
    try:
        return request.compute()
    except Exception as error:  # raised in the run of this request
        return error


def _next(one: StepGenerator[str | None], answer: Scene | Exception | None) -> CrowdStepRequest | None:
    """Return the next request of a step, or None at its end."""
    try:
        if isinstance(answer, Exception):
            return one.throw(answer)
        return next(one) if answer is None else one.send(answer)
    except StopIteration:
        return None
