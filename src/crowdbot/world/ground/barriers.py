"""Barriers: edges and slopes of uneven ground that a walker or a robot cannot pass."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from crowdbot.typing import Floats

from .part import GroundPart

PEOPLE_STEP, PEOPLE_SLOPE = 0.25, 0.7
"""Largest step [m] and slope that people walk over (assumed; steps of stairs are 0.14 to 0.21 m high, EN 81-70 and
DIN 18065)."""
PIECE = 0.05
"""Largest length [m] of the pieces into which edges are cut."""
BESIDE = 1e-5
"""Distance [m] from an edge at which both heights are measured."""
SAME = 1e-6
"""Tolerance of heights [m] and slopes: a step of 2 cm is not above a limit of 2 cm."""


def barriers(
    parts: Sequence[GroundPart], height: Callable[[Floats], Floats], max_step: float, max_slope: float
) -> tuple[Floats, ...]:
    """Return lines ``[2, 2]`` along edges, and outlines ``[4, 2]`` of slopes, that cannot be passed [m].

    Args:
        parts: parts of the ground.
        height: returns the heights ``[N]`` [m] of points ``[N, 2]`` [m].
        max_step: largest step [m] that can be passed, up and down.
        max_slope: largest slope, as rise over length.

    >>> from crowdbot.world import Ground
    >>> kerb = Ground((GroundPart(0.0, 0.0, length=2.0, width=2.0, rear=0.12, front=0.12),))
    >>> len(barriers(kerb.parts, kerb.height, 0.25, 0.7)), len(barriers(kerb.parts, kerb.height, 0.02, 0.1))
    (0, 4)
    """
    steep = [part for part in parts if abs(part.slope) > max_slope + SAME]
    # the bevel of a threshold is no hill: a wheel that passes the step passes it
    found = [part.corners for part in steep if abs(part.front - part.rear) > max_step + SAME]
    seen: set[tuple[float, ...]] = set()
    for part in parts:
        corners = part.corners
        for k in range(4):
            for line in _blocked(height, corners[k], corners[(k + 1) % 4], max_step):
                one, two = sorted(np.round(line, 6).tolist())
                key = (*one, *two)
                if key not in seen:
                    seen.add(key)
                    found.append(line)
    return tuple(found)


def _blocked(height: Callable[[Floats], Floats], start: Floats, end: Floats, max_step: float) -> list[Floats]:
    """Return the pieces of an edge on which the height changes by more than a step."""
    along = end - start
    length = float(np.sqrt(along @ along))
    count = max(2, int(np.ceil(length / PIECE)))
    side = np.array([along[1], -along[0]]) / length * BESIDE
    middle = start + (np.arange(count)[:, None] + 0.5) / count * along
    jump = np.abs(height(middle + side) - height(middle - side))
    high = np.concatenate([[False], jump > max_step + SAME, [False]])
    begin, stop = np.flatnonzero(~high[:-1] & high[1:]), np.flatnonzero(high[:-1] & ~high[1:])
    return [np.array([start + a / count * along, start + b / count * along]) for a, b in zip(begin, stop, strict=True)]
