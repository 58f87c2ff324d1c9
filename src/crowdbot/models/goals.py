"""Goals: where the people of an observed window are taken to be walking."""

from __future__ import annotations

import abc
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core.errors import InputError
from crowdbot.core.parameter import check_parameters, parameter
from crowdbot.data.windows import Windows

__all__ = ["CurrentDirection", "Goal", "GroundTruth"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Goal(abc.ABC):
    """How the goals of people are guessed from what was observed of them."""

    knows_future: ClassVar[bool] = False
    """Whether it looks at what is to be predicted: then it is for evaluation only."""

    @abc.abstractmethod
    def resolve(self, past: Windows) -> Floats:
        """Return the goals ``[W, A, 2]`` [m]; 0 for people who are not present at the last observed step."""


@dataclass(frozen=True)
class CurrentDirection(Goal):
    """A point far ahead in the direction of the last steps.

    Args:
        steps: velocity is averaged over this many last steps, or as many as there are without a gap.
        horizon: how far ahead, in time at that velocity [s]; long enough not to be reached.

    Whoever was seen at the last step only stays there.

    Raises:
        InputError: ``steps`` is below 1, or ``horizon`` is not positive.
    """

    steps: int = 1
    horizon: float = parameter(20.0, unit="s", low=5.0, high=60.0, source="crowdbot", minimum=0.1)

    def __post_init__(self) -> None:
        check_parameters(self)
        if self.steps < 1:
            raise InputError(f"current-direction: steps {self.steps} is not allowed, it must be at least 1")

    def resolve(self, past: Windows) -> Floats:
        """Return the goals ``[W, A, 2]`` [m]; 0 for people who are not present at the last observed step."""
        here = past.present[:, -1]
        last = past.position[:, -1]
        first, count = last.copy(), np.zeros(here.shape)
        going = here.copy()
        for back in range(1, min(self.steps, past.present.shape[1] - 1) + 1):
            going &= past.present[:, -1 - back]
            first[going] = past.position[:, -1 - back][going]
            count += going
        velocity = (last - first) / (np.maximum(count, 1.0) * past.dt)[..., None]
        return np.where(here[..., None], last + velocity * self.horizon, 0.0)


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
