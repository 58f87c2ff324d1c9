"""Write docs/results/measured.md: ``python studies/measured.py SHARED > docs/results/measured.md``.

SHARED holds ``data/`` (recordings, see tests/RECORDINGS.md) and ``reference/`` (steps of other engines).
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import crowdbot as cb
from crowdbot import navigation, prediction
from crowdbot.benchmark import measure
from crowdbot.evaluation import score_predictor
from crowdbot.metrics import Score
from crowdbot.recording import run
from crowdbot.trials import RobotSpec
from crowdbot.web import app_measurements

FOLDS = {
    "eth": ("biwi_eth",),
    "hotel": ("biwi_hotel",),
    "univ": ("students001", "students003"),
    "zara1": ("crowds_zara01",),
    "zara2": ("crowds_zara02",),
}
SEEDS = range(100)
HEAD = """# Measured

This page holds the numbers that crowdbot claims, each with its protocol and the command that makes it. It is generated:

```
python studies/measured.py SHARED > docs/results/measured.md
```

SHARED holds public recordings and reference steps of other engines, which are not part of crowdbot (see
`tests/RECORDINGS.md` in the repository). [Known weaknesses](weaknesses.md) lists what the numbers do not show.

| question | section |
|---|---|
| Are the baselines right? | [Constant velocity](#constant-velocity-on-the-leave-one-out-sets) |
| Which predictor is best? | [Predictors, protocol all](#predictors-protocol-all) |
| Do the models agree with other engines? | [RVO2](#orca-against-rvo2), [others](#crowd-models-against-other-engines) |
| Which search finds small costs? | [Searches](#searches) |
| What do trials with visible robots prove? | [Robots in `crossing-flows`](#robots-in-crossing-flows) |
| How fast is it? | [Speed](#speed) |"""
ENGINES = """
## Crowd models against other engines

One step from the same state, compared with a reference engine: the share of samples that agree within a tolerance. The
docstring of each test explains the samples that differ. `variant` is the variant of the model that is compared;
parameters are those of the engine. Agreement of a variant says nothing about another one: the defaults of boids,
social-force, escape-panic and group-force follow their papers and differ from these engines by medians of 0.99, 0.11,
0.14 and 0.29 m/s. `variant="crowdbot"`, `"umans2018"` or `"pysocialforce"` in a trial selects the variant of the table.

`pytest tests/models -q -s`"""
ENGINE_OF = (
    (r"^corridor of six|AnticipationVelocity", "anticipation-velocity", "JuPedSim"),
    (r"Boids", "boids", "CrowdBot simulator"),
    (r"CollisionFreeSpeedModelV3", "collision-free-speed-v3", "JuPedSim"),
    (r"GeneralizedCentrifugalForce", "generalized-centrifugal-force", "JuPedSim"),
    (r"WarpDriverModel", "warp-driver", "JuPedSim"),
    (r"CollisionFreeSpeed", "collision-free-speed", "JuPedSim"),
    (r"CostModel", "cost-model", "UMANS"),
    (r"JHSFM|PyEnvs", "headed-social-force", "JHSFM, Social-Navigation-PyEnvs"),
    (r", Vadere", "optimal-steps", "Vadere"),
    (r"Helbing2000", "escape-panic", "CrowdBot simulator"),
    (r"nogroups|pairs_triples|corridor_groups", "group-force", "PySocialForce"),
    (r"Heuristics", "heuristics", "UMANS"),
    (r"PLEdestrians", "pledestrians", "UMANS"),
    (r"PowerLaw", "power-law", "UMANS"),
    (r"SocialForces", "social-force", "UMANS"),
    (r"^Tangent", "tangent", "CrowdBot simulator"),
    (r"^VBM", "vbm", "CrowdBot simulator"),
    (r"UMANS law with its slips", "vbm", "UMANS"),
    (r"^VOG", "vog", "CrowdBot simulator"),
)
"""Model and engine of what a test prints, by a part of the line."""
VARIANT_OF = {
    ("boids", "CrowdBot simulator"): "`crowdbot`",
    ("escape-panic", "CrowdBot simulator"): "`crowdbot`",
    ("group-force", "PySocialForce"): "`pysocialforce`",
    ("social-force", "UMANS"): "`umans2018`",
    ("vbm", "CrowdBot simulator"): "`crowdbot`",
    ("vbm", "UMANS"): "default (`agents`)",
}
"""Variant of a model that is compared with an engine; all others are compared at their default."""
PARTS = {
    "pairs_triples, moving": "pairs and triples, moving people",
    "pairs_triples": "pairs and triples",
    "nogroups, moving": "no groups, moving people",
    "nogroups": "no groups",
    "groups, moving": "groups, moving people",
    "corridor_groups": "groups",
    "free": "free people",
}
"""What a line says about the people, by a part of its name."""
SPEED = """
## Speed

Medians of 7 repeats after a warm-up, on a shared machine.

`crowdbot bench --data students003.txt`

### Crowd models

Million agent-steps per second at a step of 0.1 s; in brackets the ratio to real time. The last column is for
1 024 crowds in one call."""


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


def _windows(folder: Path, fold: str, protocol: str = "all") -> list[tuple[cb.Windows, cb.Windows]]:
    files = [folder / f"{name}.txt" for name in FOLDS[fold]]
    return [cb.load(file, time_base="published").windows(8, 12, protocol) for file in files]


def _scored(predictor: cb.Predictor, cut: list[tuple[cb.Windows, cb.Windows]], samples: int = 1) -> Score:
    return Score.total([score_predictor(predictor, past, future, samples=samples) for past, future in cut])


def _table(head: list[str], rows: list[list[str]]) -> None:
    print("\n".join(_lines(head, rows)))


def _baseline(folder: Path) -> None:
    print("\n## Constant velocity on the leave-one-out sets\n")
    print(
        "ADE / FDE [m], person-windows in brackets. 8 observed and 12 predicted rows of 0.4 s; univ is students001 and"
        " students003.\n"
    )
    print("`crowdbot predict --data FILE... --predictor constant-velocity --protocol all|sgan|partial`")
    rows = []
    for protocol in ("all", "sgan", "partial"):
        scores = [_scored(cb.ConstantVelocity(), _windows(folder, fold, protocol)) for fold in FOLDS]
        rows.append([protocol, *(f"{s.ade:.3f} / {s.fde:.3f} ({s.persons})" for s in scores)])
    _table(["protocol", *FOLDS], rows)
    print(
        "\nThe row `all`, truncated to two decimals, equals the published linear baseline (GeoTDM 2024, table 2)."
        "\nThe row `partial` equals that of Schöller et al. 2020. Publications take 10 frames of biwi_eth as 0.4 s;"
        "\nthe true step of that file is 0.667 s (`--time-base true`, the default). This changes speeds, not errors."
    )


def _predictors(splits: Path) -> None:
    print("\n## Predictors, protocol all\n")
    print(
        "ADE / FDE [m]. The calibrated crowd is fitted on the training part of another scene (students003; for univ"
        " crowds_zara02) with 64 evaluations of random search. Collisions are in the order of the scenes.\n"
    )
    print(
        "`crowdbot predict --data FILE... --predictor NAME --protocol all`"
        " (`--samples 20 --best-of person` for the sampled one)"
    )
    cut = {fold: _windows(splits / "all_data", fold) for fold in FOLDS}
    plain = [cb.ConstantVelocity(), cb.ConstantVelocity(displacements=2), prediction.LeastSquares()]
    plain += [prediction.ConstantAcceleration(), cb.Kalman(), prediction.KalmanAcceleration()]
    rows = [_row(_label(p), [_scored(p, cut[f]) for f in FOLDS]) for p in [*plain, cb.Simulated(cb.ORCA())]]
    rows.append(_row("simulated (social-force)", [_scored(cb.Simulated(cb.SocialForce()), cut[f]) for f in FOLDS]))
    fitted = [_scored(_calibrated(splits / "train", fold), cut[fold]) for fold in FOLDS]
    rows.append(_row("simulated (orca, calibrated)", fitted))
    sampled = [_scored(prediction.SampledConstantVelocity(), cut[fold], samples=20) for fold in FOLDS]
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
        "One step from the same state, walls included: the share of agents with velocities that differ by less than"
        " 1e-4 m/s.\n"
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
        "\nThe samples that differ are ties between neighbours and infeasible linear programs: RVO2 computes in single"
        "\nprecision and splits walls at the planes of its tree."
    )


def _other_engines() -> None:
    command = [sys.executable, "-m", "pytest", "tests/models", "-q", "-s"]
    print(engines_text(subprocess.run(command, capture_output=True, text=True, check=True).stdout))


def engines_text(said: str) -> str:
    """Return the section about other engines from what the tests of the models print."""
    rows = [row for line in said.splitlines() if (row := _engine_row(line.lstrip("."))) is not None]
    rows.sort(key=lambda row: (row[0].lower(), row[2], row[3]))
    head = ["model", "variant", "engine", "steps compared", "agree", "within", "median", "worst"]
    return "\n".join([ENGINES, *_lines(head, rows)])


def _engine_row(line: str) -> list[str] | None:
    """Return the cells of one printed line (model, variant, engine, scene, share, ...), None for other lines."""
    share = re.search(r"([\d.]+)%(?: of (\d+))?[^,]*? within (\S+?)(?: (m/s|m))?(?:[,;]|$)", line)
    middle, worst = re.search(r"median ([\d.e+-]+)", line), re.search(r"worst ([\d.e+-]+)", line)
    known = next(((model, engine) for part, model, engine in ENGINE_OF if re.search(part, line)), None)
    if share is None or middle is None or known is None:
        return None
    count = share[2] or (match[1] if (match := re.search(r"(\d+) (?:steps|agents)", line)) else "")
    scene = re.split(r": |, (?:all|moving|free)", line)[0]
    for word in ("crossing", "corridor", "bottleneck", "random states"):
        scene = word if word in scene else scene
    part = next((word for key, word in PARTS.items() if key in line.split(":", maxsplit=1)[0]), "")
    cost = re.search(r"CostModel\((.*)\):", line)
    scene = re.sub(r"\([^)]*\)", "", cost[1]) if cost else scene if scene != "UMANS law with its slips" else "crossing"
    scene = "" if scene.endswith(", UMANS") else scene
    where = ", ".join(word for word in (scene, part, f"{count} samples" if count else "") if word)
    return [
        known[0],
        VARIANT_OF.get(known, "default"),
        known[1],
        where,
        f"{share[1]} %",
        f"{share[3]} {share[4] or ''}".strip(),
        middle[1],
        worst[1] if worst else "",
    ]


def _navigation() -> None:
    print("\n## Robots in `crossing-flows`\n")
    trial = cb.load_trial("crossing-flows")
    print(
        f"Seeds {SEEDS.start} to {SEEDS.stop - 1}. The crowd model is `{type(trial.crowd).__name__}`. `visible`:"
        " whether people react to the robot.\n\n`crowdbot run crossing-flows --seed N --set robot/visible=false`"
    )
    rows = []
    for visible in (True, False):
        for name, navigator in (("straight", navigation.Straight()), ("orca", navigation.ORCANavigator())):
            robot = dataclasses.replace(trial.robots[0], navigator=navigator, visible=visible)
            rows.append([name, str(visible).lower(), *_rates(trial, robot)])
    head = ["success", "collision", "timeout", "median least clearance [m]", "median time to goal [s]"]
    _table(["navigator", "visible", *head], rows)


def _rates(trial: cb.Trial, robot: RobotSpec) -> list[str]:
    runs = [run(dataclasses.replace(trial, robots=(robot,)), seed=seed) for seed in SEEDS]
    ends = Counter(run.outcome for run in runs)
    gap = np.median([run.metrics["min_clearance"] for run in runs])
    took = [run.metrics["time_to_goal"] for run in runs if run.outcome == "success"]
    shares = [f"{ends[name] / len(runs):.2f}" for name in ("success", "collision", "timeout")]
    return [*shares, f"{gap:.2f}", f"{np.median(took):.1f}" if took else "-"]


def _searches(data: Path) -> None:
    print("\n## Searches\n")
    print("Smallest values found in problems of N people with D numbers each.\n")
    print("`python tests/calibration/test_search_comparison.py`\n")
    folder = Path(__file__).parents[1] / "tests" / "calibration"
    for program, given in (("test_search_comparison.py", []), ("test_search_on_recordings.py", [str(data)])):
        command = [sys.executable, str(folder / program), *given]
        print(subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip())
        if not given:
            print("\nORCA on three windows of each recording.\n")
            print("`python tests/calibration/test_search_on_recordings.py DATA`\n")


def _speed(recording: Path) -> None:
    rows = measure(recording=recording, more=app_measurements())
    print(speed_text([(r.name, r.median, r.unit, r.against, r.ratio) for r in rows], rows[0].environment))


def speed_text(rows: Sequence[tuple[str, float, str, str, float]], environment: str) -> str:
    """Return the section about speed: crowd models by size, then everything else."""
    sizes = {"1000": "1 000 people", "10000": "10 000 people", "100000": "100 000 people", "batch": "1 024 x 32 people"}
    models: dict[str, dict[str, str]] = {}
    other: list[list[str]] = []
    for name, median, unit, against, ratio in rows:
        model, _, size = name.rpartition("-")
        if size in sizes and unit == "agent-steps/s":
            models.setdefault(model, {})[size] = f"{median / 1e6:.2f} ({ratio:.3g} x)"
        else:
            other.append([name, f"{median:.3g}", unit, against, f"{ratio:.3g}"])
    table = [[name, *(cells.get(size, "") for size in sizes)] for name, cells in models.items()]
    return "\n".join([
        SPEED,
        *_lines(["model", *sizes.values()], table),
        "",
        "### Other measurements",
        "",
        "The ratio compares the value with the column \"compared with\"; for values in ms and MB, below 1 is better.",
        *_lines(["name", "value", "unit", "compared with", "ratio"], other),
        "",
        f"Machine: {environment}.",
    ])  # fmt: skip


def _lines(head: list[str], rows: list[list[str]]) -> list[str]:
    return ["", *("| " + " | ".join(row) + " |" for row in (head, ["---"] * len(head), *rows))]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("shared", type=Path, metavar="SHARED", help="folder with data/ and reference/")
    main(parser.parse_args().shared)
