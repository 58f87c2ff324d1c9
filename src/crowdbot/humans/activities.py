"""Names of the activities of people."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, UnknownName

ACTIVITIES = (
    "walk", "talk", "phone", "bottle", "text", "sit", "wave", "carry", "read", "stick", "pram", "wheelchair", "run",
    "look", "signal-wait", "signal-proceed",
)  # fmt: skip
"""``walk`` includes standing and turning. All activities except ``sit`` combine with walking. ``pram`` and
``wheelchair`` push one, ``look`` turns the head to the nearest robot, ``signal-wait`` and ``signal-proceed`` are the
gestures that tell a robot to wait, or to go first."""
FIRST_POSE = 6
"""Index of the first activity whose pose is put over that of the gait."""
TALK, PHONE, BOTTLE, TEXT, SIT = 1, 2, 3, 4, 5


def activity_index(
    activity: str | Sequence[str] | NDArray[np.int64], count: int, known: Sequence[str] = ACTIVITIES
) -> NDArray[np.int64]:
    """Return indices ``[N]`` into the ``known`` activities, from one name for all people or a name (or index) for each.

    Raises:
        UnknownName: there is no such activity.
        InputError: the number of names differs from ``count``, or an index is out of range.

    >>> activity_index(["walk", "sit"], 2).tolist(), activity_index("phone", 2).tolist()
    ([0, 5], [2, 2])
    """
    if isinstance(activity, np.ndarray) and activity.dtype.kind in "iu":
        result = activity.astype(np.int64)
    else:
        words = [activity] * count if isinstance(activity, str) else list(activity)
        for word in words:
            if word not in known:
                raise UnknownName("activity", str(word), known)
        result = np.array([list(known).index(word) for word in words], dtype=np.int64)
    if result.shape != (count,):
        raise InputError(f"{len(result)} activities are given for {count} people; give one, or one for each")
    if np.any((result < 0) | (result >= len(known))):
        raise InputError(
            f"activity index {result[(result < 0) | (result >= len(known))][0]} must be from 0 to {len(known) - 1}"
        )
    return result
