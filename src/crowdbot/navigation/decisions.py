"""Decisions: the output of a navigator in several environments."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Decisions"]


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

    @classmethod
    def still(cls, memories: Sequence[Any]) -> Decisions:
        """Return decisions to stand still that keep the memories."""
        return cls(np.zeros((len(memories), 3)), list(memories), {}, np.zeros(len(memories)))
