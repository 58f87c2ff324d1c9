"""Calibrated crowds on the command line: schemes in every combination, live lines, files, stops and new starts."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from crowdbot.cli import main
from crowdbot.core import stream
from crowdbot.data import Trajectories, save
from samples import sample

SCHEME = ["--cost", "progressive", "--search", "genetic", "--budget", "30", "--set", "substep=0.4"]


@pytest.fixture(scope="module")
def street(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A short recording of twelve people in a street, most of them walking to and fro."""
    rng = stream(3, "street")
    rows = []
    for person in range(12):
        begin, way = int(rng.integers(0, 14)), 1.0 if person % 2 else -1.0
        start = np.array([-4.0 * way, rng.uniform(-2.0, 2.0)])
        speed = rng.uniform(0.8, 1.5)
        for row in range(20):
            place = start + np.array([way * speed * 0.4 * row, 0.1 * np.sin(0.6 * row + person)])
            rows.append((person, begin + row, *place))
    id, frame, x, y = np.array(sorted(rows, key=lambda r: (r[1], r[0]))).T
    file = tmp_path_factory.mktemp("data") / "street.csv"
    save(Trajectories(id.astype(int), frame.astype(int), x, y, row_rate=2.5), file)
    return str(file)


def _json(capsys: pytest.CaptureFixture[str], *words: str) -> dict:
    assert main([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_schemes_and_baselines_in_one_run(capsys, street, tmp_path):
    words = ["predict", "--data", street, "--predict", "3", "--predictor", "constant-velocity", "simulated"]
    scheme = ["--model", "orca", "social-force", "--goal", "current-direction", "ground-truth", *SCHEME]
    found = _json(capsys, *words, *scheme, "--out", str(tmp_path), "--animate", "12")
    names = [one["predictor"] for one in found["results"]]
    assert len(names) == len(set(names)) == 5
    assert len({one["total"]["persons"] for one in found["results"]}) == 1
    table = pd.read_parquet(tmp_path / "frames.parquet")
    assert set(table["predictor"]) == set(names)
    fitted = table[table["predictor"] != "constant-velocity"]
    assert (fitted["evaluations"] == 30).all()
    assert fitted["cost"].notna().any()
    assert json.loads((tmp_path / "scores.json").read_text()) == found
    for name in ("errors.png", "frames.png", "frame-12.gif"):
        assert (tmp_path / name).stat().st_size > 5000
    film = ["--data", street, "--predict", "3", "--animate", "12", "--animate-format", "mp4"]
    assert main(["predict", *film, "--out", str(tmp_path / "film")]) == 0
    assert (tmp_path / "film" / "frame-12.mp4").read_bytes()[4:8] == b"ftyp"


def test_every_frame_is_a_line_and_the_table_comes_last(capsys, street):
    words = ["predict", "--data", street, "--predict", "3", "--predictor", "simulated", "kalman"]
    assert main([*words, *SCHEME, "--live"]) == 0
    told = capsys.readouterr()
    lines = [line.split() for line in told.err.splitlines() if line[:1].isdigit()]
    assert "frame    people  minimum cost [m]  evaluations  seconds" in told.err
    assert len(lines) > 5
    assert all(len(line) == 5 and line[3] == "30" and float(line[4]) > 0.0 for line in lines)
    assert all(word in told.out for word in ("orca,", "progressive,", "genetic,", "current-direction"))
    assert "kalman" in told.out


@pytest.mark.program
def test_workers_and_a_second_run_give_the_same_numbers(capsys, street, tmp_path):
    words = ["predict", "--data", street, "--predict", "3", "--predictor", "simulated", *SCHEME]
    one = _json(capsys, *words)
    two = _json(capsys, *words, "--workers", "2", "--out", str(tmp_path))
    parts = sorted((tmp_path / "parts").glob("*.npz"))
    before = [part.stat().st_mtime_ns for part in parts]
    again = _json(capsys, *words, "--out", str(tmp_path))
    assert [part.stat().st_mtime_ns for part in parts] == before
    for found in (two, again):
        for key in ("ade", "fde", "collisions", "persons"):
            assert found["results"][0]["total"][key] == one["results"][0]["total"][key]


@pytest.mark.sweep
def test_a_ray_cluster_gives_the_same_numbers(capsys, street):
    words = ["predict", "--data", street, "--predict", "3", "--predictor", "simulated", *SCHEME]
    one = _json(capsys, *words)
    cluster = _json(capsys, *words, "--cluster", "local", "--workers", "2")
    assert cluster["results"][0]["total"]["ade"] == one["results"][0]["total"]["ade"]


def _hears_ctrl_c() -> None:
    """Undo what a shell does to programs in its background, whose children are deaf to Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.fixture
def plaza(tmp_path):
    """A synthetic recording: 12 people who turn slowly, 120 rows at 2.5 Hz."""
    rng = np.random.default_rng(4)
    rows = []
    for person in range(12):
        angle = rng.uniform(-np.pi, np.pi) + np.cumsum(rng.normal(0.0, 0.05, 120))
        place = rng.uniform(-8.0, 8.0, 2) + np.cumsum(0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=1), axis=0)
        rows += [(10 * row, person, *place[row]) for row in range(120)]
    file = tmp_path / "plaza.txt"
    np.savetxt(file, sorted(rows), fmt=["%d", "%d", "%.4f", "%.4f"], delimiter="\t")
    return str(file)


@pytest.mark.live
@pytest.mark.parametrize("workers", sample(["2", "1"], 1))
def test_a_stopped_run_goes_on_where_it_was(plaza, tmp_path, workers):
    words = ["predict", "--data", plaza, "--fps", "25", "--predictor", "simulated", "--cost", "progressive"]
    words += ["--budget", "300", "--workers", workers]
    program = [sys.executable, "-m", "crowdbot", *words, "--set", "substep=0.4", "--out", str(tmp_path)]
    running = subprocess.Popen(
        program,
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=_hears_ctrl_c,  # noqa: PLW1509
    )
    deadline = time.monotonic() + 120.0
    while not list(tmp_path.glob("parts/*.npz")) and time.monotonic() < deadline:
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    _, told = running.communicate(timeout=60)
    assert running.returncode == 130, told
    assert "interrupted" in told
    assert "Traceback" not in told
    assert "jobs are stored in" in told
    assert "run the same command again to resume" in told
    kept = {part: part.stat().st_mtime_ns for part in tmp_path.glob("parts/*.npz")}
    assert kept
    assert not list(tmp_path.glob("parts/*.part"))
    assert not (tmp_path / "scores.json").exists()
    done = subprocess.run(program, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "scores.json").exists()
    assert all(part.stat().st_mtime_ns == when for part, when in kept.items())


def test_goals_priors_and_shared_parameters_are_learned_from_the_first_part(capsys, recordings):
    data = str(recordings / "eth_ucy_splits" / "all_data" / "crowds_zara02.txt")
    words = ["predict", "--data", data, "--learn", "0.8", "--predict", "3", "--predictor", "simulated"]
    plain = _json(capsys, *words, *SCHEME)["results"][0]
    learned = _json(capsys, *words, *SCHEME, "--goal", "learned-destinations", "--prior", "learn")["results"][0]
    shared = _json(capsys, *words, *SCHEME, "--goal", "learned-destinations", "--shared")["results"][0]
    assert learned["predictor"].endswith("goal=learned-destinations, prior)")
    assert shared["predictor"].endswith("goal=learned-destinations, shared)")
    assert plain["total"]["persons"] == learned["total"]["persons"] == shared["total"]["persons"]
    assert shared["total"]["ade"] < plain["total"]["ade"]


@pytest.mark.program
def test_calibrate_writes_parameters_and_a_prior_that_predict_takes(capsys, street, tmp_path):
    words = ["calibrate", "--data", street, "--model", "orca", "--search", "random-search", "--budget", "20"]
    found = _json(capsys, *words, "--out", str(tmp_path))
    fit = found[street]
    assert fit["scheme"] == "orca, progressive, random-search, current-direction"
    assert fit["cost"] <= fit["given_cost"]
    people = pd.read_parquet(tmp_path / "parameters.parquet")
    assert {"recording", "window", "id", "window_cost", *fit["parameters"]} == set(people.columns)
    assert len(people) == fit["persons"]
    again = _json(capsys, *words, "--workers", "2")
    assert again[street]["parameters"] == fit["parameters"]
    prior = str(tmp_path / "prior.json")
    predict = ["predict", "--data", street, "--predict", "3", "--predictor", "simulated", *SCHEME]
    one, other = (_json(capsys, *predict, *more)["results"][0] for more in ([], ["--prior", prior]))
    assert other["predictor"].endswith("prior=population-prior, substep=0.4)")
    assert one["total"]["ade"] != other["total"]["ade"]


def test_calibrate_prints_lines_and_a_table(capsys, street):
    words = ["calibrate", "--data", street, "--search", "random-search", "--budget", "10"]
    assert main(words) == 0
    told = capsys.readouterr()
    assert "frame    people  minimum cost [m]  evaluations  seconds" in told.err
    assert "time_horizon" in told.out
    assert "sd over people" in told.out
    assert main([*words, "--shared", "--free", "radius"]) == 0
    told = capsys.readouterr()
    assert "radius" in told.out
    assert "time_horizon" not in told.out


WRONG = {
    "a budget of zero": (["--budget", "0"], "budget = 0 evaluations must be at least 1"),
    "an unknown cost": (["--cost", "progresive"], "did you mean 'progressive'"),
    "an unknown search": (["--search", "genetics"], "did you mean 'genetic'"),
    "an unknown goal": (["--goal", "current-directions"], "did you mean 'current-direction'"),
    "an unknown parameter": (["--free", "radios"], "did you mean 'radius'"),
    "a goal that learns from nothing": (["--goal", "learned-destinations"], "reserve one with --learn"),
    "a layout without exits": (["--goal", "environment-layout"], "reserve one with --learn"),
    "a prior that is no file": (["--prior", "nowhere.json"], "nowhere.json: cannot be read"),
    "a share above one": (["--learn", "1.5"], "must be at least 0 and below 1"),
    "a track of one point": (["--observe", "1"], "(3 with the progressive cost), not 1"),
    "the future while live": (["--goal", "ground-truth", "--live"], "which is unknown in live prediction"),
    "a negative patience": (["--patience", "-1"], "patience = -1 evaluations must be at least 0"),
    "no worker": (["--workers", "0"], "workers = 0 must be at least 1"),
}


@pytest.mark.parametrize("what", WRONG)
def test_wrong_use_is_one_sentence(capsys, street, what):
    words, sentence = WRONG[what]
    scheme = ["--search", "random-search", "--cost", "progressive"]
    assert main(["predict", "--data", street, "--predictor", "simulated", *scheme, *words]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert sentence in told.err
    assert len([line for line in told.err.splitlines() if line.startswith("crowdbot:")]) == 1


def test_a_search_stops_by_tolerance_and_patience(capsys, street):
    words = ["calibrate", "--data", street, "--budget", "400", "--search", "genetic"]
    whole = _json(capsys, *words)[street]
    for early in (["--tolerance", "1.0"], ["--patience", "50"]):
        found = _json(capsys, *words, *early)[street]
        assert found["evaluations"] < whole["evaluations"]
        assert found["cost"] >= whole["cost"]


def test_schemes_without_a_simulated_crowd_are_refused(capsys, street):
    for words in (["--cost", "absolute"], ["--prior", "learn"], ["--model", "orca"]):
        assert main(["predict", "--data", street, "--predictor", "kalman", *words]) == 2
        assert "requires the predictor simulated, not kalman" in capsys.readouterr().err
    assert main(["predict", "--data", street, "--predictor", "simulated", "--shared"]) == 2
    assert "set a cost or a search" in capsys.readouterr().err
    assert main(["predict", "--data", street, "--animate", "3"]) == 2
    assert "--animate requires --out DIR" in capsys.readouterr().err


def test_somebody_alone_cannot_be_compared_with_others(capsys, tmp_path):
    row = np.arange(24)
    file = tmp_path / "alone.csv"
    save(Trajectories(0 * row, row, 0.4 * row, 0.0 * row, row_rate=2.5), file)
    words = ["calibrate", "--data", str(file), "--cost", "inter-pedestrian", "--search", "random-search"]
    assert main([*words, "--budget", "5"]) == 2
    assert "and others nearby if the cost uses distances between people" in capsys.readouterr().err


def test_kept_parts_belong_to_the_content_of_the_file(capsys, street, tmp_path):
    copy = Path(tmp_path / "copy.csv")
    copy.write_bytes(Path(street).read_bytes())
    words = ["predict", "--data", str(copy), "--predict", "3", "--out", str(tmp_path / "out")]
    _json(capsys, *words)
    count = len(list((tmp_path / "out" / "parts").iterdir()))
    os.utime(copy)
    _json(capsys, *words)
    assert len(list((tmp_path / "out" / "parts").iterdir())) == count
    lines = copy.read_text(encoding="utf-8").splitlines()
    copy.write_text("\n".join(lines[: len(lines) - 3]) + "\n", encoding="utf-8")
    _json(capsys, *words)
    assert len(list((tmp_path / "out" / "parts").iterdir())) > count
