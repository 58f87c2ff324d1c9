"""The experiments on crossing a robot's way and on encounters in a crowd: rehearsal, measures, report."""

from __future__ import annotations

import json
import math
import re
import shutil
from types import SimpleNamespace

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import InputError, UnknownName
from crowdbot.experiments import (
    STUDIES,
    EmulatedPedestrian,
    Screen,
    analyse_sessions,
    builtin_experiments,
    experiment_xml,
    load_experiment,
    paired_test,
    parse_experiment,
    questionnaire_scores,
    rows_of,
    study_of,
    summary,
)
from crowdbot.trials import load_trial, parse_trial

PARTICIPANTS = (1, 2)


def rehearse(name, home, duration):
    """Return the folder of rehearsed sessions of a built-in experiment with shorter trials."""
    shutil.copytree(builtin_experiments()[name], home / "short")
    for path in (home / "short").glob("*.xml"):
        text = re.sub(r'duration="\d+"', f'duration="{duration}"', path.read_text()).replace(
            'step="0.05"', 'step="0.1"'
        )
        path.write_text(text.replace('repetitions="2"', 'repetitions="1"'))
    for who in PARTICIPANTS:
        words = ["experiment", "run", str(home / "short"), "--participant", str(who), "--out", str(home / "data")]
        assert main([*words, "--rehearse"]) == 0
    return home / "data"


@pytest.fixture(scope="module")
def crossing(tmp_path_factory):
    """Return rehearsed sessions of the experiment on crossing."""
    return rehearse("crossing", tmp_path_factory.mktemp("crossing"), 9)


@pytest.fixture(scope="module")
def encounters(tmp_path_factory):
    """Return rehearsed sessions of the experiment on encounters."""
    return rehearse("encounters", tmp_path_factory.mktemp("encounters"), 7)


@pytest.fixture(scope="module")
def crossing_analysis(crossing):
    """Return the analysis of the experiment on crossing."""
    return analyse_sessions(crossing)


@pytest.mark.parametrize(("name", "conditions"), [("crossing", 4), ("encounters", 3)])
def test_a_rehearsal_goes_from_consent_to_a_report(name, conditions, request, tmp_path, capsys):
    data = request.getfixturevalue(name)
    rows = summary(data)
    assert {row["session"] for row in rows} == {"done"}
    assert all(row["consent.agree"] == "yes" for row in rows)
    assert all(1.0 <= row["presence.presence"] <= 7.0 and 1.0 <= row["embodiment.embodiment"] <= 7.0 for row in rows)
    found = analyse_sessions(data)
    assert (found.study.name, len(found.conditions)) == (name, conditions)
    assert [trial.reason for trial in found.trials if trial.reason] == []
    assert len(found.trials) == conditions * len(PARTICIPANTS)
    for measure in (*STUDIES[name].measures, "looking", "rating.safe"):
        assert all(measure in trial.values for trial in found.trials)
    assert {trial.labels["view"] for trial in found.trials} == {"head"}
    report = tmp_path / "report.html"
    assert main(["experiment", "analyse", str(data), "--out", str(report), "--bound", "rating.safe=1"]) == 0
    assert "share of" in capsys.readouterr().out
    page = report.read_text()
    assert page.count("<svg") == 2
    assert "exact sign test" in page
    assert not re.search(r"""(src|href)=["']?https?:|url\(https?:|@import""", page)
    assert main(["experiment", "analyse", str(data), "--json"]) == 0
    tests = json.loads(capsys.readouterr().out)["tests"]
    assert len(tests) == len(found.tests) > 0
    assert all(test["bound"] == pytest.approx(0.6) for test in tests if test["measure"] == "rating.safe")


def test_evaluate_compares_the_participants_of_a_study(crossing, crossing_analysis, tmp_path, capsys):
    words = ["evaluate", "--participants", str(crossing)]
    assert main([*words, "--json"]) == 0
    tests = json.loads(capsys.readouterr().out)["tests"]
    shown = {(test["measure"], test["first"], test["second"]): test["difference"] for test in tests}
    assert len(shown) == len(crossing_analysis.tests)
    for test in crossing_analysis.tests:
        assert shown[test.measure, test.first, test.second] == pytest.approx(test.test.difference, nan_ok=True)
    assert main([*words, "--out", str(tmp_path / "compared")]) == 0
    assert f"participants: {len(PARTICIPANTS)}" in capsys.readouterr().out
    assert (tmp_path / "compared" / "report.html").is_file()
    assert main([*words, "frontal"]) == 2
    assert "evaluate takes trials, --logs, --real, or --participants" in capsys.readouterr().err


def test_a_robot_that_yields_lets_the_participant_pass_first(crossing_analysis):
    assert set(crossing_analysis.values("first", "fast_yields").values()) == {1.0}
    assert np.mean(list(crossing_analysis.values("clearance", "fast_yields").values())) > 0.1


def meeting(person, robot, heading="1.57079633"):
    """Return the measures of two straight ways, sampled at 10 Hz."""
    trial = parse_trial(f"""<trial name="two" duration="9"><stage/><crowd type="orca"/>
      <avatar name="me" source="external" x="{person[0][0]}" y="{person[0][1]}" heading="{heading}"/>
      <robot name="cart" x="{robot[0][0]}" y="{robot[0][1]}" radius="0.3"><goal x="9" y="0"/>
      <drive type="differential-drive" max-speed="1" max-turn-rate="1"/><navigator type="straight"/></robot></trial>""")
    position = np.stack([person, robot], axis=1)
    count = len(position)
    episode = SimpleNamespace(
        position=position, times=0.1 * np.arange(count), radius=np.array([0.25, 0.3]), robots=(1,), contacts=(),
        active=np.ones((count, 2), dtype=bool), ids=np.array([7, 8]), metrics={"time_to_goal": math.inf}, walls=(),
    )  # fmt: skip
    return SimpleNamespace(trial=trial, episode=episode, folder=None, settling=2.0)


def ways(speed, distance, robot_speed, robot_distance, count=80):
    """Return a participant who walks along y and a robot that drives along x; the crossing is at 0, 0."""
    time = 0.1 * np.arange(count)
    zero = np.zeros(count)
    return np.column_stack([zero, -distance + speed * time]), np.column_stack(
        [-robot_distance + robot_speed * time, zero]
    )


def test_a_log_made_by_hand_has_the_order_the_times_and_the_clearance_written_in_it():
    values, _, curves = STUDIES["crossing"].evaluate(meeting(*ways(1.0, 3.0, 0.5, 3.0)))
    assert (values["first"], values["collision"]) == (1.0, 0.0)
    assert values["person_time"] == pytest.approx(3.0)
    assert values["robot_time"] == pytest.approx(6.0)
    assert values["gap"] == pytest.approx(3.0)
    closest = 1.5 / math.hypot(1.0, 0.5)  # the robot is 1.5 m before the crossing as the participant passes
    assert values["clearance"] == pytest.approx(closest - 0.55, abs=1e-9)
    assert values["deviation"] == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_allclose(curves["mark"], [0.0, 0.0], atol=1e-6)
    behind, _, _ = STUDIES["crossing"].evaluate(meeting(*ways(0.5, 3.0, 1.0, 3.0)))
    assert (behind["first"], behind["gap"]) == (0.0, pytest.approx(3.0))
    into, _, _ = STUDIES["crossing"].evaluate(meeting(*ways(1.0, 3.0, 1.0, 3.0)))
    assert (into["collision"], into["clearance"]) == (1.0, pytest.approx(-0.55))
    waits, _, _ = STUDIES["crossing"].evaluate(meeting(*ways(0.1, 3.0, 1.0, 3.0)))
    assert (waits["first"], math.isnan(waits["gap"])) == (0.0, True)


def test_encounters_count_collisions_and_the_personal_distance():
    person, robot = ways(1.0, 3.0, 1.0, 3.0)
    values, _, _ = STUDIES["encounters"].evaluate(meeting(person, robot))
    assert values["collisions"] == 1.0
    assert math.isnan(values["robot_time"])
    inside = 2.0 * 1.2 / math.hypot(1.0, 1.0)  # time within 1.2 m at a relative speed of sqrt(2) m/s
    assert values["personal"] == pytest.approx(inside / 7.9, abs=0.03)
    assert values["person_speed"] == pytest.approx(1.0, abs=0.02)


def test_ways_that_do_not_cross_are_refused():
    person, robot = ways(1.0, 3.0, 1.0, 3.0)
    with pytest.raises(InputError, match="are parallel"):
        STUDIES["crossing"].evaluate(meeting(person, robot, heading="0"))
    with pytest.raises(InputError, match="behind"):
        STUDIES["crossing"].evaluate(meeting(person, robot, heading="-1.57079633"))
    with pytest.raises(InputError, match="at least one of each"):
        EmulatedPedestrian().source(load_trial("frontal"))
    with pytest.raises(UnknownName, match="crossing"):
        study_of(load_experiment("crossing"), "crosing")


def test_shares_get_the_exact_test_of_mcnemar():
    first, second = [1, 1, 1, 1, 1, 1, 0, 1], [0, 0, 0, 0, 0, 1, 0, 1]  # 5 people differ, all in one direction
    found = paired_test(first, second, 0.2, binary=True)
    assert found.p_value == pytest.approx(2.0 * 0.5**5)
    assert found.difference == pytest.approx(-5 / 8)
    assert paired_test([1, 0, 1, 0], [0, 1, 1, 0], 0.2, binary=True).p_value == 1.0


@pytest.mark.parametrize("name", ["leader-follower", "crossing", "encounters"])
def test_orders_are_balanced_over_the_participants(name):
    experiment = load_experiment(name)
    assert experiment.participants % rows_of(experiment.blocks[0]) == 0
    assert study_of(experiment).name == name


def test_a_questionnaire_becomes_its_questions_and_survives_the_file():
    screen = Screen(name="after", questionnaire="embodiment")
    assert len(screen.questions) == 8
    experiment = load_experiment("crossing")
    again = parse_experiment(experiment_xml(experiment).encode(), place="copy", folder=experiment.folder)
    assert again == experiment
    assert len(next(ending for ending in again.endings if ending.name == "sickness_after").questions) == 16
    answers = {question.name: 7 for question in screen.questions}
    scores = questionnaire_scores(answers)
    assert scores["embodiment_ownership"] == 4.0  # one of the two items is reverse
    assert scores["embodiment_response"] == 7.0
    assert scores["embodiment"] == pytest.approx((3 * 4.0 + 2 * 7.0) / 5)
    assert questionnaire_scores(dict(list(answers.items())[1:])) == {}
