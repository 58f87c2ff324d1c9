"""Orders to doors: which values of doors can change while a simulation runs, and their effect."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

from crowdbot.core import InputError
from crowdbot.trials import Door

__all__ = ["check_doors", "order_doors"]


def check_doors(old: Sequence[Door], new: Sequence[Door]) -> None:
    """Raise :class:`InputError` if something else changes than whether a door is open."""
    same = len(old) == len(new) and all(
        dataclasses.replace(two, open=one.open) == one for one, two in zip(old, new, strict=True)
    )
    if not same:
        raise InputError("of the doors, only open can change while a simulation runs")
    for one, two in zip(old, new, strict=True):
        if one.open != two.open and one.opening != "order":
            raise InputError(
                f'open of door {one.name!r} cannot change: it opens by {one.opening}; take opening="order"'
            )


def order_doors(world: Any, doors: Sequence[Door]) -> None:
    """Open and close the doors of all environments as the trial says."""
    for one in getattr(world, "worlds", [world]) if doors else ():
        one.doors.wanted = {door.name: door.open for door in doors}
