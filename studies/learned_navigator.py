"""Tables of docs/results/learned-navigator.md: navigators in unseen cases of crossings, corridors, doors and halls.

    python studies/learned_navigator.py crowdnav-circle-5 crowdnav-circle-10 --cases 2000
    python studies/learned_navigator.py doorway "random-hall layout=7" --first 2147484648 --cases 100 --only policy

Every row is a navigator in a trial with N seeds in a row, all in one simulation: share of successes, of collisions and
of timeouts with Wilson intervals of 95 %, mean time of the successes, and the mean impact speed over all cases, which
is the closing speed at the first contact, or 0 without a contact, with a bootstrap interval. ORCA has the margins 0 and
0.15 m of CrowdNav, which adds them and 0.01 m to the radii of both bodies. `check only` is the policy with a network
that always moves straight to the goal: what its check of contacts does without learning.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.evaluation import bootstrap_estimate, proportion_interval
from crowdbot.navigation import (
    AttentionPolicyNavigator,
    Navigator,
    ORCANavigator,
    PolicyNavigator,
    PolicyWeights,
    Straight,
)
from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial


def straight_weights(folder: Path) -> Path:
    """Write weights of a network that always moves straight to the goal."""
    arrays = {name: np.zeros(shape, np.float32) for name, shape in PolicyWeights.shapes().items()}
    arrays["action3_bias"][0] = 1.0
    PolicyWeights(**arrays).save(folder / "straight.npz", {"command": "studies/learned_navigator.py"})
    return folder / "straight.npz"


def navigators(trial: Any, folder: Path, attention: str) -> dict[str, Navigator]:
    """Return the navigators by the name of their row; ORCA has the settings of the trial."""
    orca = trial.robots[0].navigator
    assert isinstance(orca, ORCANavigator)
    return {
        "straight": Straight(),
        "orca safety=0.02": dataclasses.replace(orca, safety=0.02),
        "orca safety=0.32": dataclasses.replace(orca, safety=0.32),
        "check only": PolicyNavigator(file=str(straight_weights(folder))),
        "policy horizon=0": PolicyNavigator(horizon=0.0),
        "policy": PolicyNavigator(),
        "attention-policy horizon=0": AttentionPolicyNavigator(horizon=0.0, file=attention),
        "attention-policy": AttentionPolicyNavigator(file=attention),
    }


def run_cases(trial: Any, navigator: Navigator, seeds: range) -> dict[str, Any]:
    """Return the results of a case for each seed."""
    cases = len(seeds)
    robots = (dataclasses.replace(trial.robots[0], navigator=navigator), *trial.robots[1:])
    simulation = Simulation(dataclasses.replace(trial, robots=robots), seeds)
    outcomes, times, impact = np.full(cases, "", dtype="U16"), np.zeros(cases), np.zeros(cases)
    agent = simulation.robots[0].agent
    while (outcomes == "").any():
        simulation.advance()
        scene = simulation.world.scene
        for e in np.flatnonzero(simulation.may_end() & (outcomes == "")).tolist():
            outcomes[e] = simulation.outcome(e) or ""
            times[e] = simulation.ticks[e] * trial.step
            if outcomes[e] == "collision":
                away = scene.position[e] - scene.position[e, agent]
                gap = np.hypot(away[:, 0], away[:, 1]) - scene.radius[e]
                gap[agent] = np.inf
                other = int(np.argmin(gap))
                normal = away[other] / max(float(np.hypot(*away[other])), 1e-9)
                impact[e] = max(0.0, float((scene.velocity[e, agent] - scene.velocity[e, other]) @ normal))
    won = outcomes == "success"
    row: dict[str, Any] = {
        name: list(proportion_interval(int((outcomes == name).sum()), cases, method="wilson")[:3])
        for name in ("success", "collision", "timeout")
    }
    row["time"] = list(bootstrap_estimate(times[won])[:3]) if won.any() else None
    row["impact"] = list(bootstrap_estimate(impact)[:3])
    return row


def main() -> None:
    """Print the table, and write the numbers as JSON with --out."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trials", nargs="+")
    parser.add_argument("--cases", type=int, default=2000)
    parser.add_argument("--first", type=int, default=0, help="first seed; a training draws seeds below 2147483648")
    parser.add_argument("--attention", default="", help="weights of attention-policy (default: those of the package)")
    parser.add_argument("--only", nargs="+", help="names of rows")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    found: dict[str, Any] = {}
    print("| trial | navigator | success | collision | timeout | time [s] | impact speed [m/s] |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in options.trials:
            kind, *words = name.split()
            trial = load_trial(kind, dict(word.split("=", 1) for word in words))
            for title, navigator in navigators(trial, Path(folder), options.attention).items():
                if options.only and title not in options.only:
                    continue
                begin = time.process_time()
                row = run_cases(trial, navigator, range(options.first, options.first + options.cases))
                found[f"{name}/{title}"] = {**row, "cases": options.cases, "cpu": time.process_time() - begin}
                cells = [f"{a:.3f} [{b:.3f}, {c:.3f}]" for a, b, c in (row[k] for k in ("success", "collision"))]
                cells += [f"{row['timeout'][0]:.3f}", "-" if row["time"] is None else f"{row['time'][0]:.2f}"]
                value, low, high = row["impact"]
                print(
                    f"| `{name}` | `{title}` | {' | '.join(cells)} | {value:.4f} [{low:.4f}, {high:.4f}] |", flush=True
                )
    if options.out:
        options.out.write_text(json.dumps(found, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
