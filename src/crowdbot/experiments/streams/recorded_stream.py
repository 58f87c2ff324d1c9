"""RecordedStream: a stream of another program that was recorded during a session."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import EpisodeError
from crowdbot.typing import Floats

STREAMS = "streams"
"""Folder of the streams in the folder of a participant."""
COLUMNS = ("stream_time", "offset", "clock")
"""First columns of the samples: clock of the sender, what to add to it, and the monotonic clock of this computer."""


class RecordedStream(NamedTuple):
    """A recorded stream.

    Fields:
        name, type: as the sender names them.
        labels: names of the C channels.
        units: units of the channels, empty if the sender does not say.
        rate: nominal rate [Hz]; 0 for an irregular one.
        stream_time: ``[T]`` time stamps in the clock of the sender [s].
        offset: ``[T]`` estimated offset: clock of this computer minus that of the sender [s].
        clock: ``[T]`` the time stamps in the monotonic clock of this computer [s].
        values: ``[T, C]``.
    """

    name: str
    type: str
    labels: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    stream_time: Floats
    offset: Floats
    clock: Floats
    values: Floats


def read_streams(folder: Path | str) -> list[RecordedStream]:
    """Return the streams that were recorded in the session of a participant.

    Args:
        folder: folder of the participant.

    Raises:
        EpisodeError: a file is damaged.
    """
    return [_read(path) for path in sorted((Path(folder) / STREAMS).glob("*.json"))]


def _read(path: Path) -> RecordedStream:
    try:
        head: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        labels, units = tuple(map(str, head["labels"])), tuple(map(str, head["units"]))
        text = path.with_suffix(".csv").read_text(encoding="utf-8")
        lines = list(csv.reader(text[: text.rfind("\n") + 1].splitlines()))  # a killed session may end inside a row
        rows = np.array([list(map(float, line)) for line in lines[1:]], dtype=np.float64)
        rows = rows.reshape(-1, len(COLUMNS) + len(labels))
        name, kind, rate = str(head["name"]), str(head["type"]), float(head["rate"])
    except (OSError, ValueError, KeyError, TypeError):
        raise EpisodeError(f"the recorded stream {path} is damaged") from None
    stream_time, offset, clock = rows[:, : len(COLUMNS)].T
    return RecordedStream(name, kind, labels, units, rate, stream_time, offset, clock, rows[:, len(COLUMNS) :])
