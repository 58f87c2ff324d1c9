"""Table "On scans only" of docs/results/learned-navigator.md: navigators with a laser scanner in unseen cases.

    python studies/scan_navigator.py

A row is a navigator in a trial, with seeds that no training has drawn: shares of success, collision and timeout with
Clopper-Pearson intervals of 95 %, and the mean time of the successes with its bootstrap interval. `straight` ignores
everything. `check only` is `scan-policy` with a network that always moves straight to the waypoint. `orca` and `policy`
know the states of the people whom a beam meets, and the walls. `intersection` and `dense-circle` are not among the
trials of the training.
"""

from __future__ import annotations

import argparse
import dataclasses
import tempfile
from pathlib import Path

import numpy as np

from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
from crowdbot.navigation import ScanPolicyWeights
from crowdbot.trials import load_trial

FIRST_CASE = 2**31 + 1000
"""Smallest seed; those that a training draws are below 2**31."""
TRIALS = {
    "circle-crossing, moves sideways": ("circle-crossing", {"robot/holonomic": "true"}),
    "circle-crossing people=10": ("circle-crossing", {"people": "10"}),
    "square-crossing, unseen": ("square-crossing", {"robot/visible": "false"}),
    "crossing-flows": ("crossing-flows", {}),
    "doorway": ("doorway", {}),
    "frontal, unseen": ("frontal", {"robot/visible": "false"}),
    "intersection, unseen": ("intersection", {"robot/visible": "false"}),
    "dense-circle": ("dense-circle", {}),
}
METHODS = ("straight", "orca", "policy", "scan-map", "check only", "scan-policy horizon=0", "scan-policy")


def straight_weights(folder: Path) -> Path:
    """Write weights of a network that always moves straight to the waypoint."""
    arrays = {name: np.zeros(shape, np.float32) for name, shape in ScanPolicyWeights.shapes().items()}
    arrays["action3_bias"][0] = 1.0
    ScanPolicyWeights(**arrays).save(folder / "straight.npz", {"command": "studies/scan_navigator.py"})
    return folder / "straight.npz"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=50)
    parser.add_argument("--trials", nargs="+", default=list(TRIALS), help="names of rows")
    parser.add_argument("--only", nargs="+", default=METHODS, help="navigators")
    parser.add_argument("--file", default="", help="weights of scan-policy (default: those of the package)")
    options = parser.parse_args()
    print("| trial | navigator | success | collision | timeout | time [s] |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for title in options.trials:
            trial = dataclasses.replace(load_trial(*TRIALS[title]), name=title)
            for method in options.only:
                text = method.replace("check only", f"scan-policy file={straight_weights(Path(folder))}")
                if options.file and method.startswith("scan-policy"):
                    text += f" file={options.file}"
                seeds = range(FIRST_CASE, FIRST_CASE + options.cases)
                (cell,) = evaluate(EvaluationPlan([trial], parse_methods(text), seeds=seeds)).cells
                names = ("success-rate", "collision-rate", "timeout-rate", "time-to-goal")
                values = " | ".join(str(cell.estimate(name)) for name in names)
                print(f"| {title} | `{method}` | {values} |", flush=True)


if __name__ == "__main__":
    main()
