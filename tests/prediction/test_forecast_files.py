"""Forecasts made elsewhere: written, read back, scored as ours, and refused in a sentence."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import DataError, InputError
from crowdbot.data import Trajectories, load, read_forecasts, save, write_forecasts
from crowdbot.prediction import SampledConstantVelocity, forecasts_of

KINDS = (".ndjson", ".npz", ".parquet")
ROW = '{"track": {"f": %d, "p": 1, "x": 0.0, "y": 0.0, "prediction_number": 0, "scene_id": 0}}\n'


@pytest.fixture
def walkers(tmp_path: Path) -> Path:
    """Write a recording of three people who turn."""
    time = np.arange(30)
    tracks = Trajectories(
        np.repeat([3, 5, 8], 30), np.tile(10 * time, 3), np.concatenate([0.4 * time, 9.0 - 0.4 * time, 0.3 * time]),
        np.concatenate([0.01 * time**2, np.full(30, 2.0), 5.0 - 0.008 * time**2]), row_rate=2.5, frame_step=10,
    )  # fmt: skip
    save(tracks, tmp_path / "walkers.txt")
    return tmp_path / "walkers.txt"


@pytest.mark.parametrize("kind", KINDS)
def test_our_forecasts_score_the_same_from_a_file(kind: str, walkers: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = walkers.with_suffix(f".forecasts{kind}")
    asked = ["predict", "--data", str(walkers), "--samples", "5", "--seed", "3", "--json"]
    assert main([*asked, "--predictor", "sampled-constant-velocity", "--write-forecasts", str(file)]) == 0
    own = json.loads(capsys.readouterr().out)["results"][0]["total"]
    assert main([*asked, "--forecasts", str(file)]) == 0
    both = {row["predictor"]: row["total"] for row in json.loads(capsys.readouterr().out)["results"]}
    assert set(both) == {"constant-velocity", file.name}
    assert own["persons"] == both[file.name]["persons"] > 0
    for name in ("ade", "fde", "energy", "collisions"):
        np.testing.assert_allclose(both[file.name][name], own[name], rtol=1e-9)
    assert both[file.name]["ade"] != both["constant-velocity"]["ade"]


def test_fewer_samples_and_rows_are_the_first_ones(walkers: Path, tmp_path: Path) -> None:
    past, future = load(walkers).windows()
    forecast = SampledConstantVelocity().predict(past, 12, 6)
    write_forecasts(tmp_path / "a.npz", past, future, forecast)
    stored = forecasts_of(tmp_path / "a.npz")
    few = stored.predict(past, 5, 2)
    np.testing.assert_allclose(few.position, forecast.position[:, :2, :5])
    np.testing.assert_allclose(few.weight, 0.5)
    with pytest.raises(InputError, match=r"has 12 predicted rows per person, 13 are asked for"):
        stored.predict(past, 13)
    with pytest.raises(InputError, match=r"a\.npz has no forecast of the people of"):
        stored.predict(load(walkers).windows(observe=3)[0][:1], 12)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.csv", "frame,id", "the suffix '.csv' is not one of forecasts"),
        ("a.ndjson", "{", "is not a file of forecasts, or is damaged"),
        ("b.ndjson", '{"scene": {"id": 0}}\n', "has no predicted rows"),
        ("c.ndjson", ROW % 80, "needs at least two rows"),
        ("d.ndjson", (ROW % 80).replace(', "scene_id": 0', ""), "line 1: a predicted row has no scene_id"),
        ("a.npz", "no zip", "is not a file of forecasts, or is damaged"),
        ("a.parquet", "no table", "is not a file of forecasts, or is damaged"),
    ],
)
def test_wrong_files_are_refused_in_a_sentence(name: str, content: str, words: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(DataError if "suffix" not in words else InputError, match=words):
        forecasts_of(tmp_path / name)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"x": [0.0, np.nan]}, "column x has a number that is not finite"),
        ({"step": [1, 1]}, "has two rows of frame 70, id 1, sample 0, step 1"),
        ({"id": [1.5, 1.5]}, "column id has 1.5, not a whole number"),
        ({"y": [1.0]}, r"column y has shape \[1\], it must be \[2\]"),
        ({"weight": [1.0, 0.5]}, "frame 70 has different weights of one sample"),
        ({"id": [1, 2]}, "person 1 has 1 rows after frame 70, not 1 samples of 2 rows"),
        ({"step": None}, "has no column step"),
    ],
    ids=str,
)
def test_wrong_columns_are_refused_in_a_sentence(change: dict[str, object], words: str, tmp_path: Path) -> None:
    columns: dict[str, object] = {"frame": [70, 70], "id": [1, 1], "sample": [0, 0], "step": [1, 2], "x": [0.0, 0.4]}
    columns |= {"y": [0.0, 0.0]} | change
    kept = {name: np.asarray(values) for name, values in columns.items() if values is not None}
    np.savez(tmp_path / "a.npz", **kept)
    with pytest.raises(DataError, match=words):
        forecasts_of(tmp_path / "a.npz")


def test_a_missing_file_and_two_recordings_are_refused(
    walkers: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(DataError, match="there is no file"):
        read_forecasts(tmp_path / "none.npz")
    other = tmp_path / "other.txt"
    other.write_bytes(walkers.read_bytes())
    assert main(["predict", "--data", str(walkers), str(other), "--forecasts", "x.npz"]) != 0
    assert "--forecasts requires one recording" in capsys.readouterr().err
    two = ["--predictor", "constant-velocity", "kalman", "--write-forecasts", str(tmp_path / "x.npz")]
    assert main(["predict", "--data", str(walkers), *two]) != 0
    assert "--write-forecasts requires one recording and one predictor, not 1 and 2" in capsys.readouterr().err
