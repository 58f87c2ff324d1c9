"""Parameters at and beyond the ends of their boxes, and crowds that cannot be, for tests of models."""

from __future__ import annotations

import dataclasses

import numpy as np
from model_crowds import PILLAR, ROOM, SCREEN, crowd

from crowdbot.core import parameters


def extreme(kind, rng: np.random.Generator, **more):
    """Return a model whose parameters are each at the end of its box, the smallest allowed, or huge."""
    values = {
        row.name: float(rng.choice([row.default, row.low, row.high, row.min, 1e9]))
        for row in parameters(kind)
        if row.name != "max_neighbors"
    }
    return kind(**values, **more)


def heaped(rng: np.random.Generator):
    """Return a crowd some of whom share a place, overlap, stand in walls or have their goal there."""
    scene = crowd(int(rng.integers(1 << 30)), A=12, width=3.0, walls=(ROOM, PILLAR, SCREEN, [(1.0, 0.0), (2.0, 0.0)]))
    place, velocity, goal = scene.position.copy(), scene.velocity.copy(), scene.goal.copy()
    place[0, :3] = place[0, 0]
    velocity[0, 1] = velocity[0, 0]
    velocity[0, 3:5] = 0.0
    place[0, 5], place[0, 6], place[0, 7] = PILLAR[0], SCREEN[1], (1.5, 0.0)
    goal[0, 8:10] = (0.8, 0.8), place[0, 9]
    group = np.broadcast_to(rng.integers(-1, 3, 12), (1, 12))
    return dataclasses.replace(scene, position=place, velocity=velocity, goal=goal, group=group)


def assert_bounded(model, scene, dt, limit=None) -> None:
    """Check that three steps are finite and no faster than allowed."""
    for _ in range(3):
        chosen = model.velocity(scene, dt)
        assert np.all(np.isfinite(chosen))
        speed = np.hypot(chosen[..., 0], chosen[..., 1])
        assert np.all(speed <= (scene.max_speed if limit is None else limit) * (1.0 + 1e-9) + 1e-12)
        scene = model.step(scene, dt)
