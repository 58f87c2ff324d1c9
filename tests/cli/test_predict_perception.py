"""``crowdbot predict --perception``: trials and episodes, scores, JSON and plot; wrong input."""

import json

import pytest

from crowdbot.cli import main


def test_scans_of_a_trial_are_predicted_with_intervals_and_a_plot(tmp_path, capsys):
    plot = tmp_path / "scans.png"
    words = ["predict", "--perception", "crossing-flows", "--duration", "8", "--starts", "2", "--seed", "1", "--json"]
    assert main([*words, "--plot", str(plot)]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["seeds"] == [1, 2]
    assert document["horizons"] == [0.1, 0.5, 1.0, 2.0, 3.0]
    assert list(document["scores"]) == ["last-scan", "moved-scan", "tracked-scene", "learned-scene", "true-people"]
    at_one_second = {name: item["range_error"][2]["value"] for name, item in document["scores"].items()}
    assert at_one_second["tracked-scene"] < 0.7 * at_one_second["moved-scan"]
    assert at_one_second["true-people"] < at_one_second["tracked-scene"]
    late = {name: item["time_to_collision_error"][2]["value"] for name, item in document["scores"].items()}
    assert 0.0 < late["true-people"] < late["moved-scan"]
    assert plot.stat().st_size > 20_000


def test_an_episode_is_predicted_and_the_motion_of_the_robot_may_be_unknown(tmp_path, capsys):
    folder = tmp_path / "out"
    assert main(["run", "crossing-flows", "--set", "duration=6", "--out", str(folder)]) == 0
    capsys.readouterr()
    words = ["predict", "--perception", str(folder / "episode.mcap"), "--scan-predictor", "moved-scan", "--json"]
    errors = []
    for ego in ("known", "predicted"):
        assert main([*words, "--ego", ego]) == 0
        document = json.loads(capsys.readouterr().out)
        assert document["ego"] == ego
        errors.append(document["scores"]["moved-scan"]["range_error"][4]["value"])
    assert errors[0] != errors[1]


def test_the_table_names_scores_and_horizons(capsys):
    assert main(["predict", "--perception", "crossing-flows", "--duration", "6"]) == 0
    shown = capsys.readouterr().out
    names = ("occupancy iou", "range error", "time to collision error [s]", "tracked-scene", "0.5 s", "true-people")
    assert all(word in shown for word in names)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ([], "give either --data PATH or --perception SOURCE"),
        (["--perception", "two-way", "--data", "a.txt"], "give either --data PATH or --perception SOURCE"),
        (["--perception", "crossing-flows", "--duration", "2"], "s of scans; at least 4.1 s are needed"),
        (["--perception", "crossing-flows", "--scan-predictor", "last-scam"], "last-scan"),
        (["--perception", "crossing-flows", "--starts", "0"], "--starts 0 must be at least 1"),
    ],
)
def test_wrong_input_is_one_sentence(words, text, capsys):
    assert main(["predict", *words]) == 2
    assert text in capsys.readouterr().err
