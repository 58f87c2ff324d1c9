"""``crowdbot train learned-scene``: train the predictor of scans on runs of built-in trials."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from crowdbot.cli.output import Progress, print_json, print_table, progress

from .scan_training import check_scan_training

if TYPE_CHECKING:
    from crowdbot.sensors import Scan


SCAN_PREDICTOR = "learned-scene"
EPOCHS, RUNS = 20, 8
"""Default numbers of passes over the samples, and of runs of each trial."""
FILE = "learned-scene.npz"
DURATION = 9.0
"""Simulated time of a run [s]."""
TRIALS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("two-way", {"density": "0.15"}),
    ("two-way", {"density": "0.3"}),
    ("two-way", {"density": "0.6"}),
    ("block", {"people": "20"}),
    ("block", {"people": "30"}),
)
"""Trials of the training; crossing-flows is left out, so that it tests the weights in another place."""


def train_scan_predictor(options: argparse.Namespace) -> int:
    """Train the correction of paths and print the path of the weights.

    Raises:
        InputError: recordings are given, or options of other trainings.
    """
    from crowdbot.core import InputError, explain_write_errors
    from crowdbot.perception import train_learned_scene

    check_scan_training(options, SCAN_PREDICTOR)
    if options.runs < 1:
        raise InputError(f"--runs {options.runs} must be at least 1")
    file = Path(options.out) / FILE
    with explain_write_errors(options.out), progress(options.json) as report:
        options.out.mkdir(parents=True, exist_ok=True)
        fit = train_learned_scene(
            file, _runs(options, report), options.epochs or EPOCHS, options.seed,
            lambda share: report(f"train {SCAN_PREDICTOR}", share),
        )  # fmt: skip
    if options.json:
        print_json({**fit._asdict(), "file": str(fit.file)})
        return 0
    rows = [
        ("straight", *(f"{item:.3f}" for item in fit.straight)),
        ("learned", *(f"{item:.3f}" for item in fit.learned)),
    ]
    title = f"{fit.samples} people in scans of {len(TRIALS) * options.runs} runs; held-out runs"
    print_table(title, ("path", "0.5 s", "1 s", "2 s", "3 s"), rows, "mean distance from the true place [m]")
    print(fit.file)
    return 0


def _runs(options: argparse.Namespace, report: Progress) -> list[list[tuple[Scan, dict[int, tuple[float, float]]]]]:
    """Return the scans of all runs with the true people and the other robots."""
    from crowdbot.evaluation import log_readings
    from crowdbot.perception import ScanNetwork
    from crowdbot.trials import load_trial

    runs = []
    for k in range(options.runs):
        for n, (name, given) in enumerate(TRIALS):
            log = log_readings(load_trial(name, {"duration": DURATION, **given}), options.seed + k, ScanNetwork())
            runs.append([(cast("Scan", row.reading), {**row.people, **row.others}) for row in log.rows])
            report("run trials", (k * len(TRIALS) + n + 1) / (options.runs * len(TRIALS)))
    return runs
