"""Orders to doors: which values of doors can change while a simulation runs, and their effect."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError, did_you_mean
from crowdbot.trials import Door
from crowdbot.world import worlds_of

from .orders.order import Order


@dataclass(frozen=True, kw_only=True)
class DoorOrder(Order):
    """Open or close a door in one environment. The door needs ``opening="order"``.

    Fields:
        door: name of the door.
        open: whether it is to be open.

    >>> DoorOrder(door="hall", environment=3).open
    True
    """

    door: str
    open: bool = True

    def check(self, simulation: Any) -> None:
        """Raise :class:`InputError` if there is no such door, or it does not open by order."""
        super().check(simulation)
        doors = {door.name: door for door in simulation.trial.stage.doors}
        if self.door not in doors:
            hint = did_you_mean(self.door, doors)
            raise InputError(f"DoorOrder: there is no door {self.door!r}{hint}; doors are {', '.join(doors) or 'none'}")
        if (opening := doors[self.door].opening) != "order":
            raise InputError(f'DoorOrder: door {self.door!r} opens by {opening}; take opening="order"')

    def apply(self, simulation: Any) -> None:
        """Let the door begin to open or close."""
        own = worlds_of(simulation.world)[self.environment]
        own.doors.wanted = {**own.doors.wanted, self.door: bool(self.open)}


def check_doors(old: Sequence[Door], new: Sequence[Door]) -> None:
    """Raise :class:`InputError` if something else changes than whether a door is open."""
    same = len(old) == len(new) and all(
        dataclasses.replace(two, open=item.open) == item for item, two in zip(old, new, strict=True)
    )
    if not same:
        raise InputError("of the doors, only open can change while a simulation runs")
    for item, two in zip(old, new, strict=True):
        if item.open != two.open and item.opening != "order":
            raise InputError(
                f'open of door {item.name!r} cannot change: it opens by {item.opening}; take opening="order"'
            )


def order_doors(world: Any, old: Sequence[Door], new: Sequence[Door]) -> None:
    """Open and close the doors whose value in the trial changes."""
    changed = {two.name: two.open for item, two in zip(old, new, strict=True) if item.open != two.open}
    for own in worlds_of(world) if changed else ():
        own.doors.wanted = {**own.doors.wanted, **changed}
