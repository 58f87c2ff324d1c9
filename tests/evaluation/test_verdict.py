"""Verdicts: the sentence of a row, its exact intervals, and what is no proof of safety."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from crowdbot.core import InputError
from crowdbot.evaluation import (
    CellResult,
    EvaluationResult,
    RunRow,
    episode_metrics,
    judge_cell,
    junit_xml,
    parse_requirement,
    proportion_interval,
    runs_without_event,
)
from crowdbot.simulation import simulate_seeds
from crowdbot.trials import load_trial


def cell(outcomes: Sequence[str], touched: Sequence[str] = (), **protocol: Any) -> CellResult:
    """A row with one run for each outcome; ``touched`` says what each of the first runs touched."""
    runs = []
    for k, outcome in enumerate(outcomes):
        what = touched[k] if k < len(touched) else ""
        flags = {f"{kind}_collision": float(kind == what) for kind in ("person", "wall", "object")}
        ends = {"success": float(outcome == "success"), "collision": float(outcome == "collision")}
        runs.append(RunRow(k, outcome, "", {} if outcome == "invalid" else flags | ends))
    return CellResult("hall", "orca", "qolo", "", {"people": 5, **protocol}, tuple(runs))


def test_the_sentence_has_persons_walls_and_arrivals_with_exact_intervals() -> None:
    outcomes = ["collision"] * 5 + ["finished"] * 2 + ["success"] * 193
    found = judge_cell(cell(outcomes, ["person"] * 3 + ["wall", "object"]))
    assert found.sentence == (
        "In 200 runs of hall with orca on qolo the robot touched a person in 3 (0.31 to 4.3 %), touched a wall or an"
        " object in 2 (0.12 to 3.6 %) and failed to arrive in 7 (1.4 to 7.1 %: 5 contacts, 2 planned ends); not shown"
        " safe: no requirement on the rate of contacts with persons is given, such as collision-rate<0.05@95%."
    )
    assert found.limit == (
        "200 runs can show at most this: without any contact, the rate of contacts is at most 1.5 % with 95 %"
        " confidence (1 - 0.05^(1/200), one-sided as in requirements; the two-sided interval of 95 % above ends at"
        " 1.8 %); a rate below 1 % needs 299 runs without a contact."
    )
    assert found.person[1:3] == pytest.approx(stats.binomtest(3, 200).proportion_ci(0.95, "exact"))
    assert not found.warning


@pytest.mark.parametrize(
    ("texts", "safe", "words"),
    [
        (["person-collision-rate<0.05@95%"], True, "shown safe as required by person-collision-rate<0.05@95% (person"),
        (["collision-rate<0.01@95%"], False, "not shown safe: the requirement collision-rate<0.01@95% does not hold"),
        (["collision-rate<0.05"], False, "collision-rate<0.05 has no confidence, such as collision-rate<0.05@95%"),
        (["success-rate>0.9@95%"], False, "no requirement on the rate of contacts with persons is given, such as"),
        (["collision-rate<0.05@95%", "success-rate>1"], False, "the requirement success-rate>1 does not hold"),
    ],
)
def test_safe_is_what_a_requirement_with_confidence_shows(texts: list[str], safe: bool, words: str) -> None:
    found = judge_cell(cell(["success"] * 100), [parse_requirement(text) for text in texts])
    assert found.safe is safe
    assert words in found.sentence


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (cell(["timeout"] * 20), "the robot never arrived, so a small number of contacts is no proof of safety"),
        (cell(["success"] * 20, people=0), "the trial has no people"),
        (cell(["success"] * 20, ghost=True), "the robot is a ghost"),
        (cell(["invalid"] * 2), "there is no valid run"),
    ],
)
def test_runs_that_show_nothing_carry_a_warning(row: CellResult, words: str) -> None:
    requirement = parse_requirement("collision-rate<0.5@95%")
    found = judge_cell(row, [requirement])
    assert not found.safe
    assert words in found.warning
    assert f"not shown safe: {words}" in found.sentence
    if row.valid:
        report = junit_xml(EvaluationResult((row,)), [requirement])
        assert 'failures="0"' in report
        assert f'<property name="warning" value="nothing is shown: {found.warning}"/>' in report


def test_the_limit_is_that_of_the_requirement() -> None:
    found = judge_cell(cell(["success"] * 50), [parse_requirement("collision-rate<0.05@90%")])
    assert "at most 4.5 % with 90 % confidence" in found.limit
    assert "a rate below 5 % needs 45 runs without a contact" in found.limit


@given(st.floats(0.001, 0.5), st.floats(0.6, 0.999))
def test_the_number_of_runs_is_the_least_that_shows_a_rate(rate: float, confidence: float) -> None:
    count = runs_without_event(rate, confidence)
    slack = 1e-9
    assert proportion_interval(0, count, 2.0 * confidence - 1.0).high <= rate + slack
    if count > 1:
        assert proportion_interval(0, count - 1, 2.0 * confidence - 1.0).high > rate - slack


@given(st.integers(0, 40), st.integers(1, 40))
def test_the_exact_interval_covers_its_level(successes: int, more: int) -> None:
    count = successes + more
    low, high = proportion_interval(successes, count)[1:3]
    assert stats.binom.cdf(successes, count, high) == pytest.approx(0.025)
    if successes:
        assert stats.binom.sf(successes - 1, count, low) == pytest.approx(0.025)


def test_an_exact_interval_without_runs_and_with_wrong_numbers() -> None:
    assert math.isnan(proportion_interval(0, 0).value)
    with pytest.raises(InputError, match="successes = 3 must be from 0 to the number of runs, 2"):
        proportion_interval(3, 2)
    with pytest.raises(InputError, match="confidence = 1.5 must be between 0 and 1"):
        proportion_interval(1, 2, 1.5)


def test_what_is_touched_is_that_of_the_bodies_of_the_world() -> None:
    trial = load_trial("doorway", {"robot/navigator/type": "straight", "world": "physics", "crowd/robot-gap": 0.0})
    kinds = set()
    for episode in simulate_seeds(trial, range(6)):
        flags = episode_metrics(episode, ["task"])
        touched = {collision.second.kind for collision in episode.collisions}
        kinds |= touched
        assert flags["person_collision"] == float("person" in touched)
        assert flags["wall_collision"] == float("wall" in touched)
        assert flags["wall_collisions"] == sum(collision.second.kind == "wall" for collision in episode.collisions)
        assert max(flags["person_collision"], flags["wall_collision"]) == float(episode.outcome == "collision")
    assert kinds == {"person", "wall"}
    planar = load_trial("doorway", {"robot/navigator/type": "straight"})
    values = [episode_metrics(seed, ["task"]) for seed in simulate_seeds(planar, range(2))]
    assert np.array_equal([value["wall_collision"] for value in values], [1.0, 1.0])
    assert not any(value["person_collision"] for value in values)
