"""Speed of the built-in trials."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

from crowdbot.core import CrowdbotError
from crowdbot.simulation import Simulation
from crowdbot.trials import Trial, builtin_trials, expand_sweeps, load_trial

from .crossing import repeat_step
from .rows import TrialRate
from .sizes import BenchmarkSizes
from .work_rate import TimedWork, WorkRate, rates


def planar_trials() -> Iterator[tuple[str, Trial]]:
    """Yield the built-in trials in the planar world by name; of sweeps, their first trial."""
    for name in builtin_trials():
        trial = load_trial(name)
        first = expand_sweeps(trial)[0] if trial.sweeps else trial
        if first.world == "planar":
            yield name, first


def trial_rates(sizes: BenchmarkSizes, report: Callable[[str, float], None]) -> list[TrialRate]:
    """Return the speed of all built-in planar trials; ``report`` receives the progress."""
    trials = list(itertools.islice(planar_trials(), sizes.trials))
    rows = []
    for k, (name, trial) in enumerate(trials):
        report("built-in trials", k / len(trials))
        try:
            rows.append(_rate_of(name, trial, sizes))
        except CrowdbotError as error:
            rows.append(TrialRate(name, reason=str(error)))
    report("built-in trials", 1.0)
    return rows


def _rate_of(name: str, trial: Trial, sizes: BenchmarkSizes) -> TrialRate:
    single, _ = _measure(trial, 1, sizes.trial_steps)
    batch, agents = _measure(trial, sizes.trial_environments, sizes.trial_steps)
    return TrialRate(
        name, agents, single, batch, sizes.trial_environments, batch.per_cpu_second / single.per_cpu_second
    )


def _measure(trial: Trial, environments: int, steps: int) -> tuple[WorkRate, int]:
    """Return the steps of environments per second after a warm-up of two steps, and the agents at the start."""
    simulation = Simulation(trial, range(environments))
    agents = int(simulation.world.scene.active[0].sum())
    repeat_step(2)(simulation)
    work = TimedWork(environments * steps, lambda: simulation, repeat_step(steps))
    rate = rates({"ours": work}, repeats=1, warm_up=False)["ours"]
    failure = next((one for one in simulation.failures if one is not None), None)
    if failure is not None:
        raise CrowdbotError(f"an environment ended with an error: {failure}")
    return rate, agents
