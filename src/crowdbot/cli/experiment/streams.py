"""Options of ``crowdbot experiment run`` for the Lab Streaming Layer."""

from __future__ import annotations

import argparse
import contextlib
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crowdbot.experiments import StreamOutlets


def add_streams(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "--lsl", action="store_true", help="send events, head poses and robot poses over the Lab Streaming Layer"
    )
    parser.add_argument(
        "--lsl-record",
        action="append",
        default=[],
        metavar="STREAM",
        help="record streams of the Lab Streaming Layer: a name, or PROPERTY=VALUE such as type=EEG (repeatable)",
    )


def open_outlets(options: argparse.Namespace, source: str, stack: contextlib.ExitStack) -> StreamOutlets | None:
    """Open the streams to other programs, if they are wanted."""
    from crowdbot.experiments import StreamOutlets

    return stack.enter_context(StreamOutlets(source)) if options.lsl else None


def record_streams(options: argparse.Namespace, folder: Path, stack: contextlib.ExitStack) -> None:
    """Record the wanted streams in the folder of the participant until the session ends."""
    from crowdbot.experiments import StreamRecorder

    if options.lsl_record:
        stack.enter_context(StreamRecorder(folder, options.lsl_record))
