"""Sizes of the benchmark of environments."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core import InputError


@dataclass(frozen=True)
class BenchmarkSizes:
    """Numbers of environments, steps, episodes and repetitions.

    Fields:
        repeats: timed repetitions after a warm-up.
        environments: environments E of a batch.
        steps: steps of a batch of 10 people; twice as many with 50.
        single_steps: steps of a single environment.
        peer_worlds: worlds of navground per repetition.
        episodes: episodes to their end, ours and in navground.
        block: episodes that are simulated together.
        slow_episodes: episodes to their end in ir-sim.
        trial_environments: environments of each built-in trial, beside a single one.
        trial_steps: steps of each built-in trial.
        trials: largest number of built-in trials.

    Raises:
        InputError: a number is below 1.

    >>> BenchmarkSizes(environments=64).steps
    100
    """

    repeats: int = 5
    environments: int = 256
    steps: int = 100
    single_steps: int = 100
    peer_worlds: int = 64
    episodes: int = 1000
    block: int = 250
    slow_episodes: int = 4
    trial_environments: int = 64
    trial_steps: int = 20
    trials: int = 1000

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value < 1:
                raise InputError(f"{name.replace('_', ' ')} {value} is below 1")

    @classmethod
    def quick(cls, repeats: int = 1) -> BenchmarkSizes:
        """Return sizes that take seconds and only show that everything works."""
        return cls(repeats, 4, 4, 4, 2, 2, 2, 1, 2, 2, 2)
