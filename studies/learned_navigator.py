"""Tables of docs/results/learned-navigator.md: learned navigators beside others in unseen cases.

    python studies/learned_navigator.py crowdnav-circle-5 --cases 2000 --navigators "orca margin 0.15, policy"
    python studies/learned_navigator.py "random-hall layout=7" --navigators "orca, attention-policy file=mine.npz"

Every row is a navigator in a trial with N seeds in a row: shares of success, collision and timeout with
Clopper-Pearson intervals of 95 %; mean time of the successes and mean impact speed of all cases, which is the closing
speed at the first contact, or 0 without a contact, with bootstrap intervals; the smallest clearance of a case to a
person, which is negative in a contact, as its median over the cases and the smallest of all. `orca margin 0` and
`orca margin 0.15` are ORCA of CrowdNav, which adds the margin and 0.01 m to the radii of both bodies. `check only` and
`scan check only` are `policy` and `scan-policy` with a network that always moves straight to the waypoint: what the
check of contacts does without learning.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
from crowdbot.navigation import PolicyWeights, ScanPolicyWeights
from crowdbot.trials import load_trial
from navigators import LIKE_CROWDNAV

FIRST_CASE = 2**31 + 1000
"""Default of the first seed; those that a training draws are below 2**31."""
HEAD = "| trial | navigator | success | collision | timeout | time [s] | impact [m/s] | clearance [m], median, least |"
STATISTICS = ("success-rate", "collision-rate", "timeout-rate", "time-to-goal", "max-impact-speed")


def straight_weights(kind: type[PolicyWeights | ScanPolicyWeights], folder: Path) -> Path:
    """Write weights of a network that always moves straight to the waypoint."""
    arrays = {name: np.zeros(shape, np.float32) for name, shape in kind.shapes().items()}
    arrays["action3_bias"][0] = 1.0
    kind(**arrays).save(folder / f"{kind.navigator}.npz", {"command": "studies/learned_navigator.py"})
    return folder / f"{kind.navigator}.npz"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trials", nargs="+", help='names of trials with values, such as "random-hall layout=7"')
    parser.add_argument("--navigators", required=True, help="as of crowdbot evaluate, or one of the names above")
    parser.add_argument("--cases", type=int, default=50, help="number of seeds")
    parser.add_argument("--first", type=int, default=FIRST_CASE, help="first seed (default: %(default)s)")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.cases)
    print(HEAD, "|---" * (HEAD.count("|") - 1) + "|", sep="\n", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        titles = {f"orca margin {margin}": f"orca {LIKE_CROWDNAV} safety={2 * margin + 0.02:g}" for margin in (0, 0.15)}
        titles["check only"] = f"policy file={straight_weights(PolicyWeights, Path(folder))}"
        titles["scan check only"] = f"scan-policy file={straight_weights(ScanPolicyWeights, Path(folder))}"
        for name in options.trials:
            kind, *words = name.split()
            trial = load_trial(kind, dict(word.split("=", 1) for word in words))
            for title in (part.strip() for part in options.navigators.split(",")):
                method = parse_methods(titles.get(title, title))
                (cell,) = evaluate(EvaluationPlan([trial], method, seeds=seeds, families=("task",))).cells
                values = " | ".join(str(cell.estimate(statistic)) for statistic in STATISTICS)
                least = ", ".join(f"{cell.estimate(f'{share}:min-clearance').value:.2f}" for share in ("median", "min"))
                print(f"| `{name}` | `{title}` | {values} | {least} |", flush=True)


if __name__ == "__main__":
    main()
