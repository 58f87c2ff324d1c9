"""Write docs/results/navigators.md: navigators in the trials of CrowdNav and in the other built-in trials.

    python studies/navigators.py --seeds 500 --slow-seeds 100 --severity-seeds 500 --others 10 --parts parts

``--parts`` is a folder of finished parts, with which the same command continues after an interruption (Ctrl-C, or a
kill). Everything runs in one process. Each line on the terminal is a finished row, with the share of the rows that are
done and the time so far. ``--minutes`` ends the work after a time; the page is written when all rows are there, or with
``--incomplete`` from the rows that are there. ``--keep`` runs only the rows that the page does not have, and
``--only-others`` only those of the other trials; both keep the rows of the page that they do not run. ``--layout`` runs
nothing and writes the page again from its own rows, after a change of its text.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crowdbot.evaluation import (
    CellResult,
    Estimate,
    EvaluationPlan,
    evaluate,
    parse_methods,
    parse_statistic,
    proportion_interval,
)
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
QUICK_OTHERS, SLOW_OTHERS = ["straight", "orca", "policy"], SLOW
"""Navigators of the other trials: those that need little time, and the others."""
SEVERE = [f"orca {LIKE_CROWDNAV} safety=0.32", "mpc", "policy"]
MOST = 60
"""Largest number of people of the other trials."""
FRESH = 1000
"""First seed of the table of severity; no choice of parameters has seen the seeds from here on."""
COLUMNS = ("success-rate", "collision-rate", "timeout-rate", "time-to-goal")
TITLES = "success rate | collision rate | timeout rate | time to goal [s]"
SEVERITY = ("success-rate", "collision-rate", "severity-lower-bound", "severity-upper-bound", "max-impact-speed")
SEVERITY_TITLES = "success rate | collision rate | severity, lower bound | severity, upper bound | impact speed [m/s]"
OTHERS = "## Other built-in trials"
ABOUT = """All other built-in trials with a robot and at most 60 people, with the robot, the sensors and the drive of
the trial, and the defaults of each navigator. The column `runs` says how many seeds, from 0 on; the intervals of few
seeds are wide. `policy` was trained in the crossings of CrowdNav only. Missing rows have not been run.

```
python studies/navigators.py --only-others --others 10 --parts parts
```

**The crowd before.** The same rows were run with the crowd that was not fitted to encounters with robots, and whose
people walked up to them. Means over the 35 trials, before and now:

| navigator | success rate | collision rate |
|---|---|---|
| `orca` | 0.954, 0.954 | 0.043, 0.046 |
| `time-elastic-band` | 0.926, 0.934 | 0.011, 0.009 |
| `mpc` | 0.914, 0.934 | 0.020, 0.009 |
| `social-force` | 0.846, 0.860 | 0.031, 0.034 |
| `potential-field` | 0.817, 0.851 | 0.031, 0.037 |
| `dynamic-window` | 0.786, 0.849 | 0.051, 0.054 |
| `rds` | 0.760, 0.774 | 0.066, 0.037 |
| `policy` | 0.726, 0.740 | 0.006, 0.000 |
| straight | 0.603, 0.660 | 0.397, 0.340 |

The order by success stays, but `mpc` is now level with `time-elastic-band`. Five rows of 315 have an interval of
success that does not meet the one before: in `perpendicular-flow` `dynamic-window`, `potential-field` and `rds` go
from 0.3, 0.2 and 0.3 to 1, in `random-goals` `dynamic-window` from 0 and straight from 0.2 to 1, since people give
way. Two collision rates fall as clearly: straight in `random-goals`, from 0.8 to 0, and `rds` in `corner-traffic`,
from 0.9 to 0.2. So two conclusions change: `random-goals` and `perpendicular-flow` no longer tell these navigators
apart. `straight` still touches somebody in every third run; no crowd makes it safe. Between the two runs, outlines of
robots, walls and the planner changed, too, so not every difference comes from the crowd."""
CROWDNAV = ("crowdnav-circle-5", "crowdnav-circle-10", "crowdnav-circle-20", "crowdnav-square-5", "crowdnav-square-10")


class Row(NamedTuple):
    """A row of a table: a navigator in a trial."""

    table: str
    trial: str
    method: str
    seeds: int

    @property
    def title(self) -> str:
        """Name of the navigator in the table."""
        return NAMES.get(self.method, f"`{self.method}`")


class Table(NamedTuple):
    """A table of the page: its name, its columns, and their titles."""

    name: str
    columns: tuple[str, ...]
    titles: str

    @property
    def head(self) -> str:
        """First line of the table."""
        return f"| trial | navigator | runs | {self.titles} |"


TABLES = (
    Table("crowdnav", COLUMNS, TITLES),
    Table("severity", SEVERITY, SEVERITY_TITLES),
    Table("others", COLUMNS, TITLES),
)
SECTIONS = {"# Navigators": "crowdnav", "## Severity": "severity", OTHERS: "others"}
"""Tables by the title of the section in which they stand."""
Lines = dict[tuple[str, str, str], str]
"""Lines of tables by table, trial and title of the navigator."""


def rows_of(options: argparse.Namespace) -> list[Row]:
    """Return the rows of all tables, the quick ones first."""
    rest = [
        Row("others", trial, method, seeds)
        for methods, seeds in ((QUICK_OTHERS, options.others), (SLOW_OTHERS, options.slow_others))
        for trial in others()
        for method in methods
    ]
    if options.only_others:
        return rest
    quick = [Row("crowdnav", trial, method, options.seeds) for trial in CROWDNAV for method in QUICK]
    slow = [
        Row("crowdnav", trial, method, options.slow_seeds if trial in CROWDNAV[:3] else max(1, options.slow_seeds // 5))
        for trial in CROWDNAV
        for method in SLOW
    ]
    severe = [Row("severity", trial, method, options.severity_seeds) for trial in CROWDNAV[:2] for method in SEVERE]
    return [*quick, *slow, *(severe if options.severity_seeds else []), *(rest if options.others else [])]


def cell(row: Row, parts: Path) -> CellResult:
    """Return the result of a row; one plan each, so that a change of one leaves the others."""
    method = parse_methods(row.method)[0]
    first = FRESH if row.table == "severity" else 0
    plan = EvaluationPlan([load_trial(row.trial)], [method], seeds=range(first, first + row.seeds))
    return evaluate(plan, parts / f"{row.trial}-{method.name}".replace(" ", "_")).cells[0]


def compute(rows: list[Row], options: argparse.Namespace) -> dict[Row, CellResult]:
    """Run rows until the time is over, and tell how far it is."""
    found, begin = dict[Row, CellResult](), time.monotonic()
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
    values = [_estimate(found, column) for column in columns]
    texts = [
        "-" if math.isnan(value.value) else f"{value.value:.3g} [{value.low:.3g}, {value.high:.3g}]" for value in values
    ]
    return f"| `{row.trial}` | {row.title} | {len(found.values('success'))} | {' | '.join(texts)} |"


def _estimate(found: CellResult, column: str) -> Estimate:
    """Return a statistic; rates have the Wilson intervals of the rows that the page keeps."""
    statistic = parse_statistic(column)
    if statistic.kind != "rate":
        return found.estimate(statistic)
    values = found.values(statistic.metric)
    return proportion_interval(int(np.nansum(values)), int(np.sum(~np.isnan(values))), method="wilson")


def lines_of_page(page: str) -> Lines:
    """Return the rows that a page has; the tables of its text have fewer columns."""
    found, table = Lines(), ""
    bars = {item.name: item.head.count("|") for item in TABLES}
    for text in page.splitlines():
        if text.startswith("#"):
            table = SECTIONS.get(text, "")
        words = text.split(" | ")
        if table and text.startswith("| `") and text.count("|") == bars[table]:
            found[table, words[0].strip("| `"), words[1]] = text
    return found


def table_text(table: Table, lines: Lines) -> str:
    """Return a table as Markdown, by trial and navigator."""
    trials = [*CROWDNAV, *others()]
    titles = [Row("", "", method, 0).title for method in [*NAMES, "orca", *SLOW, "policy"]]
    keys = [key for key in lines if key[0] == table.name]
    keys.sort(key=lambda key: (_place(trials, key[1]), _place(titles, key[2])))
    return "\n".join([table.head, "|---" * (table.head.count("|") - 1) + "|", *(lines[key] for key in keys)]) + "\n"


def _place(names: list[str], name: str) -> int:
    """Return the place of a name in a list, or the end."""
    return names.index(name) if name in names else len(names)


def page_text(lines: Lines) -> str:
    """Return the page with these rows."""
    page = TEXT.read_text(encoding="utf-8")
    for table in TABLES:
        text = table_text(table, lines)
        if table.name == "others":
            has_rows = any(key[0] == "others" for key in lines)
            text = f"\n{OTHERS}\n\n{ABOUT}\n\n{text}" if has_rows else ""
        page = page.replace(f"{{{table.name}}}\n", text)
    return page


def others() -> list[str]:
    """Return the other built-in trials with a robot and at most 60 people, without the challenge."""
    left = [name for name in builtin_trials() if not name.startswith(("challenge", "crowdnav"))]
    return [name for name in left if load_trial(name).robots and load_trial(name).people <= MOST]


def parse_options(words: list[str] | None) -> argparse.Namespace:
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seeds", type=int, default=500)
    parser.add_argument("--slow-seeds", type=int, default=100)
    parser.add_argument("--severity-seeds", type=int, default=500, help="seeds of the table of severity (0: none)")
    parser.add_argument("--others", type=int, default=0, help="seeds of the other built-in trials (default: none)")
    parser.add_argument("--slow-others", type=int, help="seeds of slow navigators there (default: as --others)")
    parser.add_argument("--only-others", action="store_true", help="run these only, and keep the rest of the page")
    parser.add_argument("--keep", action="store_true", help="run only the rows that the page does not have")
    parser.add_argument("--layout", action="store_true", help="run nothing, write the page again from its rows")
    parser.add_argument("--minutes", type=float, default=math.inf, help="time after which no more rows begin")
    parser.add_argument("--incomplete", action="store_true", help="write the page even if rows are missing")
    parser.add_argument("--parts", type=Path, default=Path("navigators-parts"))
    options = parser.parse_args(words)
    if options.slow_others is None:
        options.slow_others = options.others
    if options.only_others and not options.others:
        parser.error("--only-others needs --others, the number of seeds")
    return options


def main(words: list[str] | None = None) -> None:
    """Run everything and write the page."""
    options = parse_options(words)
    old = lines_of_page(PAGE.read_text(encoding="utf-8"))
    if options.layout:
        PAGE.write_text(page_text(old), encoding="utf-8")
        return
    rows = [row for row in rows_of(options) if not (options.keep and (row.table, row.trial, row.title) in old)]
    try:
        found = compute(rows, options)
    except KeyboardInterrupt:
        print(f"interrupted; the same command continues with {options.parts}", file=sys.stderr)
        sys.exit(130)
    if len(found) < len(rows) and not options.incomplete:
        print(f"the page is not written; the same command continues with {options.parts}")
        return
    columns = {table.name: table.columns for table in TABLES}
    new = {(row.table, row.trial, row.title): line(row, one, columns[row.table]) for row, one in found.items()}
    PAGE.write_text(page_text((old if options.keep or options.only_others else {}) | new), encoding="utf-8")


if __name__ == "__main__":
    main()
