"""Floor 0: what every other floor stands on. Needs numpy and the standard library; kernels load numba lazily."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

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
    from .svg import PERSON_COLOR, ROBOT_COLOR, WALL_COLOR, Disc, Path2D, draw_svg

_LAZY = {
    "CHUNK": "neighbors",
    "Disc": "svg",
    "Neighbors": "neighbors",
    "PERSON_COLOR": "svg",
    "Path2D": "svg",
    "ROBOT_COLOR": "svg",
    "SMALL": "neighbors",
    "cache_folder": "kernels",
    "draw_svg": "svg",
    "WALL_COLOR": "svg",
    "is_cold": "kernels",
    "kernel": "kernels",
    "on_compiling": "compiling",
}

__all__ = [
    "CHUNK",
    "MOUNT_HEIGHT",
    "PERSON_COLOR",
    "PERSON_HEIGHT",
    "ROBOT_COLOR",
    "SMALL",
    "STAGE",
    "WALL_COLOR",
    "Bodies",
    "Bounds",
    "Clock",
    "CrowdbotError",
    "DataError",
    "Disc",
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
    "Path2D",
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
    "draw_svg",
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


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(importlib.import_module(f"{__name__}.{_LAZY[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
