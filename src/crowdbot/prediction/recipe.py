"""Recipe: a predictor that may have to be made for the recording it is used on."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass
from typing import cast

import numpy as np

from crowdbot.calibration import Calibrator, PopulationPrior, goal_for, kind_of_goal
from crowdbot.core import InputError, kebab_case, stream
from crowdbot.data import Recording, Windows
from crowdbot.models.goals import Goal

from .predictor import Predictor
from .simulated import Simulated

__all__ = ["Recipe"]

LEARNING_WINDOWS = 60
"""Priors and shared parameters are learned from about so many windows, evenly over the known part of a recording."""


@dataclass(frozen=True)
class Recipe:
    """How a predictor is made for a recording.

    Fields:
        predictor: what predicts.
        goal: name of the goal of a simulated crowd when it needs the recording: the true destinations (for evaluation
            only) or what is learned from a part of it; None leaves the predictor as it is.
        prior: whether a calibrated crowd learns its population prior from that part.
        shared: whether a calibrated crowd takes one set of parameters, fitted to that part, and fits nothing later.

    Raises:
        InputError: the goal is unknown, or the predictor cannot use what is asked for.
    """

    predictor: Predictor
    goal: str | None = None
    prior: bool = False
    shared: bool = False

    def __post_init__(self) -> None:
        crowd = self.predictor
        if self.goal is not None:
            if not isinstance(crowd, Simulated):
                name = kebab_case(type(crowd).__name__)
                raise InputError(f"goals are for predictors that simulate a crowd; {name} has none")
            kind_of_goal(self.goal)
        for word in ("prior", "shared"):
            if getattr(self, word) and (not isinstance(crowd, Simulated) or crowd.calibrator is None):
                raise InputError(f"{word} parameters belong to a calibration: name a cost and a search")
        if self.prior and self.shared:
            raise InputError("a population prior is about each person's own parameters, not about shared ones")

    @property
    def name(self) -> str:
        """Name of the predictor, with what is made for the recording."""
        made = [f"goal={self.goal}"] if self.goal is not None else []
        made += [word for word in ("prior", "shared") if getattr(self, word)]
        if not made:
            return self.predictor.name
        inside = self.predictor.name.removeprefix("simulated").removeprefix("(").removesuffix(")")
        return f"simulated({', '.join(filter(None, (inside, *made)))})"

    @property
    def knows_future(self) -> bool:
        """Whether its goal is told where people will be: then it is for evaluation only."""
        if not isinstance(self.predictor, Simulated):
            return False
        goal = self.predictor.goal
        return kind_of_goal(self.goal).knows_future if self.goal is not None else bool(cast(Goal, goal).knows_future)

    @property
    def label(self) -> str:
        """Short name for tables and plots: model, then cost and search of a calibration, then the goal."""
        crowd = self.predictor
        if not isinstance(crowd, Simulated):
            return crowd.name
        parts = [crowd.model, crowd.cost, crowd.search] if crowd.cost is not None else [crowd.model]
        words = [kebab_case(type(part).__name__) for part in parts]
        words.append(self.goal or kebab_case(type(crowd.goal).__name__))
        words += ["prior"] * (self.prior or crowd.prior is not None) + ["shared"] * self.shared
        return ", ".join(words)

    def check(self, recording: Recording, live: bool) -> None:
        """Raise :class:`InputError` when the predictor cannot work on a recording, before any work is done."""
        crowd = self.predictor
        if not isinstance(crowd, Simulated):
            return
        if crowd.calibrator is not None and recording.observe < 2:
            raise InputError(
                f"calibration needs at least 2 observed rows, and 3 with the progressive cost; {recording.observe} is"
                " observed: a track of one point shows no motion"
            )
        if live and self.knows_future:
            raise InputError(
                f"the goal {self.label.rpartition(', ')[2]} looks at what people will do, which nobody knows while"
                " predicting live; take current-direction, or leave out --live"
            )

    def prepared(self, recording: Recording) -> Predictor:
        """Return the predictor for a recording.

        Raises:
            InputError: something is learned, and nothing was kept of the recording to learn from.
        """
        return _prepared(self, recording)


@functools.lru_cache(maxsize=16)
def _prepared(recipe: Recipe, recording: Recording) -> Predictor:
    crowd = recipe.predictor
    if not isinstance(crowd, Simulated):
        return crowd
    if recipe.goal is not None:
        crowd = dataclasses.replace(crowd, goal=goal_for(recipe.goal, recording))
    if not (recipe.prior or recipe.shared):
        return crowd
    calibrator = cast(Calibrator, crowd.calibrator)
    if kind_of_goal(recipe.goal or "current-direction").knows_future:
        raise InputError(f"{recipe.goal} knows the future of what is predicted only: nothing can be learned with it")
    past = _known(recording)
    if recipe.shared:
        fit = dataclasses.replace(calibrator, shared=True, free=_shareable(calibrator)).fit(past)
        return Simulated.of(fit)
    fit = calibrator.fit_each(past, [stream(0, "prior", window) for window in range(len(past))])
    return dataclasses.replace(crowd, prior=PopulationPrior.learned(fit))


def _known(recording: Recording) -> Windows:
    past, _ = recording.known.windows(recording.observe, 1, "all", None, recording.late)
    chosen = np.unique(np.linspace(0, len(past) - 1, LEARNING_WINDOWS).astype(np.int64))
    return past[chosen]


def _shareable(calibrator: Calibrator) -> tuple[str, ...]:
    """Return the free parameters but the preferred speed, which is never shared."""
    return tuple(name for name in calibrator.free if name.replace("-", "_") != "preferred_speed")
