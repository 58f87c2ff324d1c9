"""The tabs of the app, in the order of the page."""

from __future__ import annotations

from .desk import Desk
from .editor import EditorDesk
from .evaluation import EvaluationDesk
from .experiments import ExperimentDesk

__all__ = ["DESKS"]

DESKS: tuple[type[Desk], ...] = (EditorDesk, EvaluationDesk, ExperimentDesk)
