"""PeTrack text: id, frame, x, y, z in metres or centimetres, with or without a "#" header (Boltes & Seyfried 2013).

The header has frame rate and unit. Files without a header, such as those of HERMES, are read with 16 frames/s; large
coordinates are centimetres. A note reports both assumptions.
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
UNIT = re.compile(r"\bx\s*[/\[(]\s*(?:in\s+)?(mm|cm|m)\b", re.IGNORECASE)
COLUMNS = re.compile(r"^#\s*id\s+frame\b", re.IGNORECASE)


def sniff(source: Source) -> bool:
    """Return whether the header is one of PeTrack, or rows without a header have five numbers."""
    header = _header(source)
    is_petrack = any("petrack" in line.lower() or COLUMNS.match(line) or FPS.search(line) for line in header)
    return source.numeric(5) or (is_petrack and source.numeric(4))


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read id, frame, x, y; z is ignored."""
    header = "\n".join(_header(source))
    if not source.rows:
        raise DataError(f"{source.name} has a header but no rows")
    values, line = source.table(len(source.rows[0]))
    if values.shape[1] not in (4, 5):
        raise DataError(
            f"{source.name} has {values.shape[1]} columns, PeTrack files have id frame x y and optionally z"
        )
    odd = exchange_warning(values[:, 0], values[:, 1], values[:, 2:4], ID_FIRST) if not header else ""
    fps, unit = FPS.search(header), UNIT.search(header)
    units, guess = (unit.group(1).lower(), "") if unit else _guess_units(values)
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
        columns=FileColumns(height="z", heights=values[:, 4]) if values.shape[1] == 5 else None,
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


READER = Reader("petrack", "PeTrack and HERMES text: id frame x y z, metres or centimetres", sniff, read)
