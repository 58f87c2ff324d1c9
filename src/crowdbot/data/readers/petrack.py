"""PeTrack text: id, frame, x, y, z in metres or centimetres, with or without a "#" header (Boltes & Seyfried 2013).

The header has frame rate and unit. Files without a header, such as those of HERMES, are read with 16 frames/s; large
coordinates are centimetres. A note reports both assumptions. Columns after z, such as the ellipses of JPScore and the
gaze of PeTrack, are not read.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .plausibility import FileColumns, exchange_warning
from .reader import Reader, ReadOptions

HERMES_FPS = 16.0
ID_FIRST = (
    "warning: id and frame seem to be swapped (read as id frame x y z): give --columns frame=1 id=2 x=3 y=4 and"
    " the frame rate"
)
ROOM = 50.0
"""Coordinates beyond this [m] without a unit are centimetres; no indoor experiment is larger."""

FPS = re.compile(r"frame\s*rate\s*:?\s*([0-9.]+)", re.IGNORECASE)
UNIT = re.compile(
    r"\bx\s*(?:,\s*y\s*(?:,\s*z\s*)?:[^\n(]*)?[/\[(]\s*(?:in\s+)?"
    r"(?:(mm|millimet(?:re|er)s?)|(cm|centimet(?:re|er)s?)|(m|met(?:re|er)s?))\b",
    re.IGNORECASE,
)
"""Unit of x in a header: ``x/cm``, ``X (in cm)``, or ``X,Y,Z: the agents coordinates (in metres)`` of JPScore."""
COLUMNS = re.compile(r"^#\s*id\s+(?:frame|fr)\b", re.IGNORECASE)
BRACKETS = re.compile(r"\s*[\[(][^\])]*[\])]")
MOST_COLUMNS = 50


def sniff(source: Source) -> bool:
    """Return whether the header is one of PeTrack or JPScore, or rows without a header have five numbers."""
    header = _header(source)
    is_petrack = any("petrack" in line.lower() or COLUMNS.match(line) or FPS.search(line) for line in header)
    width = len(source.rows[0]) if source.rows else 0
    return source.numeric(5) or (is_petrack and 4 <= width <= MOST_COLUMNS and source.numeric(width))


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read id, frame, x, y; z is the height, and columns after it are not read."""
    header = "\n".join(_header(source))
    if not source.rows:
        raise DataError(f"{source.name} has a header but no rows")
    values, line = source.table(len(source.rows[0]))
    if not 4 <= values.shape[1] <= MOST_COLUMNS:
        raise DataError(
            f"{source.name} has {values.shape[1]} columns, PeTrack files have id frame x y, and optionally z and others"
        )
    _check_names(header, source.name)
    odd = exchange_warning(values[:, 0], values[:, 1], values[:, 2:4], ID_FIRST) if not header else ""
    fps, unit = FPS.search(header), UNIT.search(header)
    units, guess = (_unit_of(unit), "") if unit else _guess_units(values)
    notes = [] if options.units else [guess]
    if fps is None and options.fps is None and not header:
        notes.append("no frame rate in the file: 16 Hz is assumed, as in HERMES; fps overrides this")
    return assemble(
        source,
        options,
        id=values[:, 0],
        frame=values[:, 1],
        x=values[:, 2],
        y=values[:, 3],
        fps=_parse_fps(fps, source.name) if fps else (None if header else HERMES_FPS),
        units=units,
        note="; ".join(note for note in (*notes, odd) if note),
        line=line,
        columns=FileColumns(height="z", heights=values[:, 4]) if values.shape[1] >= 5 else None,
    )


def _unit_of(unit: re.Match[str]) -> str:
    return next(short for short, word in zip(("mm", "cm", "m"), unit.groups(), strict=True) if word)


def _check_names(header: str, name: str) -> None:
    """Raise :class:`DataError` if the header names other columns than id, frame, x, y."""
    named = next((line for line in header.splitlines() if COLUMNS.match(line)), "")
    words = re.split(r"[\s,]+", BRACKETS.sub("", named).lstrip("# ").lower())
    if named and [word.partition("/")[0] for word in words[2:4]] != ["x", "y"]:
        raise DataError(
            f"{name}: its header names the columns {' '.join(words[:6])}, PeTrack files have id frame x y; name them:"
            " --format csv --columns id=1 frame=2 x=NUMBER y=NUMBER"
        )


def _header(source: Source) -> list[str]:
    return [line.strip() for line in source.lines if line.lstrip().startswith("#")]


def _parse_fps(fps: re.Match[str], name: str) -> float:
    try:
        return float(fps.group(1))
    except ValueError:
        raise DataError(f"{name}: the header's frame rate {fps.group(1)!r} is not a number; give fps") from None


def _guess_units(values: NDArray[np.float64]) -> tuple[str, str]:
    size = float(np.nanmax(np.abs(values[:, 2:4]), initial=0.0))
    units = "cm" if size > ROOM else "m"
    return units, f"no unit in the file: coordinates up to {size:.0f} are interpreted as {units}; units overrides this"


READER = Reader("petrack", "PeTrack, JPScore and HERMES text: id frame x y z, metres or centimetres", sniff, read)
