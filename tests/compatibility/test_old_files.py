"""Files of an earlier version open: episodes replay to the same digest, fits and weights predict the same numbers."""

from __future__ import annotations

import hashlib
import json
import shutil
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

import crowdbot as cb
from crowdbot.calibration import RecordingCalibration
from crowdbot.cli import main
from crowdbot.experiments import load_experiment, read_log
from crowdbot.prediction import AnchorNet, SocialWays
from crowdbot.recording import branch, read_episode, repair, replay
from crowdbot.trials import OldNameWarning, load_trial, parse_trial, trial_xml

FILES = Path(__file__).parent / "files"
EXPECTED: dict[str, Any] = json.loads((FILES / "expected.json").read_text(encoding="utf-8"))
EPISODES = sorted(path.stem for path in (FILES / "episodes").glob("*.mcap"))
FITS = sorted(path.name for path in (FILES / "fits").iterdir())
TRIALS = sorted(path.name for path in (FILES / "trials").glob("*.xml"))
OLD_WORDS = ("berth=", "symmetry=", "most=", "equipped=", "rates=", "near=", "without=")
OLD_TRIALS = [
    name for name in TRIALS if any(f" {word}" in (FILES / "trials" / name).read_text("utf-8") for word in OLD_WORDS)
]

pytestmark = [
    pytest.mark.filterwarnings("ignore::crowdbot.trials.OldNameWarning"),
    pytest.mark.filterwarnings("ignore:.*is read as rows per second"),
]


def array_hash(*arrays: ArrayLike) -> str:
    """Return the hash of arrays: shapes, and their numbers as little-endian doubles."""
    content = hashlib.blake2b(digest_size=16)
    for array in arrays:
        whole = np.ascontiguousarray(array, dtype="<f8")
        content.update(repr(whole.shape).encode() + whole.tobytes())
    return content.hexdigest()


def copy(name: str, folder: Path) -> Path:
    """Return a copy of files that a command may write to."""
    place = folder / Path(name).name
    if (FILES / name).is_dir():
        shutil.copytree(FILES / name, place)
    else:
        shutil.copy(FILES / name, place)
    return place


def command(capsys: pytest.CaptureFixture[str], *words: object) -> Any:
    """Return the JSON that a command prints."""
    capsys.readouterr()
    assert main([*map(str, words), "--json"]) == 0, capsys.readouterr().err
    return json.loads(capsys.readouterr().out)


def without_times(found: Any) -> Any:
    """Return the same without the durations that a computer needed."""
    if isinstance(found, dict):
        return {key: without_times(value) for key, value in found.items() if "seconds" not in key and key != "folder"}
    return [without_times(value) for value in found] if isinstance(found, list) else found


def assert_same(found: Any, expected: Any) -> None:
    """Compare JSON of a command: every key of the earlier version is there and has the same value."""
    if isinstance(expected, dict):
        assert set(expected) <= set(found)
        for key, value in expected.items():
            assert_same(found[key], value)
    elif isinstance(expected, list):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            assert_same(one, other)
    elif isinstance(expected, float):
        assert found == pytest.approx(expected, rel=1e-9, nan_ok=True)
    else:
        assert found == expected


def test_there_are_twenty_episodes_of_every_kind() -> None:
    assert len(EPISODES) >= 20
    assert {EXPECTED[name]["world"] for name in EPISODES} == {"planar", "physics"}
    assert {EXPECTED[name]["complete"] for name in EPISODES} == {True, False}
    assert sum(path.stat().st_size for path in FILES.rglob("*") if path.is_file()) < 3_000_000


@pytest.mark.parametrize("name", EPISODES)
def test_an_old_episode_has_the_same_content(name: str) -> None:
    old = EXPECTED[name]
    episode = read_episode(FILES / "episodes" / f"{name}.mcap")
    assert (episode.outcome, len(episode.times), episode.complete) == (old["outcome"], old["instants"], old["complete"])
    assert {key: len(readings) for key, readings in episode.readings.items()} == old["readings"]
    assert episode.version == old["version"]["version"]
    assert array_hash(
        episode.times, episode.position, episode.velocity, episode.heading, episode.radius, episode.active,
        episode.ids, episode.commands,
    ) == old["arrays"]  # fmt: skip


@pytest.mark.parametrize("name", [name for name in EPISODES if not EXPECTED[name]["camera"]])
def test_an_old_episode_replays_and_names_the_version_that_made_it(name: str) -> None:
    found = replay(FILES / "episodes" / f"{name}.mcap", folder=FILES / "trials", trust=True)
    assert found.equal, str(found)
    assert found.replayed == EXPECTED[name]["digest"]
    assert found.recorded_versions == EXPECTED[name]["version"]
    assert found.recorded_versions["version"]


def test_replay_prints_the_version_that_made_the_episode(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["replay", str(FILES / "episodes" / "doorway.mcap")]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert f"crowdbot {EXPECTED['doorway']['version']['crowdbot']}" in printed


def test_an_old_episode_branches(tmp_path: Path) -> None:
    whole = replay(FILES / "episodes" / "flow.mcap")
    assert branch(FILES / "episodes" / "flow.mcap", 1.0, out=tmp_path).digest == whole.recorded


def test_an_old_episode_that_was_killed_is_repaired(tmp_path: Path) -> None:
    path = copy("episodes/killed.mcap", tmp_path)
    repair(path)
    assert array_hash(read_episode(path).position) == array_hash(
        read_episode(FILES / "episodes/repaired.mcap").position
    )


@pytest.mark.parametrize("name", TRIALS)
def test_an_old_trial_loads_with_at_most_one_line_about_names(name: str) -> None:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        trial = load_trial(FILES / "trials" / name)
        lines = [str(one.message) for one in found if one.category is OldNameWarning]
        assert len(lines) == (name in OLD_TRIALS)
        assert all("old names of attributes: " in line and "\n" not in line for line in lines)
        assert parse_trial(trial_xml(trial), folder=FILES / "trials") == trial
    assert len([one for one in found if one.category is OldNameWarning]) == len(lines)


@pytest.mark.parametrize("name", FITS)
def test_an_old_fit_loads_and_predicts_the_same(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    old = EXPECTED[f"fit/{name}"]
    calibrations: list[RecordingCalibration] = []
    whole = RecordingCalibration.run

    def load_chunks(self: RecordingCalibration, *args: Any, keep: Path | None = None) -> Any:
        calibrations.append(self)
        for path in (FILES / "fits" / name / "parts").iterdir():
            shutil.copy(path, tmp_path / path.name.replace(old["key"], self.key))
        return whole(self, keep=tmp_path)

    monkeypatch.setattr(RecordingCalibration, "run", load_chunks)
    printed = command(
        capsys, "calibrate", "--data", FILES / "street.txt", "--model", old["model"], "--cost", old["cost"],
        "--search", old["search"], "--budget", 40, "--seed", 3, "--every", 2,
    )  # fmt: skip
    assert_same(without_times(next(iter(printed.values()))), without_times(old["json"]))
    (calibration,) = calibrations
    chunks = sorted((FILES / "fits" / name / "parts").iterdir())
    assert len(list(tmp_path.iterdir())) == len(chunks)
    monkeypatch.undo()
    fit = calibration.merge(list(calibration.run(keep=tmp_path)))
    assert (len(calibration.past), fit.persons) == (old["windows"], old["persons"])
    assert array_hash(fit.values) == old["values"]
    assert_same({key: list(value) for key, value in fit.table().items()}, old["table"])
    assert array_hash(fit.predict(calibration.past, 12).position) == old["forecast"]


def test_an_old_prior_gives_the_same_scores(capsys: pytest.CaptureFixture[str]) -> None:
    found = command(
        capsys, "predict", "--data", FILES / "street.txt", "--predictor", "simulated", "--model", "orca", "--cost",
        "absolute", "--prior", FILES / "fits" / "genetic" / "prior.json", "--budget", 20, "--every", 2,
    )  # fmt: skip
    assert_same(without_times(found), without_times(EXPECTED["prior"]))


def test_a_calibration_goes_on_in_an_old_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, old = copy("fits/greedy", tmp_path), EXPECTED["fit/greedy"]
    command(
        capsys, "calibrate", "--data", FILES / "street.txt", "--model", old["model"], "--cost", old["cost"],
        "--search", old["search"], "--budget", 40, "--seed", 3, "--every", 2, "--out", out,
    )  # fmt: skip
    before = json.loads((FILES / "fits/greedy/calibration.json").read_text())
    assert_same(without_times(json.loads((out / "calibration.json").read_text())), without_times(before))
    assert json.loads((out / "prior.json").read_text()) == json.loads((FILES / "fits/greedy/prior.json").read_text())


def test_a_prediction_goes_on_in_an_old_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = copy("predictions", tmp_path)
    found = command(
        capsys, "predict", "--data", FILES / "street.txt", "--predictor", "constant-velocity", "kalman", "simulated",
        "--every", 2, "--out", out,
    )  # fmt: skip
    assert_same(without_times(found), without_times(EXPECTED["predict"]))


@pytest.mark.parametrize("kind", [AnchorNet, SocialWays])
def test_old_weights_load_and_forecast_the_same(kind: type[Any]) -> None:
    name = {AnchorNet: "anchor-net", SocialWays: "social-ways"}[kind]
    old = EXPECTED[f"weights/{name}"]
    windows = cb.load(FILES / "street.txt").windows(8, 12)
    past = windows[0] if isinstance(windows, tuple) else windows
    field = {AnchorNet: "file", SocialWays: "checkpoint"}[kind]
    predictor = kind(**{field: str(FILES / "weights" / name / old["file"])})
    found = predictor.predict(past, 12, samples=3, rng=np.random.default_rng(0))
    assert array_hash(found.position) == old["forecast"]


def test_an_old_experiment_loads_with_one_line() -> None:
    with pytest.warns(OldNameWarning, match="<number at-least> is now min") as said:
        experiment = load_experiment(FILES / "experiment")
    assert len([one for one in said if "experiment.xml" in str(one.message)]) == 1
    assert [trial.name for block in experiment.blocks for trial in block.trials] == ["slow", "fast"]


@pytest.mark.parametrize("participant", [1, 2])
def test_an_old_session_goes_on(participant: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = copy("sessions", tmp_path)
    found = command(
        capsys, "experiment", "run", FILES / "experiment", "--participant", participant, "--out", out, "--resume",
        "--answers", FILES / "experiment" / "answers.json",
    )  # fmt: skip
    assert found["session"] == "done"
    assert found["outcomes"] == EXPECTED["session/1"]["outcomes"]
    assert found["answers"] == EXPECTED["session/1"]["answers"]


def test_an_old_session_log_is_read() -> None:
    logs = sorted((FILES / "sessions").rglob("session.jsonl"))
    assert len(logs) == 2
    assert all(len(read_log(path)) > 3 for path in logs)
