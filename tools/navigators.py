"""Write docs/results/navigators.md: navigators in the trials of CrowdNav and in the other built-in trials.

    python tools/navigators.py --seeds 500 --slow-seeds 100 --severity-seeds 500 --others 10 --parts parts

``--parts`` is a folder of finished parts, with which the same command continues after an interruption (Ctrl-C, or a
kill). Everything runs in one process. Each line on the terminal is a finished row, with the share of the rows that are
done and the time so far. ``--minutes`` ends the work after a time; the page is written when all rows are there, or with
``--incomplete`` from the rows that are there.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path
from typing import NamedTuple

from crowdbot.evaluation import CellResult, EvaluationPlan, evaluate, parse_methods
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
QUICK = [*NAMES, "policy"]
SLOW = ["social-force", "potential-field", "dynamic-window", "rds", "time-elastic-band", "mpc"]
GENERAL = ["straight", "orca", "policy", *SLOW]
SEVERE = [f"orca {LIKE_CROWDNAV} safety=0.32", "mpc", "policy"]
MOST = 60
"""Largest number of people of the other trials."""
FRESH = 1000
"""First seed of the table of severity; no choice of parameters has seen the seeds from here on."""
COLUMNS = ("success-rate", "collision-rate", "timeout-rate", "time-to-goal")
TITLES = "success rate | collision rate | timeout rate | time to goal [s]"
SEVERITY = ("success-rate", "collision-rate", "severity-lower-bound", "severity-upper-bound", "max-impact-speed")
SEVERITY_TITLES = "success rate | collision rate | severity, lower bound | severity, upper bound | impact speed [m/s]"
CROWDNAV = ("crowdnav-circle-5", "crowdnav-circle-10", "crowdnav-circle-20", "crowdnav-square-5", "crowdnav-square-10")


class Row(NamedTuple):
    """A row of a table: a navigator in a trial."""

    table: str
    trial: str
    method: str
    seeds: int


def rows_of(options: argparse.Namespace) -> list[Row]:
    """Return the rows of all tables, the quick ones first."""
    quick = [Row("crowdnav", trial, method, options.seeds) for trial in CROWDNAV for method in QUICK]
    slow = [
        Row("crowdnav", trial, method, options.slow_seeds if trial in CROWDNAV[:2] else max(1, options.slow_seeds // 5))
        for trial in CROWDNAV
        for method in SLOW
    ]
    severe = [Row("severity", trial, method, options.severity_seeds) for trial in CROWDNAV[:2] for method in SEVERE]
    rest = [Row("others", trial, method, options.others) for trial in others() for method in GENERAL]
    return [*quick, *slow, *(severe if options.severity_seeds else []), *(rest if options.others else [])]


def cell(row: Row, parts: Path) -> CellResult:
    """Return the result of a row; one plan each, so that a change of one leaves the others."""
    method = parse_methods(row.method)[0]
    first = FRESH if row.table == "severity" else 0
    plan = EvaluationPlan([load_trial(row.trial)], [method], seeds=range(first, first + row.seeds))
    return evaluate(plan, parts / f"{row.trial}-{method.name}".replace(" ", "_")).cells[0]


def compute(options: argparse.Namespace) -> dict[Row, CellResult]:
    """Run all rows until the time is over, and tell how far it is."""
    rows, found, begin = rows_of(options), dict[Row, CellResult](), time.monotonic()
    for number, row in enumerate(rows, 1):
        if time.monotonic() - begin > 60.0 * options.minutes:
            break
        found[row] = cell(row, options.parts)
        values = " ".join(str(found[row].estimate(name)) for name in COLUMNS[:3])
        minutes = (time.monotonic() - begin) / 60.0
        print(f"{number} of {len(rows)}, {minutes:.1f} min: {row.trial} {row.method}: {values}", flush=True)
    print(f"{len(found)} of {len(rows)} rows in {(time.monotonic() - begin) / 60.0:.1f} min", flush=True)
    return found


def line(row: Row, found: CellResult, columns: tuple[str, ...]) -> str:
    """Return a row of a table."""
    values = [found.estimate(column) for column in columns]
    texts = ["-" if math.isnan(one.value) else f"{one.value:.3g} [{one.low:.3g}, {one.high:.3g}]" for one in values]
    title = NAMES.get(found.method, f"`{found.method}`")
    return f"| `{row.trial}` | {title} | {len(found.values('success'))} | {' | '.join(texts)} |"


def table(found: dict[Row, CellResult], name: str, columns: tuple[str, ...], titles: str) -> str:
    """Return the results of a table as Markdown, by trial."""
    rows = [row for row in found if row.table == name]
    trials = [*CROWDNAV] if name != "others" else list(dict.fromkeys(row.trial for row in rows))
    lines = [line(row, found[row], columns) for row in sorted(rows, key=lambda row: trials.index(row.trial))]
    head = f"| trial | navigator | runs | {titles} |"
    return "\n".join([head, "|---" * (head.count("|") - 1) + "|", *lines]) + "\n"


def others() -> list[str]:
    """Return the other built-in trials with a robot and at most 60 people, without the challenge."""
    left = [name for name in builtin_trials() if not name.startswith(("challenge", "crowdnav"))]
    return [name for name in left if load_trial(name).robots and load_trial(name).people <= MOST]


def main() -> None:
    """Run everything and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seeds", type=int, default=500)
    parser.add_argument("--slow-seeds", type=int, default=100)
    parser.add_argument("--severity-seeds", type=int, default=500, help="seeds of the table of severity (0: none)")
    parser.add_argument("--others", type=int, default=0, help="seeds of the other built-in trials (default: none)")
    parser.add_argument("--minutes", type=float, default=math.inf, help="time after which no more rows begin")
    parser.add_argument("--incomplete", action="store_true", help="write the page even if rows are missing")
    parser.add_argument("--parts", type=Path, default=Path("navigators-parts"))
    options = parser.parse_args()
    try:
        found = compute(options)
    except KeyboardInterrupt:
        print(f"interrupted; the same command continues with {options.parts}", file=sys.stderr)
        sys.exit(130)
    if len(found) < len(rows_of(options)) and not options.incomplete:
        print(f"the page is not written; the same command continues with {options.parts}")
        return
    rest = table(found, "others", COLUMNS, TITLES)
    texts = {
        "{crowdnav}": table(found, "crowdnav", COLUMNS, TITLES),
        "{severity}": table(found, "severity", SEVERITY, SEVERITY_TITLES),
        "{others}\n": f"\n## Other built-in trials\n\n{rest}" if options.others else "",
    }
    page = TEXT.read_text(encoding="utf-8")
    for mark, text in texts.items():
        page = page.replace(mark, text)
    PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
