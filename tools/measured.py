"""Write docs/measured.md: ``python tools/measured.py SHARED > docs/measured.md``.

SHARED holds ``data/`` (recordings, see CONTRIBUTING.md) and ``reference/`` (steps of other engines).
"""

from __future__ import annotations

import dataclasses
import json
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np

import crowdbot as cb
from crowdbot import navigation
from crowdbot.benchmark import evaluate, measure
from crowdbot.metrics import Score
from crowdbot.recording import run

FOLDS = {
    "eth": ("biwi_eth",),
    "hotel": ("biwi_hotel",),
    "univ": ("students001", "students003"),
    "zara1": ("crowds_zara01",),
    "zara2": ("crowds_zara02",),
}
SEEDS = range(100)
HEAD = """# What is measured

Every number names its protocol and the command that makes it. `python tools/measured.py SHARED > docs/measured.md`
makes this page anew; the recordings and reference steps that it needs are not ours to ship (see CONTRIBUTING.md)."""


def main(shared: Path) -> None:
    """Print the page."""
    splits = shared / "data" / "eth_ucy_splits"
    print(HEAD)
    _baseline(splits / "all_data")
    _predictors(splits)
    _engines(shared / "reference" / "rvo2")
    _other_engines()
    _searches(shared / "data")
    _navigation()
    _speed(splits / "all_data" / "students003.txt")
    print((Path(__file__).parent / "weak.md").read_text(encoding="utf-8").rstrip())


def _windows(folder: Path, fold: str, protocol: str = "all") -> list[tuple[cb.Windows, cb.Windows]]:
    files = [folder / f"{name}.txt" for name in FOLDS[fold]]
    return [cb.load(file, time_base="published").windows(8, 12, protocol) for file in files]


def _scored(predictor: cb.Predictor, cut: list[tuple[cb.Windows, cb.Windows]], samples: int = 1) -> Score:
    return Score.total([evaluate(predictor, past, future, samples=samples) for past, future in cut])


def _table(head: list[str], rows: list[list[str]]) -> None:
    print("\n| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")


def _baseline(folder: Path) -> None:
    print("\n## Constant velocity on the leave-one-out sets\n")
    print("ADE / FDE [m] and person-windows; 8 observed and 12 predicted rows; univ is students001 + students003.\n")
    print("`crowdbot predict --data FILE... --predictor constant-velocity --protocol all|sgan|partial`")
    rows = []
    for protocol in ("all", "sgan", "partial"):
        scores = [_scored(cb.ConstantVelocity(), _windows(folder, fold, protocol)) for fold in FOLDS]
        rows.append([protocol, *(f"{s.ade:.3f} / {s.fde:.3f} ({s.persons})" for s in scores)])
    _table(["protocol", *FOLDS], rows)
    print(
        "\nThe row `all`, cut to two decimals, is the published linear baseline (GeoTDM 2024, table 2); the row"
        "\n`partial` is that of Schöller et al. 2020. Publications take 10 frames of biwi_eth as 0.4 s; the true step"
        "\nof that file is 0.667 s (`--time-base true`, the default): errors over rows do not change, speeds do."
    )


def _predictors(splits: Path) -> None:
    print("\n## Predictors, protocol all\n")
    print(
        "ADE / FDE [m]; the calibrated crowd is fitted on the training part of another scene (students003, for univ"
        " crowds_zara02), 64 evaluations of random search.\n"
    )
    print(
        "`crowdbot predict --data FILE... --predictor NAME --protocol all`"
        " (`--samples 20 --best-of person` for the sampled one)"
    )
    cut = {fold: _windows(splits / "all_data", fold) for fold in FOLDS}
    plain = [cb.ConstantVelocity(), cb.ConstantVelocity(displacements=2), cb.LeastSquares()]
    plain += [cb.ConstantAcceleration(), cb.Kalman(), cb.KalmanAcceleration()]
    rows = [_row(_label(p), [_scored(p, cut[f]) for f in FOLDS]) for p in [*plain, cb.Simulated(cb.ORCA())]]
    rows.append(_row("simulated (social-force)", [_scored(cb.Simulated(cb.SocialForce()), cut[f]) for f in FOLDS]))
    fitted = [_scored(_calibrated(splits / "train", fold), cut[fold]) for fold in FOLDS]
    rows.append(_row("simulated (orca, calibrated)", fitted))
    sampled = [_scored(cb.SampledConstantVelocity(), cut[fold], samples=20) for fold in FOLDS]
    rows.append(_row("sampled-constant-velocity, best of 20 per person", sampled))
    _table(["predictor", *FOLDS, "mean of scenes", "collisions [%]"], rows)


def _calibrated(folder: Path, left_out: str) -> cb.Predictor:
    """Fit one ORCA set to every eighth training window of the densest other scene."""
    scene = "students003" if left_out != "univ" else "crowds_zara02"
    past, _ = cb.load(folder / f"{scene}_train.txt").windows(8, 12)
    scheme = cb.Calibrator(cb.ORCA(), "absolute", "random-search", budget=64, shared=True)
    return cb.Simulated.of(scheme.fit(past[::8], seed=0))


def _label(predictor: cb.Predictor) -> str:
    return predictor.name.replace("(displacements=2)", ", mean of 2")


def _row(name: str, scores: list[Score]) -> list[str]:
    mean = f"{np.mean([s.ade for s in scores]):.3f} / {np.mean([s.fde for s in scores]):.3f}"
    return [name, *(f"{s.ade:.3f} / {s.fde:.3f}" for s in scores), mean, _clash(scores)]


def _clash(scores: list[Score]) -> str:
    return " / ".join(f"{100.0 * s.collisions:.1f}" for s in scores)


def _engines(folder: Path) -> None:
    print("\n## ORCA against RVO2\n")
    print(
        "One step from the same state; share of agents whose velocity differs by less than 1e-4 m/s; walls included.\n"
    )
    print("`pytest tests/models/test_orca.py -k rvo2`")
    rows = []
    for file in sorted(folder.glob("*.npz")):
        steps, about = np.load(file), json.loads(file.with_suffix(".json").read_text(encoding="utf-8"))
        scene = cb.Scene.of(
            steps["x"], steps["v"], radius=steps["radius"], max_speed=steps["maxSpeed"],
            preferred_velocity=steps["pref"], walls=about["obstacles"],
        )  # fmt: skip
        model = cb.ORCA(
            *(steps[n].astype(float) for n in ("neighborDist", "maxNeighbors", "timeHorizon", "timeHorizonObst"))
        )
        error = np.abs(model.velocity(scene, about["dt"]) - steps["v_next"]).max(axis=-1)
        share = f"{100.0 * np.mean(error < 1e-4):.2f} %"
        rows.append([file.stem, str(error.size), share, f"{np.median(error):.0e}", f"{error.max():.0e}"])
    _table(["scene", "samples", "within 1e-4", "median [m/s]", "worst [m/s]"], rows)
    print(
        "\nWhat remains are ties of neighbours and branches of infeasible programs, where RVO2 computes in single"
        "\nprecision and splits walls at the planes of its tree."
    )


def _other_engines() -> None:
    print("\n## Crowd models against other engines\n")
    print("One step from the same state, as the tests print it; what remains is explained where the test stands.\n")
    print("`pytest tests/models -q -s`\n\n```text")
    command = [sys.executable, "-m", "pytest", "tests/models", "-q", "-s"]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    for line in said.splitlines():
        if re.search(r"[\d.]+% .*(within|median)|median .*%", line):
            print(line.lstrip("."))
    print("```")


def _navigation() -> None:
    print("\n## Robots in `crossing-flows`\n")
    trial = cb.load_trial("crossing-flows")
    print(
        f"Seeds {SEEDS.start} to {SEEDS.stop - 1}; people walk by {type(trial.crowd).__name__}; visible: whether they"
        " react to the robot (attribute `visible` of the robot in the trial).\n\n`crowdbot run crossing-flows --seed N`"
    )
    rows = []
    for visible in (True, False):
        for navigator in (navigation.Straight(), navigation.ORCA()):
            robot = dataclasses.replace(trial.robots[0], navigator=navigator, visible=visible)
            rows.append([type(navigator).__name__.lower(), str(visible).lower(), *_rates(trial, robot)])
    head = ["success", "collision", "timeout", "median least clearance [m]", "median time to goal [s]"]
    _table(["navigator", "visible", *head], rows)


def _rates(trial: cb.Trial, robot: object) -> list[str]:
    runs = [run(dataclasses.replace(trial, robots=(robot,)), seed=seed) for seed in SEEDS]
    ends = Counter(run.outcome for run in runs)
    gap = np.median([run.metrics["min_clearance"] for run in runs])
    took = [run.metrics["time_to_goal"] for run in runs if run.outcome == "success"]
    shares = [f"{ends[name] / len(runs):.2f}" for name in ("success", "collision", "timeout")]
    return [*shares, f"{gap:.2f}", f"{np.median(took):.1f}" if took else "-"]


def _searches(data: Path) -> None:
    print("\n## Searches\n")
    print("Smallest values found, medians of 7 problems with 2000 evaluations each; N people with D numbers.\n")
    print("`python tests/calibration/test_search_comparison.py`\n")
    folder = Path(__file__).parents[1] / "tests" / "calibration"
    for program, given in (("test_search_comparison.py", []), ("test_search_on_recordings.py", [str(data)])):
        command = [sys.executable, str(folder / program), *given]
        print(subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip())
        if not given:
            print("\nORCA on three windows of each recording.\n")
            print("`python tests/calibration/test_search_on_recordings.py DATA`\n")


def _speed(recording: Path) -> None:
    print("\n## Speed\n")
    print(
        "Medians of 7 repeats after a warm-up, one run on a shared machine.\n\n`crowdbot bench --data students003.txt`"
    )
    rows = measure(recording=recording)
    _table(
        ["name", "median", "unit", "against", "ratio"],
        [[r.name, f"{r.median:.3g}", r.unit, r.against, f"{r.ratio:.3g}"] for r in rows],
    )
    print(f"\n{rows[0].environment}.")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
