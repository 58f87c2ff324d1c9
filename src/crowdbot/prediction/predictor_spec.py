"""PredictorSpec: a predictor that may depend on the recording it is applied to."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass
from typing import cast

import numpy as np

from crowdbot.calibration import Calibrator, PopulationPrior, goal_class, goal_for
from crowdbot.core import InputError, kebab_case, stream
from crowdbot.data import Recording, Windows
from crowdbot.models import Goal

from .predictor import Predictor
from .simulated import Simulated

LEARNING_WINDOWS = 60
"""Number of windows, evenly spaced over the known part of a recording, for priors and shared parameters."""


@dataclass(frozen=True)
class PredictorSpec:
    """Specification of a predictor, built for each recording with :meth:`build`.

    Fields:
        predictor: the predictor.
        goal: name of a goal that depends on the recording: true destinations (for evaluation only) or learned from
            the known part of the recording; None leaves the predictor unchanged.
        prior: estimate the population prior from the known part.
        shared: use one common set of parameters, fitted to the known part.

    Raises:
        InputError: unknown goal, or options that the predictor does not support.
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
                raise InputError(f"a goal requires a predictor that simulates a crowd, not {name}")
            goal_class(self.goal)
        for word in ("prior", "shared"):
            if getattr(self, word) and (not isinstance(crowd, Simulated) or crowd.calibrator is None):
                raise InputError(f"{word} parameters require a calibration: set a cost or a search")
        if self.prior and self.shared:
            raise InputError("a population prior requires individual parameters, not shared ones")

    @property
    def name(self) -> str:
        """Name of the predictor with the options of this specification."""
        made = [f"goal={self.goal}"] if self.goal is not None else []
        made += [word for word in ("prior", "shared") if getattr(self, word)]
        if not made:
            return self.predictor.name
        inside = self.predictor.name.removeprefix("simulated").removeprefix("(").removesuffix(")")
        return f"simulated({', '.join(filter(None, (inside, *made)))})"

    @property
    def knows_future(self) -> bool:
        """Whether the goal uses true future positions; such predictors are for evaluation only."""
        if not isinstance(self.predictor, Simulated):
            return False
        goal = self.predictor.goal
        return goal_class(self.goal).knows_future if self.goal is not None else bool(cast(Goal, goal).knows_future)

    @property
    def label(self) -> str:
        """Short name for tables and plots: model, cost, search, goal."""
        crowd = self.predictor
        if not isinstance(crowd, Simulated):
            return crowd.name
        parts = [crowd.model, crowd.cost, crowd.search] if crowd.cost is not None else [crowd.model]
        words = [kebab_case(type(part).__name__) for part in parts]
        words.append(self.goal or kebab_case(type(crowd.goal).__name__))
        words += ["prior"] * (self.prior or crowd.prior is not None) + ["shared"] * self.shared
        return ", ".join(words)

    def check(self, recording: Recording, live: bool) -> None:
        """Raise :class:`InputError` if the predictor cannot be used with a recording."""
        crowd = self.predictor
        if not isinstance(crowd, Simulated):
            return
        if crowd.calibrator is not None and recording.observe < 2:
            raise InputError(
                f"calibration needs at least 2 observed rows (3 with the progressive cost), not {recording.observe}"
            )
        if live and self.knows_future:
            raise InputError(
                f"the goal {self.label.rpartition(', ')[2]} requires the future, which is unknown in live prediction;"
                " use current-direction, or omit --live"
            )

    def build(self, recording: Recording) -> Predictor:
        """Return the predictor for a recording.

        Raises:
            InputError: a part is learned, and the recording has no known part (``learn`` is 0).
        """
        return _prepare(self, recording)


@functools.lru_cache(maxsize=16)
def _prepare(spec: PredictorSpec, recording: Recording) -> Predictor:
    crowd = spec.predictor
    if not isinstance(crowd, Simulated):
        return crowd
    if spec.goal is not None:
        crowd = dataclasses.replace(crowd, goal=goal_for(spec.goal, recording))
    if not (spec.prior or spec.shared):
        return crowd
    calibrator = cast(Calibrator, crowd.calibrator)
    if goal_class(spec.goal or "current-direction").knows_future:
        raise InputError(f"{spec.goal} requires the true future and cannot be used to fit a prior or shared parameters")
    past = _learning_windows(recording)
    if spec.shared:
        fit = dataclasses.replace(calibrator, shared=True, free=_shareable(calibrator)).fit(past)
        return Simulated.of(fit)
    fit = calibrator.fit_each(past, [stream(0, "prior", window) for window in range(len(past))])
    return dataclasses.replace(crowd, prior=PopulationPrior.from_fits(fit))


def _learning_windows(recording: Recording) -> Windows:
    past, _ = recording.learning_part.windows(recording.observe, 1, "all", None, recording.late)
    chosen = np.unique(np.linspace(0, len(past) - 1, LEARNING_WINDOWS).astype(np.int64))
    return past[chosen]


def _shareable(calibrator: Calibrator) -> tuple[str, ...]:
    """Return the free parameters except the preferred speed, which is always individual."""
    return tuple(name for name in calibrator.free if name.replace("-", "_") != "preferred_speed")
