"""Load a recording: the format is found by content, or given."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from crowdbot.core import DataError, InputError, did_you_mean

from . import episode, eth, juelich, petrack, sdd, sgan, socialways, tables, trajnetpp, ucy
from .assemble import check_fps, check_units
from .source import Given, Reader, Source
from .trajectories import Trajectories

__all__ = ["FORMATS", "TIME_BASES", "load"]

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
"""Formats that can be read, with a line about each."""

TIME_BASES = {
    "true": "rows are as far apart as they were in the recording",
    "published": "rows of the ETH text (biwi_eth.txt) are taken as 0.4 s apart, as publications do",
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
        path: the file; its content decides about the format, not its name.
        fps: rows a second of one track [1/s], when the file does not say or is wrong.
        format: one of ``FORMATS``, when the content should not decide.
        units: ``m``, ``cm``, ``mm`` or ``px``, of the numbers in the file, when it does not say or is wrong.
        time_base: ``true``, or ``published`` for the one ETH file that is published with a wrong one.

    Raises:
        InputError: an argument is not allowed.
        DataError: the file is missing, empty, damaged, too large (2 GiB), of no known format, or holds rows that are
            not finite or stand twice.

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
    given = Given(None if fps is None else check_fps(fps), units, time_base)
    source = Source.of(Path(path))
    reader = next((reader for reader in _READERS if reader.name == format), None) or _sniffed(source)
    return reader.read(source, given)


def _sniffed(source: Source) -> Reader:
    for reader in _READERS:
        if reader.sniff(source):
            return reader
    kind = {"binary": "is binary and", "zip": "is a zip and"}.get(source.kind, "is text and")
    first = f" (it begins with {source.lines[0].strip()[:40]!r})" if source.lines else ""
    raise DataError(f"{source.path} {kind} of no known format{first}; formats are {', '.join(FORMATS)}")
