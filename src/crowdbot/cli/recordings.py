"""Options about recordings, shared by the commands that read them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from .output import note

if TYPE_CHECKING:
    from crowdbot.data import Recording

__all__ = ["add_recordings", "recordings", "tell_notes"]


def add_recordings(parser: argparse.ArgumentParser, predict: int = 12) -> None:
    """Declare which files are read, how, and which windows are cut."""
    add = parser.add_argument
    add("--data", nargs="+", type=Path, required=True, metavar="PATH", help="recordings, one by one and together")
    add("--observe", type=int, default=8, metavar="ROWS", help="observed rows (default 8)")
    add("--predict", type=int, default=predict, metavar="ROWS", help=f"predicted rows (default {predict})")
    add("--protocol", default="all", metavar="NAME", help="all, sgan, partial or timesplit (default all)")
    add("--near", type=float, metavar="METRES", help="score only people this near to a recorded robot")
    add("--fps", type=float, metavar="F", help="rows a second of one track, when the file does not say")
    add("--step", type=float, metavar="SECONDS", help="time between rows, by interpolation (default: that of the file)")
    add("--format", metavar="NAME", help="crowdbot list formats; default: found by content")
    add("--time-base", default="true", metavar="NAME", help="true or published, for the ETH file with two time bases")
    add("--units", metavar="NAME", help="m, cm or px, when the file does not say")
    add("--late", default="skip", metavar="NAME", help="people who appear while observed: skip or extrapolate")
    add(
        "--learn", type=float, default=0.0, metavar="SHARE",
        help="goals that learn do so from this first share of each recording; only the rest is predicted",
    )  # fmt: skip
    add("--every", type=int, default=1, metavar="N", help="only every N-th window of each recording (default 1)")


def recordings(options: argparse.Namespace) -> tuple[Recording, ...]:
    """Return the recordings that the options name."""
    from crowdbot.data import Recording

    return tuple(
        Recording(
            str(path), options.fps, options.format, options.units, options.time_base, options.step, options.observe,
            options.predict, options.protocol, options.near, options.late, options.learn, options.every,
        )
        for path in options.data
    )  # fmt: skip


def tell_notes(found: tuple[Recording, ...]) -> None:
    """Say what the recordings say about themselves, each sentence once."""
    for sentence in dict.fromkeys(f"{one.name}: {one.tracks.note}" for one in found if one.tracks.note):
        note(sentence)
