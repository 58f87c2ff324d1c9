"""Metric: one row of the table of navigation metrics, from which their reference page is made."""

from __future__ import annotations

import functools
import importlib.resources
import tomllib
from collections.abc import Mapping
from typing import Any, NamedTuple


class Metric(NamedTuple):
    """One metric of the table.

    Fields:
        name: key in results. A ``*`` at the end stands for the name of a body region.
        family: group of metrics that are computed together.
        unit: ``1`` for numbers and shares.
        better: ``higher``, ``lower``, or ``none`` for a covariate.
        formula: definition.
        source: publication, with its address.
        needs: what the log must have.
        alias: name in the list of Francis et al. 2023, or empty.
        correlates: what it is known to correlate with.
    """

    name: str
    family: str
    unit: str
    better: str
    formula: str
    source: str
    needs: str
    alias: str
    correlates: str


@functools.cache
def _families() -> Mapping[str, Mapping[str, Any]]:
    file = importlib.resources.files("crowdbot").joinpath("assets", "metrics", "metrics.toml")
    return tomllib.loads(file.read_text(encoding="utf-8"))


@functools.cache
def metric_table() -> Mapping[str, Metric]:
    """Return every metric of navigation by name.

    >>> metric_table()["spl"].formula
    'S l / max(L, l)'
    """
    return {
        name: Metric(
            name,
            family,
            values["unit"],
            values["better"],
            values["formula"],
            *(values.get(key, about.get(key, "")) for key in ("source", "needs", "alias", "correlates")),
        )
        for family, about in _families().items()
        for name, values in about["metrics"].items()
    }


def metric_families() -> dict[str, tuple[Metric, ...]]:
    """Return the metrics of each family, in the order of the table.

    >>> [metric.name for metric in metric_families()["legibility"]]
    ['legibility']
    """
    rows = metric_table().values()
    return {family: tuple(row for row in rows if row.family == family) for family in _families()}


def metric_page() -> str:
    """Return the reference page of all metrics as Markdown."""
    parts = [_HEAD]
    for family, rows in metric_families().items():
        about = _families()[family]
        parts.append(
            f"## {about['title']}\n\nFamily `{family}`. Needs: {about['needs']}. Source unless stated otherwise:"
        )
        parts.append(f"{_link(about['source'])}. Correlates: {about['correlates']}.\n")
        parts.append("| metric | unit | better | definition |\n|---|---|---|---|")
        parts += [_row(row, about) for row in rows]
        parts.append("")
    return "\n".join(parts)


def _row(row: Metric, about: Mapping[str, Any]) -> str:
    notes = [row.formula]
    notes += [
        f"{key}: {_link(getattr(row, key))}"
        for key in ("source", "needs", "correlates")
        if getattr(row, key) != about[key]
    ]
    notes += [f"name in Francis et al.: {row.alias}"] if row.alias and "source" not in row.alias else []
    notes += [row.alias] if "source" in row.alias else []
    definition = "; ".join(notes).replace("|", "\\|").replace("*", "\\*").replace("_", "\\_")
    return f"| `{row.name}` | {row.unit} | {row.better} | {definition} |"


def _link(text: str) -> str:
    head, mark, address = text.partition("https://")
    return text if not mark else f"{head}<https://{address}>" if " " not in address else text


_HEAD = """# Metrics

This page is generated from the table of metrics: `python -m crowdbot.metrics.social.page docs/reference/metrics.md`.

All metrics come from logs: positions and velocities of the robot and of people over time. They apply to simulated
episodes and to recordings of real robots. The log counts up to the first sample at the goal. `d` is the clearance,
surface to surface, negative for overlap: from the outline of the robot, or its disc if it has none, to the disc of a
person. `r` and `r_i` are the radii of the robot (of the disc around its outline) and of a person, `v` and `v_i` their
velocities, `S` is 1 for success, `L` the length of the path, `T` its time, `mu` the reduced mass and `k` the stiffness
of the body region.

Statistics over runs are explained in [Compare navigators](../how-to/evaluate.md). "Better" says which direction is
better; `none` marks a covariate, which describes the situation. A value that is not defined is NaN, and the run does
not count for that metric.

Differences to other tools: personal space compliance uses 0.5 m here, 0.45 m in SocNavGym and 0.4 m in SocNavData2026;
a robot stalls below 0.05 m/s here, below 0.001 m/s and 0.01 rad/s in HuNavSim; HuNavSim sets negative clearances to 0
and has a collision tolerance of 0.02 m; time to collision is the time to contact here, the time to the closest
approach in Arena 5; the goal tolerance is that of the trial (0.3 m by default), 1.2 m in SEAN 2.0.

Not computed: the learned metric ALT of SocNavData2026 (<https://arxiv.org/abs/2509.01251>), a recurrent network that is
trained on ratings by people. Its repository has no licence for the weights and ratings, so they cannot be part of this
package. Two of its inputs, fear and panic, are metrics here.
"""
