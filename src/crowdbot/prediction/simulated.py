"""A simulated crowd as a predictor: any crowd model, as given or calibrated on what was observed."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from crowdbot.calibration import (
    Calibrator,
    Cost,
    Fit,
    PopulationPrior,
    Rollout,
    Search,
    futures,
    resolve_cost,
    resolve_goal,
    resolve_model,
    resolve_search,
)
from crowdbot.data import Forecast, Windows
from crowdbot.models import ORCA, CrowdModel
from crowdbot.models.goals import CurrentDirection, Goal

from .predictor import Predictor, window_streams

__all__ = ["Simulated"]


@dataclass(frozen=True)
class Simulated(Predictor):
    """Everyone walks on as a crowd model says, all windows as one batch.

    People start with the velocity on which their goal is based (that of the last displacement, for the current
    direction) and prefer to keep its length; robots follow their plan when it is known, else they keep their velocity,
    and the others avoid them. Walls are those of the recording. K is
    1, unless the goal knows several destinations of a person.

    With a cost or a search it is a scheme: before it predicts, everyone's parameters are calibrated on the observed
    rows of each window. Windows in which nobody can be compared (one person alone and the distances between people as
    cost) keep the given parameters.

    Fields:
        model: a crowd model or its name; its own paper describes it.
        goal: where people want to go, or its name.
        cost, search: of the calibration, or their names; with one of them, the other is ``progressive``, ``genetic``.
        budget: how many whole crowds each window is calibrated with.
        free: names of the calibrated parameters; empty means all.
        prior: what is known of the parameters of a population.
        radius: of people [m].
        substep: longest time step of the simulation [s]; force models need 0.05 or less.

    Raises:
        InputError: a name is unknown or a number is not above 0; on predicting, the windows are in pixels.
    """

    model: CrowdModel | str = field(default_factory=ORCA)
    goal: Goal | str = field(default_factory=CurrentDirection)
    cost: Cost | str | None = None
    search: Search | str | None = None
    budget: int = 500
    free: tuple[str, ...] = ()
    prior: PopulationPrior | None = None
    radius: float = 0.25
    substep: float = 0.1

    def __post_init__(self) -> None:
        object.__setattr__(self, "model", resolve_model(self.model))
        object.__setattr__(self, "goal", resolve_goal(self.goal))
        if self.cost is not None or self.search is not None:
            object.__setattr__(self, "cost", resolve_cost(self.cost or "progressive"))
            object.__setattr__(self, "search", resolve_search(self.search or "genetic"))
            _ = self.calibrator  # says what is wrong
        _ = self.rollout

    @classmethod
    def of(cls, fit: Fit) -> Simulated:
        """Return the predictor of a crowd that was calibrated with shared parameters.

        Raises:
            InputError: everyone in the fit has parameters of their own.
        """
        rollout = fit.shared_rollout
        return cls(
            rollout.model,
            rollout.goal,
            radius=float(rollout.radius),
            substep=rollout.substep,
        )

    @property
    def rollout(self) -> Rollout:
        """The simulation behind it, before a calibration."""
        model, goal = cast(CrowdModel, self.model), cast(Goal, self.goal)
        return Rollout(model, goal, self.radius, None, self.substep)

    @property
    def calibrator(self) -> Calibrator | None:
        """What fits everyone's parameters before a prediction, or None."""
        if self.cost is None or self.search is None:
            return None
        return Calibrator(
            self.model, self.cost, self.search, self.goal, self.budget, False, tuple(self.free), self.prior,
            self.radius, self.substep,
        )  # fmt: skip

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where people will be, see :meth:`Predictor.predict`."""
        return self.follow(past, steps, samples, rng)[0]

    def follow(
        self,
        past: Windows,
        steps: int,
        samples: int = 1,
        rng: np.random.Generator | None = None,
        memory: Any = None,
    ) -> tuple[Forecast, Any]:
        """Return the forecast and the fit behind it; given the fit of the frame before, its values are tried early."""
        self.check(past, steps, samples)
        rngs = window_streams(rng, len(past))
        calibrator = self.calibrator
        if calibrator is None or past.position.shape[1] < 2:
            return self._forecast(self.rollout, past, steps, samples, rngs), memory
        fit = calibrator.fit_each(past, rngs, start=memory)
        return self._forecast(fit.rollout, past, steps, samples, rngs), fit

    def _forecast(
        self, rollout: Rollout, past: Windows, steps: int, samples: int, rngs: Sequence[np.random.Generator]
    ) -> Forecast:
        place, weight = futures(rollout, past, steps, samples, rngs)
        return dataclasses.replace(self.forecast(past, place), weight=weight)
