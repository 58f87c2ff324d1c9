"""Forecasts made elsewhere: written, read back, scored as ours, and refused in a sentence."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
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
        ("b.ndjson", '{"scene": {"id": 0, "p": 1}}\n', "has no predicted rows"),
        ("b.ndjson", '{"scene": {"id": 0}}\n', "line 1: a scene needs the whole numbers id and p"),
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
    both = ["predict", "--data", str(walkers), str(other), "--forecasts"]
    assert main([*both, str(tmp_path / "x.npz")]) == 2
    assert "there is no file" in (said := capsys.readouterr().err)
    assert "x.walkers.npz" in said
    folder = tmp_path / "theirs"
    folder.mkdir()
    assert main([*both, str(folder)]) == 2
    assert "theirs has no file of forecasts of walkers.txt; it needs one of walkers.ndjson, .npz or .parquet" in (
        capsys.readouterr().err
    )
    for name in ("walkers.npz", "walkers.ndjson"):
        (folder / name).touch()
    assert main([*both, str(folder)]) == 2
    assert "theirs has 2 files of forecasts of walkers.txt" in capsys.readouterr().err
    (tmp_path / "again").mkdir()
    same = tmp_path / "again" / "walkers.txt"
    same.write_bytes(walkers.read_bytes())
    assert main(["predict", "--data", str(walkers), str(same), "--write-forecasts", str(tmp_path / "x.npz")]) != 0
    assert "two recordings or predictors would write x.walkers.npz" in capsys.readouterr().err
    assert main(["predict", "--data", str(walkers), "--forecasts", str(tmp_path / "none.npz")]) != 0
    assert f"there is no file {tmp_path / 'none.npz'}" in capsys.readouterr().err


def test_every_predictor_and_recording_has_its_file(
    walkers: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "other.txt"
    other.write_bytes(walkers.read_bytes())
    asked = ["predict", "--data", str(walkers), str(other), "--predictor", "constant-velocity", "kalman", "--json"]
    assert main([*asked, "--write-forecasts", str(tmp_path / "f.npz")]) == 0
    results = {row["predictor"]: row["data"] for row in json.loads(capsys.readouterr().out)["results"]}
    names = [f"f.{kind}.{place}.npz" for kind in ("constant-velocity", "kalman") for place in ("other", "walkers")]
    assert sorted(path.name for path in tmp_path.glob("*.npz")) == names
    file = tmp_path / "f.kalman.walkers.npz"
    assert main(["predict", "--data", str(walkers), "--forecasts", str(file), "--json"]) == 0
    scored = json.loads(capsys.readouterr().out)["results"][1]["total"]
    np.testing.assert_allclose(scored["ade"], results["kalman"][str(walkers)]["ade"])


@pytest.mark.parametrize("named", ["f.kalman.npz", "theirs"])
def test_several_recordings_read_one_file_each(
    named: str, walkers: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "other.txt"
    other.write_bytes(walkers.read_bytes().replace(b"0.0", b"1.0"))
    asked = ["predict", "--data", str(walkers), str(other), "--predictor", "constant-velocity", "kalman", "--json"]
    assert main([*asked, "--write-forecasts", str(tmp_path / "f.npz")]) == 0
    folder = tmp_path / "theirs"
    folder.mkdir()
    for place in ("other", "walkers"):
        (folder / f"{place}.npz").write_bytes((tmp_path / f"f.kalman.{place}.npz").read_bytes())
    capsys.readouterr()
    assert main([*asked, "--forecasts", str(tmp_path / named)]) == 0
    found = {row["predictor"]: row["data"] for row in json.loads(capsys.readouterr().out)["results"]}
    assert found[named].keys() == {str(walkers), str(other)}
    for file, score in found[named].items():
        np.testing.assert_allclose(score["ade"], found["kalman"][file]["ade"], rtol=1e-9)
    assert found[named][str(walkers)]["ade"] != found[named][str(other)]["ade"]


def test_forecasts_of_other_recordings_and_a_folder_alone_are_refused(walkers: Path, tmp_path: Path) -> None:
    past, future = load(walkers).windows()
    for place in ("here", "there"):
        write_forecasts(tmp_path / f"f.{place}.npz", past, future, SampledConstantVelocity().predict(past, 12, 6))
    stored = forecasts_of(tmp_path / "f.npz", ["here.txt", "there.txt"])
    with pytest.raises(InputError, match=r"no forecasts of the recording walkers.*, only of here\.txt, there\.txt"):
        stored.predict(past, 12)
    with pytest.raises(InputError, match="is a folder: the names of the recordings are required"):
        forecasts_of(tmp_path)


PEOPLE, SCENES = (1, 2, 3), ((0, 1, 0), (1, 2, 0), (2, 1, 30))
"""Ids, and scenes (id, primary person, first frame); two scenes begin at the same frame."""


def place_of(person: int, row: float) -> tuple[float, float]:
    return 0.4 * row, 2.0 * person + 0.02 * person * row**1.5


def scenes_file(file: Path) -> Path:
    """Write a TrajNet++ recording of three people over 24 rows."""
    lines: list[object] = [
        {"scene": {"id": id, "p": who, "s": s, "e": s + 200, "fps": 2.5, "tag": [2, []]}} for id, who, s in SCENES
    ]
    for row in range(24):
        for who in PEOPLE:
            x, y = place_of(who, row)
            lines.append({"track": {"f": 10 * row, "p": who, "x": x, "y": y}})
    file.write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
    return file


def foreign_lines() -> list[dict[str, dict[str, object]]]:
    """Return forecasts as other methods write them: neighbors in each scene, in the first of two futures only.

    The forecast of a person as a neighbor is far off; the one as the primary person is constant velocity. One neighbor
    has no numbers.
    """
    lines: list[dict[str, dict[str, object]]] = []
    for id, primary, begin in SCENES:
        lines.append({"scene": {"id": id, "p": primary, "s": begin, "e": begin + 200, "fps": 2.5, "tag": 0}})
        last = begin // 10 + 8
        for sample in (0, 1):
            for who in PEOPLE if sample == 0 else (primary,):
                now, before = (np.array(place_of(who, last - back)) for back in (0, 1))
                off = 0.0 if who == primary else np.nan if who == 3 else 50.0
                for step in range(1, 13):
                    x, y = now + step * (now - before) + off + sample
                    track = {"f": 10 * (last + step), "p": who, "x": x, "y": y}
                    lines.append({"track": track | {"prediction_number": sample, "scene_id": id}})
    return lines


def test_a_file_of_another_method_is_scored_by_scenes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data, file = scenes_file(tmp_path / "hall.ndjson"), tmp_path / "other.ndjson"
    file.write_text("\n".join(map(json.dumps, foreign_lines())))
    asked = ["predict", "--data", str(data), "--observe", "9", "--protocol", "trajnet++", "--json"]
    assert main([*asked, "--forecasts", str(file)]) == 0
    ours, theirs = (row["total"] for row in json.loads(capsys.readouterr().out)["results"])
    assert ours["persons"] == theirs["persons"] == 3
    np.testing.assert_allclose(theirs["ade"], ours["ade"])
    assert main([*asked[:4], "8", *asked[5:]]) == 2
    assert (
        "no scene has 8 + 12 rows of its primary person; the scenes of TrajNet++ have 9 + 12" in capsys.readouterr().err
    )
    assert main([*asked[:3], "--protocol", "all", "--observe", "9", "--forecasts", str(file)]) == 2
    assert "did not predict person 3" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda lines: lines[1:], "rows have scene_id 0, but there is no such scene"),
        (lambda lines: [line for line in lines if line.get("track", {}).get("p") != 1], "has no predicted rows of its"),
        (lambda lines: [lines[0], lines[1] | {"track": lines[1]["track"] | {"x": float("nan")}}, *lines[2:]],
         "column x has a number that is not finite"),
        (lambda lines: [*lines[:-1]], "person 1 has 23 rows after frame 110, not 2 samples of 12 rows"),
        (lambda lines: [{"track": lines[1]["track"] | {"p": float("inf")}}], "prediction_number and f must be finite"),
        (lambda lines: [*lines, {"track": 3}], "is not a file of forecasts, or is damaged"),
    ],
)  # fmt: skip
def test_wrong_scenes_are_refused_in_a_sentence(
    wrong: Callable[[list[dict[str, dict[str, object]]]], list[object]], words: str, tmp_path: Path
) -> None:
    (tmp_path / "a.ndjson").write_text("\n".join(map(json.dumps, wrong(foreign_lines()))))
    with pytest.raises(DataError, match=words):
        forecasts_of(tmp_path / "a.ndjson")


def test_an_array_that_pretends_to_be_huge_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        for name in ("frame", "id", "sample", "step", "x", "y"):
            with archive.open(f"{name}.npy", "w") as stream:
                header = {"descr": "<f8", "fortran_order": False, "shape": (10**12,)}
                np.lib.format.write_array_header_1_0(stream, header)
    with pytest.raises(DataError, match="more than 20000000 numbers"):
        read_forecasts(tmp_path / "a.npz")
