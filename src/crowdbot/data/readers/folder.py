"""Folders that are one recording: a ROS 2 bag, one file a person, or the frames of WILDTRACK."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from crowdbot.core import DataError
from crowdbot.data.source import MAX_ROWS, Source, folder_files
from crowdbot.data.trajectories import Trajectories

from . import tables, wildtrack
from .assemble import assemble
from .reader import ReadOptions
from .video.pixel_tracks import GRAND_CENTRAL, GRAND_CENTRAL_FPS, triples

BAG_INFO, BAG_ENDINGS = "metadata.yaml", (".mcap", ".db3")


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
    return tables.read_persons(sources, folder, options)


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
        y=values[:, 1], fps=GRAND_CENTRAL_FPS, units="px", note=f"{len(sources)} files of one person each",
    )  # fmt: skip
