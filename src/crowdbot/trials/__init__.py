"""Trials: simulations as files, how they run, and their recordings. Contract :class:`Trial`, verb ``run``."""

from .branch import branch
from .builtin import builtin_trials, load_trial
from .crowd import Contact, Crowd, Crowds, Limits, Routing
from .distribution import Distribution
from .ending import repair
from .episode import Episode, ScanRow
from .experiment import Experiment, Session, load_experiment
from .export import export
from .journey import Direction, Exit, Journey, Point, Zone
from .moments import Moment
from .notation import Points
from .people import Source, Spawner
from .recorded import Recorded, moments, read_episode
from .replay import Replay, replay
from .run import Bridge, Running, opened, record, run
from .simulation import Simulation, Touch
from .stage import Obstacle, Stage, Wall
from .tally import Summary
from .trial import End, Goal, Mount, Recording, Robot, Trial

__all__ = [
    "Bridge",
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
    "Moment",
    "Mount",
    "Obstacle",
    "Point",
    "Points",
    "Recorded",
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
    "Touch",
    "Trial",
    "Wall",
    "Zone",
    "branch",
    "builtin_trials",
    "export",
    "load_experiment",
    "load_trial",
    "moments",
    "opened",
    "read_episode",
    "record",
    "repair",
    "replay",
    "run",
]
