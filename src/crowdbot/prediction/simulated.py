"""Simulated: a crowd model as a predictor, with given or calibrated parameters."""

from __future__ import annotations

import dataclasses
import math
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
    TimeLimit,
    futures,
    resolve_cost,
    resolve_goal,
    resolve_model,
    resolve_search,
)
from crowdbot.core import InputError
from crowdbot.data import Forecast, Windows
from crowdbot.models import ORCA, CrowdModel, CurrentDirection, Goal

from .joint_futures import separate_people
from .predictor import Predictor, window_streams


@dataclass(frozen=True)
class Simulated(Predictor):
    """Simulates the observed people with a crowd model; all windows form one batch.

    The initial velocity is the one that the goal is based on (the last displacement, for the current direction); its
    magnitude is the preferred speed. Robots follow their plan if it is known, else they keep their velocity; people
    avoid them. Walls come from the recording. K = 1, unless the goal has several destinations per person.

    Crowd models let some people touch, above all between rows. Afterwards, those who come too close are moved apart as
    in :class:`.AnchorNet`, and paths that cross a wall stop there.

    With a cost or a search, the parameters of each person are calibrated on the observed rows of each window before
    the prediction. Windows without comparable people (one person, and a cost on distances between people) keep the
    given parameters.

    Fields:
        model: crowd model, or its name.
        goal: goals of people, or its name.
        cost: calibration cost, or its name; with a search only, the default is ``progressive``.
        search: calibration search, or its name; with a cost only, the default is ``genetic``.
        budget: number of simulated candidate crowds per window.
        free: names of the calibrated parameters; empty means all.
        prior: population prior of the parameters.
        radius: radius of people [m], where the windows have none; a calibration of the radius starts there.
        substep: maximum time step of the simulation [s]; force models require 0.05 or less.
        contact: minimum distance between the centres of people of a future, also between rows [m], where the windows
            have no radii; 0 is the crowd model alone.

    Raises:
        InputError: unknown name, or a value outside its range; in :meth:`predict`, windows in pixels.

    >>> from crowdbot.data import Trajectories
    >>> rows = range(20)
    >>> tracks = Trajectories([7] * 20, rows, [0.5 * row for row in rows], [0.0] * 20, row_rate=2.5)
    >>> past, _ = tracks.windows(observe=8, predict=12)
    >>> Simulated("orca").predict(past, steps=12).position[0, 0, -1].round(3).tolist()
    [[9.5, 0.0]]
    """

    batched = draws = True

    model: CrowdModel | str = field(default_factory=ORCA)
    goal: Goal | str = field(default_factory=CurrentDirection)
    cost: Cost | str | None = None
    search: Search | str | None = None
    budget: int = 500
    free: tuple[str, ...] = ()
    prior: PopulationPrior | None = None
    radius: float = 0.25
    substep: float = 0.1
    contact: float = 0.25

    def __post_init__(self) -> None:
        if not 0.0 <= self.contact < math.inf:
            raise InputError(f"simulated: contact = {self.contact} m must be finite and at least 0")
        object.__setattr__(self, "model", resolve_model(self.model))
        object.__setattr__(self, "goal", resolve_goal(self.goal))
        if self.cost is not None or self.search is not None:
            object.__setattr__(self, "cost", resolve_cost(self.cost or "progressive"))
            object.__setattr__(self, "search", resolve_search(self.search or "genetic"))
            _ = self.calibrator  # validates the fields
        _ = self.rollout

    @classmethod
    def of(cls, fit: Fit) -> Simulated:
        """Return the predictor with the shared parameters of a fit.

        Raises:
            InputError: the fit has individual parameters.
        """
        rollout = fit.shared_rollout
        return cls(
            rollout.model,
            rollout.goal,
            radius=float(rollout.radius),
            substep=rollout.substep,
        )

    @property
    def history(self) -> float:  # type: ignore[override]
        """Observed seconds that the goal reads; 0: it reads all rows."""
        return cast(Goal, self.goal).history

    @property
    def rollout(self) -> Rollout:
        """Simulation before any calibration."""
        model, goal = cast(CrowdModel, self.model), cast(Goal, self.goal)
        return Rollout(model, goal, self.radius, None, self.substep)

    @property
    def calibrator(self) -> Calibrator | None:
        """Calibrator that runs before each prediction, or None."""
        if self.cost is None or self.search is None:
            return None
        return Calibrator(
            self.model, self.cost, self.search, self.goal, self.budget, False, tuple(self.free), self.prior,
            self.radius, self.substep,
        )  # fmt: skip

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        return self.follow(past, steps, samples, rng)[0]

    def follow(
        self,
        past: Windows,
        steps: int,
        samples: int = 1,
        rng: np.random.Generator | None = None,
        memory: Any = None,
        limit: TimeLimit | None = None,
    ) -> tuple[Forecast, Any]:
        # forecast and its fit; the search starts from the previous fit, if given, and stops in time
        self.check(past, steps, samples)
        rngs = window_streams(rng, len(past))
        calibrator = self.calibrator
        if calibrator is None or past.position.shape[1] < 2:
            return self._forecast(self.rollout, past, steps, samples, rngs), memory
        fit = calibrator.fit_each(past, rngs, start=memory, limit=limit)
        return self._forecast(fit.rollout, past, steps, samples, rngs), fit

    def _forecast(
        self, rollout: Rollout, past: Windows, steps: int, samples: int, rngs: Sequence[np.random.Generator]
    ) -> Forecast:
        place, weight = futures(rollout, past, steps, samples, rngs)
        return dataclasses.replace(self.forecast(past, separate_people(past, place, self.contact)), weight=weight)
