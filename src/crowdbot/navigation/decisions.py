"""Decisions: the output of a navigator in several environments."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError


def checked_joints(joints: Any, name: str) -> dict[str, float]:
    """Return the joint targets of a navigator, by the name of the joint.

    Raises:
        InputError: they are no mapping of texts to finite numbers; the message names the navigator.

    >>> checked_joints({"HeadYaw": 1}, "Shy")
    {'HeadYaw': 1.0}
    """
    if not isinstance(joints, Mapping):
        raise InputError(f"navigator {name} returned joints = {joints!r}; they must be a mapping of names to positions")
    result: dict[str, float] = {}
    for joint, position in joints.items():
        number = isinstance(position, int | float | np.floating | np.integer) and not isinstance(position, bool)
        if not isinstance(joint, str) or not number or not math.isfinite(position):
            raise InputError(
                f"navigator {name} returned the target {position!r} for joint {joint!r}; it must be a finite number"
            )
        result[joint] = float(position)
    return result


class Decisions(NamedTuple):
    """The decisions of a navigator in N environments.

    >>> decisions = Decisions.still([None, None])
    >>> decisions.twist.shape, decisions.failures
    ((2, 3), {})
    """

    twist: NDArray[np.float64]
    """``[N, 3]`` forward [m/s], turn [rad/s], left [m/s]; 0 where the decision failed."""
    memories: list[Any]
    """N next memories; the previous memory where the decision failed."""
    failures: dict[int, Exception]
    """Exception of each environment in which the decision failed, by index 0 to N - 1."""
    seconds: NDArray[np.float64]
    """``[N]`` compute time of each decision [s]; environments decided together share the time equally; 0 without a
    timer."""

    joints: list[Mapping[str, float]]
    """Target positions of joints in each environment; empty where the navigator gives none."""

    @classmethod
    def still(cls, memories: Sequence[Any]) -> Decisions:
        """Return decisions to stand still that keep the memories."""
        count = len(memories)
        return cls(np.zeros((count, 3)), list(memories), {}, np.zeros(count), [{}] * count)
