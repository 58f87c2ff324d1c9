"""``crowdbot measure``: recordings, episodes and trials; tables, plots and JSON; wrong input."""

import csv
import json

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.data import Trajectories, save

AREA = ["--area", "2", "0", "6", "0", "6", "2", "2", "2"]


@pytest.fixture
def recording(tmp_path):
    frame, id = np.repeat(np.arange(60), 24), np.tile(np.arange(24), 60)
    side = np.where(id % 2, 1.0, -1.0)
    x = (id // 2) * 0.7 + side * (0.1 * frame + 0.02 * np.sin(0.4 * frame + id))  # a steady state must vary
    tracks = Trajectories(id, frame, x, 0.5 + id % 4 * 0.35, row_rate=10.0)
    save(tracks, tmp_path / "walk.csv")
    return tmp_path / "walk.csv"


def test_tables_figures_and_plots_are_written(recording, tmp_path, capsys):
    out = tmp_path / "out"
    words = ["measure", str(recording), *AREA, "--line", "4", "2", "4", "0", "--passage", "1", "--steady", "1", "4"]
    methods = ["--methods", "individual", "area", "diagram", "line", "passing", "profiles", "encounters", "pairs"]
    assert main([*words, *methods, "lanes", "stops", "headways", "--out", str(out), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    figures = document["recordings"][0]["figures"]
    assert figures["mean_speed"] == pytest.approx(1.0, rel=0.01)
    assert figures["people"] == 24
    assert figures["lane_order"] is not None
    files = {file.name for file in out.iterdir()}
    assert {str(out / name) for name in files} == set(document["files"])
    assert {"area.csv", "diagram.csv", "n-t.png", "profile-density.png", "measurements.json", "headways.csv"} <= files
    assert all((out / name).stat().st_size > 3000 for name in files if name.endswith(".png"))
    with (out / "area.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert rows[0]["recording"] == "walk.csv"
    assert float(rows[3]["voronoi_density"]) > 0.0
    assert json.loads((out / "measurements.json").read_text())["recordings"] == document["recordings"]


def test_starts_of_a_trial_have_means_with_intervals(tmp_path, capsys):
    words = ["measure", "crossing-flows", "--starts", "2", "--methods", "individual", "diagram", "--json"]
    words += ["--out", str(tmp_path), "--no-plots"]
    assert main(words) == 0
    document = json.loads(capsys.readouterr().out)
    assert [one["name"] for one in document["recordings"]] == ["crossing-flows, seed 1", "crossing-flows, seed 2"]
    with (tmp_path / "diagram-pooled.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert all(float(row["low"]) <= float(row["speed"]) <= float(row["high"]) for row in rows)
    mean = document["mean"]["mean_speed"]
    assert mean["starts"] == 2
    assert mean["low"] <= mean["mean"] <= mean["high"]
    assert 0.3 < mean["mean"] < 2.0


def test_an_episode_gives_what_its_trial_gives(tmp_path, capsys):
    assert main(["run", "frontal", "--set", "duration=4", "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    assert main(["measure", str(tmp_path / "episode.mcap"), "--methods", "individual", "--no-plots"]) == 0
    shown = capsys.readouterr()
    assert "mean speed" in shown.out
    assert "1 robots are not measured" in shown.err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--area", "0", "0", "1"], "--area needs x and y of at least three corners, not 3 numbers"),
        (["--area", "0", "0", "1", "1", "1", "0", "0", "1"], "edges of a measurement area intersect"),
        (["--line", "1", "1", "1", "1"], "two ends of a measurement line are equal"),
        (["--methods", "flow"], "unknown method 'flow'"),
        (["--methods", "line"], "flow and passages need a measurement line"),
        (["--passage", "2"], "flow and passages need a measurement line"),
        (["--every", "0"], "every is 0.0, it must be above 0"),
        (["--cut-off", "-1"], "the radius must be above 0"),
        (["--starts", "0"], "--starts 0 must be at least 1"),
        (["--walkable", "50", "50", "60", "50", "60", "60"], "nobody is inside the walkable area"),
        (["--steady", "90", "95"], "the reference from 90 to 95 has 0 values"),
        (["--units", "px"], "is in pixels"),
    ],
)
def test_wrong_input_is_refused_in_a_sentence(recording, capsys, words, message):
    assert main(["measure", str(recording), *words]) == 2
    said = capsys.readouterr().err.strip().splitlines()[-1]
    assert said.startswith("crowdbot: ")
    assert message in said


def test_unknown_sources_are_refused(tmp_path, capsys):
    assert main(["measure", "crosing-flows"]) == 2
    assert "crossing-flows" in capsys.readouterr().err
    (tmp_path / "a.txt").write_text("hello\n")
    assert main(["measure", str(tmp_path / "a.txt")]) == 2
    assert "unknown format" in capsys.readouterr().err
