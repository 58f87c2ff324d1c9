"""Options for recordings, shared by several commands. Options state whether they count rows, frames or seconds."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .output import note

if TYPE_CHECKING:
    from crowdbot.data import Recording

__all__ = ["add_recordings", "horizon", "print_notes", "recordings"]


def add_recordings(parser: argparse.ArgumentParser, predict: int = 12, required: bool = True) -> None:
    """Add the options for files, their time base and their windows."""
    add = parser.add_argument
    add("--data", nargs="+", type=Path, required=required, metavar="PATH", help="recordings")
    add("--observe", type=int, default=8, metavar="ROWS", help="observed rows of a window (default: 8)")
    add("--predict", type=int, default=predict, metavar="ROWS", help=f"predicted rows of a window (default: {predict})")
    add(
        "--protocol",
        default="all",
        metavar="NAME",
        help="evaluation protocol, see `crowdbot list protocols` (default: all)",
    )
    add(
        "--near",
        type=float,
        metavar="METRES",
        help="maximum distance of scored people from a recorded robot (default: none)",
    )
    add(
        "--fps",
        type=float,
        metavar="FRAMES",
        help="frame rate of the frame column in Hz (default: from the file); 10 frames per row at 25 Hz are 0.4 s",
    )
    add("--step", type=float, metavar="SECONDS", help="time step after resampling (default: from the file)")
    add("--format", metavar="NAME", help="file format, see `crowdbot list formats` (default: detected)")
    add(
        "--time-base",
        default="true",
        metavar="NAME",
        help="time base of the ETH recording: true or published (default: true)",
    )
    add("--units", metavar="NAME", help="units of the coordinates: m, cm, mm or px (default: from the file)")
    add(
        "--late",
        default="skip",
        metavar="NAME",
        help="people who appear during the observation: skip or extrapolate (default: skip)",
    )
    add(
        "--learn", type=float, default=0.0, metavar="SHARE",
        help="initial share of each recording for learning goals; only the rest is predicted (default: 0)",
    )  # fmt: skip
    add("--every", type=int, default=1, metavar="N", help="use every N-th window of each recording (default: 1)")


def recordings(options: argparse.Namespace) -> tuple[Recording, ...]:
    """Return the recordings of the options."""
    from crowdbot.data import Recording

    return tuple(
        Recording(
            str(path), options.fps, options.format, options.units, options.time_base, options.step, options.observe,
            options.predict, options.protocol, options.near, options.late, options.learn, options.every,
        )
        for path in options.data
    )  # fmt: skip


def print_notes(found: tuple[Recording, ...]) -> None:
    """Print the notes of the recordings, without duplicates."""
    for sentence in dict.fromkeys(f"{one.name}: {one.tracks.note}" for one in found if one.tracks.note):
        note(sentence)


def horizon(steps: Sequence[float], observe: int, predict: int) -> str:
    """Return observed and predicted rows with their durations, for recordings with these time steps [s].

    >>> horizon([0.4], 8, 12)
    '8 rows (3.2 s) observed, 12 rows (4.8 s) predicted'
    >>> horizon([0.4, 0.04], 8, 12)
    '8 rows (0.32 to 3.2 s) observed, 12 rows (0.48 to 4.8 s) predicted'
    """

    def seconds(rows: int) -> str:
        low, high = rows * min(steps), rows * max(steps)
        return f"{rows} rows ({low:.3g} s)" if high - low < 1e-6 * high else f"{rows} rows ({low:.3g} to {high:.3g} s)"

    return f"{seconds(observe)} observed, {seconds(predict)} predicted"
