"""Posing and skinning people, timed."""

from __future__ import annotations

from .measurement import Measurement

__all__ = ["posing_and_skinning"]

PEOPLE, OFTEN, ALLOWED = 100, 100, 0.01
"""Number of people, repeats per work, and reference time of one repeat [s]."""


def posing_and_skinning() -> Measurement:
    """Return the work of posing 100 walkers and deforming their skins at the lowest level of detail.

    >>> posing_and_skinning().reference
    10000.0
    """
    from crowdbot import humans

    work = humans.posing_and_skinning(PEOPLE, level=2)
    words = f"{PEOPLE} people in {1000 * ALLOWED:.0f} ms"
    return Measurement("people/s", PEOPLE * OFTEN, lambda: [work() for _ in range(OFTEN)], words, PEOPLE / ALLOWED)
