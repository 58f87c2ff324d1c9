"""Names of the activities of people."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, UnknownName

__all__ = ["ACTIVITIES", "activity_index"]

ACTIVITIES = ("walk", "talk", "phone", "bottle", "text", "sit")
"""``walk`` includes standing and turning. All activities except ``sit`` combine with walking."""
TALK, PHONE, BOTTLE, TEXT, SIT = 1, 2, 3, 4, 5


def activity_index(activity: str | Sequence[str] | NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return indices ``[N]`` into :data:`ACTIVITIES`, from one name for all people or a name (or index) for each.

    Raises:
        UnknownName: there is no such activity.
        InputError: the number of names differs from ``count``, or an index is out of range.

    >>> activity_index(["walk", "sit"], 2).tolist(), activity_index("phone", 2).tolist()
    ([0, 5], [2, 2])
    """
    if isinstance(activity, np.ndarray) and activity.dtype.kind in "iu":
        found = activity.astype(np.int64)
    else:
        words = [activity] * count if isinstance(activity, str) else list(activity)
        for word in words:
            if word not in ACTIVITIES:
                raise UnknownName("activity", str(word), ACTIVITIES)
        found = np.array([ACTIVITIES.index(word) for word in words], dtype=np.int64)
    if found.shape != (count,):
        raise InputError(f"{len(found)} activities are given for {count} people; give one, or one for each")
    if np.any((found < 0) | (found >= len(ACTIVITIES))):
        raise InputError(
            f"activity index {found[(found < 0) | (found >= len(ACTIVITIES))][0]} must be from 0 to"
            f" {len(ACTIVITIES) - 1}"
        )
    return found
