"""The evaluation tab: navigators compared over many runs, each of which can be watched."""

from .evaluation_desk import EvaluationDesk
from .evaluation_request import EvaluationRequest
from .imported_result import RESULT

__all__ = ["RESULT", "EvaluationDesk", "EvaluationRequest"]
