"""Crowds that are made for the tests of the calibration room."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.calibration import ResimulatedTracks, Resimulation, Rollout
from crowdbot.core import Paper, PerAgent, Scene, parameter, per_agent, stream
from crowdbot.data import Windows
from crowdbot.models import CrowdModel, CurrentDirection


@dataclass(frozen=True)
class Drifting(CrowdModel):
    """Everyone keeps a share of the desired velocity and is pushed sideways by everyone else's nearness."""

    paper: ClassVar[Paper] = Paper("Nobody", 2020, "Drifting", "Nowhere")
    share: PerAgent = parameter(1.0, unit="1", low=0.2, high=2.0, source="test")
    push: PerAgent = parameter(0.0, unit="1/s", low=0.0, high=1.0, source="test")

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> np.ndarray:
        share, push = per_agent(self.share, scene.shape), per_agent(self.push, scene.shape)
        away = scene.position[:, :, None] - scene.position[:, None, :]
        near = np.exp(-np.sum(away**2, axis=-1)) * (scene.active[:, None, :] & scene.active[:, :, None])
        pushed = np.sum(away * near[..., None], axis=2) * push[..., None] * scene.radius[..., None]
        return scene.desired_velocity(dt) * share[..., None] + pushed


@dataclass(frozen=True)
class Shy(CrowdModel):
    """Everyone walks to the goal and is pushed away by who is nearer than ``space`` and their radii."""

    paper: ClassVar[Paper] = Paper("Nobody", 2020, "Shyness", "Nowhere")
    strength: PerAgent = parameter(0.0, unit="1/s", low=0.0, high=4.0, source="test")
    space: PerAgent = parameter(1.0, unit="m", low=0.2, high=3.0, source="test")

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> np.ndarray:
        away = scene.position[:, :, None] - scene.position[:, None, :]
        distance = np.sqrt(np.sum(away**2, axis=-1))
        both = scene.active[:, None, :] & scene.active[:, :, None] & ~np.eye(scene.shape[1], dtype=bool)
        space = per_agent(self.space, scene.shape)[..., None] + scene.radius[:, None, :] + scene.radius[..., None]
        near = np.where(both, np.maximum(0.0, space - distance), 0.0) / np.maximum(distance, 1e-9)
        push = np.sum(away * near[..., None], axis=2) * per_agent(self.strength, scene.shape)[..., None]
        return scene.desired_velocity(dt) + push


def windows(W: int = 3, T: int = 6, A: int = 5, seed: int = 0) -> Windows:
    """People who walk about; agent 1 is a robot, agent 2 comes late, agent 3 leaves early, one row has a hole."""
    rng = stream(seed, "rollout")
    step = rng.normal(0.0, 0.3, (W, 1, A, 2)) + rng.normal(0.0, 0.05, (W, T, A, 2))
    position = rng.uniform(-1.0, 1.0, (W, 1, A, 2)) + np.cumsum(step, axis=1)
    present = np.ones((W, T, A), dtype=bool)
    present[:, :3, 2] = False
    present[:, 4:, 3] = False
    present[0, 2, 0] = False
    present[-1, :, 4] = False
    robot = np.tile(np.arange(A) == 1, (W, 1))
    return Windows(
        np.where(present[..., None], position, 0.0), present, np.zeros((W, A), bool), robot,
        np.tile(np.arange(A), (W, 1)), np.tile(np.arange(T), (W, 1)), 0.4, "all", "made",
    )  # fmt: skip


def shy_crowd(truth: Shy, radius: float = 0.3, W: int = 8, A: int = 6) -> Windows:
    """Windows of people who meet in the middle of a circle, walking as ``truth`` says."""
    rng = stream(4, "shy")
    T = 8
    angle = np.arange(A) * 2.0 * np.pi / A + rng.normal(0.0, 0.1, (W, A))
    out = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    aim = -(out + rng.normal(0.0, 0.1, out.shape)) * rng.uniform(1.0, 1.4, (W, A, 1))
    position = np.zeros((W, T, A, 2))
    position[:, 0], position[:, 1] = 4.0 * out, 4.0 * out + 0.4 * aim  # nobody is near anybody in the first step
    everyone, nobody = np.ones((W, T, A), dtype=bool), np.zeros((W, A), dtype=bool)
    frame, id = np.tile(np.arange(T), (W, 1)), np.tile(np.arange(A), (W, 1))
    begun = Windows(position, everyone, nobody, nobody, id, frame, 0.4, "all", "made")
    position[:, 1:] = resimulate(begun, truth, radius=radius).once[0]
    return begun


def resimulate(past: Windows, model: CrowdModel, radius: float = 0.25, substep: float = 0.1) -> ResimulatedTracks:
    """What one crowd makes of all windows."""
    rollout = Rollout(model, CurrentDirection(), radius, substep=substep)
    return Resimulation(rollout, past).resimulate(
        lambda rollout, scene, copies: (rollout, scene), 1, np.arange(len(past))
    )
