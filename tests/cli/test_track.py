"""``crowdbot track``: trials and episodes, scores, JSON and plot; wrong input."""

import json

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.data import load

TRACKERS = ["--tracker", "global-nearest-neighbor", "interacting-multiple-model"]


def test_a_trial_is_tracked_with_intervals_and_a_plot(tmp_path, capsys):
    plot = tmp_path / "tracks.png"
    words = ["track", "crossing-flows", "--duration", "4", "--starts", "2", *TRACKERS, "--plot", str(plot), "--json"]
    assert main(words) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["seeds"] == [1, 2]
    assert document["sensor"] == "robot/scan"
    assert list(document["scores"]) == TRACKERS[1:]
    for scores in document["scores"].values():
        assert scores["mota"]["value"] > 0.8
        assert scores["mota"]["runs"] == 2
        assert scores["mota"]["low"] <= scores["mota"]["value"] <= scores["mota"]["high"]
        assert scores["motp"]["value"] < 0.1
    assert plot.stat().st_size > 20_000


def test_an_episode_has_the_scores_of_its_trial(tmp_path, capsys):
    folder = tmp_path / "out"
    assert main(["run", "crossing-flows", "--set", "duration=3", "--out", str(folder)]) == 0
    capsys.readouterr()
    assert main(["track", str(folder / "episode.mcap"), "--json"]) == 0
    recorded = json.loads(capsys.readouterr().out)
    assert recorded["source"] == "episode.mcap"
    assert recorded["readings"] > 20
    assert recorded["scores"]["global-nearest-neighbor"]["mota"]["value"] > 0.8


def test_the_map_removes_false_tracks(capsys):
    words = ["track", "crossing-flows", "--duration", "4", "--json"]
    shares = []
    for extra in ([], ["--no-map"]):
        assert main([*words, *extra]) == 0
        document = json.loads(capsys.readouterr().out)
        shares.append(document["scores"]["global-nearest-neighbor"]["false_tracks"]["value"])
    assert shares[0] < shares[1]


def test_the_table_names_the_scores(capsys):
    assert main(["track", "crossing-flows", "--duration", "2"]) == 0
    shown = capsys.readouterr().out
    assert all(word in shown for word in ("mota", "hota", "gospa", "latency", "lidar-clusters"))


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--starts", "0"], "--starts 0 must be at least 1"),
        (["--reach", "0"], "--reach 0.0 m must be above 0"),
        (["--sensor", "robot/scann"], "there is no sensor 'robot/scann', did you mean 'robot/scan'?"),
        (["--detector", "cloud-clusters"], "no sensor gives a PointCloud, which CloudClusters reads"),
        (["--tracker", "nearest"], "nearest"),
    ],
)
def test_wrong_input_is_one_sentence(words, text, capsys):
    assert main(["track", "crossing-flows", *words]) == 2
    assert text in capsys.readouterr().err


def test_options_of_trials_are_rejected_for_an_episode(tmp_path, capsys):
    assert main(["track", str(tmp_path / "none.mcap"), "--starts", "2"]) == 2
    assert "an episode is one run" in capsys.readouterr().err


def test_detectors_trackers_and_motion_models_are_combined(tmp_path, capsys):
    (tmp_path / "near.py").write_text(
        "from dataclasses import dataclass\nfrom crowdbot.perception import LidarClusters\n\n\n"
        "@dataclass(frozen=True, kw_only=True)\nclass Near(LidarClusters):\n    max_range: float = 3.0\n"
    )
    words = ["--detector", "lidar-clusters", f"{tmp_path}/near.py:Near", "--motion", "constant-velocity", "orca"]
    joint = ["--tracker", "joint-probabilistic-data-association"]
    assert main(["track", "crossing-flows", "--duration", "2", *words, *joint, "--json"]) == 0
    scores = json.loads(capsys.readouterr().out)["scores"]
    assert len(scores) == 4
    far, near = (scores[f"{name}, {joint[1]} + orca"]["misses"]["value"] for name in words[1:3])
    assert far < 0.5 < near


def test_scores_are_divided_by_distance(capsys):
    words = ["track", "crossing-flows", "--duration", "3", "--by"]
    assert main([*words, "distance", "--json"]) == 0
    parts = json.loads(capsys.readouterr().out)["scores"]
    assert list(parts) == ["0 to 3 m", "3 to 6 m", "6 to 9 m", "above 9 m"]
    near, far = (parts[name]["global-nearest-neighbor"]["mota"]["value"] for name in ("0 to 3 m", "6 to 9 m"))
    assert near > 0.9
    assert near >= far
    assert main([*words, "occlusion"]) == 0
    assert "occlusion with an occlusion" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--by", "distence"], "scores by 'distence', did you mean 'distance'?"),
        (["--motion", "helbing"], "helbing"),
    ],
)
def test_wrong_choices_are_one_sentence(words, text, capsys):
    assert main(["track", "crossing-flows", "--duration", "1", *words]) == 2
    assert text in capsys.readouterr().err


def test_predictors_are_compared_on_true_and_tracked_people(capsys):
    words = ["track", "crossing-flows", "--duration", "9", "--predictor", "constant-velocity", "kalman"]
    assert main([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["prediction"]["global-nearest-neighbor"]
    assert list(found) == ["constant-velocity", "kalman"]
    for inputs in found.values():
        true, tracked, uncertain = (inputs[name] for name in ("true", "tracked", "tracked, uncertain"))
        assert true["ade"]["value"] <= tracked["ade"]["value"] < true["ade"]["value"] + 0.35
        assert uncertain["inside_90"]["value"] > 0.2
    assert main(["track", "crossing-flows", "--duration", "2", "--predictor", "kalman"]) == 2
    assert "nobody is tracked and seen on for 6.4 s" in capsys.readouterr().err


def test_five_scenes_are_one_command(capsys):
    assert main(["track", "--scenes", "--duration", "1"]) == 0
    shown = capsys.readouterr().out
    assert all(f"scene {k} " in shown for k in range(1, 6))
    assert shown.count("mota") == 5
    assert main(["track", "--scenes", "--json"]) == 2
    assert "--scenes has no --json; track the scenes one by one for it" in capsys.readouterr().err


def test_tracks_are_a_recording_for_the_other_commands(tmp_path, capsys):
    folder = tmp_path / "found"
    assert main(["track", "crossing-flows", "--duration", "9", "--out", str(folder)]) == 0
    files = [folder / name for name in ("tracks.csv", "scores.json", "tracks.png")]
    assert capsys.readouterr().out.splitlines()[-3:] == [str(file) for file in files]
    scores = json.loads(files[1].read_text())
    assert scores["scores"]["global-nearest-neighbor"]["mota"]["value"] > 0.8
    assert files[2].stat().st_size > 20_000
    tracks = load(files[0])
    assert len(np.unique(tracks.id)) > 5
    assert np.abs(np.diff(np.unique(tracks.time)) - 0.1).max() < 1e-6
    assert main(["predict", "--data", str(files[0]), "--protocol", "all", "--json"]) == 0
    errors = json.loads(capsys.readouterr().out)
    assert errors["results"][0]["total"]["windows"] > 10


def test_each_tracker_and_run_has_a_file_of_its_own(tmp_path, capsys):
    words = ["track", "crossing-flows", "--duration", "3", "--starts", "2", *TRACKERS, "--out", str(tmp_path), "--json"]
    assert main(words) == 0
    assert json.loads(capsys.readouterr().out) == json.loads((tmp_path / "scores.json").read_text())
    names = sorted(f"tracks-{name}-seed-{seed}.csv" for name in TRACKERS[1:] for seed in (1, 2))
    assert sorted(file.name for file in tmp_path.glob("*.csv")) == names
    tables = [(tmp_path / name).read_text() for name in names]
    assert len(set(tables)) == 4
    assert main([*words[:4], *TRACKERS[:2], "--seed", "2", "--out", str(tmp_path / "second")]) == 0
    assert (tmp_path / "second/tracks.csv").read_text() == tables[names.index(f"tracks-{TRACKERS[1]}-seed-2.csv")]


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["crossing-flows", "--start", "3"], "--start is for --video"),
        (["crossing-flows", "--steps", "4"], "--steps is for --video"),
        (["crossing-flows", "--truth", "people.csv"], "--truth is for --video"),
        (["crossing-flows", "--statistics", "--motion", "orca"], "--motion is for tracks; --statistics track nobody"),
        (["crossing-flows", "--statistics", "--out", "x"], "--out is for tracks; --statistics track nobody"),
        (["crossing-flows", "--statistics", "--predictor", "kalman"], "--predictor is for tracks"),
        (["--scenes", "--out", "x"], "--scenes has no --out; track the scenes one by one for it"),
        (["--video", "film.avi", "--seed", "0"], "--seed is for scans, not for --video"),
        (["--video", "film.avi", "--no-map"], "--no-map is for scans, not for --video"),
        (["scans.bag", "--starts", "2"], "--starts, --seed and --trial are for trials; recorded scans are one run"),
    ],
)
def test_no_option_is_ignored(words, text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scans.bag").touch()
    assert main(["track", *words]) == 2
    assert text in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == ["scans.bag"]


@pytest.mark.parametrize(
    ("option", "place"), [("--out", "file"), ("--out", "file/deep"), ("--plot", "file/deep/tracks.png")]
)
def test_a_place_that_cannot_be_written_is_told_before_the_run(option, place, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("crowdbot.cli.track.command._track_source", lambda options: pytest.fail("the run began"))
    (tmp_path / "file").touch()
    assert main(["track", "crossing-flows", "--duration", "1", option, str(tmp_path / place)]) == 2
    reason = f"{tmp_path / 'file'} is a file; give a folder"
    assert capsys.readouterr().err == f"crowdbot: cannot write {tmp_path / place}: {reason}\n"
