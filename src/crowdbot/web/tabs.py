"""The tabs of the app, in the order of the page."""

from __future__ import annotations

from .desk import Desk
from .simulator import SimulatorDesk

__all__ = ["DESKS"]

DESKS: tuple[type[Desk], ...] = (SimulatorDesk,)
