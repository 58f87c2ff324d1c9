"""The leader-follower experiment: rehearsal, analysis, report, consent and withdrawal."""

from __future__ import annotations

import json
import math
import re
import shutil

import numpy as np
import pytest
from scipy import stats

from crowdbot.cli import main
from crowdbot.core import EpisodeError, InputError
from crowdbot.experiments import (
    SYMPTOMS,
    Answered,
    EmulatedParticipant,
    EmulatedRespondent,
    Number,
    Session,
    SessionRunner,
    Start,
    analyse_sessions,
    builtin_experiments,
    load_experiment,
    paired_test,
    roles_of,
    sickness_scores,
    summary,
    withdraw,
)
from crowdbot.metrics import coordination
from crowdbot.recording import run
from crowdbot.simulation import EpisodeLog, Simulation, SimulationRun
from crowdbot.trials import load_trial
from samples import sample

SHIPPED = builtin_experiments()["leader-follower"]


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """Return the folder of two rehearsed participants, with shorter trials."""
    home = tmp_path_factory.mktemp("study")
    shutil.copytree(SHIPPED, home / "short")
    for path in (home / "short").glob("*.xml"):
        text = path.read_text().replace('duration="48"', 'duration="12"').replace('step="0.05"', 'step="0.1"')
        path.write_text(text.replace('cycles="6"', 'cycles="2"'))
    for who in ("1", "2"):
        words = ["experiment", "run", str(home / "short"), "--participant", who, "--out", str(home / "data")]
        assert main([*words, "--rehearse"]) == 0
    return home / "data"


def half(name):
    """Return a shipped trial in which a robot leads for three cycles instead of six."""
    return load_trial(str(SHIPPED / name), **{"duration": 24.0, "robot/navigator/cycles": 3})


def walked(trial, person):
    """Return the episode of a trial with an emulated participant."""
    log = EpisodeLog(trial, 0)
    running = SimulationRun(Simulation(trial, 0), [log], [person.source(trial)])
    running.advance()
    end = running.ends[0]
    assert end is not None
    return log.episode(*end)


@pytest.mark.parametrize(("gain", "delay"), sample([(0.9, 0.4), (0.7, 0.2)], 1, rows=True))
def test_an_emulated_follower_of_known_gain_and_delay_is_recovered_from_a_run(gain, delay):
    trial = half("robot-leads-real.xml")
    episode = walked(trial, EmulatedParticipant(gain=gain, delay=delay, wander=0.0))
    robot = episode.robots[0]
    found = coordination(episode.times, episode.position[:, robot], episode.times, episode.position[:, robot - 1])
    assert abs(found.lag - delay) < 0.01
    assert abs(found.gain / gain - 1.0) < 0.02


def test_an_added_delay_of_the_avatar_appears_in_the_lag():
    real, virtual = (half(f"robot-leads-{where}.xml") for where in ("real", "vr"))
    person, lags = EmulatedParticipant(wander=0.0), []
    for trial in (real, virtual):
        episode = walked(trial, person)
        robot = episode.robots[0]
        lags.append(
            coordination(episode.times, episode.position[:, robot], episode.times, episode.position[:, robot - 1]).lag
        )
    assert lags[1] - lags[0] == pytest.approx(0.08, abs=0.01)


def test_a_rehearsal_goes_from_consent_to_a_report(study, tmp_path, capsys):
    found = analyse_sessions(study)
    assert len(found.trials) == 8
    assert [trial.reason for trial in found.trials if trial.reason] == []
    assert {trial.condition: trial.labels["leader"] for trial in found.trials} == {
        "robot_leads_real": "robot", "robot_leads_vr": "robot",
        "person_leads_real": "participant", "person_leads_vr": "participant",
    }  # fmt: skip
    assert len(found.tests) == (5 + 2 + 2) * 6 + 1  # coordination, looking at the robot, ratings; own lag of followers
    for trial in found.trials:  # without a headset the delay of the avatar is the whole latency
        late = 0.08 if trial.condition.endswith("vr") else 0.0
        own = trial.values.get("own_lag", trial.values["lag"] - late)
        assert own == pytest.approx(trial.values["lag"] - late)
        assert ("own_lag" in trial.values) == (trial.labels["leader"] == "robot")
    assert {trial.labels["view"] for trial in found.trials} == {"head"}
    assert all(trial.values["looking"] > 0.9 for trial in found.trials)  # face to face
    report = tmp_path / "report.html"
    assert main(["experiment", "analyse", str(study), "--out", str(report), "--bound", "distance-sd=0.2"]) == 0
    assert "equivalent" in capsys.readouterr().out
    page = report.read_text()
    assert page.count("<svg") == 2
    assert not re.search(r"""(src|href)=["']?https?:|url\(https?:|@import""", page)
    assert main(["experiment", "analyse", str(study), "--json"]) == 0
    tests = json.loads(capsys.readouterr().out)["tests"]
    shown = {(test["measure"], test["first"], test["second"]): test["difference"] for test in tests}
    for test in found.tests:
        assert shown[test.measure, test.first, test.second] == pytest.approx(test.test.difference, nan_ok=True)


def test_rehearsals_repeat_and_answer_every_question(study):
    rows = summary(study)
    assert {row["session"] for row in rows} == {"done"}
    assert all(row["consent.agree"] == "yes" for row in rows)
    assert all(row["sickness_before.sickness_total"] >= 0.0 for row in rows)
    assert EmulatedRespondent(4).answer("s", Number(name="n", text="?", min=18.5, max=20, integer=True)) in ("19", "20")


def test_without_consent_the_session_ends_with_nothing_but_the_answer():
    session = Session.of(load_experiment("leader-follower"), 1).after(Start())
    refused = session.after(Answered("agree", "no"))
    assert (refused.phase, refused.reason) == ("aborted", "answer to 'agree'")
    assert refused.results == {}
    assert session.after(Answered("agree", "yes")).phase == "screen"


def test_a_withdrawal_deletes_everything_and_keeps_the_number(study, tmp_path, capsys):
    data = tmp_path / "data"
    shutil.copytree(study, data)
    words = ["experiment", "withdraw", str(data), "--participant", "2"]
    assert main(words) == 2
    assert "--yes" in capsys.readouterr().err
    assert (data / "participant-002").exists()
    assert main([*words, "--yes"]) == 0
    assert not any("participant-002" in str(path) for path in data.rglob("*"))
    assert {row["participant"] for row in summary(data)} == {1}
    with pytest.raises(EpisodeError, match="participant 2 has withdrawn"):
        SessionRunner(load_experiment("leader-follower"), 2, data, lambda: 0.0)
    with pytest.raises(EpisodeError, match="participant 2 has no session"):
        withdraw(data, 2)


def test_a_session_in_use_is_not_deleted(tmp_path):
    runner = SessionRunner(load_experiment("leader-follower"), 1, tmp_path, lambda: 0.0)
    try:
        with pytest.raises(EpisodeError, match="in use"):
            withdraw(tmp_path, 1)
    finally:
        runner.close()
    assert withdraw(tmp_path, 1).name == "participant-001"


def test_trials_of_another_kind_are_kept_with_the_reason(tmp_path):
    with pytest.raises(InputError, match="one of each"):
        roles_of(load_trial("frontal"))
    words = ["experiment", "run", "robot-speed", "--participant", "1", "--out", str(tmp_path), "--rehearse"]
    assert main(words) == 0
    found = analyse_sessions(tmp_path)
    assert all(not trial.values and "one of each" in trial.reason for trial in found.trials)
    assert found.tests == ()
    assert main(["experiment", "analyse", str(tmp_path)]) == 1


def test_a_run_without_a_participant_says_that_nobody_moves(tmp_path):
    trial = load_trial(str(SHIPPED / "person-leads-real.xml"), duration=12.0)
    episode = run(trial, 0)
    robot = episode.robots[0]
    with pytest.raises(InputError, match="the leader does not move"):
        coordination(
            episode.times, episode.position[:, robot - 1], episode.times, episode.position[:, robot], frequency=0.125
        )


def test_the_paired_test_is_that_of_scipy():
    rng = np.random.default_rng(2)
    one, other = rng.normal(0.0, 1.0, 20), rng.normal(0.1, 1.0, 20)
    other[3] = math.nan
    found = paired_test(one, other, bound=0.9)
    kept = np.isfinite(other)
    reference = stats.ttest_rel(other[kept], one[kept])
    interval = reference.confidence_interval(0.95)
    assert found.participants == 19
    np.testing.assert_allclose(
        [found.p_value, found.low, found.high], [reference.pvalue, interval.low, interval.high], rtol=1e-12
    )
    low = stats.ttest_1samp(other[kept] - one[kept], -0.9, alternative="greater").pvalue
    high = stats.ttest_1samp(other[kept] - one[kept], 0.9, alternative="less").pvalue
    assert found.equivalence == pytest.approx(max(low, high), rel=1e-12)
    assert math.isnan(paired_test([1.0, 2.0], [1.0, 2.0], 0.1).p_value)
    with pytest.raises(InputError, match="bound = 0"):
        paired_test(one, other, 0.0)


def test_sickness_scores_are_those_of_the_paper():
    assert sickness_scores({}) == {}
    most = sickness_scores(dict.fromkeys(SYMPTOMS, 3))  # the largest scores of the questionnaire
    assert most == {"nausea": 200.34, "oculomotor": 159.18, "disorientation": 292.32, "total": 235.62}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--bound", "lag"], "MEASURE=VALUE"),
        (["--bound", "speed=1"], "measures are distance"),
        (["--bound", "lag=0"], "above 0"),
        (["--out", "x.pdf"], "must end in .html"),
        (["--settling", "-1"], "at least 0 s"),
    ],
)
def test_wrong_options_are_refused(study, words, said, capsys):
    assert main(["experiment", "analyse", str(study), *words]) == 2
    assert said in capsys.readouterr().err
