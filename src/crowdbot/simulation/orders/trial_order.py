"""TrialOrder: an order that changes the trial of a running simulation."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError
from crowdbot.simulation.overrides import apply_overrides, check_overrides
from crowdbot.trials import Trial

from .order import Order, OrderTarget


@dataclass(frozen=True, kw_only=True)
class TrialOrder(Order):
    """Base of orders that change the trial; E = 1, since a trial belongs to all environments."""

    @abstractmethod
    def new_trial(self, simulation: Any) -> Trial:
        """Return the changed trial."""

    def check(self, simulation: OrderTarget) -> None:
        """Raise :class:`InputError` if the trial cannot change in this way while it runs."""
        super().check(simulation)
        if simulation.count > 1:
            name = type(self).__name__
            raise InputError(f"{name}: a trial belongs to all environments; use a simulation of one environment")
        check_overrides(simulation, self.new_trial(simulation), added=True)

    def apply(self, simulation: Any) -> None:
        """Change the trial."""
        apply_overrides(simulation, self.new_trial(simulation))
