"""One update of the policy by proximal policy optimisation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from crowdbot.prediction import torch_module

from .policy_network import PolicyNetwork
from .ppo_settings import PPOSettings
from .rollouts import PolicyRollout

__all__ = ["update_policy"]


def update_policy(
    network: PolicyNetwork,
    optimizer: Any,
    rollouts: Sequence[PolicyRollout],
    settings: PPOSettings,
    rng: np.random.Generator,
) -> dict[str, float]:
    """Change the network by some passes over the rollouts of all tasks; return the mean losses of the last pass.

    Each minibatch has the same share of every task, since tasks have different numbers of people.
    """
    torch = torch_module()
    tensors = [
        {name: torch.from_numpy(value.reshape(-1, *value.shape[2:])) for name, value in one._asdict().items()}
        for one in rollouts
    ]
    losses = np.zeros((settings.batches, 2))
    for _ in range(settings.epochs):
        parts = [np.array_split(rng.permutation(len(one["value"])), settings.batches) for one in tensors]
        for k in range(settings.batches):
            index = [torch.from_numpy(part[k]) for part in parts]
            batch = [{name: v[i] for name, v in one.items()} for one, i in zip(tensors, index, strict=True)]
            losses[k] = _step(network, optimizer, batch, settings)
    mean = losses.mean(axis=0)
    return {"policy_loss": float(mean[0]), "value_loss": float(mean[1])}


def _step(
    network: PolicyNetwork, optimizer: Any, batch: list[dict[str, Any]], settings: PPOSettings
) -> tuple[float, float]:
    """Take one step of the optimiser; return the losses of the policy and of the value."""
    torch = torch_module()
    pooled = torch.cat([network.pool(one["own"], one["people"], one["present"]) for one in batch])
    action, chance, before, advantage = (
        torch.cat([one[name] for one in batch]) for name in ("action", "chance", "value", "advantage")
    )
    mean, value = network.heads(pooled)
    spread = network.spread
    log = (-0.5 * ((action - mean) / spread.exp()) ** 2 - spread).sum(dim=1)
    ratio = (log - chance).exp()
    target = advantage + before
    scaled = (advantage - advantage.mean()) / (advantage.std() + 1e-6)
    near = ratio.clamp(1.0 - settings.clip, 1.0 + settings.clip)
    policy_loss = -torch.minimum(ratio * scaled, near * scaled).mean()
    value_loss = 0.5 * ((value - target) ** 2).mean()
    optimizer.zero_grad(set_to_none=True)
    (policy_loss + settings.value * value_loss).backward()
    torch.nn.utils.clip_grad_norm_(list(network.layers.values()), settings.gradient)
    optimizer.step()
    with torch.no_grad():
        spread.clamp_(min=float(np.log(settings.least_spread)))
    return float(policy_loss.detach()), float(value_loss.detach())
