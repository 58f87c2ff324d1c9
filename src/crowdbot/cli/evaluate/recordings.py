"""``crowdbot evaluate --logs`` and ``--real``: recordings of robots, measured and simulated."""

from __future__ import annotations

import argparse
import math
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import json_text, number, print_json, print_table, progress
from crowdbot.cli.recordings import add_file_options, check_no_file_options, check_parts, recording
from crowdbot.cli.settings import settings

if TYPE_CHECKING:
    from crowdbot.cli.parser import CommandParser
    from crowdbot.evaluation import CellResult, RealPlacement, RobotRecording


def add_recording_options(parser: CommandParser) -> None:
    """Add the options for recordings of robots."""
    group = parser.add_rare_group("recordings of robots among people")
    add = group.add_argument
    add("--logs", nargs="+", default=[], metavar="LOG", help="recordings to measure, instead of trials")
    add("--real", metavar="LOG", help="recording to simulate with all seeds, instead of trials; says where it lies")
    add(
        "--participants",
        type=Path,
        metavar="DIR",
        help="sessions of an experiment: compare its conditions, such as navigators, within participants, instead of"
        " trials",
    )
    add("--robot-file", metavar="FILE", help="recording of the robot, if it is not in the recording of people")
    add("--robot-id", type=int, metavar="ID", help="id of the robot (default: the only robot)")
    add("--robot-radius", type=float, default=0.3, metavar="METRES", help="radius of the robot (default: 0.3)")
    add("--robot-mass", type=float, default=math.nan, metavar="KG", help="mass of the robot, for severities")
    add("--robot-height", type=float, default=math.nan, metavar="METRES", help="height of the robot, for severities")
    add("--goal", type=float, nargs=2, metavar=("X", "Y"), help="goal of the robot (default: its last position)")
    add_file_options(group, agents="all")


def present_recordings(options: argparse.Namespace) -> int:
    """Measure recordings, or simulate one."""
    from crowdbot.core import InputError

    given = [name for name in ("trials", "logs", "real", "participants") if getattr(options, name)]
    if len(given) > 1:
        raise InputError(f"{' and '.join(given)} are given; evaluate takes trials, --logs, --real, or --participants")
    if options.sweep or options.require or options.disturbance or options.robots:
        raise InputError("--sweep, --require, --disturbance and --robots need trials, not recordings")
    files = [Path(log) for log in (*options.logs, options.real, options.robot_file) if log]
    if options.participants:
        check_no_file_options(options, "--logs or --real")
        return _compare_participants(options)
    check_parts(options, files)
    if options.real:
        return _simulate(options)
    values = {log: _load(log, options).metrics() for log in options.logs}
    rows = {"logs": [{"log": log, "metrics": row} for log, row in values.items()]}
    if options.out is not None:
        _write(options.out, {"logs.json": json_text(rows) + "\n"})
    if options.json:
        print_json(rows)
        return 0
    _print_metrics(values, options.metrics)
    if options.out is not None:
        print(f"result    {options.out / 'logs.json'}")
    return 0


def _compare_participants(options: argparse.Namespace) -> int:
    """Compare the conditions of an experiment, as ``crowdbot experiment analyse`` does."""
    from crowdbot.cli.experiment.study import analyse
    from crowdbot.experiments import SETTLING

    report = None if options.out is None else options.out / "report.html"
    return analyse(
        argparse.Namespace(
            folder=options.participants, out=report, analysis="", bound=[], settling=SETTLING, json=options.json
        )
    )


def _load(log: str, options: argparse.Namespace) -> RobotRecording:
    from crowdbot.evaluation import load_robot_recording

    robot_file = None if options.robot_file is None else recording(options, Path(options.robot_file))
    return load_robot_recording(
        recording(options, Path(log)),
        robot_file,
        robot=options.robot_id,
        radius=options.robot_radius,
        goal=options.goal,
        mass=options.robot_mass,
        height=options.robot_height,
    )


def _print_metrics(values: Mapping[str, Mapping[str, float]], chosen: str | None) -> None:
    from crowdbot.core import InputError, did_you_mean
    from crowdbot.metrics import metric_table

    table = metric_table()
    known = list(dict.fromkeys(name for row in values.values() for name in row))
    names = known if chosen is None else [name.strip().replace("-", "_") for name in chosen.split(",")]
    for name in names:
        if name not in known:
            raise InputError(f"there is no metric {name!r}{did_you_mean(name, known)} of these recordings")
    rows = [
        [name.replace("_", " "), *(number(row.get(name)) for row in values.values()), table[name].unit]
        for name in names
    ]
    print_table("metrics", ("metric", *(Path(log).stem for log in values), "unit"), rows)


def _simulate(options: argparse.Namespace) -> int:
    from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods, parse_seeds, place_reality, recorded_trial
    from crowdbot.trials import apply_values

    seeds = parse_seeds("0:100" if options.seeds is None else options.seeds)
    _check_runs(len(seeds), "seeds")
    robot_run = _load(options.real, options)
    real, results = robot_run.metrics(), []
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) if options.out is None else options.out
        for method in parse_methods(options.navigators):
            trial = apply_values(recorded_trial(robot_run, folder, mirror=not method.type), settings(options))
            plan = EvaluationPlan([trial], [method], seeds=seeds)
            with progress(options.json) as report:
                result = evaluate(
                    plan,
                    None if options.out is None else options.out / "parts",
                    workers=options.workers,
                    cluster=options.cluster,
                    progress=lambda share: report("evaluate", share),
                )
            _check_runs(len(result.cells[0].valid), "runs that are possible")
            results.append((result.cells[0], place_reality(real, result.cells[0].valid, not method.type)))
    values = [_values(options, cell, rows) for cell, rows in results]
    if options.out is not None:
        texts = {"reality.html": _page(results), "reality.json": json_text({"real": values}) + "\n"}
        _write(options.out, texts)
    if options.json:
        print_json({"real": values})
        return 0
    for cell, rows in results:
        _print_placements(cell, rows)
    if options.out is not None:
        print(f"pictures  {options.out / 'reality.html'}\nresult    {options.out / 'reality.json'}")
    return 0


def _check_runs(count: int, what: str) -> None:
    """Refuse a comparison with so few runs that every metric would be left out."""
    from crowdbot.core import InputError
    from crowdbot.evaluation import FEWEST_RUNS

    if count < FEWEST_RUNS:
        raise InputError(
            f"--real has {count} {what}; where a recording lies among its simulations needs at least {FEWEST_RUNS},"
            " and 40 for the ends of the central 95 %: --seeds 0:100"
        )


def _values(options: argparse.Namespace, cell: CellResult, rows: list[RealPlacement]) -> dict[str, Any]:
    return {
        "log": options.real,
        "navigator": _name(cell),
        "runs": len(cell.valid),
        "invalid": [{"seed": row.seed, "message": row.message} for row in cell.runs if not row.valid],
        "metrics": [row._asdict() for row in rows],
    }


def _name(cell: CellResult) -> str:
    return "recorded path" if cell.method == "own" else cell.method


def _print_placements(cell: CellResult, rows: list[RealPlacement]) -> None:
    told = [
        [
            row.metric.replace("_", " "),
            number(row.real),
            f"{number(row.median)} [{number(row.first)}, {number(row.last)}]",
            f"{row.quantile:.2f} [{row.low:.2f}, {row.high:.2f}]",
            "yes" if row.inside else "NO",
        ]
        for row in rows
        if not row.constant
    ]
    inside = sum(row.inside for row in rows if not row.constant)
    share = f"{inside} of {len(told)} metrics inside the central 95 % of {len(cell.valid)} runs"
    caption = f"{share}; quantile with Wilson interval"
    head = ("metric", "real", "simulated median [95 %]", "quantile of reality", "inside")
    print_table(f"{cell.trial}, {_name(cell)}", head, told, caption)


def _page(results: list[tuple[CellResult, list[RealPlacement]]]) -> str:
    import html

    from crowdbot.evaluation import reality_svg

    parts = []
    for cell, rows in results:
        title = html.escape(f"{cell.trial}, {_name(cell)}")
        parts.append(f"<h2>{title}</h2><p>{len(cell.valid)} runs</p>{reality_svg(rows)}")
    return (
        "<!doctype html><html lang='en'><meta charset='utf-8'><title>Reality in the simulations</title>"
        "<body style='max-width:760px;margin:2rem auto;font-family:system-ui'><h1>Reality in the simulations</h1>"
        f"<p>Share of simulated runs below the recording; band: central 95 %.</p>{''.join(parts)}</body></html>"
    )


def _write(out: Path, texts: Mapping[str, str]) -> None:
    """Write files of results."""
    from crowdbot.core import explain_write_errors

    for name, text in texts.items():
        with explain_write_errors(out / name):
            out.mkdir(parents=True, exist_ok=True)
            (out / name).write_text(text, encoding="utf-8")
