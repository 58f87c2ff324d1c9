"""Write docs/results/navigators.md: navigators in the trials of CrowdNav and in the other built-in trials.

    python studies/navigators.py --seeds 500 --slow-seeds 100 --severity-seeds 500 --others 10 --parts parts
    python studies/navigators.py --only crowds --crowds 12 --weights weights --workers 2 --parts parts

``--parts`` is a folder of finished parts, with which the same command continues after an interruption (Ctrl-C, or a
kill). ``--workers`` is the number of processes. Each line on the terminal is a finished row, with the share of the rows
that are done, the time so far and an estimate of the time left. ``--minutes`` ends the work after a time; the page is
written when all rows are there, or with ``--incomplete`` from the rows that are there. ``--keep`` runs only the rows
that the page does not have, and ``--only`` only those of one table; both keep the rows of the page that they do not
run. ``--layout`` runs nothing and writes the page again from its own rows, after a change of its text.

``--weights`` is a folder of several trainings, as ``examples/train_navigator.py --seed 0:5`` makes it: the table of
crowds has a row for each navigator in it, with the mean of the trainings and the standard deviation between them.
"""

from __future__ import annotations

import argparse
import functools
import math
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crowdbot.core import each
from crowdbot.evaluation import (
    CellResult,
    Estimate,
    EvaluationPlan,
    evaluate,
    parse_methods,
    parse_statistic,
    proportion_interval,
)
from crowdbot.metrics import LOG_FAMILIES
from crowdbot.trials import Trial, builtin_trials, load_trial

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
ALL = [
    *("straight", "orca", *SLOW, "mppi"),
    *("policy", "attention-policy", "recurrent-policy", "scan-policy", "scan-map"),
]
"""Navigators of the table of crowds: all built-in ones that have a goal and need no other program."""
SEVERE = [f"orca {LIKE_CROWDNAV} safety=0.32", "mpc", "policy"]
MOST = 60
"""Largest number of people of the other trials."""
FRESH = 1000
"""First seed of the table of severity; no choice of parameters has seen the seeds from here on."""
CROWDED = ("circle-crossing people=10", "dense-circle", "doorway", "corner-traffic", "block", "static-crowd")
"""Trials of the table of crowds, in which the navigators differ most. In denser ones, such as `density-ladder`, people
of `social-force` walk into the robot in the first second, whatever it does.
"""
CROWDS = ("people", "orca", "social-force")
PEOPLE = ("true", "tracked")
"""What the robots of the table of crowds know of people: the truth, or tracks in their own scans."""
UNMISSED = 50.0
"""Deadline of a decision [s] that none misses: with a deadline, the compute time of each decision is measured."""
COLUMNS = ("success-rate", "collision-rate", "timeout-rate", "time-to-goal")
TITLES = "success rate | collision rate | timeout rate | time to goal [s]"
SEVERITY = ("success-rate", "collision-rate", "severity-lower-bound", "severity-upper-bound", "max-impact-speed")
SEVERITY_TITLES = "success rate | collision rate | severity, lower bound | severity, upper bound | impact speed [m/s]"
CROWD_TITLES = f"{TITLES} | severity, lower bound | decision [ms]"
COMBINED = "## Crowds and perception"
ABOUT_COMBINED = """All built-in navigators with their defaults in six trials, with people who follow three crowd models
(`crowd`), and robots that know everybody's true state (`true`) or the people whom they track in their own scans
(`tracked`). Robot, drive, scanner and visibility are those of the trial. `scan-policy` and `scan-map` know scans only:
`people` changes nothing for them. Rates have Wilson intervals, times and severities bootstrap intervals of 95 %. A row
of several trainings has their mean and, after ±, the standard deviation between them. `decision` is the median compute
time of a decision, without sensing and tracking, in one more run of seed 0. Published numbers have other protocols and
stand [above](#published-results). Missing rows have not been run.

```
python examples/train_navigator.py --network attention --environments 416 --steps 1000000 \\
    --seed 0:5 --cases 0 --out weights
python studies/navigators.py --only crowds --crowds 12 --weights weights --workers 2 --parts parts
```

What it does not show. All people are simulated, and no navigator is tuned to a trial, so the order may be another one
among real people or after tuning. Each trial has one robot, so nothing is said about other bodies, drives, scanners or
speeds. Rates of a few seeds have wide intervals, and since the rows of a trial share their seeds, two intervals that
overlap do not say that two navigators are equal."""
SHOWN = """What it shows.

* `mppi`, `mpc` and `attention-policy` succeed most: in 0.82 to 0.96 of the runs among people of `people` and `orca`,
  known or tracked. Among people of `social-force` no navigator exceeds 0.65, and most collide in a fifth of the runs or
  more: a verdict on a robot holds for one crowd.
* Tracking costs success. In the mean over the twelve rows whose robots know people, 0.70 becomes 0.66 with `people`,
  0.73 becomes 0.64 with `orca`, and 0.48 becomes 0.33 with `social-force`.
* Few collisions do not mean that a robot arrives: `social-force` and `policy` collide least, in 0.08 of all runs, and
  arrive in 0.62 and 0.35.
* One training says little about a method. In the mean over all columns, the weights of `attention-policy` in the
  package succeed in 0.78 of the runs and five trainings by the same command in 0.66; in `doorway` with `orca`, three of
  these always pass the door and two never do."""
MEANS = """Success / collisions by crowd and what the robot knows of people, means over the six trials (`-`: not all of
them have been run):"""
OTHERS = "## Other built-in trials"
ABOUT = """All other built-in trials with a robot and at most 60 people, with the robot, the sensors and the drive of
the trial, and the defaults of each navigator. The column `runs` says how many seeds, from 0 on; the intervals of few
seeds are wide. `policy` was trained in the crossings of CrowdNav only. Missing rows have not been run.

```
python studies/navigators.py --only others --others 10 --parts parts
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
    crowd: str = ""
    people: str = ""
    files: tuple[Path, ...] = ()
    """Weights of several trainings of the navigator."""

    @property
    def title(self) -> str:
        """Name of the navigator in the table."""
        name = NAMES.get(self.method, f"`{self.method}`")
        return f"{name}, {len(self.files)} trainings" if self.files else name

    @property
    def key(self) -> tuple[str, ...]:
        """Table and labels of the row."""
        return (self.table, self.trial, *filter(None, (self.crowd, self.people)), self.title)

    def variant(self, **more: object) -> Trial:
        """Return the trial with its crowd, with what its robot knows of people, and with more values by path."""
        name, *words = self.trial.split()
        given = {"crowd/type": self.crowd, "robot/people": self.people}
        values = dict(word.split("=", 1) for word in words) | {path: value for path, value in given.items() if value}
        return load_trial(name, values | more)


class Found(NamedTuple):
    """What was found for a row: the result of each training, or of one, and the time of a decision [s] if measured."""

    cells: tuple[CellResult, ...]
    decision: float


class Table(NamedTuple):
    """A table of the page: its name, its columns, their titles, and those of the labels of a row."""

    name: str
    columns: tuple[str, ...]
    titles: str
    labels: tuple[str, ...] = ("trial", "navigator")

    @property
    def head(self) -> str:
        """First line of the table."""
        return f"| {' | '.join(self.labels)} | runs | {self.titles} |"


TABLES = (
    Table("crowdnav", COLUMNS, TITLES),
    Table("severity", SEVERITY, SEVERITY_TITLES),
    Table("crowds", (*COLUMNS, "severity-lower-bound"), CROWD_TITLES, ("trial", "crowd", "people", "navigator")),
    Table("others", COLUMNS, TITLES),
)
SECTIONS = {"# Navigators": "crowdnav", "## Severity": "severity", COMBINED: "crowds", OTHERS: "others"}
"""Tables by the title of the section in which they stand."""
Lines = dict[tuple[str, ...], str]
"""Lines of tables by table and labels of the row."""


def trainings(folder: Path | None) -> dict[str, tuple[Path, ...]]:
    """Return the weights of the trainings in a folder by navigator."""
    files = [] if folder is None else sorted(folder.glob("seed-*/*.npz"))
    names = sorted({file.stem for file in files}, key=lambda name: _place(ALL, name))
    return {name: tuple(file for file in files if file.stem == name) for name in names}


def combined_rows(options: argparse.Namespace) -> list[Row]:
    """Return the rows of the table of crowds, one navigator after another."""
    methods: list[tuple[str, tuple[Path, ...]]] = [(method, ()) for method in ALL]
    return [
        Row("crowds", trial, method, options.crowds, crowd, people, files)
        for method, files in [*methods, *trainings(options.weights).items()]
        for trial in CROWDED
        for crowd in CROWDS
        for people in PEOPLE
    ]


def rows_of(options: argparse.Namespace) -> list[Row]:
    """Return the rows of the tables that have seeds, the quick ones first."""
    rest = [
        Row("others", trial, method, seeds)
        for methods, seeds in ((QUICK_OTHERS, options.others), (SLOW_OTHERS, options.slow_others))
        for trial in others()
        for method in methods
    ]
    quick = [Row("crowdnav", trial, method, options.seeds) for trial in CROWDNAV for method in QUICK]
    slow = [
        Row("crowdnav", trial, method, options.slow_seeds if trial in CROWDNAV[:3] else max(1, options.slow_seeds // 5))
        for trial in CROWDNAV
        for method in SLOW
    ]
    severe = [Row("severity", trial, method, options.severity_seeds) for trial in CROWDNAV[:2] for method in SEVERE]
    found = [*quick, *slow, *severe, *combined_rows(options), *rest]
    return [row for row in found if row.seeds and options.only in (None, row.table)]


def run_row(row: Row, parts: Path) -> Found:
    """Return the result of a row; one plan each, so that a change of one leaves the others."""
    if row.table != "crowds":
        first = FRESH if row.table == "severity" else 0
        return Found((cell(row, None, row.variant(), range(first, first + row.seeds), parts),), math.nan)
    files, timed = row.files or (None,), row.variant(**{"robot/deadline": UNMISSED})
    cells = tuple(cell(row, file, row.variant(), range(row.seeds), parts) for file in files)
    times = [cell(row, file, timed, range(1), parts).estimate("decision-time").value for file in files]
    return Found(cells, float(np.mean(times)))


def cell(row: Row, file: Path | None, trial: Trial, seeds: range, parts: Path) -> CellResult:
    """Return the runs of the navigator of a row, or of its weights in a file, in a trial."""
    families = ("task", "severity") if row.table == "crowds" else tuple(LOG_FAMILIES)
    (method,) = parse_methods(row.method if file is None else f"{row.method} file={file}")
    plan = EvaluationPlan([trial], [method], seeds=seeds, families=families)
    return evaluate(plan, parts / f"{row.trial}-{row.method}".replace(" ", "_")).cells[0]


def compute(rows: list[Row], options: argparse.Namespace) -> dict[Row, Found]:
    """Run rows until the time is over, and tell how far it is."""
    found, begin = dict[Row, Found](), time.monotonic()
    results = each(functools.partial(run_row, parts=options.parts), rows, options.workers)
    for number, one in results if options.minutes > 0.0 else ():
        row, found[rows[number]] = rows[number], one
        minutes = (time.monotonic() - begin) / 60.0
        left = minutes / len(found) * (len(rows) - len(found))
        what = f"{' '.join(row.key[1:])}: {' '.join(texts_of(one, COLUMNS[:3]))}"
        print(f"{len(found)} of {len(rows)}, {minutes:.1f} min, about {left:.0f} min left: {what}", flush=True)
        if minutes > options.minutes:
            break
    print(f"{len(found)} of {len(rows)} rows in {(time.monotonic() - begin) / 60.0:.1f} min", flush=True)
    return found


def texts_of(found: Found, columns: Sequence[str]) -> list[str]:
    """Return the statistics of a row: values with intervals, or means of trainings with standard deviations."""
    texts = []
    for column in columns:
        values = [_estimate(cell, column) for cell in found.cells]
        known = [value.value for value in values if not math.isnan(value.value)]
        if not known:
            texts.append("-")
        elif len(values) == 1:
            texts.append(f"{values[0].value:.3g} [{values[0].low:.3g}, {values[0].high:.3g}]")
        elif len(known) == 1:
            texts.append(f"{known[0]:.3g}, one training")
        else:
            texts.append(f"{np.mean(known):.3g} ± {np.std(known, ddof=1):.2g}")
    return texts


def line(row: Row, found: Found, columns: tuple[str, ...]) -> str:
    """Return a row of a table."""
    texts = texts_of(found, columns)
    if row.table == "crowds":
        texts.append("-" if math.isnan(found.decision) else f"{1e3 * found.decision:.2g}")
    runs = sum(len(cell.values("success")) for cell in found.cells)
    return f"| `{row.trial}` | {' | '.join(row.key[2:])} | {runs} | {' | '.join(texts)} |"


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
    tables = {item.name: item for item in TABLES}
    bars = {item.name: item.head.count("|") for item in TABLES}
    for text in page.splitlines():
        if text.startswith("#"):
            table = SECTIONS.get(text, "")
        words = text.split(" | ")
        if table and text.startswith("| `") and text.count("|") == bars[table]:
            labels = words[1 : len(tables[table].labels)]
            found[table, words[0].strip("| `"), *labels] = text
    return found


def table_text(table: Table, lines: Lines) -> str:
    """Return a table as Markdown, in the order of its labels."""
    orders = {
        "trial": CROWDED if table.name == "crowds" else [*CROWDNAV, *others()],
        "crowd": CROWDS,
        "people": PEOPLE,
        "navigator": titles(),
    }
    keys = [key for key in lines if key[0] == table.name]
    keys.sort(key=lambda key: [_place(orders[label], name) for label, name in zip(table.labels, key[1:], strict=True)])
    return "\n".join([table.head, "|---" * (table.head.count("|") - 1) + "|", *(lines[key] for key in keys)]) + "\n"


def titles() -> list[str]:
    """Return the names of all navigators in the order of the tables; those of several trainings come last."""
    methods = [*NAMES, "orca", *SLOW, *(method for method in ALL if method not in ("straight", "orca", *SLOW))]
    return [Row("", "", method, 0).title for method in methods]


def summary(lines: Lines) -> str:
    """Return the shares of success and collisions of each navigator: means over the trials of the table of crowds."""
    columns = [(crowd, people) for crowd in CROWDS for people in PEOPLE]
    named = sorted({key[-1] for key in lines if key[0] == "crowds"}, key=lambda name: (_place(titles(), name), name))
    head = f"| navigator | {' | '.join(f'{crowd}, {people}' for crowd, people in columns)} |"
    rows = [head, "|---" * (len(columns) + 1) + "|"]
    for name in named:
        texts = []
        for column in columns:
            found = [lines.get(("crowds", trial, *column, name)) for trial in CROWDED]
            shares = [[float(word.split()[0]) for word in text.split(" | ")[5:7]] for text in found if text]
            whole = len(shares) == len(CROWDED)
            texts.append(" / ".join(f"{value:.2f}" for value in np.mean(shares, axis=0)) if whole else "-")
        rows.append(f"| {name} | {' | '.join(texts)} |")
    return "\n".join(rows) + "\n"


def _place(names: Sequence[str], name: str) -> int:
    """Return the place of a name in a list, or the end."""
    return names.index(name) if name in names else len(names)


def page_text(lines: Lines) -> str:
    """Return the page with these rows."""
    page = TEXT.read_text(encoding="utf-8")
    for table in TABLES:
        text = table_text(table, lines)
        has_rows = any(key[0] == table.name for key in lines)
        if table.name == "others":
            text = f"\n{OTHERS}\n\n{ABOUT}\n\n{text}" if has_rows else ""
        if table.name == "crowds":
            parts = (COMBINED, ABOUT_COMBINED, MEANS, summary(lines).rstrip("\n"), SHOWN, text)
            text = "\n" + "\n\n".join(parts) if has_rows else ""
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
    parser.add_argument("--crowds", type=int, default=0, help="seeds of the table of crowds (default: none)")
    parser.add_argument("--weights", type=Path, help="folder of trainings, whose means are in the table of crowds")
    parser.add_argument(
        "--only", choices=[table.name for table in TABLES], help="run one table only, and keep the rest of the page"
    )
    parser.add_argument("--keep", action="store_true", help="run only the rows that the page does not have")
    parser.add_argument("--layout", action="store_true", help="run nothing, write the page again from its rows")
    parser.add_argument("--minutes", type=float, default=math.inf, help="time after which no more rows begin")
    parser.add_argument("--incomplete", action="store_true", help="write the page even if rows are missing")
    parser.add_argument("--workers", type=int, default=1, help="number of processes (default: 1)")
    parser.add_argument("--parts", type=Path, default=Path("navigators-parts"))
    options = parser.parse_args(words)
    if options.slow_others is None:
        options.slow_others = options.others
    if options.only and not rows_of(options):
        parser.error(f"--only {options.only} needs the number of seeds of this table, such as --{options.only} 10")
    if options.weights and not trainings(options.weights):
        parser.error(f"--weights {options.weights} has no trainings; there are files such as seed-0/policy.npz in it")
    return options


def main(words: list[str] | None = None) -> None:
    """Run everything and write the page."""
    options = parse_options(words)
    old = lines_of_page(PAGE.read_text(encoding="utf-8"))
    if options.layout:
        PAGE.write_text(page_text(old), encoding="utf-8")
        return
    rows = [row for row in rows_of(options) if not (options.keep and row.key in old)]
    try:
        found = compute(rows, options)
    except KeyboardInterrupt:
        print(f"interrupted; the same command continues with {options.parts}", file=sys.stderr)
        sys.exit(130)
    if len(found) < len(rows) and not options.incomplete:
        print(f"the page is not written; the same command continues with {options.parts}")
        return
    columns = {table.name: table.columns for table in TABLES}
    new = {row.key: line(row, one, columns[row.table]) for row, one in found.items()}
    PAGE.write_text(page_text((old if options.keep or options.only else {}) | new), encoding="utf-8")


if __name__ == "__main__":
    main()
