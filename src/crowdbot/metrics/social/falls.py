"""Fall metrics: people who fall in the physics world, and how hard their heads hit the floor."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Protocol

PULSE = 690.0
"""Peak acceleration of a head that hits a hard floor per impact speed [1/s]. Hajiaghamemar et al. 2015,
doi:10.1007/s10439-015-1255-1: 95 % of 107 standing falls of dummies have 2.02 to 7.41 m/s and 146 to 502 g, which is
709 and 665 1/s."""
HALF_SINE = 0.4146
"""HIC of a half sine of peak A [g] and duration T [s] in relation to ``A^2.5 T``: the best window is 0.68 T long."""
HIC15_LIMIT = 700.0
"""Largest HIC15 of the dummy of an average man in frontal crash tests (49 CFR 571.208)."""
GRAVITY = 9.81

FALL_METRICS: dict[str, tuple[str, str]] = {
    "falls": ("1", "number of people who fell in the physics world"),
    "robot_caused_falls": ("1", "falls after a push by this robot, also if other people passed it on"),
    "head_impacts_of_falls": ("1", "falls in which the head hit the floor"),
    "fall_head_speed": ("m/s", "maximum speed at which a head hit the floor in a fall, 0 without"),
    "fall_hic15": ("1", "maximum HIC15 of falls on a hard floor, 0 without head impact"),
    "fall_severity": ("1", "maximum HIC15 / 700 of the falls that this robot caused"),
}
"""Unit and definition of each key of :func:`fall_metrics`, in order; absent in the planar world."""


class FallOutcome(Protocol):
    """What the metrics read of a fall; :class:`crowdbot.world.Fall` and its record have it."""

    @property
    def head(self) -> float:
        """Speed of the head at the floor [m/s], 0 without impact."""

    @property
    def hic15(self) -> float:
        """Head injury criterion."""


def fall_hic15(speed: float) -> float:
    """Return HIC15 of a head that hits a hard floor at a speed [m/s].

    The acceleration is half a sine with the peak and the duration of :data:`PULSE`; Versace 1971,
    https://doi.org/10.4271/710881.

    >>> round(fall_hic15(2.91)), round(fall_hic15(0.0))
    (1131, 0)
    """
    return float(HALF_SINE * (PULSE * max(speed, 0.0) / GRAVITY) ** 2.5 * math.pi / PULSE)


def fall_metrics(falls: Iterable[FallOutcome], own: Iterable[FallOutcome]) -> dict[str, float]:
    """Return every metric of :data:`FALL_METRICS`.

    Args:
        falls: all falls of a run.
        own: those that the robot caused.

    >>> fall_metrics([], [])["falls"]
    0.0
    """
    every, caused = list(falls), list(own)
    return {
        "falls": float(len(every)),
        "robot_caused_falls": float(len(caused)),
        "head_impacts_of_falls": float(sum(item.head > 0.0 for item in every)),
        "fall_head_speed": max((item.head for item in every), default=0.0),
        "fall_hic15": max((item.hic15 for item in every), default=0.0),
        "fall_severity": max((item.hic15 for item in caused), default=0.0) / HIC15_LIMIT,
    }
