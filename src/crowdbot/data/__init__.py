"""Recordings of people: readers, writers and windows; and forecasts.

Names are loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from .degrade import Degradation, DegradedTracks
    from .example import example_windows
    from .file_formats import FORMATS, TIME_BASES, detect_format, load
    from .file_options import AGENTS, FILE_OPTIONS, UNITS, FileOption, parse_columns, split_columns
    from .forecast import Forecast
    from .forecast_files import FORECAST_SUFFIXES, check_forecast_suffix, read_forecasts, write_forecasts
    from .homography import read_homography
    from .mcap_reader import (
        MCAP_MAGIC,
        McapChannel,
        McapError,
        McapMessage,
        McapOpcode,
        McapPlace,
        McapReader,
        has_summary,
        read_attachment,
        read_message,
    )
    from .motion import fill_gaps, observed_velocity, resample_rows, slice_rows, steady_velocity
    from .place_layout import PlaceLayout, walkable_rings
    from .protocols import PROTOCOLS, NoWindowError
    from .readers.columns import check_quantities
    from .readers.hdf5_arrays import read_hdf5_arrays
    from .readers.plausibility import WIDEST_DEGREES
    from .readers.ros.bags import read_bag_messages
    from .readers.ros.detections import DETECTIONS, PERSON_CLASSES, detected_people
    from .readers.ros.episode import PEOPLE_TYPES
    from .readers.ros.frames import Frames, frame_name, stamp_of
    from .readers.time_base import RowRateError
    from .readers.ucy import UCY_TO_METRES
    from .recording import Recording
    from .source import folder_files
    from .track_writers import save
    from .trajectories import PrimaryScene, Trajectories
    from .trajnet_scenes import TRAJNET_CATEGORIES, primary_windows, scenes_of_category
    from .windows import Windows

__getattr__, __dir__, _ = lazy_exports(__name__)

__all__ = [
    "AGENTS",
    "DETECTIONS",
    "FILE_OPTIONS",
    "FORECAST_SUFFIXES",
    "FORMATS",
    "MCAP_MAGIC",
    "PEOPLE_TYPES",
    "PERSON_CLASSES",
    "PROTOCOLS",
    "TIME_BASES",
    "TRAJNET_CATEGORIES",
    "UCY_TO_METRES",
    "UNITS",
    "WIDEST_DEGREES",
    "Degradation",
    "DegradedTracks",
    "FileOption",
    "Forecast",
    "Frames",
    "McapChannel",
    "McapError",
    "McapMessage",
    "McapOpcode",
    "McapPlace",
    "McapReader",
    "NoWindowError",
    "PlaceLayout",
    "PrimaryScene",
    "Recording",
    "RowRateError",
    "Trajectories",
    "Windows",
    "check_forecast_suffix",
    "check_quantities",
    "detect_format",
    "detected_people",
    "example_windows",
    "fill_gaps",
    "folder_files",
    "frame_name",
    "has_summary",
    "load",
    "observed_velocity",
    "parse_columns",
    "primary_windows",
    "read_attachment",
    "read_bag_messages",
    "read_forecasts",
    "read_hdf5_arrays",
    "read_homography",
    "read_message",
    "resample_rows",
    "save",
    "scenes_of_category",
    "slice_rows",
    "split_columns",
    "stamp_of",
    "steady_velocity",
    "walkable_rings",
    "write_forecasts",
]
