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
from crowdbot.typing import Bools, Floats

from .config import SocialWaysConfig
from .network import SceneInput

MOVED = 0.1
"""Minimum displacement for a heading [m]; below it, more rows are used."""
SPANS = (2, 4)
"""Numbers of displacements for the heading, tried in this order before all rows."""


@dataclass(frozen=True)
class AgentFrames:
    """Tracks of S scenes in agent frames.

    Fields:
        local: ``[S, T, A, 2]`` [m] positions in the frame of each person.
        origin: ``[S, A, 2]`` [m] origins of the frames, relative to ``centre``.
        turn: ``[S, A, 2]`` cosine and sine of their headings.
        centre: ``[S, 1, 2]`` [m] mean position of the people, for precision.
    """

    local: Floats
    origin: Floats
    turn: Floats
    centre: Floats

    def world(self, local: Floats) -> Floats:
        """Return positions ``[..., S, T, A, 2]`` [m] of these frames in the world."""
        cos, sin = self.turn[:, None, :, 0], self.turn[:, None, :, 1]
        x, y = local[..., 0], local[..., 1]
        turned = np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
        return turned + (self.origin + self.centre)[:, None]

    def own(self, world: Floats) -> Floats:
        """Return positions ``[S, T, A, 2]`` [m] of the world in these frames."""
        away = world - self.centre[:, None] - self.origin[:, None]
        cos, sin = self.turn[:, None, :, 0], self.turn[:, None, :, 1]
        x, y = away[..., 0], away[..., 1]
        return np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)


def agent_frames(past: Floats, here: Bools, frame: str, offset: Floats) -> AgentFrames:
    """Transform tracks ``[S, T, A, 2]`` [m] to agent frames; absent agents stay at 0.

    Args:
        past: complete observed tracks.
        here: mask of present agents ``[S, A]``.
        frame: ``person``: origin at the last position and x axis along the heading of each person; ``world``: origin at
            ``offset`` for all.
        offset: origin of the frame ``world``, ``[2]`` [m].
    """
    now = past[:, -1]
    if frame == "world":
        centre = np.broadcast_to(offset, (len(past), 1, 2))
        origin, turn = np.zeros_like(now), np.broadcast_to(np.array([1.0, 0.0]), now.shape)
    else:
        count = np.maximum(here.sum(axis=1), 1)[:, None, None]
        centre = np.sum(np.where(here[..., None], now, 0.0), axis=1, keepdims=True) / count
        origin, turn = np.where(here[..., None], now - centre, 0.0), headings(past)
    made = AgentFrames(past, origin, turn, centre)
    return AgentFrames(np.where(here[:, None, :, None], made.own(past), 0.0), origin, turn, centre)


def headings(past: Floats) -> Floats:
    """Return heading vectors ``[S, A, 2]`` of the last rows, or of more rows if a person hardly moved.

    The heading of people who did not move is +x.
    """
    rows = past.shape[1]
    found = np.zeros_like(past[:, -1])
    length = np.zeros(found.shape[:2])
    for span in (*SPANS, rows - 1):
        way = past[:, -1] - past[:, max(0, rows - 1 - span)]
        wanted = length < MOVED
        found = np.where(wanted[..., None], way, found)
        length = np.where(wanted, np.hypot(way[..., 0], way[..., 1]), length)
    still = length < 1e-9
    unit = found / np.where(still, 1.0, length)[..., None]
    return np.where(still[..., None], np.array([1.0, 0.0]), unit)


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
