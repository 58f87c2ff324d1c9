"""Evaluations: rows equal single runs, resume, workers, failures and invalid runs, requirements, files."""

from __future__ import annotations

import dataclasses
import importlib
import json
import math
import shutil
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import crowdbot
from crowdbot.core import EpisodeError, InputError, TrialError
from crowdbot.evaluation import (
    CellResult,
    EvaluationPlan,
    EvaluationResult,
    RunRow,
    episode_metrics,
    evaluate,
    load_evaluation,
    pareto_front,
    parse_methods,
    parse_requirement,
    parse_seeds,
    parse_statistic,
    result_schema,
    worst_runs,
)
from crowdbot.evaluation.job import RunJob
from crowdbot.evaluation.pareto import pareto_svg
from crowdbot.navigation import PolicyWeights, policy_file
from crowdbot.simulation import Simulation, simulate
from crowdbot.trials import Trial, load_trial, trial_xml

SHY = """
from dataclasses import dataclass
from crowdbot.core import Twist
from crowdbot.navigation import Navigator


@dataclass(frozen=True)
class Shy(Navigator):
    fails: bool = False

    def act(self, observation):
        if self.fails and observation.time > 1.0:
            raise ValueError("too shy")
        return Twist(0.1)
"""


@pytest.fixture(scope="module")
def trial() -> Trial:
    return load_trial("circle-crossing", duration=4.0)


@pytest.fixture(scope="module")
def result(trial: Trial) -> EvaluationResult:
    return evaluate(EvaluationPlan([trial], parse_methods("straight, orca"), seeds=range(5)))


def test_each_row_is_that_of_a_single_run(trial: Trial, result: EvaluationResult) -> None:
    for method, cell in zip(parse_methods("straight, orca"), result.cells, strict=True):
        variant = method.put_into(trial)
        for row in cell.runs:
            episode = simulate(variant, row.seed)
            assert (row.outcome, row.digest) == (episode.outcome, episode.digest)
            wanted = dict(episode.metrics) | episode_metrics(episode) | {"error": 0.0}
            assert dict(row.metrics) == pytest.approx(wanted, nan_ok=True)
            assert set(episode.metrics) < set(wanted)
    assert result.cells[0].hash != result.cells[1].hash
    assert result.cells[0].protocol["visible"] is False
    assert result.cells[0].protocol["senses"] == ["Lidar2D"]


@pytest.mark.program
def test_an_evaluation_continues_and_does_not_depend_on_chunks_and_workers(
    trial: Trial, result: EvaluationResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = importlib.import_module("crowdbot.evaluation.runner")
    monkeypatch.setattr(module, "BATCH", 2)
    monkeypatch.setattr(module, "PART_SECONDS", math.inf)
    plan = EvaluationPlan([trial], parse_methods("straight, orca"), seeds=range(5))

    def interrupt(share: float) -> None:
        if share >= 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        evaluate(plan, tmp_path, progress=interrupt)
    (done,) = tmp_path.glob("*.jsonl")
    assert [json.loads(line)["seed"] for line in done.read_text().splitlines()] == [0, 1, 2, 3, 4]
    before = done.stat().st_mtime_ns
    again = evaluate(plan, tmp_path, workers=2)
    assert done.stat().st_mtime_ns == before
    assert sorted(len(file.read_text().splitlines()) for file in tmp_path.glob("*.jsonl")) == [5, 5]
    assert [[row.digest for row in cell.runs] for cell in again.cells] == [
        [row.digest for row in cell.runs] for cell in result.cells
    ]


def test_a_damaged_part_is_told(trial: Trial, tmp_path: Path) -> None:
    plan = EvaluationPlan([trial], seeds=range(1))
    evaluate(plan, tmp_path)
    (file,) = tmp_path.glob("*.jsonl")
    file.write_text("[{\n")
    with pytest.raises(InputError, match="is damaged .*; remove it to run its seeds again"):
        evaluate(plan, tmp_path)


def test_finished_runs_are_kept_one_by_one(trial: Trial, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = importlib.import_module("crowdbot.evaluation.runner")
    monkeypatch.setattr(module, "PART_SECONDS", 0.0)  # each run is longer than a batch may be
    whole = evaluate(EvaluationPlan([trial], seeds=range(4))).cells[0].runs
    ran: list[int] = []
    run_job = module.run_job

    def fail(job: RunJob) -> list[RunRow]:
        ran.extend(job.seeds)
        if len(ran) == 3:
            raise KeyboardInterrupt
        return list(run_job(job))

    monkeypatch.setattr(module, "run_job", fail)
    plan = EvaluationPlan([trial], seeds=range(4))
    with pytest.raises(KeyboardInterrupt):
        evaluate(plan, tmp_path)
    (file,) = tmp_path.glob("*.jsonl")
    assert len(file.read_text().splitlines()) == 2
    file.write_text(file.read_text() + '{"seed": 2, "outc')  # as a kill leaves it
    found = evaluate(plan, tmp_path).cells[0].runs
    assert ran == [0, 1, 2, 2, 3]
    assert repr(found) == repr(whole)
    assert evaluate(EvaluationPlan([trial], seeds=[3, 0]), tmp_path).cells[0].runs[0].seed == 3
    assert ran == [0, 1, 2, 2, 3]


def test_a_navigator_of_the_user_that_fails_is_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "shy.py").write_text(SHY)
    monkeypatch.chdir(tmp_path)
    trial = load_trial("frontal", duration=2.0)
    found = evaluate(EvaluationPlan([trial], parse_methods("shy.py:Shy, shy.py:Shy fails=true"), seeds=range(3)))
    good, bad = found.cells
    assert [row.outcome for row in good.runs] == ["timeout"] * 3
    assert [row.outcome for row in bad.runs] == ["error"] * 3
    assert bad.estimate("error-rate").value == 1.0
    assert bad.estimate("success-rate").value == 0.0
    assert len(found.failures) == 3
    assert found.failures[0][1].message.startswith("ValueError: too shy (shy.py:13)")
    assert not found.invalid


def test_a_changed_navigator_is_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "shy.py").write_text(SHY)
    plan = EvaluationPlan([load_trial("frontal", duration=1.0)], parse_methods("shy.py:Shy"), seeds=range(2))
    evaluate(plan, tmp_path / "parts")
    (tmp_path / "shy.py").write_text(SHY.replace("Twist(0.1)", "Twist(0.2)"))
    evaluate(plan, tmp_path / "parts")
    assert len(list((tmp_path / "parts").glob("*.jsonl"))) == 2


def test_weights_of_the_working_folder_are_read_before_the_first_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "halls").mkdir()
    (tmp_path / "halls/hall.xml").write_text(trial_xml(load_trial("frontal", duration=1.0)))
    weights, card = PolicyWeights.read(policy_file())
    slower = dataclasses.replace(weights, action3_weight=0.5 * weights.action3_weight)
    methods = parse_methods("policy file=own.npz")
    for parts, source in ((tmp_path / "a", "frontal"), (tmp_path / "b", "halls/hall.xml")):
        weights.save(tmp_path / "own.npz", card)
        plan = EvaluationPlan([load_trial(source, duration=1.0)], methods, seeds=range(2))
        assert {row.outcome for row in evaluate(plan, parts).cells[0].runs} == {"timeout"}
        slower.save(tmp_path / "own.npz", card)  # the same name, other values
        evaluate(plan, parts)
        assert len(list(parts.glob("*.jsonl"))) == 2
    (tmp_path / "own.npz").unlink()
    with pytest.raises(TrialError, match=r"navigator file=\"own.npz\": there is no file 'own.npz'"):
        EvaluationPlan([load_trial("frontal")], methods, seeds=range(2))
    with pytest.raises(TrialError, match=r"attention-policy.*person1_weight must be"):
        EvaluationPlan([load_trial("frontal")], parse_methods(f"attention-policy file={policy_file()}"), seeds=range(2))


def test_weights_that_vanish_after_the_plan_are_failures_of_the_runs(tmp_path: Path) -> None:
    file = tmp_path / "own.npz"
    file.write_bytes(policy_file().read_bytes())
    plan = EvaluationPlan([load_trial("frontal", duration=1.0)], parse_methods(f"policy file={file}"), seeds=range(2))
    (cell,) = plan.cells
    simulation = Simulation(cell.variant, seeds=[0, 1])
    file.unlink()
    simulation.advance()
    assert [failure.message.partition(";")[0] for failure in simulation.failures] == [
        f"InputError: there is no file {file}"
    ] * 2


def test_a_seed_with_which_the_trial_is_impossible_is_invalid_and_counts_nowhere() -> None:
    rows = (RunRow(0, "success", "d", {"success": 1.0}), RunRow(1, "invalid", message="no room"))
    evaluation_result = EvaluationResult((CellResult("hall", "orca", "", "", {}, rows),))
    assert evaluation_result.cells[0].estimate("success-rate")[::3] == (1.0, 1)
    assert [row.seed for _, row in evaluation_result.invalid] == [1]
    assert not evaluation_result.failures


def test_a_result_is_the_same_after_writing_and_reading(result: EvaluationResult, tmp_path: Path) -> None:
    result.save(tmp_path / "out" / "result.json")
    again = load_evaluation(tmp_path / "out" / "result.json")
    assert again.provenance["crowdbot"] == result.provenance["crowdbot"]
    for old, new in zip(result.cells, again.cells, strict=True):
        assert dataclasses.replace(old, runs=()) == dataclasses.replace(new, runs=())
        for run, two in zip(old.runs, new.runs, strict=True):
            np.testing.assert_array_equal(list(run.metrics.values()), list(two.metrics.values()))
            assert (run.seed, run.outcome, run.digest) == (two.seed, two.outcome, two.digest)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "is not a result of an evaluation"),
        ("[]", "its schema is None, expected 'crowdbot-evaluation/1'"),
        ('{"schema": "other"}', "its schema is 'other'"),
        ('{"schema": "crowdbot-evaluation/1", "cells": [3], "provenance": {}}', "is damaged: TypeError"),
        ("[" * 100_000, "is not a result of an evaluation"),
    ],
)
def test_files_that_are_no_result_are_refused(text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "r.json").write_text(text)
    with pytest.raises(EpisodeError, match=words):
        load_evaluation(tmp_path / "r.json")
    with pytest.raises(EpisodeError, match="No such file"):
        load_evaluation(tmp_path / "missing.json")


def test_comparisons_are_paired_by_seed(result: EvaluationResult) -> None:
    found = {item.metric: item for item in result.compare(["collision", "min_clearance", "no_such_metric"])}
    assert set(found) == {"collision", "min_clearance"}
    one = found["min_clearance"]
    straight, orca = (cell.values("min_clearance") for cell in result.cells)
    assert (one.first, one.second) == ("straight", "orca")
    assert one.difference.value == pytest.approx(float(np.mean(orca - straight)))
    assert one.p_value <= one.corrected <= 1.0


def test_another_robot_has_the_size_drive_and_sensors_of_its_type() -> None:
    trial = load_trial("frontal", duration=1.0)
    (cell,) = EvaluationPlan([trial], robots=["qolo"], seeds=[1]).cells
    robot = cell.variant.robots[0]
    assert robot.type == "qolo"
    assert robot.radius != trial.robots[0].radius
    assert robot.goal == trial.robots[0].goal


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("orcaa", "unknown navigator 'orcaa', did you mean 'orca'"),
        ("orca speedd=3", "has no attribute 'speedd', did you mean 'speed'"),
        ("orca speed=x", "'x' is not a number"),
        ("orca speed 3", "'speed' must be name=value"),
        ("orca, orca", "'orca' is there twice"),
        (" , ", "is empty; an example"),
        ("missing.py:Mine", "missing.py"),
    ],
)
def test_wrong_navigators_are_refused(trial: Trial, text: str, words: str) -> None:
    with pytest.raises((InputError, TrialError), match=words):
        EvaluationPlan([trial], parse_methods(text))


def test_wrong_plans_are_refused(trial: Trial) -> None:
    with pytest.raises(InputError, match="an evaluation needs seeds; the list is empty"):
        EvaluationPlan([trial], seeds=[])
    with pytest.raises(InputError, match="trials: 'circle-crossing' is there twice"):
        EvaluationPlan([trial, trial])
    with pytest.raises(InputError, match="seeds: 3 is there twice"):
        EvaluationPlan([trial], seeds=[3, 3])
    with pytest.raises(InputError, match="has no robot to evaluate"):
        EvaluationPlan([dataclasses.replace(trial, robots=())])


@pytest.mark.parametrize("text", ["", "a", "5:2", "1.5", "0:99999999", "9" * 5000, "1.." + "9" * 5000], ids=range(7))
def test_wrong_seeds_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="seeds"):
        parse_seeds(text)


def test_statistics_by_name() -> None:
    values = np.array([1.0, 2.0, 3.0, 4.0, math.nan])
    assert parse_statistic("median:time-to-goal").estimate(values).value == 2.5
    assert parse_statistic("max:time-to-goal").estimate(values)[::3] == (4.0, 4)
    assert parse_statistic("p25:time-to-goal").estimate(values).value == 1.75
    with pytest.raises(InputError, match="there is no metric 'sucess-rate', did you mean 'success-rate'"):
        parse_statistic("sucess-rate", {"success": None})
    with pytest.raises(InputError, match="'mode' is unknown"):
        parse_statistic("mode:success")


@pytest.mark.parametrize(
    ("text", "values", "holds"),
    [
        ("collision-rate<0.01", np.zeros(10), True),
        ("collision-rate<0.01@95%", np.zeros(10), False),
        ("collision-rate<=0", np.zeros(10), True),
        ("min-clearance>0.2", np.linspace(0.1, 0.5, 20), True),
        ("min:min-clearance>0.2", np.linspace(0.1, 0.5, 20), False),
        ("min-clearance>=0.25@99%", np.linspace(0.1, 0.5, 20), False),
        ("time-to-goal<5", np.full(3, math.nan), False),
    ],
)
def test_requirements(text: str, values: np.ndarray, holds: bool) -> None:
    assert parse_requirement(text).judge(values).holds is holds


@pytest.mark.parametrize("text", ["collision-rate", "collision-rate=0", "x<y", "a<1@200%", "a<1@40%", "a<1..2"])
def test_wrong_requirements_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="requirement"):
        parse_requirement(text)


def test_the_pareto_front_is_what_nobody_beats() -> None:
    rng = np.random.default_rng(0)
    points = [tuple(row) for row in rng.integers(0, 5, (40, 3)).tolist()]
    front = pareto_front(points)
    for k, point in enumerate(points):
        beaten = any(all(a <= b for a, b in zip(p, point, strict=True)) and p != point for p in points)
        assert (k in front) is not beaten


def test_the_picture_shows_severity_and_who_is_not_beaten(result: EvaluationResult) -> None:
    straight, orca = result.cells
    soft = _with_severities(straight, 0.0, 0.5)
    hard = _with_severities(orca, 0.0, math.inf)
    picture = pareto_svg([soft, hard])
    assert picture.rindex("<path ") < picture.index('paint-order="stroke"')  # no bar crosses a label
    assert "height: success rate; color: mean severity, green 0, red 0.25 and more" in picture
    assert picture.count('stroke="#111"') == 1
    assert "color: collision rate, green 0<" in pareto_svg([soft, _with_severities(orca, math.nan, math.nan)])


def _with_severities(cell: CellResult, *severities: float) -> CellResult:
    """Return a cell with successful runs of these severities."""
    metrics = {"success": 1.0, "collision": 0.0, "time_to_goal": 9.0}
    rows = [RunRow(k, "success", metrics=metrics | {"max_severity": severity}) for k, severity in enumerate(severities)]
    return dataclasses.replace(cell, runs=tuple(rows))


def test_the_drawing_of_a_worst_run_has_the_outline_of_the_robot() -> None:
    plan = EvaluationPlan([load_trial("frontal", duration=1.0)], robots=["pepper", ""], seeds=[0])
    pepper, disc = (
        [len(item["outline"]) for item in run.drawing["agents"]] for run in worst_runs(plan, evaluate(plan))
    )
    assert sorted(pepper) == [0, len(plan.cells[0].variant.robots[0].body.footprint)]
    assert disc == [0, 0]


def test_each_row_has_its_margin(trial: Trial) -> None:
    plan = EvaluationPlan([trial], parse_methods("straight, orca safety=0.2, mpc margin=0.1"), seeds=[0])
    assert [cell.protocol["margin"] for cell in plan.cells] == [None, 0.2, 0.1]


def test_a_result_keeps_its_schema(result: EvaluationResult, tmp_path: Path) -> None:
    invalid = dataclasses.replace(result.cells[0], runs=(RunRow(3, "invalid", message="no room"),), factors={"a": "1"})
    jsonschema.Draft202012Validator.check_schema(result_schema())
    checker = jsonschema.Draft202012Validator(result_schema())
    for found in (result, dataclasses.replace(result, cells=(invalid,))):
        found.save(tmp_path / "r.json")
        content = json.loads((tmp_path / "r.json").read_text())
        assert [error.message for error in checker.iter_errors(content)] == []
    content["cells"][0]["runs"][0]["metrics"] = {"success": 1.0}
    assert not checker.is_valid(content)


def test_values_of_rows_are_json(result: EvaluationResult, tmp_path: Path) -> None:
    result.save(tmp_path / "r.json")
    content = json.loads((tmp_path / "r.json").read_text())
    assert content["schema"] == "crowdbot-evaluation/1"
    assert content["cells"][0]["runs"][0]["metrics"]["time_to_goal"] == "nan"


def test_robots_and_code_of_a_folder_stand_in_for_those_of_the_working_folder(tmp_path: Path) -> None:
    place = tmp_path / "files"
    shutil.copytree(Path(crowdbot.__file__).parent / "assets/robots/differential", place / "mybot")
    (place / "shy.py").write_text(SHY)
    (place / "halls").mkdir()
    (place / "halls/hall.xml").write_text(trial_xml(load_trial("frontal", duration=1.0)))
    hall = load_trial(place / "halls/hall.xml")
    plan = EvaluationPlan([hall], parse_methods("shy.py:Shy"), ["mybot"], [0], trust=False, folder=place)
    (cell,) = plan.cells
    assert (cell.robot, cell.variant.robots[0].type) == ("mybot", "../mybot")
    assert [row.outcome for row in evaluate(plan).cells[0].runs] == ["timeout"]
    shutil.copytree(place / "mybot", tmp_path / "other")
    for folder in (None, place):
        with pytest.raises(TrialError, match="other"):
            EvaluationPlan([hall], robots=["../other"], seeds=[0], trust=False, folder=folder)
