"""Candidate velocities of VOG: a first set around the desired and the current velocity, then refinements."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Floats

SAMPLES = 48
"""Maximum number of samples per level."""
SLOW = 0.1
"""Below this speed [m/s] an agent samples all directions, and a chosen velocity counts as standing."""


def _turns(count: int, shift: float, round_: float) -> Floats:
    """Return sines and cosines in single precision, whose rounding decides if samples at right angles go backwards."""
    angle = (np.arange(count, dtype=np.float32) + np.float32(shift)) * np.float32(np.pi) * np.float32(2.0)
    angle = angle / np.float32(round_)
    return np.stack([np.sin(angle), np.cos(angle)]).astype(np.float64)


EIGHT, SIX, SIXTEEN = _turns(8, 0.0, 8.0), _turns(6, 0.5, 6.0), _turns(16, 0.0, 16.0)


@kernel
def sample_first(samples: Floats, vx: float, vy: float, px: float, py: float, radius: float) -> int:
    """Write the first samples (x, y, size); return their number."""
    speed = math.sqrt(vx * vx + vy * vy)
    scale = max(math.sqrt(px * px + py * py), speed)
    scale = 4.0 * radius if scale <= radius else scale
    _write_sample(samples, 0, px, py, 0.3 * scale)
    _write_sample(samples, 1, vx, vy, 0.3 * scale)
    for k in range(8):  # on the circle from 0 to v
        along, across = 0.5 * (1.0 + EIGHT[1, k]), 0.5 * EIGHT[0, k]
        size = (1.0 - abs(k - 4.0) / 8.0) * 0.5 * scale
        _write_sample(samples, 2 + k, vx * along + vy * across, vy * along - vx * across, size)
    for k in range(6):
        along, across = 0.5 + 0.3 * SIX[0, k], 0.3 * SIX[1, k]
        _write_sample(samples, 10 + k, vx * along + vy * across, vy * along - vx * across, 0.3 * scale)
        _write_sample(samples, 16 + k, vx + 0.2 * scale * SIX[1, k], vy + 0.2 * scale * SIX[0, k], 0.4 * scale)
    _write_sample(samples, 22, 0.5 * vx, 0.5 * vy, 0.4 * scale)
    if speed >= SLOW:
        return 23
    for k in range(16):
        _write_sample(samples, 23 + k, scale * SIXTEEN[0, k], scale * SIXTEEN[1, k], 0.5 * scale)
    for k in range(8):
        _write_sample(samples, 39 + k, 0.5 * scale * SIXTEEN[0, k], 0.5 * scale * SIXTEEN[1, k], 0.25 * scale)
    return 47


@kernel
def _write_sample(samples: Floats, at: int, x: float, y: float, size: float) -> None:
    samples[at, 0], samples[at, 1], samples[at, 2] = x, y, size


@kernel
def sample_around(samples: Floats, best: Floats) -> int:
    """Write four samples around each of the two best; return their number."""
    for k in range(2):
        x, y, size = best[k, 0], best[k, 1], best[k, 2]
        step, finer = 0.3 * size, 0.6 * size * size
        _write_sample(samples, 4 * k, x + step, y + step, finer)
        _write_sample(samples, 4 * k + 1, x - step, y + step, finer)
        _write_sample(samples, 4 * k + 2, x - step, y - step, finer)
        _write_sample(samples, 4 * k + 3, x + step, y - step, finer)
    return 8


@kernel
def keep_best(best: Floats, samples: Floats, k: int, score: float) -> None:
    """Update the two best samples with sample k; as in the original, a replaced best does not become second best."""
    if score > best[0, 3]:
        return
    at = 0 if score > best[1, 3] else 1
    best[at, 0], best[at, 1], best[at, 2], best[at, 3] = samples[k, 0], samples[k, 1], samples[k, 2], score
