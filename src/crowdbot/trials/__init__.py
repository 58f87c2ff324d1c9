"""Trials: simulations as data. The dataclasses, their XML, the checks, built-in scenarios, placement and importers."""

from .agent import Agent, Parameter
from .builtin import builtin_trials, load_trial
from .camera import OVERVIEW, Camera, overview
from .code_references import is_code, named_code
from .crowd import Contact, Crowd, Crowds, Limits, Routing, crowd_names
from .distribution import Distribution
from .fields import UNWRITABLE, attribute, check, children, outline, shown
from .importers.original import Imported, import_original, plan_of, trials_of
from .importers.original_order import Plan
from .importers.recording import recorded_trial
from .journey import Direction, Exit, Journey, Point, Portal, Zone
from .map_files import is_file_of_area, map_files
from .notation import Points, plain
from .parser import check_trial, parse_trial
from .partial import readable, told
from .people import Group, Source, Spawner
from .placement.appearance import Figures, cast_of
from .placement.expansion import expand_spawners
from .placement.population import place
from .placement.spawn_placement import GAP, People
from .props import Cube, Light, Table, Tree
from .randomized_model import Drawn, own
from .recorded_people import RecordedPeople
from .robot import Goal, Mount, Robot
from .scenarios import PRESETS
from .scenarios.challenge import FLOWS, SIZES
from .scenarios.crowds import DENSITIES
from .stage import Obstacle, Stage, Wall, area
from .sweep import Sweep
from .trial import End, Recording, Trial, When
from .trial_files import beside
from .validation.rates import trial_remarks
from .variants import apply_values, expand_sweeps
from .xml.document import parse_trial_xml, read_trial_bytes
from .xml.old_names import OldNameWarning, update_names
from .xml.reader import Reader
from .xml.writer import element_from, trial_xml
from .xml.xsd import schema

__all__ = [
    "DENSITIES",
    "FLOWS",
    "GAP",
    "OVERVIEW",
    "PRESETS",
    "SIZES",
    "UNWRITABLE",
    "Agent",
    "Camera",
    "Contact",
    "Crowd",
    "Crowds",
    "Cube",
    "Direction",
    "Distribution",
    "Drawn",
    "End",
    "Exit",
    "Figures",
    "Goal",
    "Group",
    "Imported",
    "Journey",
    "Light",
    "Limits",
    "Mount",
    "Obstacle",
    "OldNameWarning",
    "Parameter",
    "People",
    "Plan",
    "Point",
    "Points",
    "Portal",
    "Reader",
    "RecordedPeople",
    "Recording",
    "Robot",
    "Routing",
    "Source",
    "Spawner",
    "Stage",
    "Sweep",
    "Table",
    "Tree",
    "Trial",
    "Wall",
    "When",
    "Zone",
    "apply_values",
    "area",
    "attribute",
    "beside",
    "builtin_trials",
    "cast_of",
    "check",
    "check_trial",
    "children",
    "crowd_names",
    "element_from",
    "expand_spawners",
    "expand_sweeps",
    "import_original",
    "is_code",
    "is_file_of_area",
    "load_trial",
    "map_files",
    "named_code",
    "outline",
    "overview",
    "own",
    "parse_trial",
    "parse_trial_xml",
    "place",
    "plain",
    "plan_of",
    "read_trial_bytes",
    "readable",
    "recorded_trial",
    "schema",
    "shown",
    "told",
    "trial_remarks",
    "trial_xml",
    "trials_of",
    "update_names",
]
