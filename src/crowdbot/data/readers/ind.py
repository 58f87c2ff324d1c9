"""inD and its relatives: ``NN_tracks.csv`` of road users at 25 Hz (Bock et al., IV 2020).

``NN_recordingMeta.csv`` beside the file has the frame rate, ``NN_tracksMeta.csv`` the classes of the road users.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crowdbot.core import DataError
from crowdbot.data.rows import integers
from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .columns import numbers
from .reader import Reader, ReadOptions

VIDEO_FPS = 25.0
NAMES = ("trackId", "frame", "xCenter", "yCenter")
END = "_tracks.csv"


def sniff(source: Source) -> bool:
    """Return whether the first line has the column names of inD."""
    return bool(source.lines) and set(NAMES) <= set(source.lines[0].strip().split(","))


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read the centers of all road users; classes are labels, such as ``pedestrian``."""
    table = _rows(source.name, source.text(), NAMES)
    columns = {name: numbers(np.array([row[name] for row in table]), name, source.name, None) for name in NAMES}
    users, place = _beside(source.path, "_tracksMeta.csv", "trackId", "class"), f"{source.name}: _tracksMeta.csv"
    ids = integers(numbers(np.array([row["trackId"] for row in users]), "trackId", place, None), "trackId", place)
    classes = dict(zip(ids.tolist(), (row["class"] for row in users), strict=True))
    rates = [row["frameRate"] for row in _beside(source.path, "_recordingMeta.csv", "frameRate")]
    try:
        fps = float(rates[0]) if rates else VIDEO_FPS
    except ValueError:
        raise DataError(f"{source.name}: the frame rate {rates[0]!r} of the recording is not a number") from None
    note = "" if rates else "no recordingMeta.csv beside the file: 25 Hz is assumed, as in inD; fps overrides this"
    known = set(columns["trackId"].tolist())
    return assemble(
        source,
        options,
        id=columns["trackId"],
        frame=columns["frame"],
        x=columns["xCenter"],
        y=columns["yCenter"],
        fps=fps,
        frame_step=1,
        note=note,
        labels={key: label for key, label in classes.items() if key in known},
    )


def _rows(name: str, text: str, columns: Sequence[str]) -> list[dict[str, str]]:
    """Return the rows of a table as words by column; it has the given columns, perhaps others."""
    try:
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
    except csv.Error as error:
        raise DataError(f"{name} is not a table of inD, or is damaged: {error}") from None
    if not rows:
        raise DataError(f"{name} has no rows")
    missing = [column for column in columns if column not in rows[0]]
    if missing:
        raise DataError(f"{name} has no column {missing[0]}")
    for number, row in enumerate(rows, 2):
        if None in row or None in row.values():
            raise DataError(f"{name} line {number} has another number of columns than the line of names")
    return rows


def _beside(path: Path, end: str, *names: str) -> list[dict[str, str]]:
    """Return the rows of a table beside the file; none if it is missing or lacks a column."""
    other = path.with_name(path.name.removesuffix(END) + end)
    if not path.name.endswith(END) or not other.is_file():
        return []
    return _rows(str(other), Source.of(other).text(), names)


READER = Reader("ind", "inD NN_tracks.csv: road users with classes from NN_tracksMeta.csv", sniff, read)
