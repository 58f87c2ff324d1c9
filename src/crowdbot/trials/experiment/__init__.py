"""Experiments: trials for participants, the screens around them, and what was answered.

An :class:`Experiment` is what is planned, a :class:`Session` where one participant is in it (a state machine that every
front end shares), a :class:`Sitting` that session with its folder and log, and a :class:`Console` a front end.
"""

from .console import Console, Left
from .event import Abort, Answered, Begin, Event, Fail, Finish, Next, Pause, Repeat, Resume, Start
from .experiment import Block, Experiment, Screen, TrialEntry
from .loading import builtin_experiments, is_experiment, load_experiment
from .order import orders, rows_of, seed_of, williams
from .original import ImportedExperiment, import_experiment
from .page import Page, page_of
from .person import Given, Person, Typed
from .plan import Step, plan
from .question import Choice, FreeText, Number, Option, Question, Scale
from .session import Result, Session
from .sitting import Sitting
from .summary import save_summary, session_of, summary

__all__ = [
    "Abort", "Answered", "Begin", "Block", "Choice", "Console", "Event", "Experiment", "Fail", "Finish", "FreeText",
    "Given", "ImportedExperiment", "Left", "Next", "Number", "Option", "Page", "Pause", "Person", "Question",
    "Repeat", "Result", "Resume", "Scale", "Screen", "Session", "Sitting", "Start", "Step", "TrialEntry", "Typed",
    "builtin_experiments", "import_experiment", "is_experiment", "load_experiment", "orders", "page_of", "plan",
    "rows_of", "save_summary", "seed_of", "session_of", "summary", "williams",
]  # fmt: skip
