"""LocalizationJump: an error of the estimated pose that is drawn for each run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .fault import Fault


@dataclass(frozen=True)
class LocalizationJump(Fault):
    """A jump of the pose that the robot believes, by a normally distributed error that depends on the seed.

    At the end, the pose jumps back. People are seen relative to that pose, walls and goal are not.

    Fields:
        deviation: standard deviation of x and y [m].
        heading: standard deviation of the heading [rad].

    Raises:
        InputError: a standard deviation is negative.

    >>> LocalizationJump(deviation=0.5, begin=3.0).deviation
    0.5
    """

    deviation: float = 0.5
    heading: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("deviation", "heading"):
            if getattr(self, name) < 0.0:
                raise InputError(f"{name} = {getattr(self, name):g} must be at least 0")

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        """Return the names of the numbers."""
        return (*super().number_names(), "deviation", "heading")

    def shift_pose(self, numbers: NDArray[np.float64], draws: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the error, see :meth:`Fault.shift_pose`."""
        return draws * numbers[:, [2, 2, 3]]
