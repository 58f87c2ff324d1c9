"""Recording: episodes as MCAP files. Write, read, repair, replay, branch, export."""

from .attachments import Carried, LeftOut, named_files
from .episode_branch import branch
from .episode_export import export
from .episode_reader import Recorded, moments, read_episode
from .episode_repair import repair
from .episode_replay import Replay, replay
from .episode_writer import Recorder
from .image_export import folder_of
from .metadata import as_json, versions
from .reading_tables import READING_TABLES
from .recorded_run import opened, record, run, target
from .step_records import Moment

__all__ = [
    "READING_TABLES",
    "Carried",
    "LeftOut",
    "Moment",
    "Recorded",
    "Recorder",
    "Replay",
    "as_json",
    "branch",
    "export",
    "folder_of",
    "moments",
    "named_files",
    "opened",
    "read_episode",
    "record",
    "repair",
    "replay",
    "run",
    "target",
    "versions",
]
