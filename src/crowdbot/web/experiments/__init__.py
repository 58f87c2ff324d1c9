"""The experiments tab: the session of a participant, for the operator and the participant."""

from .experiment_desk import ExperimentDesk
from .question_form import question_form
from .session_streams import StreamChoice, chosen_streams

__all__ = ["ExperimentDesk", "StreamChoice", "chosen_streams", "question_form"]
