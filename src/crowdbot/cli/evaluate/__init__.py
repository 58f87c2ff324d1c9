"""``crowdbot evaluate TRIAL ...``: run navigators in many trials with many seeds, and compare them."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING

from crowdbot.cli.output import add_json, note, print_json, print_robots, progress
from crowdbot.cli.recordings import check_no_file_options
from crowdbot.cli.settings import add_robots, add_seeds, add_settings, add_world

from .again import print_worst, worst_lines, worst_values
from .plan_options import add_plan_options, plan_of, statistic_names
from .recordings import add_recording_options, present_recordings
from .tables import (
    print_answers,
    print_comparisons,
    print_effects,
    print_result,
    print_runs,
    print_verdicts,
    result_values,
)

if TYPE_CHECKING:
    from crowdbot.cli.parser import CommandParser
    from crowdbot.evaluation import EvaluationPlan, EvaluationResult, Requirement, Statistic

STATISTICS = (
    "success-rate", "person-collision-rate", "wall-collision-rate", "timeout-rate", "time-to-goal", "min-clearance",
)  # fmt: skip


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    parser.add_argument("trials", nargs="*", metavar="TRIAL", help="trial files or built-in names")
    parser.add_argument(
        "--navigators",
        default="own",
        metavar="LIST",
        help='navigators with parameters, separated by commas: "orca, orca safety=0.2, mine.py:Mine"'
        " (default: own, the navigator of each trial)",
    )
    parser.add_argument(
        "--safety",
        choices=("own", "both"),
        default="own",
        help="each navigator as it is (own), or without and with a safety layer (both); default: own",
    )
    add_robots(parser)
    add_seeds(parser, "0:20; with --real 0:100")
    parser.add_argument("--metrics", metavar="LIST", help=f"columns of the table (default: {','.join(STATISTICS)})")
    parser.add_argument(
        "--require",
        action="append",
        default=[],
        metavar="BOUND",
        help='requirement for every row, such as "collision-rate<0.01@95%%"; exit status 1 if one does not hold',
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder of result.json, report.html and junit.xml")
    parser.add_argument(
        "--worst", type=int, default=1, metavar="N", help="worst runs of each row to play in the report"
    )
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="number of processes")
    parser.add_argument("--cluster", metavar="ADDRESS", help="address of a Ray cluster, auto, or local")
    parser.add_argument("--trust", action="store_true", help="allow code outside the folders of the trials")
    add_plan_options(parser)
    add_recording_options(parser)
    add_world(parser)
    add_settings(parser)
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Run the evaluation; return 1 if a requirement does not hold."""
    from crowdbot.core import InputError
    from crowdbot.evaluation import evaluate, parse_requirement
    from crowdbot.trials import remarks_at_end

    if options.worst < 0:
        raise InputError(f"--worst {options.worst} must be at least 0")
    requirements = [parse_requirement(text) for text in options.require]
    if options.logs or options.real or options.participants:
        return present_recordings(options)
    check_no_file_options(options, "--logs or --real")
    if not options.trials:
        raise InputError("evaluate needs a trial, or recordings with --logs, --real or --participants")
    names = statistic_names(options, STATISTICS)
    with remarks_at_end():
        plan = plan_of(options, [*names, *(requirement.statistic.name for requirement in requirements)])
    print_robots((cell.variant for cell in plan.cells), options.json)
    parts, begin = None if options.out is None else options.out / "parts", time.perf_counter()
    try:
        with progress(options.json) as report:
            result = evaluate(
                plan,
                parts,
                workers=options.workers,
                cluster=options.cluster,
                progress=lambda share: report("evaluate", share),
            )
    except KeyboardInterrupt:
        if parts is not None:
            note(f"crowdbot: what is done is stored in {options.out}; the same command continues")
        raise
    return _present(options, plan, result, requirements, names, time.perf_counter() - begin)


def _occasional_names(result: EvaluationResult) -> list[str]:
    """Return the columns of what only some results have: failed runs, measured decisions, deadlines."""
    decisions = ("decision-time", "missed-deadlines")
    measured = [decision for decision in decisions if any(cell.estimate(decision).runs for cell in result.cells)]
    return ["error-rate"] * bool(result.failures) + measured


def _present(
    options: argparse.Namespace,
    plan: EvaluationPlan,
    result: EvaluationResult,
    requirements: list[Requirement],
    names: list[str],
    wall: float,
) -> int:
    from crowdbot.evaluation import parse_requirement, parse_statistic

    if options.metrics is None:
        names = [*names, *_occasional_names(result)]
    statistics = [parse_statistic(name, result.metrics) for name in names]
    requirements = [parse_requirement(requirement.text, result.metrics) for requirement in requirements]
    verdicts = [
        (cell, requirement, requirement.judge(cell.values(requirement.statistic.metric)))
        for requirement in requirements
        for cell in result.cells
    ]
    comparisons = result.compare()
    if options.out is not None:
        result.save(options.out / "result.json")
    if options.json:
        values = result_values(result, statistics, comparisons, verdicts, requirements)
        for row, cell in zip(values["cells"], result.cells, strict=True):
            row["worst"] = worst_values(cell, options)
        print_json(values)
    else:
        print_answers(result, requirements)
        print_result(result, statistics, wall)
        print_effects(result, statistics)
        print_comparisons(result, comparisons)
        print_verdicts(verdicts)
        print_runs(result)
        print_worst(result, options)
    if options.out is not None:  # worst runs are simulated again, which takes as long as they took
        _write(options, plan, result, statistics, requirements)
        if not options.json:
            print(f"report    {options.out / 'report.html'}\nresult    {options.out / 'result.json'}")
    return 0 if all(verdict.holds for _, _, verdict in verdicts) else 1


def _write(
    options: argparse.Namespace,
    plan: EvaluationPlan,
    result: EvaluationResult,
    statistics: list[Statistic],
    requirements: list[Requirement],
) -> None:
    from crowdbot.core import explain_write_errors
    from crowdbot.evaluation import junit_xml, worst_runs, write_report

    with progress(options.json) as report:
        worst = worst_runs(plan, result, options.worst, lambda share: report("worst runs", share))
    write_report(
        result,
        options.out / "report.html",
        statistics,
        worst=worst,
        again=worst_lines(result, options),
        requirements=requirements,
        comparisons=result.compare(),
    )
    if requirements:
        file = options.out / "junit.xml"
        with explain_write_errors(file):
            file.write_text(junit_xml(result, requirements), encoding="utf-8")
