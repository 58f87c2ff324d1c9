"""Experiments: sequences of trials for participants, with screens, questions and answers."""

from .background_run import Aborted, BackgroundRun
from .console import Console, ConsoleClosed
from .event import Abort, Answered, Begin, Event, Fail, Finish, Next, Pause, Repeat, Resume, Start, event_of, record_of
from .experiment import Block, Experiment, Screen, TrialEntry
from .experiment_files import FILE, builtin_experiments, is_experiment, load_experiment
from .log import SessionLog, read_log
from .order import orders, rows_of, seed_of, williams
from .original import import_experiment
from .page import page_of, sanitise_html
from .parser import check_experiment, experiment_xml, parse_experiment
from .question import Choice, ChoiceOption, FreeText, Number, Scale
from .respondent import ConsoleRespondent, Respondent, ScriptedRespondent
from .session import Session
from .session_plan import plan
from .session_runner import SessionRunner
from .session_summary import save_summary, summary

__all__ = [
    "FILE",
    "Abort",
    "Aborted",
    "Answered",
    "BackgroundRun",
    "Begin",
    "Block",
    "Choice",
    "ChoiceOption",
    "Console",
    "ConsoleClosed",
    "ConsoleRespondent",
    "Event",
    "Experiment",
    "Fail",
    "Finish",
    "FreeText",
    "Next",
    "Number",
    "Pause",
    "Repeat",
    "Respondent",
    "Resume",
    "Scale",
    "Screen",
    "ScriptedRespondent",
    "Session",
    "SessionLog",
    "SessionRunner",
    "Start",
    "TrialEntry",
    "builtin_experiments",
    "check_experiment",
    "event_of",
    "experiment_xml",
    "import_experiment",
    "is_experiment",
    "load_experiment",
    "orders",
    "page_of",
    "parse_experiment",
    "plan",
    "read_log",
    "record_of",
    "rows_of",
    "sanitise_html",
    "save_summary",
    "seed_of",
    "summary",
    "williams",
]
