"""Trials: simulations as files, how they run, and their recordings. Contract :class:`Trial`, verb ``run``."""

from .agent import Agent, Parameter
from .batch import run_batch
from .branch import branch
from .builtin import builtin_trials, load_trial
from .camera import Camera
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
from .props import Cube, Light, Table, Tree
from .recorded import Recorded, moments, read_episode
from .recorded_people import RecordedPeople
from .replay import Replay, replay
from .run import Bridge, Running, opened, record, run
from .schema import schema
from .shots import Shot, Take, camera_names, shots
from .simulation import Simulation, Touch
from .stage import Obstacle, Stage, Wall
from .sweep import Sweep
from .tally import Summary
from .trial import End, Goal, Mount, Recording, Robot, Trial, When

__all__ = [
    "Agent",
    "Bridge",
    "Camera",
    "Contact",
    "Crowd",
    "Crowds",
    "Cube",
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
    "Light",
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
    "Shot",
    "Simulation",
    "Source",
    "Spawner",
    "Stage",
    "Summary",
    "Sweep",
    "Table",
    "Take",
    "Touch",
    "Tree",
    "Trial",
    "Wall",
    "When",
    "Zone",
    "branch",
    "builtin_trials",
    "camera_names",
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
    "run_batch",
    "schema",
    "shots",
]
