"""Tables of an evaluation for the terminal, and its values for ``--json``."""

from __future__ import annotations

import dataclasses
import math
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import print_table

if TYPE_CHECKING:
    from crowdbot.evaluation import (
        CellResult,
        EvaluationResult,
        PairedComparison,
        Requirement,
        RequirementVerdict,
        SafetyVerdict,
        Statistic,
    )

WIDTH = 120
"""Width of a line of sentences [characters]."""
MOST_ROWS = 20
"""Largest number of messages of failed or invalid runs that are printed."""


def print_answers(result: EvaluationResult, requirements: Sequence[Requirement]) -> None:
    """Print what the runs show: a sentence for each row, and what their number can show at most."""
    from crowdbot.evaluation import judge_cell, person_contacts, realism_notice, remark_lines

    verdicts = [judge_cell(cell, requirements) for cell in result.cells]
    for cell, verdict in zip(result.cells, verdicts, strict=True):
        print(textwrap.fill(verdict.sentence, WIDTH))
        for contact in person_contacts(cell)[:1]:
            print(textwrap.fill(f"hardest contact: {contact.sentence}", WIDTH, initial_indent="  "))
    for remark in remark_lines(result.cells):
        print(textwrap.fill(remark, WIDTH))
    notices: dict[str, dict[str, None]] = {}
    for cell in result.cells:
        if cell.realism:
            notices.setdefault(realism_notice(cell.realism), {})[cell.trial] = None
    for notice, trials in notices.items():
        where = f"{', '.join(trials)}: " if len(notices) > 1 else ""
        print(textwrap.fill(f"{where}{notice}", WIDTH))
    for limit in dict.fromkeys(verdict.limit for verdict in verdicts):
        print(textwrap.fill(limit, WIDTH))
    print()


def print_result(result: EvaluationResult, statistics: Sequence[Statistic], wall: float) -> None:
    """Print a table with a row for each navigator for each trial."""
    robots = any(cell.robot for cell in result.cells)
    head = ["navigator", *(["robot"] if robots else []), "visible", "runs", *map(_head, statistics)]
    count = sum(len(cell.runs) for cell in result.cells)
    for trial in dict.fromkeys(cell.trial for cell in result.cells):
        rows = [
            [
                cell.method,
                *([cell.robot or "own"] if robots else []),
                "yes" if cell.protocol.get("visible") else "no",
                str(len(cell.valid)),
                *(str(cell.estimate(statistic)) for statistic in statistics),
            ]
            for cell in result.cells
            if cell.trial == trial
        ]
        print_table(trial, head, rows, words=2 if robots else 1)
    print(f"{count} runs in {wall:.1f} s; intervals of 95 %: exact (Clopper-Pearson) for rates, bootstrap for others\n")


def _head(statistic: Statistic) -> str:
    """Return the head of a column on lines of its own, with the unit below the name."""
    name, _, unit = statistic.title.partition(" [")
    return "\n".join([*textwrap.wrap(name, 10, break_long_words=False), *([f"[{unit}"] if unit else [])])


def print_comparisons(result: EvaluationResult, comparisons: Sequence[PairedComparison]) -> None:
    """Print the comparisons of each navigator with the first one."""
    from crowdbot.evaluation import metric_title

    first = result.cells[0].method
    robots = len({cell.robot for cell in result.cells}) > 1
    rows = [
        [
            comparison.trial,
            comparison.second,
            *([comparison.robot or "own"] if robots else []),
            metric_title(comparison.metric),
            str(comparison.difference),
            _p_value(comparison.corrected),
        ]
        for comparison in comparisons
        if comparison.first == first and not math.isnan(comparison.p_value)
    ]
    if rows:
        caption = f"paired by seed; p-values corrected for all {len(comparisons)} comparisons (Holm)"
        head = ("trial", "navigator", *(["robot"] if robots else []), "metric", f"difference to {first}", "p")
        print_table(f"comparison with {first}", head, rows, caption, words=4 if robots else 3)


def print_effects(result: EvaluationResult, statistics: Sequence[Statistic]) -> None:
    """Print the main effects of the factors of a sweep, and the interactions whose interval is clear of 0."""
    from crowdbot.evaluation import factor_effects, metric_title

    if not any(cell.factors for cell in result.cells):
        return
    caption = "mean of the level minus mean of all levels; pairs: what is left after both; only pairs clear of 0"
    for metric in dict.fromkeys(statistic.metric for statistic in statistics):
        rows = [
            [
                effect.trial,
                effect.method,
                " and ".join(effect.factors),
                ", ".join(effect.levels),
                str(effect.mean),
                str(effect.effect),
            ]
            for effect in factor_effects(result, metric)
            if len(effect.factors) == 1 or effect.effect.low > 0.0 or effect.effect.high < 0.0
        ]
        head = ("trial", "navigator", "factor", "level", "mean", "effect")
        print_table(f"effects on {metric_title(metric)}", head, rows, caption, words=4)


def print_verdicts(verdicts: Sequence[tuple[CellResult, Requirement, RequirementVerdict]]) -> None:
    """Print whether the requirements hold, and whether that shows anything."""
    from crowdbot.evaluation import judge_cell

    for cell, requirement, verdict in verdicts:
        word = "holds" if verdict.holds else "DOES NOT HOLD"
        where = ", ".join(filter(None, (cell.trial, cell.method, cell.robot)))
        print(f"{requirement.text}: {word} for {where}: {verdict.sentence}")
        if verdict.holds and (warning := judge_cell(cell).warning):
            print(f"WARNING: {requirement.text} holds, but shows nothing: {warning}")


def print_runs(result: EvaluationResult) -> None:
    """Print the failed and the invalid runs, one line for each message of a navigator in a trial."""
    for word, runs in (("failed", result.failures), ("invalid", result.invalid)):
        seeds: dict[tuple[str, str, str], list[int]] = {}
        for cell, row in runs:
            seeds.setdefault((cell.trial, cell.method, row.message), []).append(row.seed)
        for (trial, method, message), own in list(seeds.items())[:MOST_ROWS]:
            some = ", ".join(map(str, own[:5])) + (", ..." if len(own) > 5 else "")
            print(f"{word}: {trial}, {method}, {len(own)} runs (seeds {some}): {message}")
        if len(seeds) > MOST_ROWS:
            print(f"{word}: {len(seeds) - MOST_ROWS} more messages, see --json or --out")


def result_values(
    result: EvaluationResult,
    statistics: Sequence[Statistic],
    comparisons: Sequence[PairedComparison],
    verdicts: Sequence[tuple[CellResult, Requirement, RequirementVerdict]],
    requirements: Sequence[Requirement] = (),
) -> dict[str, Any]:
    """Return the values of all tables."""
    from crowdbot.evaluation import judge_cell, person_contacts

    return {
        "provenance": dict(result.provenance),
        "cells": [
            {
                **_names(cell),
                "verdict": _verdict_values(judge_cell(cell, requirements)),
                "contacts": [contact._asdict() for contact in person_contacts(cell)],
                "remarks": list(cell.remarks),
                "realism": [dataclasses.asdict(item) for item in cell.realism],
                "runs": len(cell.valid),
                "hash": cell.hash,
                "protocol": dict(cell.protocol),
                "statistics": {statistic.name: cell.estimate(statistic)._asdict() for statistic in statistics},
                "titles": {statistic.name: statistic.title for statistic in statistics},
            }
            for cell in result.cells
        ],
        **({"effects": effect_values(result, statistics)} if any(cell.factors for cell in result.cells) else {}),
        "comparisons": [
            comparison._asdict() | {"difference": comparison.difference._asdict()} for comparison in comparisons
        ],
        "requirements": [
            {
                **_names(cell),
                "requirement": requirement.text,
                "holds": verdict.holds,
                "sentence": verdict.sentence,
                "warning": judge_cell(cell).warning if verdict.holds else "",
            }
            for cell, requirement, verdict in verdicts
        ],
        "failed": [{**_names(cell), "seed": row.seed, "message": row.message} for cell, row in result.failures],
        "invalid": [{**_names(cell), "seed": row.seed, "message": row.message} for cell, row in result.invalid],
    }


def _verdict_values(verdict: SafetyVerdict) -> dict[str, Any]:
    shares = {name: getattr(verdict, name)._asdict() for name in ("person", "obstacle", "missed")}
    return dataclasses.asdict(verdict) | shares | {"interval": "exact binomial (Clopper-Pearson), 95 %"}


def effect_values(result: EvaluationResult, statistics: Sequence[Statistic]) -> list[dict[str, Any]]:
    """Return the effects of factors on all metrics of the statistics."""
    from crowdbot.evaluation import factor_effects

    return [
        effect._asdict() | {"mean": effect.mean._asdict(), "effect": effect.effect._asdict()}
        for metric in dict.fromkeys(statistic.metric for statistic in statistics)
        for effect in factor_effects(result, metric)
    ]


def _names(cell: CellResult) -> dict[str, str]:
    return {"trial": cell.trial, "navigator": cell.method, "robot": cell.robot}


def _p_value(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3g}"
