"""ParameterOrder: changes values of the trial while it runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from crowdbot.trials import Trial, apply_values

from .trial_order import TrialOrder


@dataclass(frozen=True, kw_only=True)
class ParameterOrder(TrialOrder):
    """Change a value of the trial, such as ``crowd.neighbor-distance`` or ``robot.goal.x``; E = 1.

    Fields:
        path: path of the value, see :class:`crowdbot.trials.Sweep`.
        value: the new value as text.
    """

    path: str
    value: str

    def new_trial(self, simulation: Any) -> Trial:
        """Return the trial with the new value."""
        trial: Trial = simulation.trial
        return apply_values(trial, {self.path: self.value}, place=f"order parameter of trial {trial.name!r}")
