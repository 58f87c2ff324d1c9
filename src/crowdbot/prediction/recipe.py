"""Recipe: a predictor whose goals may depend on the recording it is used on."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from crowdbot.calibration import goal_for, kind_of_goal
from crowdbot.core import InputError
from crowdbot.core.plug import kebab
from crowdbot.data import Recording

from .predictor import Predictor
from .simulated import Simulated

__all__ = ["Recipe"]


@dataclass(frozen=True)
class Recipe:
    """How a predictor is made for a recording.

    Fields:
        predictor: what predicts.
        goal: name of the goal of a simulated crowd when it needs the recording: the true destinations (for evaluation
            only) or what is learned from a part of it; None leaves the predictor as it is.

    Raises:
        InputError: the goal is unknown, or the predictor has none.
    """

    predictor: Predictor
    goal: str | None = None

    def __post_init__(self) -> None:
        if self.goal is None:
            return
        if not isinstance(self.predictor, Simulated):
            name = kebab(type(self.predictor).__name__)
            raise InputError(f"goals are for predictors that simulate a crowd; {name} has none")
        kind_of_goal(self.goal)

    @property
    def name(self) -> str:
        """Name of the predictor, with its goal."""
        if self.goal is None:
            return self.predictor.name
        inside = self.predictor.name.removeprefix("simulated").strip("()")
        return f"simulated({', '.join(part for part in (inside, f'goal={self.goal}') if part)})"

    @property
    def label(self) -> str:
        """Short name for tables and plots: model, then cost and search of a calibration, then the goal."""
        crowd = self.predictor
        if not isinstance(crowd, Simulated):
            return crowd.name
        parts = [crowd.model, crowd.cost, crowd.search] if crowd.cost is not None else [crowd.model]
        words = [kebab(type(part).__name__) for part in parts]
        words.append(self.goal or kebab(type(crowd.goal).__name__))
        return ", ".join([*words, "prior"] if crowd.prior is not None else words)

    def prepared(self, recording: Recording) -> Predictor:
        """Return the predictor for a recording.

        Raises:
            InputError: the goal learns, and nothing was kept of the recording to learn from.
        """
        if self.goal is None:
            return self.predictor
        return dataclasses.replace(self.predictor, goal=goal_for(self.goal, recording))  # type: ignore[call-arg]
