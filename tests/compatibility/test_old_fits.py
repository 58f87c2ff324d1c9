"""Calibrations, priors, learned weights and predictions of an earlier version."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from old_files import EXPECTED, FILES, assert_same, command_json, copy, describe

import crowdbot as cb
from crowdbot.calibration import PopulationPrior
from crowdbot.prediction import AnchorNet, SocialWays
from samples import sample

FITS = sorted(path.name for path in (FILES / "fits").iterdir())
SCHEMES = {
    "annealing": ("vog", "absolute", "annealing"),
    "cmaes": ("social-force", "progressive", "cmaes"),
    "genetic": ("orca", "absolute", "genetic"),
    "greedy": ("power-law", "inter-pedestrian", "greedy"),
    "random-search": ("tangent", "absolute", "random-search"),
}
"""Model, cost and search of each fit of a recording."""
OWN = [*SCHEMES, "episode"]
"""Fits with parameters of each person, and so with a table and a prior."""

pytestmark = pytest.mark.filterwarnings("ignore:.*no frame rate in the file")


def test_every_fit_is_tested() -> None:
    assert sorted([*OWN, "shared"]) == FITS


@pytest.mark.parametrize("name", OWN)
def test_an_old_fit_opens(name: str, tmp_path: Path) -> None:
    folder = FILES / "fits" / name
    table = pd.read_parquet(folder / "parameters.parquet")
    assert describe(table) == EXPECTED["fits"][name]
    prior = PopulationPrior.load(folder / "prior.json")
    prior.save(tmp_path / "prior.json")
    assert json.loads((tmp_path / "prior.json").read_text()) == json.loads((folder / "prior.json").read_text())
    assert set(prior.names) <= set(table.columns)


@pytest.mark.parametrize("name", sample(SCHEMES, ["genetic"]))
def test_a_calibration_goes_on_in_an_old_folder(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    model, cost, search = SCHEMES[name]
    out = copy(f"fits/{name}", tmp_path)
    monkeypatch.chdir(FILES)
    found = command_json(
        capsys, "calibrate", "--data", "street.txt", "--model", model, "--cost", cost, "--search", search,
        "--budget", 40, "--seed", 3, "--every", 2, "--out", out,
    )  # fmt: skip
    assert_same(found, json.loads((FILES / "fits" / name / "calibration.json").read_text()))
    before, after = (pd.read_parquet(folder / "parameters.parquet") for folder in (FILES / "fits" / name, out))
    pd.testing.assert_frame_equal(after, before, rtol=1e-6)


def test_a_shared_fit_gives_the_same_parameters(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(FILES)
    found = command_json(
        capsys, "calibrate", "--data", "street.txt", "--shared", "--model", "orca", "--budget", 40, "--seed", 3,
        "--every", 2,
    )  # fmt: skip
    assert_same(found, json.loads((FILES / "fits/shared/calibration.json").read_text()))


def test_an_old_prior_gives_the_same_scores(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(FILES)
    found = command_json(
        capsys, "predict", "--data", "street.txt", "--predictor", "simulated", "--model", "orca", "--cost", "absolute",
        "--prior", "fits/genetic/prior.json", "--budget", 20, "--every", 2,
    )  # fmt: skip
    assert_same(found, EXPECTED["prior"])


def test_a_prediction_goes_on_in_an_old_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = copy("predictions", tmp_path)
    monkeypatch.chdir(FILES)
    found = command_json(
        capsys, "predict", "--data", "street.txt", "--predictor", "constant-velocity", "kalman", "simulated",
        "--every", 2, "--out", out,
    )  # fmt: skip
    assert_same(found, EXPECTED["predict"])
    assert_same(json.loads((out / "scores.json").read_text()), EXPECTED["predict"])
    before, after = (pd.read_parquet(folder / "frames.parquet") for folder in (FILES / "predictions", out))
    assert set(before.columns) <= set(after.columns)
    kept = [column for column in before.columns if "seconds" not in column]
    pd.testing.assert_frame_equal(after[kept], before[kept], rtol=1e-6)


@pytest.mark.parametrize(("name", "kind", "field"), [("anchor-net", AnchorNet, "file"),
                                                     ("social-ways", SocialWays, "checkpoint")])  # fmt: skip
def test_old_weights_load_and_forecast_the_same(name: str, kind: type[Any], field: str) -> None:
    past, _ = cb.load(FILES / "street.txt").windows(8, 12)
    predictor = kind(**{field: str(FILES / "weights" / name / "best.npz")})
    found = predictor.predict(past, 12, samples=3, rng=np.random.default_rng(0))
    old = EXPECTED["weights"][name]
    assert list(found.position.shape) == old["shape"]
    assert found.position[:, :, -1].mean(axis=(0, 1)) == pytest.approx(np.array(old["last"]), abs=1e-4)
