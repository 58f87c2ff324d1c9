"""``crowdbot run TRIAL --mocap SOURCE=NAME``: motion capture that moves people and robots."""

from __future__ import annotations

import argparse
import contextlib
from collections.abc import Sequence
from typing import TYPE_CHECKING

from crowdbot.cli.output import note

if TYPE_CHECKING:
    from crowdbot.bridges import CaptureSet, MotionCapture
    from crowdbot.cli.parser import Options
    from crowdbot.trials import Trial


def add_mocap(parser: Options) -> None:
    """Declare the option ``--mocap``."""
    parser.add_argument(
        "--mocap",
        action="append",
        default=[],
        metavar="SOURCE=NAME",
        help="motion capture that moves an avatar or mirrored robot: xsens:9763=guide, natnet:HOST#Cart=twin,"
        " vrpn:HOST#Cart=twin or walk.bvh=guide@X,Y,HEADING; repeatable",
    )


def open_captures(trial: Trial, options: argparse.Namespace, stack: contextlib.ExitStack) -> list[MotionCapture]:
    """Return the motion captures of the command line, open; live ones set the pace to real time.

    Raises:
        InputError: a source cannot be opened, a name is not in the trial, or the pace does not fit.
    """
    from crowdbot.core import InputError

    if not options.mocap:
        return []
    from crowdbot.bridges import parse_captures

    captures = parse_captures(options.mocap, trial)
    if any(capture.stream.live for capture in captures):
        if options.pace not in (None, 1.0):
            raise InputError(f"--pace {options.pace:g} does not fit live motion capture, which needs real time")
        if options.clock not in (None, "paced"):
            raise InputError(f"--clock {options.clock} does not fit live motion capture, which needs real time")
        options.pace = 1.0
    return [stack.enter_context(capture) for capture in captures]


def open_capture_set(options: argparse.Namespace, stack: contextlib.ExitStack) -> CaptureSet:
    """Return the motion capture of the session of an experiment, open; live streams set the rate to real time.

    Raises:
        InputError: a source cannot be opened, or the options do not fit.
    """
    from crowdbot.bridges import CaptureSet
    from crowdbot.core import InputError

    if options.mocap and options.rehearse:
        raise InputError("--mocap moves the avatars; leave out --rehearse, which moves them too")
    capture_set = stack.enter_context(CaptureSet(options.mocap))
    if capture_set.live:
        if options.rate not in (None, 1.0):
            raise InputError(f"--rate {options.rate:g} does not fit live motion capture, which needs real time")
        options.rate = 1.0
    return capture_set


def print_captures(captures: Sequence[MotionCapture]) -> None:
    """Print what motion captures have received."""
    for remark in (remark for capture in captures for remark in capture.remarks()):
        note(f"motion capture {remark}")
