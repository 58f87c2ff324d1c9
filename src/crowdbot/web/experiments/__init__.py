"""The experiments tab: the session of a participant, for the operator and the participant."""

from .experiment_desk import ExperimentDesk, StreamChoice, chosen_streams, question_form

__all__ = ["ExperimentDesk", "StreamChoice", "chosen_streams", "question_form"]
