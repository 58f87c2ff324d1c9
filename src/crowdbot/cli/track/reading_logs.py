"""Readings of a trial or an episode, for commands that score perception."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import Progress
from crowdbot.cli.settings import add_settings, parse_settings

if TYPE_CHECKING:
    from crowdbot.cli.parser import Options
    from crowdbot.evaluation import ReadingLog
    from crowdbot.perception import Detector


def add_runs(parser: Options) -> None:
    """Add the options for the sensor and the runs."""
    add = parser.add_argument
    add("--sensor", default="", metavar="ROBOT/SENSOR", help="sensor, or topic of a bag (default: the first)")
    add("--starts", type=int, default=1, metavar="N", help="runs of a trial, by consecutive seeds (default: 1)")
    add("--duration", type=float, metavar="SECONDS", help="time that is simulated or read (default: all)")
    add_settings(parser, option="--trial")
    add("--trust", action="store_true", help="allow code outside the folder of a trial")


def reading_logs(options: argparse.Namespace, source: str, detector: Detector, report: Progress) -> list[ReadingLog]:
    """Return the readings of the episode, or of each run of the trial."""
    from crowdbot.core import InputError
    from crowdbot.evaluation import log_readings, read_readings
    from crowdbot.trials import load_trial

    given = _given(options)
    if source.endswith(".mcap"):
        if options.duration is not None:
            raise InputError("--duration is for trials and folders of recorded scans; an episode is one run")
        check_plain_runs(options, "an episode is one run")
        return [read_readings(source, detector, options.sensor)]
    trial = load_trial(source, given, trust=options.trust)
    first = trial.seed if options.seed is None else options.seed
    logs = []
    for k in range(options.starts):
        logs.append(log_readings(trial, first + k, detector, options.sensor))
        report(f"run {trial.name}", (k + 1) / options.starts)
    return logs


def check_plain_runs(options: argparse.Namespace, reason: str) -> None:
    """Raise :class:`InputError` if an option is given that only trials have."""
    from crowdbot.core import InputError

    if options.starts != 1 or options.seed is not None or options.trial:
        raise InputError(f"--starts, --seed and --trial are for trials; {reason}")


def _given(options: argparse.Namespace) -> dict[str, Any]:
    """Return the parameters of the trial."""
    given: dict[str, Any] = dict(parse_settings(options.trial, "--trial"))
    return given if options.duration is None else {**given, "duration": options.duration}
