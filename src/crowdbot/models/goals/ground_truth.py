"""The goal that people will be at: for evaluation only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core.errors import InputError
from crowdbot.data.windows import Windows

from .goal import Goal

__all__ = ["GroundTruth"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class GroundTruth(Goal):
    """The last place where each person is seen in the future; for evaluation only.

    It tells how much of an error comes from not knowing the goals. Whoever is not seen in the future stays.

    Args:
        future: the windows to be predicted, with the same people as the past.

    Raises:
        InputError: past and future do not hold the same people.
    """

    knows_future: ClassVar[bool] = True
    future: Windows

    def resolve(self, past: Windows) -> Floats:
        """Return the goals ``[W, A, 2]`` [m]; 0 for people who are not present at the last observed step."""
        if past.id.shape != self.future.id.shape or not np.array_equal(past.id, self.future.id):
            raise InputError(
                f"ground-truth: the past has people {list(past.id.shape)} and the future {list(self.future.id.shape)};"
                " both must be cut from the same recording with the same windows"
            )
        goal = np.where(past.present[:, -1, :, None], past.position[:, -1], 0.0)
        for step in range(self.future.present.shape[1]):
            seen = self.future.present[:, step] & past.present[:, -1]
            goal[seen] = self.future.position[:, step][seen]
        return goal
