"""``crowdbot experiment analyse|withdraw``: comparison of the conditions, and the end of a participation."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from crowdbot.cli.output import add_json, note, number, print_json, print_table

if TYPE_CHECKING:
    from crowdbot.experiments import Measure


def add_analyse(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``analyse``."""
    from crowdbot.experiments import LOOKING, SETTLING, STUDIES

    parser.add_argument("folder", metavar="DIR", type=Path, help="output folder of the sessions (--out)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write a report with plots to an .html file")
    parser.add_argument(
        "--analysis",
        choices=list(STUDIES),
        metavar="KIND",
        default="",
        help=f"kind of the experiment: {', '.join(STUDIES)} (default: that of the experiment, or leader-follower)",
    )
    kinds = [f"{name}: {_defaults(study.measures)}" for name, study in STUDIES.items()]
    parser.add_argument(
        "--bound",
        action="append",
        default=[],
        metavar="MEASURE=VALUE",
        help="largest difference that counts as equivalent; measures and defaults, for "
        + "; ".join([*kinds, f"all kinds: {_defaults(LOOKING)}, and SCREEN.QUESTION of each rating"]),
    )
    parser.add_argument(
        "--settling",
        type=float,
        default=SETTLING,
        metavar="S",
        help=f"time at the start of leader-follower trials that is left out [s] (default: {SETTLING:g})",
    )
    add_json(parser)


def analyse(options: argparse.Namespace) -> int:
    """Print the differences between the conditions; the exit status is 1 if no trial has a result."""
    from crowdbot.core import InputError
    from crowdbot.experiments import analyse_sessions, write_study_report

    if options.out is not None and options.out.suffix != ".html":
        raise InputError(f"--out {options.out} must end in .html")
    if not options.settling >= 0.0:
        raise InputError(f"--settling {options.settling} must be at least 0 s")
    found = analyse_sessions(
        options.folder, analysis=options.analysis, bounds=_bounds(options.bound), settling=options.settling
    )
    if options.out is not None:
        write_study_report(found, options.out, f"{found.study.title}: {options.folder.name}")
    lost = [trial for trial in found.trials if trial.reason]
    if options.json:
        print_json({"trials": [t.record() for t in found.trials], "tests": [t.record() for t in found.tests]})
        return 0 if len(lost) < len(found.trials) else 1
    rows = [
        (
            found.measures[test.measure].title,
            f"{test.second}\n- {test.first}",
            number(test.test.difference, 3),
            f"{number(test.test.low, 3)} to {number(test.test.high, 3)}",
            number(test.corrected, 3),
            number(test.test.effect, 2),
            "yes" if test.test.equivalent else "not shown",
        )
        for test in found.tests
    ]
    people = len({trial.participant for trial in found.trials})
    head = ("measure", "conditions", "difference", "95 % interval", "p", "d_z", "equivalent")
    print_table(f"participants: {people}, trials: {len(found.trials)}", head, rows, words=2)
    for trial in lost:
        note(f"participant {trial.participant}, {trial.condition}: {trial.reason}")
    if options.out is not None:
        print(f"report    {options.out}")
    return 0 if len(lost) < len(found.trials) else 1


def _defaults(measures: Mapping[str, Measure]) -> str:
    return ", ".join(f"{name}={measure.bound:g}" for name, measure in measures.items())


def _bounds(texts: list[str]) -> dict[str, float]:
    from crowdbot.core import InputError, parse_number

    bounds = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"--bound {text}: give MEASURE=VALUE, such as lag=0.1")
        bounds[name.strip() if "." in name else name.strip().replace("-", "_")] = parse_number(value.strip())
    return bounds


def add_withdraw(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``withdraw``."""
    parser.add_argument("folder", metavar="DIR", type=Path, help="output folder of the sessions (--out)")
    parser.add_argument("--participant", type=int, required=True, metavar="N", help="participant number, from 1")
    parser.add_argument("--yes", action="store_true", help="delete without asking")
    add_json(parser)


def withdraw_participant(options: argparse.Namespace) -> int:
    """Delete a participant after a question; the exit status is 1 if the answer is no."""
    import sys

    from crowdbot.core import InputError
    from crowdbot.experiments import withdraw

    if not options.yes:
        if not sys.stdin.isatty():
            raise InputError("everything recorded of this participant is deleted; confirm with --yes")
        if input(f"Delete everything recorded of participant {options.participant}? [y/N] ").strip().lower() != "y":
            return 1
    folder = withdraw(options.folder, options.participant)
    if options.json:
        print_json({"participant": options.participant, "deleted": str(folder)})
    else:
        print(f"deleted {folder}; tables and reports made before still contain this participant: make them anew")
    return 0
