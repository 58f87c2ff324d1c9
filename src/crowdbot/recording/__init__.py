"""Recording: episodes as MCAP files. Write, read, repair, replay, branch, export."""

from .attachments import Carried, LeftOut, named_files
from .episode_branch import branch, branched
from .episode_export import export
from .episode_reader import Recorded, moments, read_episode
from .episode_repair import repair
from .episode_replay import Replay, replay
from .episode_writer import Recorder
from .image_export import folder_of
from .metadata import MAP, as_json, versions
from .reading_tables import READING_TABLES
from .step_records import Moment

__all__ = [
    "MAP",
    "READING_TABLES",
    "Carried",
    "LeftOut",
    "Moment",
    "Recorded",
    "Recorder",
    "Replay",
    "as_json",
    "branch",
    "branched",
    "export",
    "folder_of",
    "moments",
    "named_files",
    "read_episode",
    "repair",
    "replay",
    "versions",
]
