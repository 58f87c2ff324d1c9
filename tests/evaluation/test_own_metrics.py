"""Metrics of users in evaluations: their values, names, requirements and errors."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.evaluation import EvaluationPlan, episode_log, evaluate, parse_requirement, parse_statistic
from crowdbot.metrics import check_log_metric
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial

CODE = """
from dataclasses import dataclass
import crowdbot as cb

@dataclass(frozen=True)
class Nearest(cb.LogMetric):
    def measure(self, log):
        return float(log.gap.min(initial=99.0))

@dataclass(frozen=True)
class Text(cb.LogMetric):
    def measure(self, log):
        return "near"

@dataclass(frozen=True)
class Broken(cb.LogMetric):
    def measure(self, log):
        return 1 / 0

@dataclass(frozen=True)
class MeanSpeed(cb.LogMetric):
    def measure(self, log):
        return 0.0

class Open:
    pass
"""


@pytest.fixture(autouse=True)
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(CODE, encoding="utf-8")
    return tmp_path / "mine.py"


def test_a_metric_of_users_is_a_column_and_a_requirement(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["evaluate", "frontal", "--seeds", "0:2", "--metrics", "success-rate,max:mine.py:Nearest"]
    assert main([*words, "--require", "mine.py:Nearest>-1"]) == 0
    assert "max:nearest" in capsys.readouterr().out
    assert main([*words, "--require", "mine.py:Nearest>50"]) == 1


def test_its_value_is_that_of_the_log() -> None:
    trial = load_trial("frontal")
    plan = EvaluationPlan([trial], seeds=[3], families=("path", "mine.py:Nearest"))
    (row,) = evaluate(plan).cells[0].runs
    assert row.metrics["nearest"] == episode_log(simulate(trial, 3)).gap.min(initial=99.0)
    assert "spl" in row.metrics


def test_partial_results_belong_to_the_code_of_the_metric(mine: Path) -> None:
    plan = EvaluationPlan([load_trial("frontal", duration="1")], seeds=[0], families=("mine.py:Nearest",))
    evaluate(plan, Path("parts"))
    evaluate(plan, Path("parts"))
    assert len(list(Path("parts").iterdir())) == 1
    mine.write_text(CODE + "\n# changed\n", encoding="utf-8")
    evaluate(plan, Path("parts"))
    assert len(list(Path("parts").iterdir())) == 2


def test_names_of_statistics() -> None:
    statistic = parse_statistic("p95:mine.py:Nearest")
    assert (statistic.name, statistic.metric, statistic.kind, statistic.address) == (
        "p95:nearest",
        "nearest",
        "p95",
        "mine.py:Nearest",
    )
    assert parse_requirement("mine.py:Nearest<0.5@95%").statistic.metric == "nearest"


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("mine.py:Text", "metric Text returned a str, it must return a number"),
        ("mine.py:Broken", "metric Broken: ZeroDivisionError: division by zero"),
        ("mine.py:MeanSpeed", "mean_speed is a built-in metric; use another name"),
        ("mine.py:Nobody", "Nobody"),
        ("nowhere.py:Nearest", "nowhere.py"),
    ],
)
def test_wrong_metrics_are_explained(address: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        evaluate(EvaluationPlan([load_trial("frontal", duration="1")], seeds=[0], families=(address,)))
    assert message in str(caught.value)


def test_the_contract_is_checked() -> None:
    code = runpy.run_path("mine.py")
    check_log_metric(code["Nearest"]())
    with pytest.raises(InputError, match="metric Text returned a str"):
        check_log_metric(code["Text"]())
    with pytest.raises(InputError, match="Open is not a LogMetric"):
        check_log_metric(code["Open"]())
