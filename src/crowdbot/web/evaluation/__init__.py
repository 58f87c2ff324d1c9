"""The evaluation tab: navigators compared over many runs, each of which can be watched."""

from .evaluation_desk import RESULT, EvaluationDesk
from .evaluation_request import EvaluationRequest

__all__ = ["RESULT", "EvaluationDesk", "EvaluationRequest"]
