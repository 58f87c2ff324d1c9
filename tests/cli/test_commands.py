"""The commands as a user runs them: the real program, its output and its files."""

import json
import os
import re
import subprocess
import sys

import pytest

from crowdbot.cli import COMMANDS, main


def _json(capsys, *arguments):
    assert main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def _program(*arguments, **options):
    return subprocess.run([sys.executable, "-m", "crowdbot", *arguments], capture_output=True, text=True, **options)


def test_the_help_lists_each_command_once_by_job_in_80_columns(capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["--help"])
    lines = capsys.readouterr().out.splitlines()
    named = [line.split()[0] for line in lines if re.match(r"  [a-z]+  ", line)]
    assert sorted(named) == sorted(COMMANDS)
    assert "test a robot in a crowd:" in lines
    assert max(map(len, lines)) <= 80


def test_predict_scores_files_one_by_one_and_together(capsys, recordings):
    files = [str(recordings / "eth_ucy_splits" / "all_data" / f"students00{k}.txt") for k in (1, 3)]
    found = _json(capsys, "predict", "--data", *files, "--predictor", "constant-velocity", "--protocol", "all")
    assert set(found) == {"protocol", "observe", "predict", "seed", "results"}
    assert found["protocol"] == "all"
    (found,) = found["results"]
    assert found["predictor"] == "constant-velocity"
    assert list(found["data"]) == files
    assert set(found["total"]) == set(found["data"][files[0]])
    assert found["total"]["persons"] == 24334 == sum(found["data"][f]["persons"] for f in files)
    assert found["total"]["ade"] == pytest.approx(0.524, abs=1e-3)
    assert found["total"]["fde"] == pytest.approx(1.165, abs=1e-3)
    assert found["data"][files[0]]["ade"] == pytest.approx(0.458, abs=1e-3)


@pytest.mark.parametrize(
    ("protocol", "persons", "ade", "fde"),
    [("all", 1197, 0.319, 0.614), ("sgan", 1053, 0.323, 0.617), ("partial", 3376, 0.278, 0.512)],
)
def test_predict_by_protocol(capsys, recordings, protocol, persons, ade, fde):
    hotel = str(recordings / "eth_ucy_splits" / "all_data" / "biwi_hotel.txt")
    total = _json(capsys, "predict", "--data", hotel, "--protocol", protocol)["results"][0]["total"]
    assert total["persons"] == persons
    assert (total["ade"], total["fde"]) == (pytest.approx(ade, abs=1e-3), pytest.approx(fde, abs=1e-3))


def test_predict_prints_a_table_with_its_protocol(capsys, recordings):
    hotel = str(recordings / "eth_ucy_splits" / "all_data" / "biwi_hotel.txt")
    assert main(["predict", "--data", hotel, "--predictor", "kalman"]) == 0
    text = capsys.readouterr().out
    assert "kalman" in text
    assert "protocol all" in text
    assert "1197" in text


def test_parameters_reach_the_predictor_and_the_crowd_model(capsys, recordings):
    hotel = str(recordings / "eth_ucy_splits" / "all_data" / "biwi_hotel.txt")
    two = _json(capsys, "predict", "--data", hotel, "--set", "displacements=2")["results"][0]["total"]
    assert (two["ade"], two["fde"]) == (pytest.approx(0.270, abs=1e-3), pytest.approx(0.521, abs=1e-3))
    words = ["predict", "--data", hotel, "--predictor", "simulated", "--model", "social-force"]
    near = _json(capsys, *words, "--set", "neighbor-distance=1")["results"][0]["total"]["ade"]
    far = _json(capsys, *words, "--set", "neighbor-distance=6")["results"][0]["total"]["ade"]
    assert near != far


def test_run_records_and_replay_agrees(capsys, tmp_path):
    ran = _json(capsys, "run", "crossing-flows", "--seed", "5", "--out", str(tmp_path))
    assert {"outcome", "steps", "sim_seconds", "wall_seconds", "digest", "metrics"} <= set(ran)
    assert ran["outcome"] in ("success", "collision", "timeout")
    replayed = _json(capsys, "replay", str(tmp_path / "episode.mcap"))
    assert replayed["equal"] is True
    assert replayed["recorded"] == replayed["replayed"] == ran["digest"]
    assert [p.name for p in tmp_path.iterdir()] == ["episode.mcap"]


BRIEF = ["run", "crossing-flows", "--set", "duration=4", "--seed"]


@pytest.mark.program
def test_the_digest_is_the_same_in_another_process(capsys, tmp_path):
    here = _json(capsys, *BRIEF, "2")
    again = _json(capsys, *BRIEF, "2")
    out = tmp_path / "a b"
    there = json.loads(_program(*BRIEF, "2", "--json", "--out", str(out), check=True).stdout)  # and nothing but JSON
    other = _json(capsys, *BRIEF, "3")
    assert here["digest"] == again["digest"] == there["digest"] != other["digest"]
    assert here["metrics"] == there["metrics"]
    assert there["episode"] == str(out / "episode.mcap")


@pytest.mark.program
def test_one_thread_gives_the_same_digest(capsys):
    here = _json(capsys, *BRIEF, "2")
    alone = {**os.environ, "NUMBA_NUM_THREADS": "1"}
    there = json.loads(_program(*BRIEF, "2", "--json", check=True, env=alone).stdout)
    assert here["digest"] == there["digest"]


def test_list_knows_every_kind(capsys):
    found = _json(capsys, "list")
    assert {
        "models",
        "goals",
        "sensors",
        "drives",
        "navigators",
        "predictors",
        "trials",
        "protocols",
        "formats",
    } <= set(found)
    assert {"orca", "social-force"} <= set(found["models"])
    assert {"straight", "orca"} <= set(found["navigators"])
    assert {"all", "sgan", "partial", "timesplit"} <= set(found["protocols"])
    assert "crossing-flows" in found["trials"]
    assert all(line and "\n" not in line for names in found.values() for line in names.values())


def test_every_listed_trial_is_right(capsys):
    for name in _json(capsys, "list", "trials")["trials"]:
        assert main(["check", name]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines
    assert [line for line in lines if not line.endswith(": OK") and not line.startswith("  robot ")] == []


def test_cite_names_the_doi(capsys):
    assert main(["cite", "orca"]) == 0
    assert "10.1007/978-3-642-19457-3_1" in capsys.readouterr().out
    assert main(["cite", "social-force", "--bibtex"]) == 0
    assert "doi = {10.1103/PhysRevE.51.4282}" in capsys.readouterr().out
    assert main(["cite"]) == 0
    assert "D4.2" in capsys.readouterr().out


def test_bench_rows(capsys, tmp_path):
    rows = _json(capsys, "bench", "orca-1000", "lidar-720", "--repeats", "2", "--out", str(tmp_path / "rows.json"))[
        "rows"
    ]
    assert [row["name"] for row in rows] == ["orca-1000", "lidar-720"]
    assert all(set(row) == {"name", "median", "unit", "against", "ratio", "environment"} for row in rows)
    assert all(row["median"] > 0 and row["ratio"] > 0 for row in rows)
    assert json.loads((tmp_path / "rows.json").read_text()) == rows


def test_a_user_adds_a_predictor_in_one_file(capsys, tmp_path, monkeypatch, recordings):
    (tmp_path / "still.py").write_text(
        "from dataclasses import dataclass\nimport numpy as np\nimport crowdbot as cb\n"
        "@dataclass(frozen=True)\nclass Still(cb.Predictor):\n    '''Everyone stays.'''\n"
        "    def predict(self, past, steps, samples=1, rng=None):\n"
        "        here = past.position[:, -1]\n"
        "        stay = np.repeat(here[:, None, None], steps, axis=2)\n"
        "        return cb.Forecast(stay, np.ones((len(past), 1)), past.present[:, -1], past.dt, 'still')\n"
    )
    monkeypatch.chdir(tmp_path)
    zara = str(recordings / "eth_ucy_splits" / "all_data" / "crowds_zara01.txt")
    total = _json(capsys, "predict", "--data", zara, "--predictor", "still.py:Still")["results"][0]["total"]
    assert (total["ade"], total["fde"]) == (pytest.approx(2.50, abs=0.01), pytest.approx(4.59, abs=0.01))


def test_humans_are_told_in_words(capsys):
    assert main(["list", "humans", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["humans"]
    assert found["woman-36"].startswith("f, 36 years, 1.53 m")
    assert found["mannequin"].startswith("a plain figure, 1.70 m")
