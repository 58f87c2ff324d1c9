"""Tables of prediction in Markdown, from the stored results of studies/prediction_tables.py."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["page"]

Row = dict[str, Any]
Rows = dict[str, Row]
PLACES = ("eth", "hotel", "univ", "zara1", "zara2")
PAIR = ("ADE", "FDE")


def page(folder: Path, source: str) -> str:
    """Return all tables for which there are results of this source code."""
    found: dict[str, Rows] = {}
    for file in sorted(folder.glob("*.json")):
        kept = json.loads(file.read_text(encoding="utf-8"))
        if kept.get("source") == source:
            found.setdefault(kept["part"], {})[kept["name"]] = kept["row"]
    makers = {
        "zero-shot": zero_shot, "leave-one-out": leave_one_out, "trajnet": trajnet, "degraded": degraded,
        "robot-plan": robot_plan, "trials": trials,
    }  # fmt: skip
    ordered = {part: dict(sorted(rows.items())) for part, rows in found.items()}
    return "\n\n".join(f"## {part}\n\n{make(ordered[part])}" for part, make in makers.items() if part in found) + "\n"


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a Markdown table."""
    names = list(head)
    lines = [names, ["---"] * len(names), *map(list, rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def pair(row: Row, names: tuple[str, str] = PAIR) -> str:
    """Return two errors as a cell."""
    return "/".join("-" if row.get(name) is None else f"{row[name]:.3f}" for name in names)


def seeds(rows: Rows, begin: str) -> list[Row]:
    """Return the results of all seeds of a predictor."""
    return [row for name, row in rows.items() if name.startswith(f"{begin}, seed ")]


def spread(rows: list[Row], names: tuple[str, str] = PAIR) -> str:
    """Return mean and standard deviation over seeds of two errors."""
    values = np.array([[row[name] for name in names] for row in rows])
    deviation = values.std(axis=0, ddof=1) if len(values) > 1 else np.zeros(2)
    cells = (f"{item:.3f} ± {two:.3f}" for item, two in zip(values.mean(axis=0), deviation, strict=True))
    return f"{' / '.join(cells)} ({len(rows)})"


def by_place(rows: Rows) -> dict[str, Rows]:
    """Return results by the first word of their names."""
    result: dict[str, Rows] = {}
    for name, row in rows.items():
        place, _, rest = name.partition("|")
        result.setdefault(place, {})[rest] = row
    return result


def zero_shot(rows: Rows) -> str:
    """Return the table of data sets that no default weight saw, and the mean gain."""
    lines, gains = [], []
    for place, own in by_place(rows).items():
        base = [own[name] for name in ("constant velocity", "Kalman")]
        one, many = own["AnchorNet, 1, seed 0"], own["AnchorNet, 20, seed 0"]
        gain = [1.0 - one[name] / min(row[name] for row in base) for name in PAIR]
        gain += [1.0 - many[name] / own["anchors, 20"][name] for name in PAIR]
        gains.append(gain)
        lines.append([
            place, str(one["persons"]), *(pair(own[name]) for name in ("constant velocity", "Kalman", "least squares")),
            f"**{pair(one)}**", f"{100 * gain[0]:.0f} / {100 * gain[1]:.0f} %", spread(seeds(own, "AnchorNet, 1")),
            pair(own["anchors, 20"]), f"**{pair(many)}**", f"{100 * gain[2]:.0f} / {100 * gain[3]:.0f} %",
            spread(seeds(own, "AnchorNet, 20")),
        ])  # fmt: skip
    mean = 100.0 * np.mean(gains, axis=0)
    head = (
        "data set", "persons", "constant velocity", "Kalman", "least squares", "AnchorNet, 1", "gain", "mean of seeds",
        "20 anchors", "AnchorNet, 20", "gain", "mean of seeds",
    )  # fmt: skip
    words = f"Mean gain: {mean[0]:.1f} / {mean[1]:.1f} % for one answer, {mean[2]:.1f} / {mean[3]:.1f} % for 20."
    return f"{table(head, lines)}\n\n{words}"


def leave_one_out(rows: Rows) -> str:
    """Return the tables of the leave-one-out places, by protocol."""
    parts = []
    names = ("missed", "energy", "NLL", "collisions", "swept 0.2", "truth 0.2", "swept 0.4", "truth 0.4")
    for protocol in ("all", "sgan"):
        own = {name.partition("|")[2]: row for name, row in rows.items() if name.startswith(f"{protocol}|")}
        for place in PLACES:
            if place not in (here := by_place(own)):
                continue
            lines = [
                [name, str(row["persons"]), pair(row), pair(row, ("JADE", "JFDE")),
                 *("-" if row.get(key) is None else f"{row[key]:.3f}" for key in names)]
                for name, row in here[place].items()
            ]  # fmt: skip
            for begin in ("AnchorNet, 1", "AnchorNet, 20"):
                if len(seeds(here[place], begin)) > 1:
                    lines.append([f"{begin}, mean of seeds", "", spread(seeds(here[place], begin)),
                                  spread(seeds(here[place], begin), ("JADE", "JFDE")), *[""] * len(names)])  # fmt: skip
            head = ("predictor", "persons", "ADE/FDE [m]", "JADE/JFDE [m]", *names)
            parts.append(f"Protocol {protocol}, {place}:\n\n{table(head, lines)}")
    return "\n\n".join(parts)


def trajnet(rows: Rows) -> str:
    """Return the table of the categories of TrajNet++."""
    lines = [
        [name.replace("|", ": "), category, str(row["scenes"]), pair(row), f"{100 * row['Col-I']:.1f} %",
         f"{100 * row['Col-II']:.1f} %"]
        for name, own in rows.items() for category, row in own.items()
    ]  # fmt: skip
    return table(("file and predictor", "category", "scenes", "ADE/FDE [m]", "Col-I", "Col-II"), lines)


def degraded(rows: Rows) -> str:
    """Return the table of degraded tracks."""
    places = by_place(rows)
    names = list(next(iter(places.values())))
    return table(
        ("tracks", *names), [[cost, *(pair(own[n]) for n in names if n in own)] for cost, own in places.items()]
    )


def robot_plan(rows: Rows) -> str:
    """Return the table of the plan of the cart."""
    lines = [
        [name, what, str(row["people"]), "-" if row["ADE"] is None else f"{row['ADE']:.3f}",
         "-" if row["power"] is None else f"{row['difference']:+.4f} ({row['low']:+.4f} to {row['high']:+.4f})",
         "-" if row["power"] is None else f"{row['power']:.2f}"]
        for name, own in rows.items() for what, row in own.items()
    ]  # fmt: skip
    return table(("predictor", "known", "people", "ADE [m]", "difference, 95 %", "power for 5 %"), lines)


def trials(rows: Rows) -> str:
    """Return the table of built-in trials."""
    names = ("constant velocity", "AnchorNet, 1", "anchors, 20", "AnchorNet, 20")
    kept = {name: row for name, row in rows.items() if "left out" not in row}
    lines = [[name, str(row[names[0]]["persons"]), *(pair(row[n]) for n in names)] for name, row in kept.items()]
    left = ", ".join(name for name in rows if name not in kept)
    return table(("trial", "persons", *names), lines) + (f"\n\nNobody can be scored: {left}." if left else "")
