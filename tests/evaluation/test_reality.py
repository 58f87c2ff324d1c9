"""Recordings of robots: metrics of logs, trials of recordings, and where reality lies."""

import json

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import DataError, InputError
from crowdbot.evaluation import (
    EvaluationPlan,
    RunRow,
    episode_metrics,
    evaluate,
    load_robot_recording,
    place_reality,
    reality_svg,
    recorded_trial,
)
from crowdbot.metrics import metric_table
from crowdbot.recording import record
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial


@pytest.fixture
def clip(tmp_path):
    """A robot that drives along x at 1 m/s, one person who waits and one who enters after 1 s."""
    lines = ["id,frame,label,x,y"]
    for k in range(61):
        lines += [f"9,{k},robot,{0.1 * k:.3f},0.0", f"1,{k},pedestrian,3.0,1.5"]
        if k >= 10:
            lines.append(f"2,{k},pedestrian,{6.0 - 0.1 * k:.3f},-1.2")
    path = tmp_path / "clip.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_metrics_of_a_recording(clip):
    recording = load_robot_recording(clip, fps=10.0, mass=40.0, height=0.8)
    metrics = recording.metrics()
    assert metrics["duration"] == pytest.approx(5.7)  # it ends within 0.3 m of the last position
    assert metrics["mean_speed"] == pytest.approx(1.0)
    assert metrics["min_clearance"] == pytest.approx(1.2 - 0.3 - 0.25, abs=5e-3)
    assert metrics["severity_lower_bound"] == 0.0
    assert not set(metrics) - set(metric_table())
    assert recording.agents.active.sum(axis=0).tolist() == [61, 61, 51]


def test_the_robot_must_be_known(clip, tmp_path):
    text = clip.read_text().replace("robot", "pedestrian")
    (tmp_path / "people.csv").write_text(text)
    with pytest.raises(DataError, match=r"has no robot; name one by its id \(--robot-id\)"):
        load_robot_recording(tmp_path / "people.csv", fps=10.0)
    assert load_robot_recording(tmp_path / "people.csv", fps=10.0, robot=9).agents.position[0, 0, 0] == 0.0
    with pytest.raises(DataError, match="has no track of id 5"):
        load_robot_recording(clip, robot=5, fps=10.0)
    with pytest.raises(InputError, match="radius"):
        load_robot_recording(clip, radius=0.0, fps=10.0)


def test_an_episode_has_the_same_metrics_as_its_recording(tmp_path):
    trial = load_trial("frontal", duration=8.0)
    record(trial, out=tmp_path / "run")
    episode = simulate(trial)
    recording = load_robot_recording(
        tmp_path / "run/episode.mcap", goal=trial.robots[0].goal.position, radius=trial.robots[0].radius
    )
    ours, theirs = recording.metrics(), dict(episode.metrics) | episode_metrics(episode)
    for name in ("path_length", "duration", "local_density", "goal_progress", "density_5m", "legibility"):
        assert ours[name] == pytest.approx(theirs[name], rel=0.02), name


def test_the_trial_of_a_recording_repeats_it(clip, tmp_path):
    recording = load_robot_recording(clip, fps=10.0)
    plan = EvaluationPlan([recorded_trial(recording, tmp_path)], seeds=range(12))
    (cell,) = evaluate(plan).cells
    assert {row.outcome for row in cell.runs} == {"success"}
    assert cell.values("path_length") == pytest.approx(5.7, abs=0.05)
    assert np.std(cell.values("min_clearance")) > 0.0
    rows = {row.metric: row for row in place_reality(recording.metrics(), cell.valid, mirror=True)}
    assert rows["min_clearance"].inside
    assert "path_length" not in rows
    assert reality_svg(list(rows.values())).startswith("<svg")
    free = recorded_trial(recording, tmp_path, mirror=False)
    assert free.robots[0].pose is None
    assert free.duration == pytest.approx(9.0)


def test_placements_of_known_values():
    rows = [RunRow(k, "success", "", {"a": float(k), "b": 1.0}) for k in range(100)]
    rows.append(RunRow(100, "invalid", message="impossible"))
    low, middle, same = (
        place_reality({name: value}, rows)[0] for name, value in (("a", -1.0), ("a", 49.5), ("b", 1.0))
    )
    assert (low.quantile, low.inside) == (0.0, False)
    assert (middle.quantile, middle.inside, middle.median) == (0.5, True, 49.5)
    assert 0.40 < middle.low < 0.5 < middle.high < 0.60
    assert same.constant
    assert same.quantile == 0.5
    assert place_reality({"a": float("nan")}, rows) == []


def test_the_command_measures_and_simulates(clip, tmp_path, capsys):
    words = ["--fps", "10", "--json", "--out", str(tmp_path / "logs")]
    assert main(["evaluate", "--logs", str(clip), *words]) == 0
    document = json.loads(capsys.readouterr().out)
    assert json.loads((tmp_path / "logs/logs.json").read_text()) == document
    assert document["logs"][0]["metrics"]["success"] == 1.0
    out = tmp_path / "real"
    options = ["--fps", "10", "--seeds", "0:12", "--out", str(out)]
    assert main(["evaluate", "--real", str(clip), *options]) == 0
    text = capsys.readouterr().out
    assert "quantile of reality" in text
    assert "recorded path" in text
    values = json.loads((out / "reality.json").read_text())
    assert values["real"][0]["runs"] == 12
    assert "<svg" in (out / "reality.html").read_text()
    assert main(["evaluate", "--real", str(clip), "--fps", "10", "--seeds", "0:9"]) == 2
    assert (
        "--real has 9 seeds; where a recording lies among its simulations needs at least 10" in capsys.readouterr().err
    )
    assert main(["evaluate", "frontal", "--real", str(clip)]) == 2
    assert "trials and real are given" in capsys.readouterr().err
    assert main(["evaluate"]) == 2
    assert "needs a trial, or recordings" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("who,tick,kind,east,north", ["--columns", "id=who", "frame=tick", "label=kind", "x=east", "y=north"]),
        ("id,frame,label,x_px,y_px", []),
    ],
)
def test_a_recording_is_read_with_the_shared_options(clip, tmp_path, capsys, table, words):
    rows = clip.read_text().splitlines()[1:]
    cells = [row.split(",") for row in rows]
    rows = [f"{who},{frame},{kind},{float(x) * 50},{float(y) * 50}" for who, frame, kind, x, y in cells]
    (tmp_path / "other.csv").write_text("\n".join([table, *rows]) + "\n")
    assert main(["evaluate", "--logs", str(clip), "--fps", "10", "--json"]) == 0
    (expected,) = json.loads(capsys.readouterr().out)["logs"]
    words = ["--fps", "10", "--scale", "0.02", *words, "--json"]
    assert main(["evaluate", "--logs", str(tmp_path / "other.csv"), *words]) == 0
    (found,) = json.loads(capsys.readouterr().out)["logs"]
    for name, value in expected["metrics"].items():
        assert found["metrics"][name] == (None if value is None else pytest.approx(value, rel=1e-6, abs=1e-9)), name


def test_people_and_robot_in_two_files_meet_on_their_clock(tmp_path):
    for name, begin, x in (("people", 900.0, 3.0), ("robot", 902.0, 0.0)):
        rows = [f"1,{begin + 0.1 * k:.1f},{x + (name == 'robot') * 0.1 * k:.2f},1\n" for k in range(61)]
        (tmp_path / f"{name}.csv").write_text("id,time,x,y\n" + "".join(rows))
    recording = load_robot_recording(tmp_path / "people.csv", tmp_path / "robot.csv")
    assert recording.agents.active[:, 1].sum() == 41  # people are there in the first 4 s of the robot
    assert recording.agents.active[40:42, 1].tolist() == [True, False]


def test_options_of_recordings_without_recordings_are_rejected(capsys, tmp_path):
    assert main(["evaluate", "frontal", "--columns", "id=who"]) == 2
    assert "--columns is for recordings; give --logs or --real" in capsys.readouterr().err
    (tmp_path / "a.csv").write_text("id,time,x,y\n")
    assert main(["evaluate", "--logs", str(tmp_path / "a.csv"), "--fps", "citr=25"]) == 2
    assert "--fps citr=25.0: no recording has 'citr' in its path" in capsys.readouterr().err
