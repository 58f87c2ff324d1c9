"""``crowdbot track``: trials and episodes, scores, JSON and plot; wrong input."""

import json

import pytest

from crowdbot.cli import main

TRACKERS = ["--tracker", "global-nearest-neighbor", "interacting-multiple-model"]


def test_a_trial_is_tracked_with_intervals_and_a_plot(tmp_path, capsys):
    plot = tmp_path / "tracks.png"
    words = ["track", "crossing-flows", "--duration", "4", "--starts", "2", *TRACKERS, "--plot", str(plot), "--json"]
    assert main(words) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["seeds"] == [1, 2]
    assert found["sensor"] == "robot/scan"
    assert list(found["scores"]) == TRACKERS[1:]
    for scores in found["scores"].values():
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
        found = json.loads(capsys.readouterr().out)
        shares.append(found["scores"]["global-nearest-neighbor"]["false_tracks"]["value"])
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
