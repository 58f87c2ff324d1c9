"""CurrentDirection: goal estimator that assumes that people keep their current direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, check_parameters, parameter
from crowdbot.data import Windows, steady_velocity
from crowdbot.typing import Floats

from .goal import Goal
from .headings import extrapolate


@dataclass(frozen=True)
class CurrentDirection(Goal):
    """Goal far ahead in the direction of the last steps.

    Args:
        steps: number of last steps over which the velocity is averaged; fewer after a gap.
        horizon: distance of the goal as time at that velocity [s]; long enough that the goal is not reached.
        adaptive: adapt the averaging to the noise of the tracks, see
            :func:`crowdbot.data.motion.steady_velocity`; requires ``steps`` = 1.

    The goal of people observed only at the last step is their position.

    Raises:
        InputError: ``steps`` is below 1 or combined with ``adaptive``, or ``horizon`` is not positive.
    """

    steps: int = 1
    horizon: float = parameter(20.0, unit="s", low=5.0, high=60.0, source="crowdbot", min=0.1)
    adaptive: bool = False

    def __post_init__(self) -> None:
        check_parameters(self)
        if self.steps < 1:
            raise InputError(f"current-direction: steps {self.steps} is not allowed, it must be at least 1")
        if self.adaptive and self.steps != 1:
            raise InputError(f"current-direction: steps {self.steps} and adaptive cannot be combined; give one of them")

    def resolve(self, past: Windows) -> Floats:
        return extrapolate(past.position[:, -1], past.present[:, -1], self.velocity(past), self.horizon)

    def velocity(self, past: Windows) -> Floats:
        if self.adaptive:
            return steady_velocity(past)
        here = past.present[:, -1]
        last = past.position[:, -1]
        first, count = last.copy(), np.zeros(here.shape)
        going = here.copy()
        for back in range(1, min(self.steps, past.present.shape[1] - 1) + 1):
            going &= past.present[:, -1 - back]
            first[going] = past.position[:, -1 - back][going]
            count += going
        return (last - first) / (np.maximum(count, 1.0) * past.dt)[..., None]
