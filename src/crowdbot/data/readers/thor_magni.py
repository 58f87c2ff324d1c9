"""THÖR-MAGNI: CSV files of motion capture at 100 Hz with lines of metadata (Schreiter et al., IJRR 2024).

The metadata end with the line of column names, which begins with ``Frame``. A body has the columns ``NAME Centroid_X``
and ``NAME Centroid_Y`` [mm]; where they are missing, the mean of its markers ``NAME - K X`` is used.
"""

from __future__ import annotations

import csv
import io
import itertools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .reader import Reader, ReadOptions

FPS = 100.0
FIRST = "FILE_ID"
MOST_METADATA = 100
"""Largest number of lines before the column names."""
PERSON, ROBOT = "Helmet", "DARKO"
"""Beginnings of the names of people and of robots; other bodies are objects."""


def sniff(source: Source) -> bool:
    """Return whether the first line has the file name of THÖR-MAGNI, and a later one the bodies."""
    lines = source.lines[:MOST_METADATA]
    return bool(lines) and lines[0].startswith(FIRST) and any(line.startswith("BODY_NAMES") for line in lines)


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read people and robots; the roles of people are labels."""
    try:
        lines = iter(list(csv.reader(io.StringIO(source.text(), newline=""))))
    except csv.Error as error:
        raise DataError(f"{source.name} is not a table of THÖR-MAGNI, or is damaged: {error}") from None
    metadata: dict[str, list[str]] = {}
    names: list[str] = []
    for row in itertools.islice(lines, MOST_METADATA):
        if row and row[0] == "Frame":
            names = row
            break
        metadata |= {row[0]: [word for word in row[1:] if word]} if row else {}
    bodies = metadata.get("BODY_NAMES", [])
    if not names or not bodies:
        raise DataError(f"{source.name} has no BODY_NAMES, or no line of column names that begins with Frame")
    roles = dict(zip(bodies, metadata.get("BODY_ROLES", []), strict=False))
    kept = [body for body in bodies if body.startswith((PERSON, ROBOT))]
    columns = {body: _columns(source.name, names, body) for body in kept}
    frame, place = _rows(source.name, lines, columns, 1 + len(metadata))
    here = ~np.isnan(place).any(axis=2)
    rows, number = np.nonzero(here)
    ids = number + 1
    note = "100 Hz is assumed, as in THÖR-MAGNI; fps overrides this"
    if len(kept) < len(bodies):
        note += f"; {len(bodies) - len(kept)} objects are left out"
    return assemble(
        source, options, id=ids, frame=frame[rows], x=place[rows, number, 0], y=place[rows, number, 1], fps=FPS,
        units="mm", frame_step=1,
        note=note,
        labels={k: roles[body] for k, body in enumerate(kept, 1) if body in roles and k in ids},
        robots=frozenset(k for k, body in enumerate(kept, 1) if body.startswith(ROBOT) and k in ids),
    )  # fmt: skip


def _columns(name: str, names: list[str], body: str) -> tuple[list[int], list[int]]:
    """Return the columns of x and y of a body."""
    found = []
    for axis in "XY":
        exact = [k for k, word in enumerate(names) if word == f"{body} Centroid_{axis}"]
        marks = [k for k, word in enumerate(names) if word.startswith(f"{body} - ") and word.endswith(f" {axis}")]
        found.append(exact or marks)
    if not found[0] or len(found[0]) != len(found[1]):
        raise DataError(f"{name} has no columns {body} Centroid_X and {body} Centroid_Y, nor markers of this body")
    return found[0], found[1]


def _rows(
    name: str, lines: Any, columns: dict[str, tuple[list[int], list[int]]], before: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return frames ``[N]`` and positions ``[N, bodies, 2]``, NaN where there is none; repeated frames are dropped."""
    found: dict[float, list[float]] = {}
    for number, row in enumerate(lines, before + 1):
        if not row:
            continue
        try:
            places = [_mean(row, column) for both in columns.values() for column in both]
            found.setdefault(float(row[0]), places)
        except (ValueError, IndexError, OverflowError):
            raise DataError(f"{name} line {number}: a frame or a position is missing or is not a number") from None
    if not found:
        raise DataError(f"{name} has no rows")
    return np.array([*found]), np.array([*found.values()]).reshape(len(found), len(columns), 2)


def _mean(row: list[str], columns: list[int]) -> float:
    known = [float(row[column]) for column in columns if row[column]]
    return math.fsum(known) / len(known) if known else math.nan


READER = Reader("thor-magni", "THÖR-MAGNI CSV: motion capture of people and robots at 100 Hz", sniff, read)
