"""Experiments: trials for participants, the screens around them, and what was answered. Contract :class:`Session`."""

from .experiment import Block, Experiment, Screen, TrialEntry
from .loading import builtin_experiments, is_experiment, load_experiment
from .question import Choice, FreeText, Number, Option, Question, Scale

__all__ = ["Block", "Choice", "Experiment", "FreeText", "Number", "Option", "Question", "Scale", "Screen", "TrialEntry", "builtin_experiments", "is_experiment", "load_experiment"]
