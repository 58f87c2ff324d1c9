"""Processor time of bridges, as measurements of ``crowdbot bench``."""

from __future__ import annotations

import functools
from collections.abc import Callable

from crowdbot.bridges import LOADED_BRIDGES, bridge_load

from .measurement import Gauge

__all__ = ["bridge_measurements"]

SHARE = 0.25
"""Largest processor time of a bridge over real time."""


def bridge_measurements() -> dict[str, Callable[[], Gauge]]:
    """Return functions that measure the processor time of bridges, by name.

    A bridge sends a scan of 1080 beams and an image of 640 x 480 pixels at 10 Hz, and odometry and transforms at
    20 Hz, to a viewer in another process. The simulation itself is not counted.

    >>> sorted(bridge_measurements())
    ['bridge-foxglove', 'bridge-rosbridge', 'bridge-rosbridge-cbor']
    """
    return {f"bridge-{name}": functools.partial(_load, name) for name in LOADED_BRIDGES}


def _load(name: str) -> Gauge:
    words = f"{100 * SHARE:g} % of a core: 1080 beams, 640 x 480 pixels at 10 Hz, odometry, tf"
    return Gauge("CPU s/s", bridge_load(name).share, words, SHARE)
