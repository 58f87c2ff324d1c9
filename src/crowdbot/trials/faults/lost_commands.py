"""LostCommands: commands that do not reach the drive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .fault import Fault


@dataclass(frozen=True)
class LostCommands(Fault):
    """Commands of the navigator that are lost: the one before stays in force.

    Fields:
        share: share of the commands that are lost, drawn from the seed.

    Raises:
        InputError: the share is not above 0 and at most 1.

    >>> LostCommands(share=0.3).share
    0.3
    """

    share: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 < self.share <= 1.0:
            raise InputError(f"share = {self.share:g} must be above 0 and at most 1")

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        """Return the names of the numbers."""
        return (*super().number_names(), "share")

    def lose_commands(self, numbers: NDArray[np.float64], shares: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which commands are lost, see :meth:`Fault.lose_commands`."""
        return shares < numbers[:, 2]
