"""L-CAS: ``data.csv`` of people around a robot, 2.5 rows per second, without a line of names (Yan et al., IROS 2017).

Columns: row of the recording, person, x, y [m], and the z and w components of the quaternion of the heading.
"""

from __future__ import annotations

import numpy as np

from crowdbot.core import DataError
from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .reader import Reader, ReadOptions

ROW_RATE = 2.5
"""Rows per second [1/s]."""
NEEDED = 6
"""Number of columns; a seventh one, the name of the scene, is ignored."""


def sniff(source: Source) -> bool:
    """Return whether the first rows have commas, and end with two components of a unit quaternion."""
    rows = [line.split(",") for line in source.lines[:20]]
    return bool(rows) and all(len(row) in (NEEDED, NEEDED + 1) and _is_unit(row[4:NEEDED]) for row in rows)


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read the positions of people."""
    rows, lines = [], []
    for number, text in enumerate(source.text().splitlines(), 1):
        if not text.strip():
            continue
        words = text.split(",")
        try:
            frame, person, x, y = map(float, words[:4])
        except ValueError:
            raise DataError(
                f"{source.name} line {number}: the first four of {NEEDED} columns must be numbers"
            ) from None
        rows.append((frame, person, x, y))
        lines.append(number)
    frames, people, xs, ys = zip(*rows, strict=True)
    return assemble(
        source, options, id=people, frame=frames, x=xs, y=ys, row_rate=ROW_RATE, line=np.asarray(lines),
        note="2.5 rows per second are assumed, as in L-CAS; fps overrides this",
    )  # fmt: skip


def _is_unit(words: list[str]) -> bool:
    try:
        z, w = map(float, words)
    except ValueError:
        return False
    return abs(z * z + w * w - 1.0) < 0.02


READER = Reader("lcas", "L-CAS data.csv: people around a robot, 2.5 rows per second", sniff, read)
