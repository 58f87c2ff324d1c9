"""WILDTRACK: a folder of JSON files, one per annotated frame, with cells of a grid (Chavdarova et al., CVPR 2018).

Any file of the folder stands for the folder: all files with a number as their name are read. Cells have 2.5 cm; the
grid has 480 x 1440 cells and starts at (-3 m, -9 m). The frame counter has 10 Hz, every fifth frame is annotated.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from crowdbot.core import DataError
from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .reader import Reader, ReadOptions

FPS = 10.0
START = re.compile(r"^\s*\[\s*\{")
COLUMNS, ROWS = 480, 1440
"""Size of the grid."""
CELL = 0.025
"""Size of a cell [m]."""
CORNER = (-3.0, -9.0)
"""Position of the first cell [m]."""


def sniff(source: Source) -> bool:
    """Return whether the text begins with a list of objects that have a person and a position."""
    if source.kind != "text":
        return False
    head = source.head.decode("utf-8", errors="replace")
    return bool(START.match(head)) and '"personID"' in head and '"positionID"' in head


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read the positions of people in all frames of the folder."""
    files = sorted(path for path in source.path.parent.glob("*.json") if path.stem.isdecimal())
    if source.path not in files:
        raise DataError(f"{source.name}: the name of a WILDTRACK file is its frame, such as 00000005.json")
    rows = [(int(path.stem), *place) for path in files for place in _places(path)]
    frame, person, x, y = zip(*rows, strict=True)
    note = (
        f"{len(files)} frames of the folder {source.path.parent.name}; 10 Hz is assumed, as in WILDTRACK; fps overrides"
    )
    return assemble(source, options, id=person, frame=frame, x=x, y=y, fps=FPS, note=f"{note} this")


def _places(path: Path) -> list[tuple[int, float, float]]:
    """Return person, x and y [m] of the people of a frame."""
    name = str(path)
    if path.stat().st_size <= 2:  # an empty list
        return []
    try:
        people: list[dict[str, Any]] = json.loads(Source.of(path).text())
        found = [(int(person["personID"]), int(person["positionID"])) for person in people]
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        raise DataError(f"{name} is not a file of WILDTRACK, or is damaged: {error!r}") from None
    bad = next((cell for _, cell in found if not 0 <= cell < COLUMNS * ROWS), None)
    if bad is not None:
        raise DataError(f"{name}: positionID is {bad}, it must be at least 0 and below {COLUMNS * ROWS}")
    return [
        (person, CORNER[0] + CELL * (cell % COLUMNS), CORNER[1] + CELL * (cell // COLUMNS)) for person, cell in found
    ]


READER = Reader("wildtrack", "WILDTRACK NNNNNNNN.json: cells of people by frame; reads the whole folder", sniff, read)
