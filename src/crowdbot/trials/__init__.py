"""Trials: simulations as files, how they run, and their recordings. Contract :class:`Trial`, verb ``run``."""

from .agent import Agent, Parameter
from .builtin import builtin_trials, load_trial
from .crowd import Contact, Crowd, Crowds, Limits, Routing
from .distribution import Distribution
from .drawn import Drawn
from .episode import Episode, ScanRow
from .experiment import Experiment, Session, load_experiment
from .explicit import explicit
from .from_recording import recorded_trial
from .journey import Direction, Exit, Journey, Point, Portal, Zone
from .notation import Points
from .original import Imported, import_original
from .people import Group, Source, Spawner
from .recorded import Recorded, read_episode
from .recorded_people import RecordedPeople
from .replay import Replay, replay
from .run import run
from .schema import schema
from .simulation import Simulation
from .stage import Obstacle, Stage, Wall
from .sweep import Sweep
from .trial import End, Goal, Mount, Recording, Robot, Trial, When

__all__ = [
    "Agent",
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
    "ScanRow",
    "Session",
    "Simulation",
    "Source",
    "Spawner",
    "Stage",
    "Sweep",
    "Trial",
    "Wall",
    "When",
    "Zone",
    "builtin_trials",
    "explicit",
    "import_original",
    "load_experiment",
    "load_trial",
    "read_episode",
    "recorded_trial",
    "replay",
    "run",
    "schema",
]
