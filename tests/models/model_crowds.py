"""Scenes that several tests of models use."""

from __future__ import annotations

import dataclasses

import numpy as np

from crowdbot.core import Scene

ROOM = [(-6.0, -6.0), (-6.0, 6.0), (6.0, 6.0), (6.0, -6.0)]  # clockwise: people are inside
PILLAR = [(0.5, 0.0), (1.5, 0.5), (1.0, 1.5), (0.0, 1.0)]
SCREEN = [(-3.0, -2.0), (-1.5, -3.5)]


def crowd(seed: int, A: int = 30, E: int = 1, width: float = 11.0, walls=(ROOM, PILLAR, SCREEN), **more) -> Scene:
    """Return people at random places of a room, on their way to random goals."""
    rng = np.random.default_rng(seed)
    velocity = rng.normal(0.0, 0.7, (E, A, 2))
    values = {
        "radius": rng.uniform(0.15, 0.3, (E, A)),
        "goal": rng.uniform(-0.5 * width, 0.5 * width, (E, A, 2)),
        "preferred_speed": rng.uniform(0.8, 1.6, (E, A)),
        "max_speed": 2.0,
        "walls": walls,
    } | more
    return Scene.of(rng.uniform(-0.5 * width, 0.5 * width, (E, A, 2)), velocity, **values)


def renumbered(scene: Scene, order) -> Scene:
    """Return the scene in which agent k is the old agent ``order[k]``."""
    arrays = {}
    for field in dataclasses.fields(scene):
        value = getattr(scene, field.name)
        if isinstance(value, np.ndarray):
            arrays[field.name] = value[:, order]
    return scene.replace(**arrays)


def moved(scene: Scene, walls, turn: float = 0.0, shift=(0.0, 0.0), mirror: bool = False) -> Scene:
    """Return the scene mirrored in the x axis, turned by ``turn`` [rad] about the origin, then shifted."""
    cos, sin = np.cos(turn), np.sin(turn)
    matrix = np.array([[cos, sin], [-sin, cos]])
    if mirror:
        matrix = np.array([[1.0, 0.0], [0.0, -1.0]]) @ matrix

    def placed(points):
        return np.asarray(points) @ matrix + shift

    rings = [placed(ring)[::-1] if mirror else placed(ring) for ring in walls]
    return Scene.of(
        placed(scene.position),
        scene.velocity @ matrix,
        goal=placed(scene.goal),
        radius=scene.radius,
        preferred_speed=scene.preferred_speed,
        max_speed=scene.max_speed,
        active=scene.active,
        visible=scene.visible,
        external=scene.external,
        walls=rings,
    )
