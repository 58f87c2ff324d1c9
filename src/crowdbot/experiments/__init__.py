"""Experiments: sequences of trials for participants, with screens, questions and answers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from .background_run import Aborted as Aborted
    from .background_run import BackgroundRun as BackgroundRun
    from .comparison import LATENCY_FILE as LATENCY_FILE
    from .comparison import LOOKING as LOOKING
    from .comparison import SETTLING as SETTLING
    from .comparison import EmulatedPerson as EmulatedPerson
    from .comparison import Measure as Measure
    from .comparison import PairedTest as PairedTest
    from .comparison import RecordedTrial as RecordedTrial
    from .comparison import Study as Study
    from .comparison import StudyAnalysis as StudyAnalysis
    from .comparison import TrialLatency as TrialLatency
    from .comparison import TrialMeasures as TrialMeasures
    from .comparison import ViewTrack as ViewTrack
    from .comparison import measures_figure as measures_figure
    from .comparison import paired_test as paired_test
    from .comparison import rating_measures as rating_measures
    from .comparison import read_trial_latency as read_trial_latency
    from .comparison import view_track as view_track
    from .comparison import write_study_report as write_study_report
    from .comparison import write_trial_latency as write_trial_latency
    from .console import Console as Console
    from .console import ConsoleClosed as ConsoleClosed
    from .emulation import EmulatedPedestrian as EmulatedPedestrian
    from .experiment import Block as Block
    from .experiment import Experiment as Experiment
    from .experiment import Screen as Screen
    from .experiment import TrialEntry as TrialEntry
    from .leader_follower import EmulatedParticipant as EmulatedParticipant
    from .leader_follower import roles_of as roles_of
    from .log import Abort as Abort
    from .log import Answered as Answered
    from .log import Begin as Begin
    from .log import Event as Event
    from .log import Fail as Fail
    from .log import Finish as Finish
    from .log import Next as Next
    from .log import Pause as Pause
    from .log import Repeat as Repeat
    from .log import Resume as Resume
    from .log import SessionLog as SessionLog
    from .log import Start as Start
    from .log import event_of as event_of
    from .log import read_log as read_log
    from .log import record_of as record_of
    from .original import import_experiment as import_experiment
    from .page import page_of as page_of
    from .page import sanitise_html as sanitise_html
    from .parser import FILE as FILE
    from .parser import builtin_experiments as builtin_experiments
    from .parser import check_experiment as check_experiment
    from .parser import experiment_xml as experiment_xml
    from .parser import is_experiment as is_experiment
    from .parser import load_experiment as load_experiment
    from .parser import parse_experiment as parse_experiment
    from .question import QUESTIONNAIRES as QUESTIONNAIRES
    from .question import SYMPTOMS as SYMPTOMS
    from .question import Choice as Choice
    from .question import ChoiceOption as ChoiceOption
    from .question import FreeText as FreeText
    from .question import Number as Number
    from .question import Scale as Scale
    from .question import questionnaire_questions as questionnaire_questions
    from .question import questionnaire_scores as questionnaire_scores
    from .question import sickness_scores as sickness_scores
    from .respondent import ConsoleRespondent as ConsoleRespondent
    from .respondent import EmulatedRespondent as EmulatedRespondent
    from .respondent import Respondent as Respondent
    from .respondent import ScriptedRespondent as ScriptedRespondent
    from .session import Session as Session
    from .session_folder import withdraw as withdraw
    from .session_plan import orders as orders
    from .session_plan import plan as plan
    from .session_plan import rows_of as rows_of
    from .session_plan import seed_of as seed_of
    from .session_plan import williams as williams
    from .session_runner import SessionRunner as SessionRunner
    from .session_summary import save_summary as save_summary
    from .session_summary import summary as summary
    from .streams import RecordedStream as RecordedStream
    from .streams import StreamOutlets as StreamOutlets
    from .streams import StreamRecorder as StreamRecorder
    from .streams import TrialClock as TrialClock
    from .streams import TrialClockLog as TrialClockLog
    from .streams import read_streams as read_streams
    from .streams import read_trial_clock as read_trial_clock
    from .studies import STUDIES as STUDIES
    from .studies import analyse_sessions as analyse_sessions
    from .studies import emulated_participant as emulated_participant
    from .studies import study_of as study_of

__getattr__, __dir__, __all__ = lazy_exports(__name__)
