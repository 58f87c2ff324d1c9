"""Tracks in pixels of fixed cameras: Edinburgh Informatics Forum, Grand Central, and files of four rows.

* Edinburgh Informatics Forum, ``tracks.01Sep.txt`` (Majecka, 2009): ``TRACK.R1=[[x y frame];[x y frame]];``, about 9
  frames per second, 24.7 mm per pixel.
* Grand Central (Yi et al., CVPR 2015): one file for a person, ``000001.txt``, with a number per line: y, x, frame, y,
  x, frame; 25 frames per second. The other files of the folder are read by giving the folder.
* Four rows of Social LSTM (Alahi et al., CVPR 2016), ``pixel_pos.csv``: frames, persons, y and x.
"""

from __future__ import annotations

import itertools
import re

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.readers.assemble import assemble
from crowdbot.data.readers.reader import Reader, ReadOptions
from crowdbot.data.source import MAX_ROWS, Source
from crowdbot.data.trajectories import Trajectories
from crowdbot.typing import Floats

EDINBURGH_FPS, EDINBURGH_SCALE = 9.0, 0.0247
GRAND_CENTRAL_FPS = 25.0
GRAND_CENTRAL_ORDER = (
    "x is the second number of a row, as in the homographies of its publications, although the first one is horizontal"
    " in the picture of 1920 x 1080 pixels"
)
"""Note on the order of coordinates: the first numbers reach 1919, the second ones 1079."""
TRACK = re.compile(r"^\s*TRACK\.R(\d{1,15})\s*=\s*\[(.*)\]\s*;?\s*$")
POINT = re.compile(r"\[\s*(-?\d{1,9})\s+(-?\d{1,9})\s+(\d{1,12})\s*\]")
SEPARATORS = re.compile(r"[\s;]*")
LONG_LINE = 32 * 1024
"""Length of a line that may be longer than the first bytes of a file."""
ENOUGH, BESIDE = 50, 0.05
"""Rows from which on places tell that they are fractions of a picture, and how far they may be outside of it."""


def sniff_edinburgh(source: Source) -> bool:
    """Return whether a line among the first is a track."""
    return any(line.lstrip().startswith(("TRACK.R", "Properties.R")) for line in source.lines[:20])


def read_edinburgh(source: Source, options: ReadOptions) -> Trajectories:
    """Read the tracks; of several rows of a person at one frame, the first counts."""
    found: dict[tuple[int, int], tuple[int, int, int]] = {}
    for number, text in enumerate(source.text().splitlines(), 1):
        if not text.lstrip().startswith("TRACK"):
            continue
        track = TRACK.match(text)
        if track is None or SEPARATORS.sub("", POINT.sub("", track[2])):
            raise DataError(f"{source.name} line {number} is not a track, TRACK.R1=[[x y frame];[x y frame]];")
        for x, y, frame in POINT.findall(track[2]):
            found.setdefault((int(track[1]), int(frame)), (int(x), int(y), number))
    if not found:
        raise DataError(f"{source.name} has no tracks")
    keys, rows = np.asarray([*found], dtype=np.int64), np.asarray([*found.values()], dtype=np.int64)
    note = "9 Hz are assumed, as in the Edinburgh Informatics Forum; fps overrides this"
    pixels = options.units is not None
    if not pixels:
        note += f"; {1000 * EDINBURGH_SCALE:g} mm per pixel are assumed, a scale overrides this"
    scale = 1.0 if pixels else EDINBURGH_SCALE
    return assemble(
        source, options, id=keys[:, 0], frame=keys[:, 1], x=scale * rows[:, 0], y=scale * rows[:, 1],
        fps=EDINBURGH_FPS, frame_step=1, note=note, line=rows[:, 2],
    )  # fmt: skip


def sniff_grand_central(source: Source) -> bool:
    """Return whether each of the first lines is a whole number, and each third one is larger than the one before."""
    lines = [line.strip() for line in source.lines[:60]]
    if len(lines) < 6 or not all(line.isdecimal() and len(line) < 10 for line in lines):
        return False
    frames = list(map(int, lines[2::3]))
    return all(before < after for before, after in itertools.pairwise(frames))


def triples(source: Source) -> NDArray[np.int64]:
    """Return x, y and frame ``[N, 3]`` of a person of Grand Central.

    Raises:
        DataError: a line is not a whole number, or their count is not a multiple of 3.
    """
    values = []
    for number, text in enumerate(source.text().splitlines(), 1):
        if text.strip():
            if not text.strip().isdecimal() or len(text.strip()) > 9:
                raise DataError(f"{source.name} line {number}: {text.strip()[:40]!r} is not a whole number from 0 on")
            values.append(int(text))
    if len(values) % 3 or not values or len(values) > 3 * MAX_ROWS:
        raise DataError(f"{source.name} has {len(values)} numbers, Grand Central has three for each frame: y, x, frame")
    return np.asarray(values, dtype=np.int64).reshape(-1, 3)[:, [1, 0, 2]]


def read_grand_central(source: Source, options: ReadOptions) -> Trajectories:
    """Read one person, whose id is the name of the file if that is a number."""
    rows = triples(source)
    stem = source.path.name.partition(".")[0]
    id = int(stem) if stem.isdecimal() and len(stem) < 16 else 1
    return assemble(
        source, options, id=np.full(len(rows), id), frame=rows[:, 2], x=rows[:, 0], y=rows[:, 1],
        fps=GRAND_CENTRAL_FPS, units="px",
        note="one person; the others of Grand Central are in files of the same folder, give the folder to read all;"
        f" {GRAND_CENTRAL_ORDER}",
    )  # fmt: skip


def sniff_four_rows(source: Source) -> bool:
    """Return whether there are four lines of as many numbers: frames in ascending order, persons, and two more.

    Four lines of four numbers could be rows of frame, person, x and y, too, if their first column ascends. A recording
    has longer lines than the first bytes of a file: the whole text decides then.
    """
    if source.kind != "text" or not source.lines or "," not in source.lines[0]:
        return False
    short = len(source.lines[0]) < LONG_LINE
    if (len(source.lines) if short else 1) > 4 or not _is_numbers(source.lines[0][:LONG_LINE].rpartition(",")[0]):
        return False
    lines = [line for line in source.text().splitlines() if line.strip()]
    if len(lines) != 4:
        return False
    try:
        values = np.asarray([line.replace(",", " ").split() for line in lines], dtype=np.float64)
    except ValueError:  # a word that is no number, or lines of different lengths
        return False
    whole = bool(np.all(values[:2] == np.rint(values[:2])) and np.all(np.diff(values[0]) >= 0.0))
    pairs = len(set(zip(values[0].tolist(), values[1].tolist(), strict=True))) == values.shape[1]
    columns = values.shape[1] == 4 and bool(np.all(np.diff(values[:, 0]) >= 0.0))
    return whole and pairs and values.shape[1] > 1 and not columns


def _is_numbers(line: str) -> bool:
    try:
        np.asarray(line.split(","), dtype=np.float64)
    except ValueError:
        return False
    return True


def read_four_rows(source: Source, options: ReadOptions) -> Trajectories:
    """Read frames, persons, y and x; places from 0 to 1 are fractions of the picture."""
    rows = [line.replace(",", " ").split() for line in source.text().splitlines() if line.strip()]
    if len(rows) != 4 or len({len(row) for row in rows}) != 1:
        counts = ", ".join(str(len(row)) for row in rows[:6])
        raise DataError(
            f"{source.name} has {len(rows)} lines of {counts} numbers, four of the same length are required"
        )
    try:
        frame, id, y, x = (np.asarray(row, dtype=np.float64) for row in rows)
    except ValueError as error:
        raise DataError(f"{source.name}: {error}") from None
    note, units = "the four rows are frames, persons, y and x, as in files of Social LSTM", "m"
    if len(x) >= ENOUGH and options.units is None and all(_is_fraction(axis) for axis in (x, y)):
        units = "px"
        note += (
            "; warning: all places are from 0 to 1, so they are fractions of the picture and no metres, give"
            " --homography from them to metres, or --scale with the metres of its side"
        )
    return assemble(source, options, id=id, frame=frame, x=x, y=y, units=units, note=note)


def _is_fraction(values: Floats) -> bool:
    """Return whether nearly all values are from 0 to 1."""
    low, high = np.percentile(values, [1, 99])
    return bool(low >= -BESIDE and high <= 1.0 + BESIDE)


EDINBURGH = Reader(
    "edinburgh", "Edinburgh Informatics Forum tracks.*.txt: TRACK.R1=[[x y frame];...]", sniff_edinburgh, read_edinburgh
)
GRAND_CENTRAL = Reader(
    "grand-central", "Grand Central: one file a person of y, x, frame; give the folder", sniff_grand_central,
    read_grand_central,
)  # fmt: skip
FOUR_ROWS = Reader("four-rows", "four rows of frames, persons, y and x (Social LSTM)", sniff_four_rows, read_four_rows)
