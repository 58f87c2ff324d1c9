"""Trials: simulations as files, how they run, and their recordings. Contract :class:`Trial`, verb ``run``."""

from .agent import Agent, Parameter
from .branch import branch
from .builtin import builtin_trials, load_trial
from .crowd import Contact, Crowd, Crowds, Limits, Routing
from .distribution import Distribution
from .drawn import Drawn
from .ending import repair
from .episode import Episode, ScanRow
from .experiment import Experiment, Session, load_experiment
from .explicit import explicit
from .export import export
from .from_recording import recorded_trial
from .journey import Direction, Exit, Journey, Point, Portal, Zone
from .moments import Moment
from .notation import Points
from .original import Imported, import_original
from .people import Group, Source, Spawner
from .recorded import Recorded, moments, read_episode
from .recorded_people import RecordedPeople
from .replay import Replay, replay
from .run import Bridge, Running, opened, record, run
from .schema import schema
from .simulation import Simulation, Touch
from .stage import Obstacle, Stage, Wall
from .sweep import Sweep
from .tally import Summary
from .trial import End, Goal, Mount, Recording, Robot, Trial, When

__all__ = [
    "Agent",
    "Bridge",
    "Contact",
    "Crowd",
    "Crowds",
    "Direction",
    "Distribution",
    "Drawn",
    "End",
    "Episode",
    "Exit",
    "Experiment",
    "Goal",
    "Group",
    "Imported",
    "Journey",
    "Limits",
    "Moment",
    "Mount",
    "Obstacle",
    "Parameter",
    "Point",
    "Points",
    "Portal",
    "Recorded",
    "RecordedPeople",
    "Recording",
    "Replay",
    "Robot",
    "Routing",
    "Running",
    "ScanRow",
    "Session",
    "Simulation",
    "Source",
    "Spawner",
    "Stage",
    "Summary",
    "Sweep",
    "Touch",
    "Trial",
    "Wall",
    "When",
    "Zone",
    "branch",
    "builtin_trials",
    "explicit",
    "export",
    "import_original",
    "load_experiment",
    "load_trial",
    "moments",
    "opened",
    "read_episode",
    "record",
    "recorded_trial",
    "repair",
    "replay",
    "run",
    "schema",
]
