"""Folders that are one recording: a ROS 2 bag, one file a person, or the frames of WILDTRACK."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from crowdbot.core import DataError
from crowdbot.data.source import MAX_ROWS, Source, folder_files
from crowdbot.data.trajectories import Trajectories

from . import tables, wildtrack
from .assemble import assemble
from .reader import ReadOptions
from .video.pixel_tracks import GRAND_CENTRAL, GRAND_CENTRAL_FPS, GRAND_CENTRAL_ORDER, triples

BAG_INFO, BAG_ENDINGS = "metadata.yaml", (".mcap", ".db3")
DOCUMENTS = (".md", ".rst", ".license")
"""Endings of texts that people read."""


def bag_file(folder: Path) -> Path | None:
    """Return the file of messages of a ROS 2 bag, or None if the folder is no bag.

    Raises:
        DataError: the bag has several files, or none that is read.
    """
    if not (folder / BAG_INFO).is_file():
        return None
    files = [path for path in folder_files(folder) if path.suffix in BAG_ENDINGS]
    if len(files) != 1:
        held = ", ".join(path.name for path in files[:10]) or "none"
        raise DataError(f"the bag {folder} must have one file of messages ({' or '.join(BAG_ENDINGS)}); it has {held}")
    return files[0]


def read_folder(folder: Path, options: ReadOptions) -> Trajectories:
    """Read the files of a folder as one recording.

    Raises:
        DataError: they cannot be read, or are recordings of several persons.
    """
    sources = [Source.of(path) for path in folder_files(folder)]
    if wildtrack.sniff(sources[0]):
        return wildtrack.read(sources[0], options)
    if GRAND_CENTRAL.sniff(sources[0]):
        return _read_grand_central(sources, folder, options)
    other = next((source for source in sources if source.kind != "text"), None)
    if other is not None:
        raise DataError(f"the folder {folder} has {other.path.name}, which is not a text; give the files to read")
    beside = [source for source in sources if _is_beside(source)]
    people = [source for source in sources if source not in beside]
    recording = next((source for source in people if not options.columns and _is_plain_recording(source)), None)
    if recording is not None:
        raise DataError(
            f"the folder {folder} has {recording.path.name}, which has rows of several persons and no names of columns;"
            f" give the files instead of the folder, such as {folder}/*{recording.path.suffix}"
        )
    if not people:
        raise DataError(
            f"the folder {folder} has no tables, only {', '.join(source.path.name for source in beside[:5])}"
        )
    tracks = tables.read_persons(people, folder, options)
    if not beside:
        return tracks
    left_out = f"not read, because it is no table: {', '.join(source.path.name for source in beside[:5])}"
    return dataclasses.replace(tracks, note="; ".join(filter(None, (tracks.note, left_out))))


def _is_beside(source: Source) -> bool:
    """Return whether a text is a single number, such as the scale of a data set, or a text to read, and no table."""
    return source.path.suffix.lower() in DOCUMENTS or (len(source.rows) == 1 and len(source.rows[0]) == 1)


def _is_plain_recording(source: Source) -> bool:
    """Return whether a text has rows of frame, id, x, y without names, of several persons."""
    if not source.numeric(4):
        return False
    return len({row[1] for row in source.rows}) > 1


def _read_grand_central(sources: list[Source], folder: Path, options: ReadOptions) -> Trajectories:
    rows = [triples(source) for source in sources]
    if sum(map(len, rows)) > MAX_ROWS:
        raise DataError(f"the folder {folder} has more rows than the limit of {MAX_ROWS}")
    stems = [source.path.name.partition(".")[0] for source in sources]
    own = all(stem.isdecimal() and len(stem) < 16 for stem in stems) and len(set(map(int, stems))) == len(stems)
    ids = [int(stem) if own else number for number, stem in enumerate(stems, 1)]
    values = np.concatenate(rows)
    return assemble(
        Source(folder, b""), options, id=np.repeat(ids, list(map(len, rows))), frame=values[:, 2], x=values[:, 0],
        y=values[:, 1], fps=GRAND_CENTRAL_FPS, units="px",
        note=f"{len(sources)} files of one person each; {GRAND_CENTRAL_ORDER}",
    )  # fmt: skip
