"""OrderSchedule: orders at given times, from a file of JSON lines."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.core import InputError

from .order import Order, read_order

if TYPE_CHECKING:
    from crowdbot.simulation.simulation import Simulation

LARGEST = 1 << 26
"""Largest file [bytes]."""


class OrderSchedule:
    """Gives orders at their times, as an :class:`crowdbot.simulation.OrderSource`.

    An order is given at the first time step at or after its time.

    Args:
        rows: time [s] and order.

    >>> from crowdbot.simulation import PushOrder
    >>> schedule = OrderSchedule([(1.0, PushOrder(person=0, force=100)), (0.5, PushOrder(person=1, force=90))])
    >>> [time for time, _ in schedule.rows]
    [0.5, 1.0]
    """

    def __init__(self, rows: Iterable[tuple[float, Order]]) -> None:
        self.rows = sorted(rows, key=lambda row: row[0])
        self._next = 0

    @classmethod
    def read(cls, path: Path | str) -> OrderSchedule:
        """Return the orders of a file: one JSON object per line, with ``time`` [s]; empty lines are skipped.

        Raises:
            InputError: the file cannot be read, or a line is not an order with a time.
        """
        path = Path(path)
        try:
            if path.stat().st_size > LARGEST:
                raise InputError(f"{path} has more than {LARGEST >> 20} MiB; a file of orders must be smaller")
            lines = path.read_text(encoding="utf-8").splitlines()
        except OSError as error:
            raise InputError(f"cannot read the orders {path}: {error.strerror}") from None
        except UnicodeDecodeError:
            raise InputError(f"{path} is not a text file of orders in UTF-8") from None
        rows = []
        for number, line in enumerate(lines, 1):
            if line.strip():
                try:
                    rows.append(_read_row(line))
                except InputError as error:
                    raise InputError(f"{path}, line {number}: {error}") from None
        return cls(rows)

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the orders of the current step."""
        now, found = float(simulation.world.clock.time), []
        while self._next < len(self.rows) and self.rows[self._next][0] <= now + 1e-9:
            found.append(self.rows[self._next][1])
            self._next += 1
        return found


def _read_row(line: str) -> tuple[float, Order]:
    try:
        values: Any = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise InputError(f"not JSON: {error}") from None
    if not isinstance(values, dict):
        raise InputError('an order must be a JSON object, such as {"time": 1, "order": "push", "person": 2, ...}')
    time = values.pop("time", None)
    if isinstance(time, bool) or not isinstance(time, int | float) or not (math.isfinite(time) and time >= 0.0):
        raise InputError(f"time = {time!r} must be a number of seconds from 0 on")
    return float(time), read_order(json.dumps(values))
