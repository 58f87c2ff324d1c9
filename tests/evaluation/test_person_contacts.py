"""Contacts with persons: body region, severity, order, and the titles of columns with their units."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from crowdbot.evaluation import (
    CellResult,
    EvaluationResult,
    RunRow,
    WorstRun,
    metric_title,
    not_dangerous,
    parse_statistic,
    person_contacts,
    worst_rows,
    write_report,
)


def row(seed: int, **metrics: float) -> RunRow:
    return RunRow(seed, "collision", "", {"person_collision": 1.0, **metrics})


PHYSICS = {"impacts": 1.0, "surface_impact_speed": 0.8}


def cell(*rows: RunRow) -> CellResult:
    return CellResult("hall", "orca", "", "", {}, rows)


def test_the_hardest_contact_is_first_with_its_region() -> None:
    found = person_contacts(
        cell(
            row(1, max_severity=0.5, impact_severity_hand=0.5, robot_caused_impacts=1.0, **PHYSICS),
            row(2, max_severity=math.inf, impact_severity_face=math.inf, impact_severity_hand=0.2, **PHYSICS),
            row(3, max_severity=3.0, impact_severity_lower_leg=3.0, person_caused_impacts=1.0, **PHYSICS),
            RunRow(4, "success", "", {"person_collision": 0.0, "max_severity": 9.0}),
        )
    )
    assert [(one.seed, one.region, one.cause) for one in found] == [
        (2, "face", "both"), (3, "lower leg", "person"), (1, "hand", "robot"),
    ]  # fmt: skip
    assert [one.severity for one in found] == ["inf", "3", "0.5"]


def test_the_region_of_discs_is_unknown() -> None:
    bounds = {"severity_lower_bound": 1.5, "severity_upper_bound": 9.6, "robot_caused_collision": 1.0}
    (known,) = person_contacts(cell(row(1, max_impact_speed=0.7, **bounds)))
    assert (known.region, known.severity, known.speed, known.cause) == ("", "1.5 to 9.6", 0.7, "robot")
    (unknown,) = person_contacts(cell(row(1)))
    assert (unknown.severity, unknown.cause) == ("unknown", "")


def test_the_worst_runs_are_contacts_then_closeness_then_no_arrival() -> None:
    def free(seed: int, outcome: str, clearance: float, **more: float) -> RunRow:
        values = {"person_collision": 0.0, "success": float(outcome == "success"), "min_clearance": clearance}
        return RunRow(seed, outcome, "", values | more)

    rows = [
        free(1, "success", 0.4),
        free(2, "timeout", 0.6),
        free(3, "success", 0.1),
        free(4, "collision", math.nan, wall_collision=1.0),
        row(5, max_severity=0.5, impact_severity_hand=0.5, **PHYSICS),
        row(6, max_severity=1.5, impact_severity_hand=1.5, **PHYSICS),
        RunRow(7, "invalid"),
    ]
    assert [(run.seed, reason) for run, reason in worst_rows(cell(*rows), 9)] == [
        (6, "contact with a person at 0.80 m/s, severity 1.5"),
        (5, "contact with a person at 0.80 m/s, severity 0.5"),
        (3, "clearance 0.10 m"),
        (4, "contact with a wall, nobody near"),
        (2, "timeout, clearance 0.60 m"),
    ]
    assert [run.seed for run, _ in worst_rows(cell(*rows))] == [6, 5, 3]
    assert not not_dangerous(cell(*rows))


def test_rows_without_a_dangerous_run_say_so_and_show_the_closest(tmp_path: Path) -> None:
    values = {"person_collision": 0.0, "success": 1.0}
    calm = cell(*(RunRow(k, "success", "", values | {"min_clearance": 0.3 + 0.1 * k}) for k in range(3)))
    sentence = (
        "no run was dangerous: no contact, no fall, all arrived, and the smallest clearance is 0.30 m"
        " (dangerous: below 0.2 m)"
    )
    assert not_dangerous(calm) == sentence
    ((closest, _),) = worst_rows(calm)
    assert closest.seed == 0
    drawing: dict[str, Any] = {"times": [], "agents": []}
    run = WorstRun(calm, closest, drawing, same=True)
    write_report(EvaluationResult((calm,)), tmp_path / "report.html", [parse_statistic("time-to-goal")], worst=[run])
    assert f"<p>hall, orca: {sentence}.</p>" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "title"),
    [
        ("person-collision-rate", "person-collision-rate [share]"),
        ("time-to-goal", "time-to-goal [s]"),
        ("max:impact-severity-hand", "max:impact-severity-hand [1]"),
        ("mine.py:TimeNear", "time-near"),
    ],
)
def test_titles_have_units(name: str, title: str) -> None:
    assert parse_statistic(name).title == title
    assert metric_title("no_such_metric") == "no-such-metric"
    assert metric_title("max_severity") == "max-severity [1]"


def test_the_page_begins_with_the_verdict_and_lists_contacts(tmp_path: Path) -> None:
    hard = row(7, success=0.0, max_severity=3.0, impact_severity_lower_leg=3.0, **PHYSICS)
    result = EvaluationResult((cell(hard),))
    write_report(result, tmp_path / "report.html", [parse_statistic("time-to-goal")])
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "In 1 run of hall with orca the robot touched a person in 1" in page
    assert "Hardest contact with a person: seed 7, at the lower leg, 0.80 m/s, severity 3 (force over the limit" in page
    assert page.index("In 1 run of hall") < page.index("<table")
    assert "<th>time-to-goal [s]</th>" in page
    assert "<th>severity [force / limit]</th>" in page
    assert "<td>lower leg</td><td>3</td><td>0.80</td>" in page
