"""Recording of episodes as MCAP files: write, read, repair, replay, branch and export."""

from .attachments import AttachedFile, SkippedAttachmentWarning, files_digest, named_files, write_trial_files
from .episode_branch import branch
from .episode_export import READING_TABLES, export, folder_of
from .episode_reader import RecordedEpisode, iterate_steps, read_episode
from .episode_repair import repair
from .episode_replay import Replay, replay
from .episode_writer import Recorder
from .keyframes import KeyframeWarning, keyframe_ticks
from .metadata import as_json, versions
from .recorded_rows import RecordedRows
from .recorded_run import episode_path, open_run, record, run
from .recorded_simulation import EpisodeRerun, RecordedSimulation, open_rerun
from .robot_messages import LinkFrames
from .step_messages import StepMessage, StepMessages, is_latched
from .step_records import RecordedStep

__all__ = [
    "READING_TABLES",
    "AttachedFile",
    "EpisodeRerun",
    "KeyframeWarning",
    "LinkFrames",
    "RecordedEpisode",
    "RecordedRows",
    "RecordedSimulation",
    "RecordedStep",
    "Recorder",
    "Replay",
    "SkippedAttachmentWarning",
    "StepMessage",
    "StepMessages",
    "as_json",
    "branch",
    "episode_path",
    "export",
    "files_digest",
    "folder_of",
    "is_latched",
    "iterate_steps",
    "keyframe_ticks",
    "named_files",
    "open_rerun",
    "open_run",
    "read_episode",
    "record",
    "repair",
    "replay",
    "run",
    "versions",
    "write_trial_files",
]
