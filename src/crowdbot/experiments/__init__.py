"""Experiments: sequences of trials for participants, with screens, questions and answers."""

from .background_run import Aborted, BackgroundRun
from .comparison import (
    LATENCY_FILE,
    LOOKING,
    SETTLING,
    EmulatedPerson,
    Measure,
    PairedTest,
    RecordedTrial,
    Study,
    StudyAnalysis,
    TrialLatency,
    TrialMeasures,
    ViewTrack,
    measures_figure,
    paired_test,
    rating_measures,
    read_trial_latency,
    view_track,
    write_study_report,
    write_trial_latency,
)
from .console import Console, ConsoleClosed
from .emulation import EmulatedPedestrian
from .event import Abort, Answered, Begin, Event, Fail, Finish, Next, Pause, Repeat, Resume, Start, event_of, record_of
from .experiment import Block, Experiment, Screen, TrialEntry
from .experiment_files import FILE, builtin_experiments, is_experiment, load_experiment
from .leader_follower import EmulatedParticipant, roles_of
from .log import SessionLog, read_log
from .order import orders, rows_of, seed_of, williams
from .original import import_experiment
from .page import page_of, sanitise_html
from .parser import check_experiment, experiment_xml, parse_experiment
from .question import Choice, ChoiceOption, FreeText, Number, Scale
from .questionnaires import QUESTIONNAIRES, questionnaire_questions, questionnaire_scores
from .respondent import ConsoleRespondent, EmulatedRespondent, Respondent, ScriptedRespondent
from .session import Session
from .session_plan import plan
from .session_runner import SessionRunner
from .session_summary import save_summary, summary
from .sickness import SYMPTOMS, sickness_scores
from .streams import (
    RecordedStream,
    StreamOutlets,
    StreamRecorder,
    TrialClock,
    TrialClockLog,
    read_streams,
    read_trial_clock,
)
from .studies import STUDIES, analyse_sessions, emulated_participant, study_of
from .withdrawal import withdraw

__all__ = [
    "FILE",
    "LATENCY_FILE",
    "LOOKING",
    "QUESTIONNAIRES",
    "SETTLING",
    "STUDIES",
    "SYMPTOMS",
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
    "EmulatedParticipant",
    "EmulatedPedestrian",
    "EmulatedPerson",
    "EmulatedRespondent",
    "Event",
    "Experiment",
    "Fail",
    "Finish",
    "FreeText",
    "Measure",
    "Next",
    "Number",
    "PairedTest",
    "Pause",
    "RecordedStream",
    "RecordedTrial",
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
    "StreamOutlets",
    "StreamRecorder",
    "Study",
    "StudyAnalysis",
    "TrialClock",
    "TrialClockLog",
    "TrialEntry",
    "TrialLatency",
    "TrialMeasures",
    "ViewTrack",
    "analyse_sessions",
    "builtin_experiments",
    "check_experiment",
    "emulated_participant",
    "event_of",
    "experiment_xml",
    "import_experiment",
    "is_experiment",
    "load_experiment",
    "measures_figure",
    "orders",
    "page_of",
    "paired_test",
    "parse_experiment",
    "plan",
    "questionnaire_questions",
    "questionnaire_scores",
    "rating_measures",
    "read_log",
    "read_streams",
    "read_trial_clock",
    "read_trial_latency",
    "record_of",
    "roles_of",
    "rows_of",
    "sanitise_html",
    "save_summary",
    "seed_of",
    "sickness_scores",
    "study_of",
    "summary",
    "view_track",
    "williams",
    "withdraw",
    "write_study_report",
    "write_trial_latency",
]
