"""Inputs of the Social Ways network from tracks in metres, and their normalization."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from crowdbot.prediction.training.samples import Samples
from crowdbot.typing import Floats

from .agent_frames import AgentFrames, agent_frames
from .config import SocialWaysConfig
from .network import SceneInput

MOST = 2000
"""Maximum number of scenes for the normalization."""
LEAST = 1e-3
"""Minimum scale, for people who never move."""


@dataclass(frozen=True)
class Normalization:
    """Normalization, computed from the training data.

    Fields:
        position, velocity, distance: root mean squares: of observed positions in their frames [m], of velocities
            [m/s], and of distances to others [m].
        offset: center of the training data [m], the origin of the frame ``world``.
        dt: time step [s].
    """

    position: float
    velocity: float
    distance: float
    offset: tuple[float, float]
    dt: float

    @classmethod
    def of(cls, samples: Samples, config: SocialWaysConfig) -> Normalization:
        """Return the scales of training samples."""
        offset = samples.position[samples.there].mean(axis=0)
        some = samples.subsample(MOST)
        scenes = some.batch(np.arange(len(some)))
        past, here = scenes.position[:, : samples.observe], scenes.here
        local = agent_frames(past, here, config.frame, offset).local.swapaxes(1, 2)[here]  # [P, T, 2]
        velocity = np.diff(local, axis=1) / samples.dt
        now = past[:, -1]
        apart = np.hypot(*np.moveaxis(now[:, :, None] - now[:, None], -1, 0))
        pairs = here[:, :, None] & here[:, None] & ~np.eye(here.shape[1], dtype=bool)

        def size(values: Floats) -> float:
            return float(max(LEAST, np.sqrt(np.mean(values**2)))) if values.size else 1.0

        return cls(size(local), size(velocity), size(apart[pairs]), (float(offset[0]), float(offset[1])), samples.dt)

    @classmethod
    def read(cls, facts: Mapping[str, Any]) -> Normalization:
        """Return the scales of a checkpoint."""
        x, y = facts["offset"]
        return cls(facts["position"], facts["velocity"], facts["distance"], (x, y), facts["dt"])


def scene_input(
    past: Floats, here: NDArray[np.bool_], config: SocialWaysConfig, scales: Normalization, device: Any = "cpu"
) -> tuple[SceneInput, AgentFrames]:
    """Return the input of the generator for complete observed tracks ``[S, T, A, 2]`` [m], and the frames."""
    seen = agent_frames(past, here, config.frame, np.array(scales.offset))
    velocity = np.diff(seen.local[:, -2:], axis=1)[:, 0] / scales.dt

    def tensor(values: NDArray[Any]) -> Tensor:
        return torch.as_tensor(np.array(values, dtype=np.float32), device=device)  # a copy: some are views to read only

    mask = torch.as_tensor(here, device=device)
    state = tensor(states_of(seen.local, scales))
    return SceneInput(state, mask, *map(tensor, (seen.origin, seen.turn, velocity, seen.local[:, -1]))), seen


def states_of(local: Floats, scales: Normalization, before: Floats | None = None) -> Floats:
    """Return states ``[S, T, A, 4]`` of positions ``[S, T, A, 2]`` [m] in their frames.

    Args:
        local: positions.
        scales: normalization.
        before: ``[S, A, 2]`` [m] the position one row earlier; None repeats the first velocity.
    """
    whole = local if before is None else np.concatenate([before[:, None], local], axis=1)
    velocity = np.diff(whole, axis=1) / scales.dt
    if before is None:
        velocity = np.concatenate([velocity[:, :1], velocity], axis=1)
    return np.concatenate([local / scales.position, velocity / scales.velocity], axis=-1)
