"""LocalizationOffset: a constant error of the estimated pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .fault import Fault


@dataclass(frozen=True)
class LocalizationOffset(Fault):
    """An error of the pose that the robot believes; people are seen relative to that pose, walls and goal are not.

    Fields:
        x, y: error of the position in the world [m].
        heading: error of the heading [rad].

    >>> LocalizationOffset(x=0.3).numbers()
    (0.0, 86400.0, 0.3, 0.0, 0.0)
    """

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        """Return the names of the numbers."""
        return (*super().number_names(), "x", "y", "heading")

    def shift_pose(self, numbers: NDArray[np.float64], draws: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the error, see :meth:`Fault.shift_pose`."""
        return numbers[:, 2:5]
