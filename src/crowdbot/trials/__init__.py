"""Trials: simulations as files, how they run, and their recordings. Contract :class:`Trial`, verb ``run``."""

from .builtin import builtin_trials, load_trial
from .crowd import Contact, Crowd, Crowds, Limits, Routing
from .distribution import Distribution
from .episode import Episode, ScanRow
from .experiment import Experiment, Session, load_experiment
from .journey import Direction, Exit, Journey, Point, Zone
from .notation import Points
from .people import Source, Spawner
from .recorded import Recorded, read_episode
from .replay import Replay, replay
from .run import run
from .simulation import Simulation
from .stage import Obstacle, Stage, Wall
from .trial import End, Goal, Mount, Recording, Robot, Trial

__all__ = [
    "Contact",
    "Crowd",
    "Crowds",
    "Direction",
    "Distribution",
    "End",
    "Episode",
    "Exit",
    "Experiment",
    "Goal",
    "Journey",
    "Limits",
    "Mount",
    "Obstacle",
    "Point",
    "Points",
    "Recorded",
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
    "Trial",
    "Wall",
    "Zone",
    "builtin_trials",
    "load_experiment",
    "load_trial",
    "read_episode",
    "replay",
    "run",
]
