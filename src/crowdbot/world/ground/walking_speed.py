"""Walking speed on ramps and stairs."""

from __future__ import annotations

import numpy as np

from crowdbot.core import Scene
from crowdbot.typing import Floats

from .ground import Ground

LEVEL = 1.34
UPSTAIRS, DOWNSTAIRS = 0.610 / LEVEL, 0.694 / LEVEL
"""Horizontal speed on stairs over that on level ground: 0.610 m/s up, 0.694 m/s down and 1.34 m/s (U. Weidmann,
Transporttechnik der Fussgänger, IVT ETH Zürich, 1993)."""
STEEPNESS, BEST = 3.5, 0.05
"""Speed on a slope s is exp(-3.5 abs(s + 0.05)) (W. Tobler, Three presentations on geographical analysis and modeling,
NCGIA report 93-1, 1993). It is divided by the speed on level ground; nobody walks faster downhill."""
STRIDE = 0.7
"""Distance [m] over which the slope is measured: the length of a step, so that a threshold is no hill."""


def walking_speed_factor(ground: Ground, position: Floats, velocity: Floats) -> Floats:
    """Return the speed ``[...]`` of people relative to that on level ground, from 0 to 1.

    Args:
        ground: the ground.
        position: ``[..., 2]`` [m].
        velocity: ``[..., 2]``, of any length; it gives the direction.

    >>> from crowdbot.world.ground.part import GroundPart
    >>> ramp = Ground((GroundPart(0.0, 0.0, length=4.0, width=2.0, rear=0.0, front=0.4),))
    >>> walking_speed_factor(ramp, np.zeros((2, 2)), np.array([[1.0, 0.0], [-1.0, 0.0]])).round(3).tolist()
    [0.705, 1.0]
    """
    speed = np.sqrt(np.sum(velocity * velocity, axis=-1, keepdims=True))
    half = 0.5 * STRIDE * velocity / np.maximum(speed, 1e-9)
    rise = (ground.height(position + half) - ground.height(position - half)) / STRIDE
    factor = np.minimum(1.0, np.exp(-STEEPNESS * (np.abs(rise + BEST) - BEST)))
    _, stairs = ground.gradient(position)
    on_stairs = np.where(rise > 0.0, UPSTAIRS, np.where(rise < 0.0, DOWNSTAIRS, 1.0))
    return np.where(stairs, on_stairs, factor)


def slow_people(scene: Scene, ground: Ground) -> Scene:
    """Return the scene in which people on ramps and stairs have lower preferred and largest speeds."""
    factor = np.where(scene.external, 1.0, walking_speed_factor(ground, scene.position, scene.velocity))
    return scene.replace(preferred_speed=scene.preferred_speed * factor, max_speed=scene.max_speed * factor)
