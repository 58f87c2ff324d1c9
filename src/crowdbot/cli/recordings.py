"""Options for recordings, shared by several commands; rows, frames and seconds are distinguished."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .output import note

if TYPE_CHECKING:
    from crowdbot.data import Recording

__all__ = ["add_recordings", "horizon", "recordings", "tell_notes"]


def add_recordings(parser: argparse.ArgumentParser, predict: int = 12) -> None:
    """Add the options that choose files, their time base, and the windows cut from them."""
    add = parser.add_argument
    add("--data", nargs="+", type=Path, required=True, metavar="PATH", help="recordings, scored separately and jointly")
    add("--observe", type=int, default=8, metavar="ROWS", help="observed rows of a window (default 8)")
    add("--predict", type=int, default=predict, metavar="ROWS", help=f"predicted rows of a window (default {predict})")
    add("--protocol", default="all", metavar="NAME", help="all, sgan, partial or timesplit (default all)")
    add("--near", type=float, metavar="METRES", help="score only people within this distance of a recorded robot")
    add(
        "--fps",
        type=float,
        metavar="FRAMES",
        help="frames per second of the frame column (default: from the file); rows 10 frames apart at 25 are 0.4 s",
    )
    add("--step", type=float, metavar="SECONDS", help="resample rows to this time step (default: that of the file)")
    add("--format", metavar="NAME", help="file format, see crowdbot list formats (default: detected)")
    add("--time-base", default="true", metavar="NAME", help="true or published, for the ETH file with two time bases")
    add("--units", metavar="NAME", help="units of the coordinates: m, cm, mm or px (default: from the file)")
    add("--late", default="skip", metavar="NAME", help="people who appear during the observation: skip or extrapolate")
    add(
        "--learn", type=float, default=0.0, metavar="SHARE",
        help="first share of each recording, used to learn goals; only the rest is predicted (default 0)",
    )  # fmt: skip
    add("--every", type=int, default=1, metavar="N", help="only every N-th window of each recording (default 1)")


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


def tell_notes(found: tuple[Recording, ...]) -> None:
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
