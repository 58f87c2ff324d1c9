"""Out-of-distribution score of a person: no measured person walks as evenly, or as fast, as what the score marks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Floats

from .agent_frame import ROWS, AgentHistories

EVEN = (0.005, 0.015)
"""Deviation of a track from a straight line at constant speed [m]: even below the first, not even above the second."""
EVEN_SHARE = (0.1, 0.3)
"""Share of even tracks among the moving people of a window from which, and above which, all of them are foreign."""
FEWEST_EVEN = 3
"""Number of moving people in a window for which the share of even tracks counts."""
FAST = (1.6, 2.4)
"""Mean displacement in 0.4 s [m] from which, and above which, a person is foreign: 4 and 6 m/s."""
EQUAL = (0.0001, 0.0003)
"""Difference of the last displacements [m] below which a person is steady, and above which not at all."""
SLOW = 0.08
"""Displacement in 0.4 s below which a person does not count as moving [m]."""


def out_of_distribution(
    numbers: Mapping[str, NDArray[Any]], people: AgentHistories, window: NDArray[np.int64]
) -> Floats:
    """Return scores ``[N]`` between 0 (like the training data) and 1; 0 for the leave-one-out weights.

    Args:
        numbers: weights; those for other places have the array ``reach``.
        people: histories.
        window: ``[N]`` window of each person.

    The score is the largest of three: the speed above 4 m/s, the evenness of the person's track, and the share of even
    tracks in the window. No measured person walks in a straight line at constant speed to a few millimetres; simulated
    people do.
    """
    if "reach" not in numbers:
        return np.zeros(len(people.past))
    even, moves = _evenness(people)
    count = np.bincount(window, moves.astype(np.float64))
    share = np.bincount(window, np.where(moves, even, 0.0)) / np.maximum(count, 1.0)
    simulated = np.where(count >= FEWEST_EVEN, _ramp(share, *EVEN_SHARE), 0.0)
    fast = _ramp(np.hypot(*(people.past[:, -1] - people.past[:, 0]).T) / (ROWS - 1.0), *FAST)
    return np.asarray(np.max([even, simulated[window], fast], axis=0))


def steadiness(people: AgentHistories) -> Floats:
    """Return ``[N]``, between 0 and 1, whether the last three displacements of a person are equal, to 0.2 mm.

    Simulated people who walk or stand undisturbed do so, and people in some recordings whose tracks are interpolated or
    who stand. The last displacement then has no noise, and no learned correction is better on average.
    """
    change = np.diff(people.past[:, -4:], 2, axis=1)
    largest = np.sqrt(change[..., 0] ** 2 + change[..., 1] ** 2).max(axis=1)
    return np.where(people.seen[:, -4:].all(axis=1), 1.0 - _ramp(largest, *EQUAL), 0.0)


def _evenness(people: AgentHistories) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the evenness ``[N]`` of tracks of moving people, between 0 and 1, and who moves with all rows observed."""
    row = np.arange(ROWS) - 0.5 * (ROWS - 1)
    away = people.past - people.past.mean(axis=1, keepdims=True)
    step = (away * row[:, None]).sum(axis=1) / float((row * row).sum())
    rest = away - step[:, None] * row[:, None]
    deviation = np.sqrt((rest[..., 0] ** 2 + rest[..., 1] ** 2).mean(axis=1))
    moves = (np.hypot(step[:, 0], step[:, 1]) > SLOW) & people.seen.all(axis=1)
    return np.where(moves, 1.0 - _ramp(deviation, *EVEN), 0.0), moves


def _ramp(value: Floats, low: float, high: float) -> Floats:
    """Return 0 below ``low``, 1 above ``high`` and a smooth value between."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share))
