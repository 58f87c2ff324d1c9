"""Trials: simulations as files, how they run, and their recordings. Contract :class:`Trial`, verb ``run``."""

from .builtin import builtin_trials, load_trial
from .distribution import Distribution
from .episode import Episode, ScanRow
from .notation import Points
from .recorded import Recorded, read_episode
from .replay import Replay, replay
from .run import run
from .simulation import Simulation
from .stage import Obstacle, Stage, Wall
from .trial import End, Goal, Mount, Recording, Robot, Spawner, Trial

__all__ = [
    "Distribution",
    "End",
    "Episode",
    "Goal",
    "Mount",
    "Obstacle",
    "Points",
    "Recorded",
    "Recording",
    "Replay",
    "Robot",
    "ScanRow",
    "Simulation",
    "Spawner",
    "Stage",
    "Trial",
    "Wall",
    "builtin_trials",
    "load_trial",
    "read_episode",
    "replay",
    "run",
]
