"""Options of ``crowdbot run`` for bridges: ``--bridge rosbridge``."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import note, print_warnings

if TYPE_CHECKING:
    from crowdbot.bridges import Transport
    from crowdbot.cli.parser import CommandParser
    from crowdbot.simulation import OrderSource, RunSummary
    from crowdbot.trials import Trial

__all__ = ["add_bridge", "check_bridge_options", "open_bridges", "run_with_bridge"]

CLOCKS = ("paced", "free", "step", "follow", "commands")


def add_bridge(parser: CommandParser) -> None:
    """Declare the options of bridges."""
    group = parser.add_argument_group("bridges to robot software")
    group.add_argument(
        "--bridge",
        action="append",
        metavar="NAME[:ADDRESS]",
        help="let other programs drive the robots: rosbridge[:PORT], rosbridge-client:ws://HOST:PORT,"
        " ros1[:http://HOST:PORT], ros2[:DOMAIN], naoqi:HOST, foxglove[:PORT], tcp[:PORT]; repeatable",
    )
    group = parser.add_rare_group("time of bridges and access to them")
    group.add_argument(
        "--clock",
        choices=CLOCKS,
        help="time of a run with a bridge: paced (default; --pace X times real time), free, step (on the service"
        " step_simulation), follow (the time on /clock), commands (when all robots have a command)",
    )
    group.add_argument("--bridge-host", metavar="HOST", help="address on which a server listens (default: 127.0.0.1)")
    group.add_argument("--bridge-token", metavar="TOKEN", help="token that clients must send")
    group.add_argument(
        "--bridge-topics",
        metavar="PATTERNS",
        help="topics and services that clients may use, separated by commas, such as '/robot/*,/tf' (default: all)",
    )
    group.add_argument(
        "--bridge-origins",
        metavar="ORIGINS",
        help="pages that may connect without the token, separated by commas, such as 'https://app.foxglove.dev'"
        " (default: none)",
    )


def run_with_bridge(
    trial: Trial, options: argparse.Namespace, sources: Sequence[OrderSource] = ()
) -> tuple[RunSummary, float]:
    """Run a trial with bridges and return its summary and the real time [s].

    Raises:
        InputError: a bridge does not exist or cannot start, or an option does not fit.
    """
    from crowdbot.bridges import BridgeClock, run_bridge
    from crowdbot.core import InputError

    mode = options.clock or "paced"
    if mode != "paced" and options.pace is not None:
        raise InputError(f"--pace needs the clock paced, not --clock {mode}")
    transports = open_bridges(options)
    begin = time.perf_counter()
    out = None if options.out is None else options.out / "episode.mcap"
    with print_warnings():
        done = run_bridge(
            trial,
            transports,
            options.seed,
            out,
            BridgeClock(mode, options.pace or 1.0),
            options.force,
            note=lambda text: note(f"crowdbot: {text}"),
            sources=sources,
        )
    return done, time.perf_counter() - begin


def open_bridges(options: argparse.Namespace) -> list[Transport]:
    """Return the transports of the command line.

    Raises:
        InputError: a bridge does not exist, or an option does not fit.
    """
    from crowdbot.bridges import open_transport

    given = {"host": options.bridge_host, "token": options.bridge_token}
    values: dict[str, Any] = {key: value for key, value in given.items() if value is not None}
    for name, text in (("topics", options.bridge_topics), ("origins", options.bridge_origins)):
        if text is not None:
            values[name] = [item.strip() for item in text.split(",") if item.strip()]
    return [open_transport(text, values) for text in options.bridge]


def check_bridge_options(options: argparse.Namespace) -> None:
    """Raise :class:`InputError` if options of bridges are given without a bridge."""
    from crowdbot.core import InputError

    for name in ("clock", "bridge_host", "bridge_token", "bridge_topics", "bridge_origins"):
        if getattr(options, name) is not None:
            raise InputError(f"--{name.replace('_', '-')} needs --bridge")
