"""Load a recording; the format is detected from the content."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path

from numpy.typing import ArrayLike

from crowdbot.core import DataError, InputError, did_you_mean

from .readers import (
    eth,
    ind,
    jrdb,
    juelich,
    lcas,
    petrack,
    sgan,
    simulators,
    socialways,
    tables,
    thor_magni,
    trajnetpp,
    ucy,
    wildtrack,
)
from .readers.assemble import check_units
from .readers.columns import check_quantities
from .readers.folder import bag_file, read_folder
from .readers.other_files import describe
from .readers.plausibility import check_walkers
from .readers.reader import Reader, ReadOptions
from .readers.ros import episode
from .readers.time_base import check_fps
from .readers.video import boxes, cvml, pixel_tracks
from .source import Source
from .trajectories import Trajectories

_READERS: tuple[Reader, ...] = (
    episode.READER,
    tables.PARQUET,
    episode.SQLITE,
    episode.ROS1,
    juelich.HDF5,
    juelich.SQLITE,
    socialways.READER,
    jrdb.READER,
    wildtrack.READER,
    thor_magni.READER,
    trajnetpp.READER,
    ucy.READER,
    lcas.READER,
    tables.ATC,
    cvml.READER,
    boxes.SDD,
    boxes.KITTI,
    boxes.MOT,
    simulators.VADERE,
    simulators.VISWALK,
    pixel_tracks.EDINBURGH,
    pixel_tracks.GRAND_CENTRAL,
    pixel_tracks.FOUR_ROWS,
    petrack.READER,
    eth.READER,
    sgan.READER,
    ind.READER,
    tables.CSV,
)

BAGS = (episode.READER, episode.SQLITE, episode.ROS1)
TABLES = (tables.CSV, tables.PARQUET, tables.ATC)

FORMATS = {reader.name: reader.about for reader in _READERS}
"""Supported formats, each with a line of description."""

TIME_BASES = {
    "true": "the time step of the recording",
    "published": "0.4 s per row for the ETH text file (biwi_eth.txt), as in publications; its true step is 0.667 s",
}


def load(
    path: str | PathLike[str],
    fps: float | None = None,
    format: str | None = None,
    units: str | None = None,
    time_base: str = "true",
    columns: Mapping[str, str] | None = None,
    transform: ArrayLike | None = None,
    topic: str | None = None,
    frame: str | None = None,
) -> Trajectories:
    """Load a recording of people.

    Args:
        path: the file; the format is detected from its content, not its name. A text may be packed by gzip. A folder is
            a ROS 2 bag, or tables of one person each.
        fps: frames per second of the frame counter [1/s] (default: from the file or its convention). Rows of a track
            are ``frame_step`` frames apart, so the time step is ``frame_step / fps``: the ETH/UCY text files have a
            step of 10 frames at ``fps=25``, which is 0.4 s. Without a frame column, or where frames number the rows
            (``social-ways``, ``episode``), ``fps`` is rows per second.
        format: one of ``FORMATS`` (default: detected).
        units: units of the coordinates in the file, one of :data:`crowdbot.data.UNITS`; ``deg`` is longitude and
            latitude (default: from the file).
        time_base: ``true``, or ``published`` for the one ETH file that is published with a wrong time step.
        columns: columns of a CSV or Parquet file by quantity (``id``, ``frame``, ``time``, ``x``, ``y``, ``label``),
            for names that are not found: ``{"id": "who", "x": "east"}``; numbers count columns from 1, for tables
            without names. Times that are not in seconds are ``time_ms``, ``time_us`` or ``time_ns``.
        transform: metres per pixel, or a homography ``[3, 3]`` from (x, y, 1) of the file to metres. The coordinates
            of the file are pixels then.
        topic: topic of people of a ROS bag (default: ``/people``, or the only topic of people).
        frame: coordinate frame of the tracks of a ROS bag, such as ``map`` (default: the frame of the people if it is
            fixed, else the root of the transforms above it).

    Raises:
        InputError: an argument is not allowed.
        DataError: the file is missing, empty, damaged, larger than 2 GiB, or of no supported format; a coordinate is
            not finite or a row is duplicated; or ``fps`` is a row rate, which makes the speeds impossible for people.

    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "two.txt")
    ...     _ = path.write_text("0 1 0.0 0.0\\n10 1 0.5 0.0\\n")
    ...     load(path)
    <Trajectories two.txt: 2 rows of 1 people, dt 0.4 s>
    """
    for what, word, known in (("format", format, FORMATS), ("time base", time_base, TIME_BASES)):
        if word is not None and word not in known:
            raise InputError(f"unknown {what} {word!r}{did_you_mean(str(word), known)}; known are {', '.join(known)}")
    check_units(units)
    check_quantities(columns or {})
    if transform is not None and units not in (None, "px"):
        raise InputError(f"units {units!r} and a transform are given; a transform is from pixels to metres")
    units = units if transform is None else "px"
    options = ReadOptions(None if fps is None else check_fps(fps), units, time_base, columns or {}, topic, frame)
    path = Path(path)
    if path.is_dir():
        bag = bag_file(path)
        if bag is None:
            if format or topic or frame:
                raise InputError(f"{path} is a folder of files, which has no format, topic or frame; leave them out")
            return _finish(read_folder(path, options), transform, options)
        path = bag
    source = Source.of(path)
    reader = next((reader for reader in _READERS if reader.name == format), None)
    reader = reader or (_table(source) if columns else _detect(source))
    if columns and reader not in TABLES:
        raise InputError(f"columns are given, but the format {reader.name} has none; they need a CSV or Parquet file")
    if (topic or frame) and reader not in BAGS:
        raise InputError(f"a topic or a frame is given, but the format {reader.name} has none; they need a ROS bag")
    return _finish(reader.read(source, options), transform, options)


def _finish(tracks: Trajectories, transform: ArrayLike | None, options: ReadOptions) -> Trajectories:
    """Return the tracks in metres if a transform is given."""
    return tracks if transform is None else check_walkers(tracks.metres(transform), options)


def detect_format(path: str | PathLike[str], columns: bool = False) -> str:
    """Return the name of the format of a recording, from its content: one of ``FORMATS``.

    Args:
        path: the file.
        columns: whether the user names columns, so that the file is a table.

    Raises:
        DataError: the file is missing, empty, larger than 2 GiB, or of no supported format.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "two.csv")
    ...     _ = path.write_text("0 1 0.0 0.0\\n10 1 0.5 0.0\\n")
    ...     detect_format(path)
    'sgan'
    """
    source = Source.of(Path(path))
    return (_table(source) if columns else _detect(source)).name


def _table(source: Source) -> Reader:
    """Return the reader of tables for a file whose columns the user names."""
    return tables.PARQUET if source.kind == "parquet" else tables.CSV


def _detect(source: Source) -> Reader:
    for reader in _READERS:
        if reader.sniff(source):
            return reader
    known = describe(source)
    if known:
        raise DataError(f"{source.path} {known}")
    kind = {"binary": "is binary and"}.get(source.kind, "is text and")
    first = f" (it starts with {source.lines[0].strip()[:40]!r})" if source.lines else ""
    hint = "a table without names needs numbers of columns, such as --columns time=1 id=2 x=3 y=4; "
    numbers = tables.has_numbers(source)
    raise DataError(
        f"{source.path} {kind} of an unknown format{first}; {hint if numbers else ''}formats are {', '.join(FORMATS)}"
    )
