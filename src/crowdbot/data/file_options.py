"""Options for reading a recording, declared once for the command line, ``<recorded>`` of trials, and Python."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

AGENTS = ("pedestrians", "all")
"""Who is read where a file has labels."""
UNITS = ("m", "cm", "mm", "km", "ft", "px", "deg")
"""Units of coordinates in a file."""
NEXT_COLUMN = re.compile(r"\s+(?=[a-z_]+=)")


class FileOption(NamedTuple):
    """An option: its description without the default, the default in words, the metavar, and whether it is a number.

    ``per_file`` options may differ between the files of a command, ``PART=VALUE``.
    """

    about: str
    default: str
    metavar: str = "NAME"
    number: bool = False
    per_file: bool = False


FILE_OPTIONS = {
    "fps": FileOption("frame rate of the frame column in Hz", "from the file", "FRAMES", number=True, per_file=True),
    "format": FileOption("file format, see `crowdbot list formats`", "detected"),
    "units": FileOption(
        "units of the coordinates: m, cm, mm, km, ft, px, or deg for longitude and latitude",
        "from the file",
        per_file=True,
    ),
    "columns": FileOption(
        "columns of a table by name or number: id, frame, time (time_ms, time_us, time_ns), x, y, label",
        "by their usual names",
        "NAME=COLUMN",
    ),
    "scale": FileOption("metres per pixel of coordinates in pixels", "none", "METRES", number=True, per_file=True),
    "homography": FileOption("text file with the 3 x 3 matrix from pixels to metres", "none", "FILE"),
    "topic": FileOption("topic of people of a ROS bag", "/people, or the only one"),
    "frame": FileOption(
        "coordinate frame of the tracks of a ROS bag, such as map", "the fixed frame of the transforms"
    ),
    "time_base": FileOption("time base of the ETH recording: true or published", "true"),
    "agents": FileOption("who is read where the file has labels: pedestrians, or all with cyclists and cars", ""),
}
"""Options by name. Commands call them ``--fps`` to ``--agents``, with hyphens for underscores."""


def parse_columns(words: Iterable[str]) -> tuple[tuple[str, str], ...]:
    """Return columns as pairs of a quantity and a name or number.

    Raises:
        InputError: a word is not NAME=COLUMN.

    >>> parse_columns(["id=who", "x=3"])
    (('id', 'who'), ('x', '3'))
    """
    from crowdbot.core import InputError  # loads NumPy, and the help of commands lists these options without it

    pairs = []
    for word in words:
        quantity, sign, column = word.partition("=")
        if not sign or not column:
            raise InputError(f"columns {word}: write NAME=COLUMN, such as id=pedestrian")
        pairs.append((quantity, column))
    return tuple(pairs)


def split_columns(text: str) -> list[str]:
    """Split columns in one text, also if names of columns have blanks.

    >>> split_columns("id=who x=x [cm] y=4")
    ['id=who', 'x=x [cm]', 'y=4']
    """
    return NEXT_COLUMN.split(text.strip()) if text.strip() else []
