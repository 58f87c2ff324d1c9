"""PPOSettings: the numbers of a training by proximal policy optimisation."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core import InputError
from crowdbot.gym.reward import Reward

__all__ = ["PPOSettings"]

REWARD = Reward(success=1.0, collision=-1.0, discomfort_distance=0.2, discomfort=1.0, progress=0.1)


@dataclass(frozen=True)
class PPOSettings:
    """Settings of proximal policy optimisation.

    A round is a number of updates that begins with new episodes in all environments; its random numbers depend on the
    seed and on its number only. The learning rate falls linearly to 0 over all rounds.

    Fields:
        rounds: number of rounds.
        updates: number of updates in a round.
        steps: steps of each environment between two updates.
        epochs: passes over the steps in an update.
        batches: minibatches of a pass.
        learning_rate: at the beginning.
        discount: factor of the reward of the next step.
        trace: factor lambda of the generalised advantage estimate.
        clip: largest change of the probability ratio.
        value: weight of the loss of the value.
        gradient: largest norm of the gradient.
        spread: initial standard deviation of actions, as a share of the maximum speed.
        least_spread: smallest standard deviation.
        reward: terms of the reward.
        seed: random seed.

    Source: Schulman et al. 2017, https://arxiv.org/abs/1707.06347.

    Raises:
        InputError: a number is not allowed.

    >>> PPOSettings(rounds=2).steps
    16
    """

    rounds: int = 6
    updates: int = 16
    steps: int = 16
    epochs: int = 4
    batches: int = 8
    learning_rate: float = 1e-3
    discount: float = 0.99
    trace: float = 0.95
    clip: float = 0.2
    value: float = 0.5
    gradient: float = 0.5
    spread: float = 0.6
    least_spread: float = 0.1
    reward: Reward = REWARD
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("rounds", "updates", "steps", "epochs", "batches"):
            if getattr(self, name) < 1:
                raise InputError(f"{name} = {getattr(self, name)} must be at least 1")
        for name in ("learning_rate", "clip", "gradient", "spread", "least_spread"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"{name} = {getattr(self, name):g} must be above 0")
        for name in ("discount", "trace"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(f"{name} = {getattr(self, name):g} must be from 0 to 1")
