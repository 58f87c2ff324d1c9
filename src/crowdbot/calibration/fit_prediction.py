"""Futures: samples of a prediction, each with one random destination per person."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene, parameters
from crowdbot.data import Windows
from crowdbot.typing import Floats

from .rollout import Rollout


def futures(
    rollout: Rollout, past: Windows, steps: int, samples: int, rngs: Sequence[np.random.Generator]
) -> tuple[Floats, Floats]:
    """Return up to ``samples`` futures ``[W, K, steps, A, 2]`` [m] and their weights ``[W, K]``.

    With one sample, or if nobody has more than one destination, K is 1 and all people go to their most probable
    destination. Otherwise destinations are drawn by their probabilities, independently for each person (systematic
    resampling). Identical futures are merged: the first one has their total weight, the others have weight 0.
    """
    choices = rollout.goal.choices(past) if samples > 1 else None
    if choices is None or choices.weight.shape[-1] < 2 or not np.any(past.present[:, -1:]):
        return rollout.predict_positions(past, steps)[:, None], np.ones((len(past), 1))
    W, A = past.present.shape[0], past.present.shape[2]
    chosen = np.stack(
        [_draw_destinations(weight, samples, rng) for weight, rng in zip(choices.weight, rngs, strict=True)], axis=1
    )
    weight = np.stack([_merge_weights(chosen[:, w]) for w in range(W)])
    goal = np.take_along_axis(choices.position[None], chosen[..., None, None], axis=3)[:, :, :, 0]
    copied = _repeat(rollout, samples)
    start = _base(rollout, past).environments(np.tile(np.arange(W), samples))
    here = start.active & ~start.external
    start = start.replace(goal=np.where(here[..., None], goal.reshape(samples * W, A, 2), start.goal))
    place = copied.run(start, past, steps).reshape(samples, W, steps, A, 2)
    return np.ascontiguousarray(np.swapaxes(place, 0, 1)), weight


def _base(rollout: Rollout, past: Windows) -> Scene:
    return rollout.scene(past, past.position.shape[1] - 1)


def _draw_destinations(weight: Floats, samples: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Return one destination for every sample and person ``[K, A]``, from their probabilities ``[A, G]``."""
    total = np.cumsum(weight, axis=1)
    place = (np.arange(samples)[:, None] + rng.random(len(weight))) / samples * np.maximum(total[:, -1], 1e-300)
    index = np.sum(place[..., None] >= total[None], axis=2)
    return np.asarray(rng.permuted(np.minimum(index, weight.shape[1] - 1), axis=0), dtype=np.int64)


def _merge_weights(chosen: NDArray[np.int64]) -> Floats:
    """Return the weight of each future ``[K]``; the first of identical futures has their total weight."""
    _, first, count = np.unique(chosen, axis=0, return_index=True, return_counts=True)
    weight = np.zeros(len(chosen))
    weight[first] = count / len(chosen)
    return weight


def _repeat(rollout: Rollout, copies: int) -> Rollout:
    """Return the rollout of ``copies`` of the windows; values ``[W, A]`` are repeated along E."""

    def repeat(value: object) -> object:
        return np.tile(value, (copies, 1)) if isinstance(value, np.ndarray) and value.ndim == 2 else value

    changed = {row.name: repeat(getattr(rollout.model, row.name)) for row in parameters(rollout.model)}
    return dataclasses.replace(rollout, model=dataclasses.replace(rollout.model, **changed))
