"""The experiments tab: the session of a participant, for the operator and the participant."""

from .experiment_desk import ExperimentDesk
from .question_form import question_form

__all__ = ["ExperimentDesk", "question_form"]
