"""Write docs/results/navigators.md: navigators in the trials of CrowdNav and in the other built-in trials.

    python tools/navigators.py --seeds 500 --slow-seeds 100 --others 10 --parts parts

``--parts`` is a folder of finished parts, with which the same command continues after an interruption.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from pathlib import Path

from crowdbot.evaluation import CellResult, EvaluationPlan, Method, evaluate, parse_methods
from crowdbot.trials import builtin_trials, load_trial

PAGE = Path(__file__).parent.parent / "docs" / "results" / "navigators.md"
TEXT = Path(__file__).parent / "navigators.md.in"
LIKE_CROWDNAV = "share=0.5 time-horizon=5 neighbor-distance=10 max-neighbors=10 reaction=0.25"
NAMES = {
    "straight": "straight",
    f"orca {LIKE_CROWDNAV} safety=0.02": "ORCA, margin 0",
    f"orca {LIKE_CROWDNAV} safety=0.32": "ORCA, margin 0.15 m",
}
"""Titles of methods."""
QUICK = ", ".join(NAMES)
SLOW = "social-force, potential-field, dynamic-window, rds, time-elastic-band, mpc"
GENERAL = "straight, orca, rds, social-force, potential-field, dynamic-window, time-elastic-band, mpc"
MOST = 60
"""Largest number of people of the other trials."""
COLUMNS = ("success-rate", "collision-rate", "timeout-rate", "time-to-goal")
CROWDNAV = ("crowdnav-circle-5", "crowdnav-circle-10", "crowdnav-circle-20", "crowdnav-square-5", "crowdnav-square-10")


def cells(trials: list[str], methods: str, seeds: int, parts: Path) -> Iterator[tuple[str, CellResult]]:
    """Yield the results of methods in trials, one plan each, so that a change of one leaves the others."""
    for name in trials:
        for method in parse_methods(methods):
            yield name, cell(name, method, seeds, parts)


def cell(name: str, method: Method, seeds: int, parts: Path) -> CellResult:
    """Return the result of a method in a trial."""
    plan = EvaluationPlan([load_trial(name)], [method], seeds=range(seeds))
    folder = parts / f"{name}-{method.name}".replace(" ", "_")
    found = evaluate(plan, folder).cells[0]
    print(name, method.name, *(found.estimate(column) for column in COLUMNS), flush=True)
    return found


def row(name: str, found: CellResult) -> str:
    """Return a row of the table."""
    values = [found.estimate(column) for column in COLUMNS]
    texts = ["-" if math.isnan(one.value) else f"{one.value:.3g} [{one.low:.3g}, {one.high:.3g}]" for one in values]
    title = NAMES.get(found.method, f"`{found.method}`")
    return f"| `{name}` | {title} | {len(found.values('success'))} | {' | '.join(texts)} |"


def table(found: list[tuple[str, CellResult]]) -> str:
    """Return results as a table."""
    head = "| trial | navigator | runs | success rate | collision rate | timeout rate | time to goal [s] |"
    return "\n".join([head, "|---|---|---|---|---|---|---|", *(row(*pair) for pair in found)]) + "\n"


def others() -> list[str]:
    """Return the other built-in trials with a robot and at most 60 people, without the challenge."""
    left = [name for name in builtin_trials() if not name.startswith(("challenge", "crowdnav"))]
    return [name for name in left if load_trial(name).robots and load_trial(name).people <= MOST]


def main() -> None:
    """Run everything and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seeds", type=int, default=500)
    parser.add_argument("--slow-seeds", type=int, default=100)
    parser.add_argument("--others", type=int, default=0, help="seeds of the other built-in trials (default: none)")
    parser.add_argument("--parts", type=Path, default=Path("navigators-parts"))
    options = parser.parse_args()
    trials = [*CROWDNAV]
    found = [*cells(trials, QUICK, options.seeds, options.parts)]
    found += cells(trials[:2], SLOW, options.slow_seeds, options.parts)
    found += cells(trials[2:], SLOW, max(1, options.slow_seeds // 5), options.parts)
    found.sort(key=lambda pair: trials.index(pair[0]))
    rest = [*cells(others(), GENERAL, options.others, options.parts)] if options.others else []
    texts = [table(found), f"\n## Other built-in trials\n\n{table(rest)}" if rest else ""]
    text = TEXT.read_text(encoding="utf-8").replace("{crowdnav}", texts[0]).replace("{others}\n", texts[1])
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
