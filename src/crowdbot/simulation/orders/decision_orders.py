"""Orders that a run writes itself about the real time of decisions, so that a replay measures none."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from crowdbot.core import InputError

from .order import Order, OrderTarget


@dataclass(frozen=True, kw_only=True)
class DecisionOrder(Order):
    """Record something about the real time of a decision.

    Fields:
        robot: name of the robot.
    """

    robot: str

    def check(self, simulation: OrderTarget) -> None:
        what = type(self).__name__.removesuffix("DecisionOrder").lower()
        raise InputError(f"a {what}-decision order is written by a run and cannot be given to one")


@dataclass(frozen=True, kw_only=True)
class MissedDecisionOrder(DecisionOrder):
    """Record that a decision took longer than the deadline of the robot, so that its command stayed in force."""

    def apply(self, simulation: OrderTarget) -> None:
        """Do nothing: the command stays in force."""


@dataclass(frozen=True, kw_only=True)
class HungDecisionOrder(DecisionOrder):
    """Record that a decision did not return within its limit, so that the run ended with an error.

    Fields:
        seconds: the limit [s].
        place: file and line of the call that did not return.
    """

    seconds: float
    place: str = ""

    def apply(self, simulation: OrderTarget) -> None:
        """Do nothing: the run has ended."""


class RecordedDecisions(NamedTuple):
    """What a recording says about the real time of the decisions of one robot.

    >>> orders = [(4, MissedDecisionOrder(robot="pepper")), (6, HungDecisionOrder(robot="pepper", seconds=60.0))]
    >>> recorded = RecordedDecisions.of(orders, "pepper")
    >>> sorted(recorded.missed), sorted(recorded.hung)
    ([4], [6])
    """

    missed: frozenset[int] = frozenset()
    """Ticks of the decisions that missed the deadline."""
    hung: Mapping[int, HungDecisionOrder] = {}
    """Decisions that did not return, by tick."""

    @classmethod
    def of(cls, orders: Iterable[tuple[int, Order]], robot: str) -> RecordedDecisions:
        """Return what orders with their ticks say about a robot."""
        own = [(tick, order) for tick, order in orders if isinstance(order, DecisionOrder) and order.robot == robot]
        missed = frozenset(tick for tick, order in own if isinstance(order, MissedDecisionOrder))
        return cls(missed, {tick: order for tick, order in own if isinstance(order, HungDecisionOrder)})
