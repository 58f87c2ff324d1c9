"""A simulated crowd as a predictor: any crowd model, started from what was observed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import cast

import numpy as np

from crowdbot.calibration import Fit, Rollout, named_goal, named_model
from crowdbot.data.forecast import Forecast
from crowdbot.data.windows import Windows
from crowdbot.models import ORCA, CrowdModel
from crowdbot.models.goals import CurrentDirection, Goal

from .predictor import Predictor

__all__ = ["Simulated"]


@dataclass(frozen=True)
class Simulated(Predictor):
    """Everyone walks on as a crowd model says, all windows as one batch.

    People start with the velocity of their last displacements and prefer to keep its length; robots go on with their
    velocity and the others avoid them. Walls are those of the recording. K = 1.

    Fields:
        model: a crowd model or its name; its own paper describes it.
        goal: where people want to go, or its name.
        radius: of people [m].
        substep: longest time step of the simulation [s]; force models need 0.05 or less.
        displacements: how many last displacements give the velocity.

    Raises:
        InputError: a name is unknown or a number is not above 0; on predicting, the windows are in pixels.
    """

    model: CrowdModel | str = field(default_factory=ORCA)
    goal: Goal | str = field(default_factory=CurrentDirection)
    radius: float = 0.25
    substep: float = 0.1
    displacements: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "model", named_model(self.model))
        object.__setattr__(self, "goal", named_goal(self.goal))
        self.rollout()  # says what is wrong with a number

    @classmethod
    def of(cls, fit: Fit) -> Simulated:
        """Return the predictor of a calibrated crowd."""
        rollout = fit.rollout
        return cls(rollout.model, rollout.goal, float(rollout.radius), rollout.substep, rollout.displacements)

    def rollout(self) -> Rollout:
        """Return the simulation behind it."""
        model, goal = cast(CrowdModel, self.model), cast(Goal, self.goal)
        return Rollout(model, goal, self.radius, self.substep, self.displacements)

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where people will be, see :meth:`Predictor.predict`."""
        self.check(past, steps, samples)
        return self.rollout().forecast(past, steps, self.name, rng)
