"""ParameterOrder: changes values of the trial while it runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError
from crowdbot.simulation.overrides import apply_overrides, check_overrides
from crowdbot.trials import Trial, apply_values

from .order import Order, OrderTarget

__all__ = ["ParameterOrder"]


@dataclass(frozen=True, kw_only=True)
class ParameterOrder(Order):
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

    def check(self, simulation: OrderTarget) -> None:
        """Raise :class:`InputError` if the value cannot change while the trial runs."""
        super().check(simulation)
        if simulation.count > 1:
            raise InputError("ParameterOrder: values of a trial belong to all environments; use one environment")
        check_overrides(simulation, self.new_trial(simulation))

    def apply(self, simulation: Any) -> None:
        """Change the value."""
        apply_overrides(simulation, self.new_trial(simulation))
