"""FaultOrder: the event that a fault of a robot begins or ends, as a run writes it."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core import InputError
from crowdbot.simulation.orders.decision_orders import DecisionOrder
from crowdbot.simulation.orders.order import OrderTarget


@dataclass(frozen=True, kw_only=True)
class FaultOrder(DecisionOrder):
    """Record that a fault begins or ends; the trial says when, so a replay does not need it.

    Fields:
        fault: name of the fault, or its kind and number, such as ``frozen-sensor 1``.
        state: ``begin`` or ``end``.

    >>> from crowdbot.simulation import write_order
    >>> write_order(FaultOrder(robot="pepper", fault="lost-commands 1", state="begin"))
    '{"order": "fault", "robot": "pepper", "fault": "lost-commands 1", "state": "begin"}'
    """

    fault: str
    state: str

    def check(self, simulation: OrderTarget) -> None:
        """Raise :class:`InputError`: nobody can give such an order."""
        raise InputError("a fault order is written by a run and cannot be given to one; write a <fault> in the trial")

    def apply(self, simulation: OrderTarget) -> None:
        """Do nothing: the fault acts by itself."""
