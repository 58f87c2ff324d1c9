"""Load a recording; the format is detected from the content."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from crowdbot.core import DataError, InputError, did_you_mean

from .readers import episode, eth, juelich, petrack, sdd, sgan, socialways, tables, trajnetpp, ucy
from .readers.assemble import check_units
from .readers.reader import Reader, ReadOptions
from .readers.time_base import check_fps
from .source import Source
from .trajectories import Trajectories

__all__ = ["FORMATS", "TIME_BASES", "detect_format", "load"]

_READERS: tuple[Reader, ...] = (
    episode.READER,
    tables.PARQUET,
    juelich.HDF5,
    juelich.SQLITE,
    socialways.READER,
    trajnetpp.READER,
    ucy.READER,
    sdd.READER,
    petrack.READER,
    eth.READER,
    sgan.READER,
    tables.CSV,
)

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
) -> Trajectories:
    """Load a recording of people.

    Args:
        path: the file; the format is detected from its content, not its name.
        fps: frames per second of the frame counter [1/s] (default: from the file or its convention). Rows of a track
            are ``frame_step`` frames apart, so the time step is ``frame_step / fps``: the ETH/UCY text files have a
            step of 10 frames at ``fps=25``, which is 0.4 s. Without a frame column, or where frames number the rows
            (``social-ways``, ``episode``), ``fps`` is rows per second.
        format: one of ``FORMATS`` (default: detected).
        units: units of the coordinates in the file, ``m``, ``cm``, ``mm`` or ``px`` (default: from the file).
        time_base: ``true``, or ``published`` for the one ETH file that is published with a wrong time step.

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
    options = ReadOptions(None if fps is None else check_fps(fps), units, time_base)
    source = Source.of(Path(path))
    reader = next((reader for reader in _READERS if reader.name == format), None) or _detect(source)
    return reader.read(source, options)


def detect_format(path: str | PathLike[str]) -> str:
    """Return the name of the format of a recording, from its content: one of ``FORMATS``.

    Raises:
        DataError: the file is missing, empty, larger than 2 GiB, or of no supported format.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "two.csv")
    ...     _ = path.write_text("0 1 0.0 0.0\\n10 1 0.5 0.0\\n")
    ...     detect_format(path)
    'sgan'
    """
    return _detect(Source.of(Path(path))).name


def _detect(source: Source) -> Reader:
    for reader in _READERS:
        if reader.sniff(source):
            return reader
    kind = {"binary": "is binary and", "zip": "is a zip and"}.get(source.kind, "is text and")
    first = f" (it starts with {source.lines[0].strip()[:40]!r})" if source.lines else ""
    raise DataError(f"{source.path} {kind} of an unknown format{first}; formats are {', '.join(FORMATS)}")
