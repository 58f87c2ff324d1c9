"""The tabs of the app, in the order of the page."""

from __future__ import annotations

from .desk import Desk
from .editor import EditorDesk
from .experiments import ExperimentDesk
from .prediction import PredictionDesk

__all__ = ["DESKS"]

DESKS: tuple[type[Desk], ...] = (PredictionDesk, EditorDesk, ExperimentDesk)
