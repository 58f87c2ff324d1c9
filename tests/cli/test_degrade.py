"""``crowdbot degrade`` as a user runs it: tables, files, a written recording, and one sentence for wrong input."""

import json

import numpy as np
import pytest

from crowdbot import evaluation
from crowdbot.cli import main
from crowdbot.cli.degrade import read_degradations
from crowdbot.core import stream
from crowdbot.data import load
from crowdbot.data.degrade import Chain, GaussianNoise, MissingFrames, Occlusion


@pytest.fixture
def zara(recordings):
    return str(recordings / "eth_ucy_splits" / "all_data" / "crowds_zara01.txt")


@pytest.fixture
def small(tmp_path):
    """Three people and 30 rows, the third comes near the second."""
    rows = [f"{10 * k}\t{i}\t{0.4 * k}\t{y}" for k in range(30) for i, y in ((1, 0.0), (2, 3.0), (3, 3.5 - 0.01 * k))]
    path = tmp_path / "small.txt"
    path.write_text("\n".join(rows) + "\n")
    return str(path)


def _json(capsys, *words):
    assert main(["degrade", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_predictors_over_levels_with_table_json_and_plot(capsys, tmp_path, zara):
    out = tmp_path / "a folder" / "out"
    words = ["degrade", "--data", zara, "--by", "gaussian-noise", "--levels", "0", "0.1"]
    words += ["--predictor", "constant-velocity", "kalman", "simulated", "--seed", "1", "--draws", "2"]
    assert main([*words, "--out", str(out)]) == 0
    text = capsys.readouterr().out
    assert "0.427 / 0.952" in text
    assert "0.443 / 0.972" in text
    assert "100.0 %" in text
    assert "2356 persons" in " ".join(text.split())
    assert "sd [m]" in text
    assert sorted(path.name for path in out.iterdir()) == ["degraded.json", "degraded.png", "degraded.svg"]
    page = json.loads((out / "degraded.json").read_text())
    assert page["complete"] is True
    assert page["task"]["seed"] == 1
    rows = page["degradations"]["gaussian-noise"]["rows"]
    assert [(row["level"], row["predictor"]) for row in rows][::3] == [
        (0.0, "constant-velocity"),
        (0.1, "constant-velocity"),
    ]
    assert rows[3]["score"]["ade"] > rows[4]["score"]["ade"] > 2.0 * rows[0]["score"]["ade"]
    assert (out / "degraded.png").read_bytes()[:4] == b"\x89PNG"
    assert "sampled" not in (out / "degraded.svg").read_text()
    assert main([*words, "--json"]) == 0
    again = json.loads(capsys.readouterr().out)["degradations"]["gaussian-noise"]["rows"]
    assert [row["score"]["ade"] for row in again] == [row["score"]["ade"] for row in rows]


@pytest.mark.sweep
def test_all_degradations_and_all_predictors(capsys, tmp_path, small):
    page = _json(capsys, "--data", small, "--by", "all", "--set", "eye=3,-4", "--draws", "1", "--out", str(tmp_path))
    names = {"gaussian-noise", "missing-frames", "occlusion", "identity-switches", "late-start", "false-tracks"}
    assert names <= set(page["degradations"])
    assert page["degradations"]["occlusion"]["parameters"]["eye"] == "3,-4"
    assert {"constant-velocity", "simulated"} <= {row["predictor"] for row in page["degradations"]["occlusion"]["rows"]}
    assert page["files"][1:] == [str(tmp_path / "degraded.png"), str(tmp_path / "degraded.svg")]


def test_a_robot_of_a_recorded_trial_looks(capsys, tmp_path):
    assert main(["run", "crossing-flows", "--seed", "5", "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    words = ["--data", str(tmp_path / "episode.mcap"), "--by", "occlusion", "--levels", "0", "1"]
    words += ["--observe", "4", "--predict", "6", "--predictor", "constant-velocity", "--set", "reach=6"]
    rows = _json(capsys, *words)["degradations"]["occlusion"]["rows"]
    assert rows[0]["coverage"] == 1.0
    assert 0.05 < rows[1]["coverage"] < 0.95
    carried = _json(capsys, *words, "--carry", "3")["degradations"]["occlusion"]["rows"]
    assert carried[1]["coverage"] > rows[1]["coverage"]


def test_the_degraded_recording_is_written(capsys, tmp_path, zara):
    file = tmp_path / "seen.parquet"
    words = ["--data", zara, "--by", "missing-frames+gaussian-noise", "--levels", "0.2", "--seed", "7"]
    words += ["--set", "burst=2", "sd=0.1"]
    assert main(["degrade", *words, "--write", str(file)]) == 0
    said = capsys.readouterr().out
    assert "missing-frames(probability=0.2, burst=2, of=person) + gaussian-noise(sd=0.1 m), seed 7" in said
    clean = load(zara)
    chain = Chain((MissingFrames(0.2, 2.0), GaussianNoise(0.1)))
    expected = chain.apply(clean, stream(7, "degrade", 0)).tracks
    written = load(file)
    assert all(np.array_equal(getattr(written, k), getattr(expected, k)) for k in ("id", "frame", "x", "y"))
    assert "seed 7" in written.note
    counts = _json(capsys, *words, "--write", str(tmp_path / "seen.csv"))
    assert counts["rows"] == [len(clean), len(expected)]
    assert f"rows {len(clean)} -> {len(expected)}" in said
    same = tmp_path / "same.txt"
    assert main(["degrade", "--data", zara, "--by", "late-start", "--levels", "0", "--write", str(same)]) == 0
    again = load(same)
    assert np.array_equal(again.x, clean.x)
    assert np.array_equal(again.id, clean.id)


def test_parameters_find_their_degradation():
    one, both = read_degradations(["occlusion", "missing-frames+occlusion"], {"occlusion.eye": "4", "burst": "3"})
    assert one == Occlusion(eye=4)
    assert both == Chain((MissingFrames(burst=3.0), Occlusion(eye=4)))
    (point,) = read_degradations(["occlusion"], {"eye": "1.5,-2"})
    assert point.eye == (1.5, -2.0)


def test_an_interrupt_keeps_what_is_done(capsys, tmp_path, monkeypatch, small):
    whole = evaluation.sweep_degradations

    def interrupted(*parts):
        levels = whole(*parts)
        yield next(levels)
        yield next(levels)
        raise KeyboardInterrupt

    monkeypatch.setattr(evaluation, "sweep_degradations", interrupted)
    words = ["degrade", "--data", small, "--by", "gaussian-noise", "--predictor", "constant-velocity"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 130
    said = capsys.readouterr()
    assert "0.02" in said.out
    assert "0.05" not in said.out
    assert said.err.endswith(f"are shown and stored in {tmp_path / 'out'}\ncrowdbot: interrupted\n")
    page = json.loads((tmp_path / "out" / "degraded.json").read_text())
    assert page["complete"] is False
    assert [row["level"] for row in page["degradations"]["gaussian-noise"]["rows"]] == [0.0, 0.02]
    assert (tmp_path / "out" / "degraded.png").is_file()
    assert main([*words, "--json"]) == 130
    assert json.loads(capsys.readouterr().out)["complete"] is False


def test_degradations_are_listed(capsys):
    assert main(["list", "degradations", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["degradations"]
    assert len(found) == 8
    assert "occlusion" in found
    assert "chain" not in found


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--by", "gausian-noise"], ("unknown degradation 'gausian-noise', did you mean 'gaussian-noise'?",)),
        (["--by", "late-start+occlussion"], ("did you mean 'occlusion'?",)),
        (["--by", "gaussian-noise", "--levels", "0", "-0.1"], ("sd = -0.1 [m]", "at least 0")),
        (["--by", "missing-frames", "--levels", "1.5"], ("probability = 1.5 must be at most 1",)),
        (["--by", "late-start", "--levels", "1.5"], ("rows = 1.5 must be a whole number",)),
        (["--by", "occlusion"], ("small.txt has no robot as a viewpoint", "set eye")),
        (["--by", "all"], ("small.txt has no robot as a viewpoint", "set eye")),
        (["--by", "occlusion", "--set", "eye=99"], ("eye = 99", "no track of this id")),
        (["--by", "occlusion", "--set", "eye=there"], ("'there' is not a number",)),
        (["--by", "occlusion", "--set", "eyes=1,2"], ("did you mean 'eye'?", "occlusion.reach")),
        (
            ["--by", "gaussian-noise", "--set", "sd=0.1"],
            ("this parameter is varied by the sweep of gaussian-noise", "--levels"),
        ),
        (["--by", "gaussian-noise", "--set", "sd"], ("NAME=VALUE",)),
        (["--by", "gaussian-noise", "late-start", "--levels", "1"], ("--levels requires a single degradation, not 2",)),
        (["--by", "gaussian-noise", "--predictor", "kalmann"], ("did you mean 'kalman'?",)),
        (["--by", "gaussian-noise", "--predictor", "kalman", "--model", "orca"], ("--model requires",)),
        (["--by", "gaussian-noise", "--protocol", "sgam"], ("did you mean 'sgan'?",)),
        (["--by", "gaussian-noise", "--observe", "40"], ("small.txt: no window of 40 observed",)),
        (["--by", "gaussian-noise", "--draws", "0"], ("draws = 0",)),
        (["--by", "gaussian-noise", "--every", "0"], ("every = 0 must be at least 1",)),
        (
            ["--by", "gaussian-noise", "--late", "extrapolate"],
            ("--late extrapolate is not supported by degrade", "late-start"),
        ),
        (["--by", "gaussian-noise", "--out", "small.txt"], ("small.txt is a file; give a folder",)),
        (["--by", "gaussian-noise", "--write", "x.csv", "--predictor", "kalman"], ("does not evaluate",)),
        (["--by", "gaussian-noise", "late-start", "--write", "x.csv"], ("exactly one --data",)),
        (["--by", "gaussian-noise", "--write", "x.docx"], ("x.docx", ".csv")),
        (["--by", "late-start", "--levels", "30", "--write", "x.csv"], ("no rows are left after degradation",)),
    ],
)
def test_wrong_input_is_one_sentence(capsys, tmp_path, monkeypatch, small, words, said):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    assert main(["degrade", "--data", small, *words]) == 2
    spoken = capsys.readouterr()
    assert spoken.out == ""
    sentence = [line for line in spoken.err.splitlines() if not line.endswith(" ...")]
    assert len(sentence) == 1
    assert sentence[0].startswith("crowdbot: ")
    assert all(word in sentence[0] for word in said), sentence[0]
    assert sorted(tmp_path.rglob("*")) == before


def test_parameters_of_the_predictor(capsys, small):
    words = ["--data", small, "--by", "gaussian-noise", "--levels", "0.05", "--draws", "1", "--observe", "4"]
    words += ["--predict", "6", "--predictor", "simulated", "--model", "social-force"]
    rows = [
        _json(capsys, *words, *more)["degradations"]["gaussian-noise"]["rows"][0]
        for more in ([], ["--set-predictor", "relaxation_time=0.9"], ["--set-predictor", "relaxation_time=0.5"])
    ]
    assert rows[1]["predictor"] != rows[0]["predictor"]
    assert rows[1]["score"]["ade"] != rows[0]["score"]["ade"]
    assert rows[2]["score"]["ade"] == rows[0]["score"]["ade"]  # the default of the model
    assert main(["degrade", *words, "--set-predictor", "relax=1"]) == 2
    assert "relax" in capsys.readouterr().err
    assert main(["degrade", "--data", small, "--by", "late-start", "--set-predictor", "a=1", "--write", "x.csv"]) == 2
    assert "omit --predictor, --set-predictor and --out" in capsys.readouterr().err
