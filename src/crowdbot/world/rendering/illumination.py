"""Light and sky of a stage for the rasteriser."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.world.physics.stage import LightSource
from crowdbot.world.stage_appearance import StageAppearance

from .rasterizer import Illumination

__all__ = ["illumination"]

GRID = 1e-9
"""Step of directions: libraries differ in the last digit of a sine."""
SKIES = {
    "clear": ((1.05, 0.97, 0.84), (0.36, 0.42, 0.52), (0.62, 0.74, 0.88), (0.16, 0.36, 0.72), (0.35, 0.30, 0.20),
              (0.9, 0.56, 3.4), (1.0, 1.0, 1.0), 0.0),
    "cloudy": ((0.80, 0.77, 0.72), (0.46, 0.50, 0.56), (0.70, 0.77, 0.85), (0.28, 0.45, 0.70), (0.20, 0.18, 0.14),
               (1.0, 0.40, 3.0), (0.93, 0.94, 0.96), 0.04),
    "overcast": ((0.38, 0.38, 0.38), (0.62, 0.64, 0.67), (0.76, 0.78, 0.80), (0.58, 0.61, 0.65), (0.0, 0.0, 0.0),
                 (0.8, 0.30, 1.6), (0.72, 0.74, 0.77), 0.30),
    "dusk": ((0.85, 0.52, 0.28), (0.26, 0.26, 0.36), (0.90, 0.56, 0.36), (0.13, 0.17, 0.34), (0.55, 0.30, 0.12),
             (0.8, 0.45, 3.0), (0.62, 0.38, 0.36), 0.02),
}  # fmt: skip
"""Colour of the light, light from above, horizon, zenith, glow, clouds (share, lower limit, slope), their colour, and
the radius [m] of the edge of shadows."""


def illumination(appearance: StageAppearance, lights: tuple[LightSource, ...]) -> Illumination:
    """Return the light of a stage: daylight, or lamps with soft shadows straight below.

    >>> illumination(StageAppearance(), ()).sun.shape
    (4, 3)
    """
    light, above, horizon, zenith, glow, cloud, white, soft = SKIES[appearance.sky]
    flat = math.cos(appearance.sun_elevation)
    direction = (
        flat * math.cos(appearance.sun_heading),
        flat * math.sin(appearance.sun_heading),
        -math.sin(appearance.sun_elevation),
    )
    lamps = np.zeros((0, 4))
    if lights:
        lamps = np.array([(lamp.x, lamp.y, lamp.z, 0.9 * lamp.brightness) for lamp in lights])
        light, above, direction, soft = (0.22, 0.22, 0.21), (0.30, 0.30, 0.29), (0.02, 0.03, -1.0), 0.15
    elif appearance.sky == "overcast":
        direction = (0.12, 0.16, -1.0)
    rounded = np.round(np.array(direction) / GRID) * GRID
    rounded = rounded / math.sqrt(float(np.sum(rounded * rounded)))
    ground = 0.45 * np.array(above) * (1.0, 0.96, 0.9)
    return Illumination(
        np.array([rounded, light, above, ground]),
        np.array([horizon, zenith, glow, cloud, rounded, white]),
        lamps,
        soft,
        haze=140.0,
    )
