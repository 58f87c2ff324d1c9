"""``crowdbot study gan``: compare GANs on the toy data of the report, with respect to mode collapse."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import add_json, json_text, note, number, print_json, print_table, progress
from .schemes import assignments

if TYPE_CHECKING:
    from crowdbot.benchmark import GanComparison, GanRun

STUDIES = ("gan",)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("what", metavar="NAME", help=f"study: {', '.join(STUDIES)}")
    add("--methods", nargs="+", metavar="NAME", help="GAN methods (default: all)")
    add("--seeds", type=int, default=3, metavar="N", help="number of seeds per method (default: 3)")
    add("--updates", type=int, default=20_000, metavar="N", help="updates per training (default: 20000)")
    add("--check-every", type=int, default=500, metavar="N", help="updates between measurements (default: 500)")
    add(
        "--set",
        nargs="+",
        default=[],
        metavar="NAME=VALUE",
        help="settings of all methods, such as hidden=64 (default: none)",
    )
    add("--workers", type=int, default=1, metavar="N", help="number of processes (default: 1)")
    add("--device", default="cpu", metavar="NAME", help="cpu or cuda (default: cpu)")
    add(
        "--out",
        type=Path,
        required=True,
        metavar="DIR",
        help="output folder for trainings, tables and plots; an existing study is resumed",
    )
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Train every method with every seed, then write tables and plots."""
    from crowdbot.benchmark import METHODS, GanComparison, with_settings
    from crowdbot.core import UnknownName
    from crowdbot.prediction import torch_device

    if options.what not in STUDIES:
        raise UnknownName("study", options.what, STUDIES)
    for name in options.methods or ():
        if name not in METHODS:
            raise UnknownName("method", name, METHODS)
    torch_device(options.device)
    methods, seeds = tuple(options.methods or METHODS), tuple(range(options.seeds))
    study = GanComparison(methods, seeds, options.updates, options.check_every, device=options.device)
    study = with_settings(study, assignments(options.set))
    runs: list[GanRun] = []
    with progress(options.json) as report:
        for run in study.run(options.out / "trainings", options.workers):
            runs.append(run)
            report(run.method, sum(one.method == run.method for one in runs) / len(seeds))
    return _write_and_print(options, study, runs)


def _write_and_print(options: argparse.Namespace, study: GanComparison, runs: list[GanRun]) -> int:
    from crowdbot.benchmark import plot_measures, plot_samples
    from crowdbot.core import explain_write_errors

    ideal = study.ideal()
    found: dict[str, Any] = {
        "updates": study.updates, "seeds": list(study.seeds), "settings": dict(study.values), "ideal": ideal,
        "methods": study.rows(runs),
        "runs": [
            {"method": run.method, "seed": run.seed, "update": run.update.tolist(),
             **{name: values.tolist() for name, values in run.measures.items()}}
            for run in runs
        ],
    }  # fmt: skip
    with explain_write_errors(options.out):
        (options.out / "study.json").write_text(json_text(found) + "\n", encoding="utf-8")
        plot_samples(study, runs, options.out / "samples.png")
        plot_measures(study, runs, ideal, options.out / "measures.png")
    if options.json:
        print_json(found)
        return 0
    names = ("nearest_neighbor", "emd", "modes", "whole", "nearest_neighbor_20", "emd_20")
    rows = [("real against real", *(number(ideal[name]) for name in names))]
    rows += [(row["method"], *(number(row[name]) for name in names)) for row in found["methods"]]
    caption = (
        f"{study.updates} updates, {len(study.seeds)} seeds; 200 real against 200 drawn paths per group, and 20"
        " against 20 as in the report; means over the last quarter of the measurements"
    )
    print_table(
        "GANs on the toy data",
        ("method", "1-NN", "EMD [m]", "modes", "groups with all", "1-NN of 20", "EMD of 20"),
        rows,
        caption,
    )
    note(f"wrote study.json, samples.png and measures.png in {options.out}")
    return 0
