"""Factorial sweeps: effects of a known table, levels of files and of the command line, pictures."""

import math

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.evaluation import (
    CellResult,
    EvaluationPlan,
    EvaluationResult,
    RunRow,
    evaluate,
    factor_effects,
    load_evaluation,
    parse_factors,
    parse_statistic,
    sweep_trials,
    write_report,
)
from crowdbot.trials import load_trial


def table(value, seeds=6):
    """Return a result with factors a (2 levels) and b (3 levels); ``value(a, b, seed)`` is the metric."""
    cells = [
        CellResult(
            f"hall [{a}, {b}]", "orca", "", "", {},
            tuple(RunRow(k, "success", "", {"m": value(a, b, k)}) for k in range(seeds)),
            {"a": str(a), "b": "xyz"[b]}, "hall",
        )
        for a in range(2) for b in range(3)
    ]  # fmt: skip
    return EvaluationResult(tuple(cells))


def effects(result, confidence=0.95):
    return {effect.levels: effect for effect in factor_effects(result, "m", confidence)}


def test_an_additive_table_has_main_effects_only():
    found = effects(table(lambda a, b, seed: 10.0 + 4.0 * a + b + 0.1 * seed))
    assert found["0",].effect.value == pytest.approx(-2.0)
    assert found["1",].effect.value == pytest.approx(2.0)
    assert [found["1", "xyz"[b]].effect.value for b in range(3)] == pytest.approx([0.0] * 3)
    assert found["1",].effect.low == pytest.approx(2.0) == pytest.approx(found["1",].effect.high)  # seeds are paired
    assert found["1",].mean.low < found["1",].mean.value < found["1",].mean.high


def test_interactions_sum_to_zero_and_match_a_direct_computation():
    rng = np.random.default_rng(1)
    values = rng.normal(size=(2, 3, 6))
    found = effects(table(lambda a, b, seed: values[a, b, seed]))
    cell = values.mean(axis=2)
    for a in range(2):
        for b in range(3):
            wanted = cell[a, b] - cell[a].mean() - cell[:, b].mean() + cell.mean()
            assert found[str(a), "xyz"[b]].effect.value == pytest.approx(wanted)
            assert found[str(a), "xyz"[b]].effect.low <= wanted <= found[str(a), "xyz"[b]].effect.high


def test_intervals_of_main_effects_cover_the_truth():
    inside = 0
    for seed in range(60):
        noise = np.random.default_rng(seed).normal(size=(2, 3, 30))
        one = effects(table(lambda a, b, k, noise=noise: a + noise[a, b, k], 30))["1",].effect
        inside += one.low <= 0.5 <= one.high
    assert inside >= 50


def test_values_that_are_missing_do_not_count():
    found = effects(table(lambda a, b, seed: math.nan if seed == 0 else float(a)))
    assert found["1",].mean.value == 1.0
    with pytest.raises(InputError, match="the evaluation has no factors"):
        factor_effects(EvaluationResult((CellResult("t", "orca", "", "", {}, ()),)), "m")
    with pytest.raises(InputError, match="confidence = 1 must be between 0 and 1"):
        factor_effects(table(lambda a, b, seed: 0.0), "m", confidence=1)


def test_factors_of_the_command_line():
    one, two = parse_factors(["robot.visible=true,false", "seed=0:3"])
    assert (one.levels, two.levels) == (("true", "false"), ("0", "1", "2"))
    rows = sweep_trials(lambda levels: load_trial("frontal", **levels), [one])
    assert [(trial.robots[0].visible, levels) for trial, levels in rows] == [
        (True, {"robot.visible": "true"}),
        (False, {"robot.visible": "false"}),
    ]
    for text, message in (("robot.visible", "must be NAME=VALUES"), ("a=", "must be NAME=VALUES")):
        with pytest.raises(InputError, match=message):
            parse_factors([text])
    with pytest.raises(InputError, match="--sweep a is given twice"):
        parse_factors(["a=1", "a=2"])
    with pytest.raises(InputError, match="the sweep has 20000 combinations, at most 10000"):
        sweep_trials(lambda levels: load_trial("frontal"), parse_factors(["a=0:10000", "b=1,2"]))


def test_a_sweep_is_evaluated_saved_and_reported(tmp_path):
    factors = parse_factors(["robot.visible=true,false", "robot/drive/max-speed=0.5,1"])
    rows = sweep_trials(lambda levels: load_trial("frontal", duration=3.0, **levels), factors)
    plan = EvaluationPlan(
        [trial for trial, _ in rows], seeds=range(2), families=("motion",),
        factors={trial.name: ("frontal", levels) for trial, levels in rows},
    )  # fmt: skip
    result = evaluate(plan)
    speeds = {effect.levels: effect.mean.value for effect in factor_effects(result, "max_speed")}
    assert speeds["0.5",] == pytest.approx(0.5, abs=0.02)
    assert speeds["1",] == pytest.approx(1.0, abs=0.02)
    result.save(tmp_path / "result.json")
    again = load_evaluation(tmp_path / "result.json")
    assert factor_effects(again, "max_speed") == factor_effects(result, "max_speed")
    write_report(result, tmp_path / "report.html", [parse_statistic("max-speed")])
    page = (tmp_path / "report.html").read_text()
    assert "Effects of factors" in page
    assert page.count("robot.visible and robot/drive/max-speed") >= 4


def test_sweeps_of_a_file_are_factors(tmp_path):
    (tmp_path / "flow.xml").write_text(
        '<trial name="flow" duration="1"><crowd type="orca"/>'
        '<robot x="0" y="0"><goal x="5" y="0"/><drive type="differential-drive"/><navigator type="straight"/></robot>'
        '<sweep path="robot/visible" values="true false"/></trial>'
    )
    plan = EvaluationPlan([load_trial(tmp_path / "flow.xml")], seeds=[0], families=())
    assert [(cell.base, dict(cell.factors)) for cell in plan.cells] == [
        ("flow", {"robot/visible": "true"}),
        ("flow", {"robot/visible": "false"}),
    ]
