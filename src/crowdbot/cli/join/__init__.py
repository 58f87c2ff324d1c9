"""``crowdbot join TRIAL``: a real robot drives among the people of a trial."""

from __future__ import annotations

import argparse
import contextlib
import time
from pathlib import Path
from typing import TYPE_CHECKING

from crowdbot.cli.bridge import add_bridge, open_bridges
from crowdbot.cli.bridge.mocap import add_mocap, open_captures, print_captures
from crowdbot.cli.output import add_json, note, print_warnings
from crowdbot.cli.run import print_run
from crowdbot.cli.settings import add_settings, add_world, load_settings_trial, settings

from .stop_key import StopKey

if TYPE_CHECKING:
    from crowdbot.bridges import CommandGuard
    from crowdbot.cli.parser import CommandParser

LIMITS = {
    "max-speed": ("speed", 0.5, "largest speed [m/s]"),
    "max-turn": ("turn", 1.0, "largest turn rate [rad/s]"),
    "max-acceleration": ("acceleration", 0.5, "largest acceleration of commands [m/s2]"),
    "max-turn-acceleration": ("turn_acceleration", 2.0, "largest angular acceleration of commands [rad/s2]"),
    "link-timeout": ("link", 0.5, "age of the latest pose of the robot at which it is stopped [s]"),
    "command-timeout": ("command", 0.5, "age of the latest command at which the robot stops [s]"),
}
"""Options of the limits: field, default and help."""


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    parser.add_argument("trial", metavar="TRIAL", help="trial file or built-in name")
    parser.add_argument("--robot", default="", metavar="NAME", help="robot of the trial (default: the only one)")
    parser.add_argument(
        "--area",
        required=True,
        metavar="X0,Y0,X1,Y1",
        help="rectangle in the trial that the real robot may not leave [m]; write --area=-3,-2,3,2",
    )
    parser.add_argument(
        "--odometry", default="/odom", metavar="TOPIC", help="odometry of the real robot (default: /odom)"
    )
    parser.add_argument(
        "--command", default="/cmd_vel", metavar="TOPIC", help="commands to the real robot (default: /cmd_vel)"
    )
    limits = parser.add_rare_group("limits of the robot")
    for name, (_, default, about) in LIMITS.items():
        limits.add_argument(f"--{name}", type=float, default=default, metavar="X", help=f"{about} (default: {default})")
    parser.add_argument("--seed", type=int, help="random seed (default: the seed of the trial)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="record to DIR/episode.mcap")
    parser.add_argument("--force", action="store_true", help="overwrite an existing file")
    parser.add_argument("--trust", action="store_true", help="allow code outside the folder of the trial")
    add_world(parser)
    add_settings(parser)
    add_bridge(parser)
    add_mocap(parser)
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Run the trial in real time with the robot."""
    from crowdbot.bridges import JoinRun, joined_trial
    from crowdbot.core import InputError

    if not options.bridge:
        raise InputError("crowdbot join needs --bridge, such as --bridge ros2")
    if options.clock not in (None, "paced"):
        raise InputError(f"--clock {options.clock} does not fit a real robot, which needs real time")
    options.pace = None
    trial = load_settings_trial(options.trial, settings(options), options.trust)
    guard = _guard(options)
    begin = time.perf_counter()
    with contextlib.ExitStack() as stack:
        stack.enter_context(print_warnings())
        joined = joined_trial(trial, options.robot)
        captures = open_captures(joined, options, stack)
        chosen = options.robot or joined.robots[0].name
        moved = any(binding.target == chosen for capture in captures for binding in capture.bindings)
        run = JoinRun(
            trial,
            open_bridges(options),
            guard,
            options.robot,
            "" if moved else options.odometry,
            options.command,
            options.seed,
            None if options.out is None else options.out / "episode.mcap",
            options.force,
            note=lambda text: note(f"crowdbot: {text}"),
            sources=captures,
        )
        stack.enter_context(StopKey(run.port.request_stop))
        note("crowdbot: Enter stops the robot; go and Enter releases it; Ctrl-C ends the run")
        done = run.run()
    for remark in run.remarks():
        note(f"crowdbot: {remark}")
    print_captures(captures)
    return print_run(done, options, time.perf_counter() - begin)


def _guard(options: argparse.Namespace) -> CommandGuard:
    from crowdbot.bridges import CommandGuard, DrivingArea, GuardLimits

    values = {field: getattr(options, name.replace("-", "_")) for name, (field, _, _) in LIMITS.items()}
    return CommandGuard(DrivingArea.of(options.area), GuardLimits(**values))
