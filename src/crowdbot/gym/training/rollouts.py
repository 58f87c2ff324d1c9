"""Rollouts: steps of the policy in the environments of several tasks, with advantages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.gym.crowd_task import CrowdTask
from crowdbot.prediction import torch_module

from .policy_network import PolicyNetwork
from .ppo_settings import PPOSettings

__all__ = ["FIRST_SEED", "Counts", "PolicyRollout", "TaskRunner", "to_speeds"]

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

FIRST_SEED = 2**30
"""Smallest seed of an episode in a training; smaller ones are free for tests."""


class PolicyRollout(NamedTuple):
    """T steps of E environments of one task: inputs, actions and their estimates, as ``[T, E, ...]``."""

    own: Singles
    people: Singles
    present: Singles
    action: Singles
    chance: Singles
    """Logarithm of the probability density of the action."""
    value: Singles
    advantage: Singles


class Counts:
    """Number of ended episodes by their outcome."""

    def __init__(self) -> None:
        self.outcomes: dict[str, int] = {}

    def add(self, outcomes: Sequence[str]) -> None:
        """Count the episodes that have ended."""
        for outcome in outcomes:
            if outcome:
                self.outcomes[outcome] = self.outcomes.get(outcome, 0) + 1

    def share(self, outcome: str) -> float:
        """Return the share of an outcome; 0 without episodes."""
        return self.outcomes.get(outcome, 0) / max(1, sum(self.outcomes.values()))


def to_speeds(action: Singles, turn: Singles) -> Floats:
    """Return shares of the maximum speed in the frame of the robot ``[N, 2]``, at most 1.

    Args:
        action: ``[N, 2]`` shares in the goal frame.
        turn: ``[N, 2]`` cosine and sine of the goal frame from the heading.
    """
    wish = action.astype(np.float64)
    x, y = (wish / np.maximum(1.0, np.hypot(wish[:, 0], wish[:, 1]))[:, None]).T
    cos, sin = turn.T.astype(np.float64)
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=1)


class TaskRunner:
    """Runs the policy in the environments of one task.

    Args:
        task: the task.
        environments: number of environments.
        rng: random numbers of the episodes and actions of a round.
    """

    def __init__(self, task: CrowdTask, environments: int, rng: np.random.Generator) -> None:
        self.task, self.rng, self.environments = task, rng, environments
        self.now = task.reset(self._seeds(environments))

    def _seeds(self, count: int) -> list[int]:
        return self.rng.integers(FIRST_SEED, 2 * FIRST_SEED, count).tolist()  # type: ignore[no-any-return]

    def run(self, network: PolicyNetwork, settings: PPOSettings, counts: Counts) -> PolicyRollout:
        """Return the steps until the next update; ended episodes begin again."""
        T, E, rows = settings.steps, self.environments, list[tuple[Any, ...]]()
        reward, end, cut = np.zeros((T, E), np.float32), np.zeros((T, E), np.bool_), np.zeros((T, E), np.float32)
        spread = np.exp(network.spread.detach().numpy())
        for t in range(T):
            seen = self.now
            mean, value = self._estimate(network, seen)
            noise = self.rng.standard_normal((E, 2)).astype(np.float32)
            action = mean + spread * noise
            chance = -0.5 * (noise**2).sum(axis=1) - np.log(spread).sum()
            found = self.task.step(to_speeds(action, seen["turn"]))
            self.now, reward[t], end[t] = found.observations, found.rewards, found.terminated | found.truncated
            if found.truncated.any():
                cut[t] = np.where(found.truncated, self._estimate(network, self.now)[1], 0.0)
            if end[t].any():
                counts.add(found.outcomes)
                again = np.flatnonzero(end[t])
                self.now = self.task.restart(again, self._seeds(len(again)))
            rows.append((seen["own"], seen["people"], seen["present"], action, chance, value))
        columns = [np.stack(column).astype(np.float32) for column in zip(*rows, strict=True)]
        last = self._estimate(network, self.now)[1]
        advantage = advantages(reward + settings.discount * cut, end, columns[5], last, settings)
        return PolicyRollout._make([*columns, advantage])

    def _estimate(self, network: PolicyNetwork, seen: dict[str, Singles]) -> tuple[Singles, Singles]:
        torch = torch_module()
        with torch.no_grad():
            own, people, present = (torch.from_numpy(seen[name]) for name in ("own", "people", "present"))
            mean, value = network.heads(network.pool(own, people, present))
        return mean.numpy(), value.numpy()


def advantages(
    reward: Singles, end: NDArray[np.bool_], value: Singles, last: Singles, settings: PPOSettings
) -> Singles:
    """Return the generalised advantage estimates ``[T, E]``; ``last`` is the value after the last step.

    Source: Schulman et al. 2016, https://arxiv.org/abs/1506.02438.
    """
    found, running, after = np.zeros_like(reward), np.zeros_like(last), last
    for t in reversed(range(len(reward))):
        going = np.where(end[t], 0.0, 1.0).astype(np.float32)
        delta = reward[t] + settings.discount * going * after - value[t]
        running = delta + settings.discount * settings.trace * going * running
        found[t], after = running, value[t]
    return found
