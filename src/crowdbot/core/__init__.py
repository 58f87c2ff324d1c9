"""Base of all other packages: scenes, geometry, clocks, errors, kernels. The first kernel call imports numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

from . import tree
from .bodies import STAGE, Bodies, Skins
from .clock import Clock, ExternalClock, FreeClock, PacedClock, TickSchedule, whole_ticks
from .errors import (
    PROGRAMS,
    CrowdbotError,
    DataError,
    EpisodeError,
    InputError,
    MissingExtra,
    RobotError,
    TrialError,
    UnknownName,
    check_programs,
    did_you_mean,
    explain_write_errors,
    import_optional,
    nearest_name,
)
from .gestures import GESTURES
from .markup.xml_tree import Element, format_xml, parse_number, parse_xml, read_bytes, reject_entities, strict_xml
from .model_parameter import (
    Bounds,
    Paper,
    Parameter,
    PerAgent,
    check_number,
    check_parameters,
    dense,
    every,
    field_units,
    parameter,
    parameters,
    per_agent,
    some,
)
from .output_lock import lock_output, release_stale_lock
from .plugins.class_source import UnreadableValue, reads_only, unread_fields, without_running_code
from .plugins.plugin import (
    attribute_names,
    attribute_problems,
    builtin_classes,
    builtin_name,
    find_class,
    from_attributes,
    kebab_case,
    required_fields,
    reset_undeclared,
)
from .plugins.plugin_module import plugin_address, plugin_sources, relative_name, sources_of
from .pose import MOUNT_HEIGHT, Pose, SpatialPose, Twist, product, wrap_angle
from .random import stream
from .scene import PERSON_HEIGHT, Scene
from .systems import lock_file, machine_memory, peak_memory, refuse_system, system_name, user_data_folder
from .tree import StateError, StateMark, Storage, storable
from .version import source_digest
from .walls import Walls

if TYPE_CHECKING:
    from .access import AccessPolicy, close_listener, is_loopback
    from .compiling import notify_compiling
    from .kernels import cache_folder, cache_root, is_cold, kernel, prange, read_only
    from .markup.gltf import MOST_PARTS, MOST_TRIANGLES, GltfFile, check_gltf_table, glb_table, read_gltf, table_rows
    from .markup.svg import PERSON_COLOR, ROBOT_COLOR, WALL_COLOR, Disc, Path2D, draw_svg
    from .markup.yaml import parse_yaml
    from .neighbors import CHUNK, SMALL, Neighbors
    from .random_streams import (
        HASH_BLOCK,
        RandomStreams,
        draw_uniform,
        hash_blocks,
        hash_start,
        next_uniform,
        stream_states,
    )
    from .workers import each, run_saved_jobs

__getattr__, __dir__, _ = lazy_exports(__name__)

__all__ = [
    "CHUNK",
    "GESTURES",
    "HASH_BLOCK",
    "MOST_PARTS",
    "MOST_TRIANGLES",
    "MOUNT_HEIGHT",
    "PERSON_COLOR",
    "PERSON_HEIGHT",
    "PROGRAMS",
    "ROBOT_COLOR",
    "SMALL",
    "STAGE",
    "WALL_COLOR",
    "AccessPolicy",
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
    "GltfFile",
    "InputError",
    "MissingExtra",
    "Neighbors",
    "PacedClock",
    "Paper",
    "Parameter",
    "Path2D",
    "PerAgent",
    "Pose",
    "RandomStreams",
    "RobotError",
    "Scene",
    "Skins",
    "SpatialPose",
    "StateError",
    "StateMark",
    "Storage",
    "TickSchedule",
    "TrialError",
    "Twist",
    "UnknownName",
    "UnreadableValue",
    "Walls",
    "attribute_names",
    "attribute_problems",
    "builtin_classes",
    "builtin_name",
    "cache_folder",
    "cache_root",
    "check_gltf_table",
    "check_number",
    "check_parameters",
    "check_programs",
    "close_listener",
    "dense",
    "did_you_mean",
    "draw_svg",
    "draw_uniform",
    "each",
    "every",
    "explain_write_errors",
    "field_units",
    "find_class",
    "format_xml",
    "from_attributes",
    "glb_table",
    "hash_blocks",
    "hash_start",
    "import_optional",
    "is_cold",
    "is_loopback",
    "kebab_case",
    "kernel",
    "lock_file",
    "lock_output",
    "machine_memory",
    "nearest_name",
    "next_uniform",
    "notify_compiling",
    "parameter",
    "parameters",
    "parse_number",
    "parse_xml",
    "parse_yaml",
    "peak_memory",
    "per_agent",
    "plugin_address",
    "plugin_sources",
    "prange",
    "product",
    "read_bytes",
    "read_gltf",
    "read_only",
    "reads_only",
    "refuse_system",
    "reject_entities",
    "relative_name",
    "release_stale_lock",
    "required_fields",
    "reset_undeclared",
    "run_saved_jobs",
    "some",
    "source_digest",
    "sources_of",
    "storable",
    "stream",
    "stream_states",
    "strict_xml",
    "system_name",
    "table_rows",
    "tree",
    "unread_fields",
    "user_data_folder",
    "whole_ticks",
    "without_running_code",
    "wrap_angle",
]
