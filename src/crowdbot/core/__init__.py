"""The base of all other rooms: scenes, geometry, clocks, errors, kernels. numba is loaded with the first kernel."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

from .bodies import STAGE, Bodies, Skins
from .bounds import Bounds, check_number
from .clock import Clock, ExternalClock, FreeClock, PacedClock
from .errors import (
    CrowdbotError,
    DataError,
    EpisodeError,
    InputError,
    MissingExtra,
    RobotError,
    TrialError,
    UnknownName,
    did_you_mean,
    nearest_name,
)
from .optional import optional
from .paper import Paper
from .parameter import Parameter, PerAgent, check_parameters, parameter, parameters, per_agent
from .plugin import (
    attribute_names,
    attribute_problems,
    builtin_classes,
    find_class,
    from_attributes,
    kebab,
    required_fields,
)
from .pose import MOUNT_HEIGHT, Pose, SpatialPose, Twist, product, wrap
from .random import stream
from .scene import PERSON_HEIGHT, Scene
from .version import code_digest
from .walls import Walls
from .workers import each, each_kept
from .xml_tree import Element, format_xml, parse_number, parse_xml, read_bytes, reject_entities

if TYPE_CHECKING:
    from .compiling import on_compiling
    from .kernels import cache_folder, is_cold, kernel
    from .neighbors import CHUNK, SMALL, Neighbors

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "compiling": ["on_compiling"],
        "kernels": ["cache_folder", "is_cold", "kernel"],
        "neighbors": ["CHUNK", "SMALL", "Neighbors"],
    },
)

__all__ = [
    "CHUNK",
    "MOUNT_HEIGHT",
    "PERSON_HEIGHT",
    "SMALL",
    "STAGE",
    "Bodies",
    "Bounds",
    "Clock",
    "CrowdbotError",
    "DataError",
    "Element",
    "EpisodeError",
    "ExternalClock",
    "FreeClock",
    "InputError",
    "MissingExtra",
    "Neighbors",
    "PacedClock",
    "Paper",
    "Parameter",
    "PerAgent",
    "Pose",
    "RobotError",
    "Scene",
    "Skins",
    "SpatialPose",
    "TrialError",
    "Twist",
    "UnknownName",
    "Walls",
    "attribute_names",
    "attribute_problems",
    "builtin_classes",
    "cache_folder",
    "check_number",
    "check_parameters",
    "code_digest",
    "did_you_mean",
    "each",
    "each_kept",
    "find_class",
    "format_xml",
    "from_attributes",
    "is_cold",
    "kebab",
    "kernel",
    "nearest_name",
    "on_compiling",
    "optional",
    "parameter",
    "parameters",
    "parse_number",
    "parse_xml",
    "per_agent",
    "product",
    "read_bytes",
    "reject_entities",
    "required_fields",
    "stream",
    "wrap",
]
