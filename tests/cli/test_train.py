"""``crowdbot train``: from recordings to weights to scores, and wrong words."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import stream

TINY = ["hidden=4", "pooled=2", "noise=2", "batch=16"]


@pytest.fixture(scope="module")
def walks(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Two recordings of people who walk straight on."""
    files = []
    for number, name in enumerate(("street", "plaza")):
        rng = stream(number, "walks")
        begin, velocity = rng.uniform(-5.0, 5.0, (6, 2)), rng.normal(0.0, 1.0, (6, 2))
        rows = [(10 * t, who, *(begin[who] + 0.4 * t * velocity[who])) for t in range(60) for who in range(6)]
        file = tmp_path_factory.mktemp("walks") / f"{name}.txt"
        np.savetxt(file, rows, fmt=["%d", "%d", "%.4f", "%.4f"], delimiter="\t")
        files.append(str(file))
    return files


def said(words: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, str, str]:
    status = main(words)
    out, err = capsys.readouterr()
    return status, out, err


@pytest.mark.parametrize("there", [False, True])
def test_a_training_that_never_began_is_not_resumed(
    walks: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], there: bool
) -> None:
    out = tmp_path / "weights"
    if there:
        out.mkdir()
    status, _, err = said(["train", "social-ways", "--data", *walks, "--out", str(out), "--resume"], capsys)
    assert status == 2
    assert err == (
        f"crowdbot: --out {out} has no last.npz: nothing to resume; give the folder of a training, or omit --resume\n"
    )
    assert list(tmp_path.iterdir()) == ([out] if there else [])


def test_weights_are_learned_resumed_and_scored(
    walks: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["train", "social-ways", "--data", *walks, "--fps", "25", "--leave-out", "plaza", "--out", str(tmp_path),
             "--check-every", "2", "--set", *TINY]  # fmt: skip
    status, _, err = said([*words, "--updates", "2"], capsys)
    assert status == 0
    assert "warning: street.txt has 24 s; more than 3 minutes are recommended for training" in err
    assert "update 2" in err
    status, _, err = said([*words, "--updates", "4"], capsys)
    assert (status, "already contains a training: resume it with --resume" in err) == (2, True)
    status, out, _ = said([*words, "--updates", "4", "--resume", "--json"], capsys)
    done = json.loads(out)
    assert (status, done["updates"], done["left_out"]) == (0, 4, [walks[1]])
    assert [row["update"] for row in done["log"]] == [2, 4]
    status, out, _ = said(
        ["predict", "--predictor", "social-ways", "--set", f"checkpoint={done['checkpoint']}", "--samples", "3",
         "--fps", "25", "--data", walks[1], "--every", "12", "--json"], capsys,
    )  # fmt: skip
    total = json.loads(out)["results"][0]["total"]
    assert (status, total["samples"]) == (0, 3)
    assert total["ade"] < 5.0


def test_the_anchor_network_learns_and_scores_the_same_way(
    walks: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["train", "anchor-net", "--data", *walks, "--fps", "25", "--leave-out", "plaza", "--out", str(tmp_path),
             "--updates", "4", "--check-every", "2", "--set", "width=16", "social=8", "people=16"]  # fmt: skip
    status, out, _ = said([*words, "--json"], capsys)
    done = json.loads(out)
    assert (status, [row["update"] for row in done["log"]]) == (0, [2, 4])
    status, out, _ = said(
        ["predict", "--predictor", "anchor-net", "--set", f"file={done['checkpoint']}", "--samples", "20",
         "--fps", "25", "--data", walks[1], "--every", "12", "--json"], capsys,
    )  # fmt: skip
    total = json.loads(out)["results"][0]["total"]
    assert (status, total["samples"]) == (0, 20)
    assert total["ade"] < 1.0


def test_a_balanced_training_has_equal_shares_and_repeats_its_bytes(
    walks: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["train", "anchor-net", "--data", *walks, "--fps", "25", "--updates", "2", "--check-every", "2",
             "--set", "width=16", "social=8", "people=16"]  # fmt: skip
    equal = ["--balance", "36"]
    cases: tuple[tuple[list[str], int], ...] = (
        ([], 156),
        (equal, 72),
        (equal, 72),
        ([*equal, "--balance", "plaza=12"], 48),
    )
    found = []
    for number, (limits, people) in enumerate(cases):
        out = tmp_path / str(number)
        status, _, err = said([*words, *limits, "--out", str(out)], capsys)
        assert status == 0
        assert f"training anchor-net on {people} futures" in err
        found.append((out / "best.npz").read_bytes())
    assert found[1] == found[2]
    assert len({*found}) == 3


@pytest.mark.parametrize(
    ("limit", "why"),
    [
        ("0", "--balance 0: the number of futures must be at least 1"),
        ("nowhere=9", "--balance nowhere=9: no recording of --data has 'nowhere' in its path"),
    ],
)
def test_wrong_limits_are_refused(
    walks: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], limit: str, why: str
) -> None:
    words = ["train", "anchor-net", "--data", *walks, "--balance", limit, "--out", str(tmp_path / "out")]
    status, _, err = said(words, capsys)
    assert (status, why in err) == (2, True)
    assert not (tmp_path / "out").exists()


def test_weights_that_do_not_fit_are_said_and_a_baseline_answers(
    walks: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["predict", "--predictor", "anchor-net", "social-ways", "--samples", "3", "--fps", "10", "--every", "20",
             "--data", walks[0]]  # fmt: skip
    status, _, err = said(words, capsys)
    assert status == 0
    assert "anchor-net: street.txt has time steps of 1 s; the weights require 0.4 s, at most 0.7 s; a baseline" in err
    assert "social-ways: street.txt has time steps of 1 s; the weights require 0.4 s: resample with --step 0.4" in err
    assert "UserWarning" not in err
    status, out, _ = said([*words, "--json"], capsys)
    assert [len(item["notes"]) for item in json.loads(out)["results"]] == [1, 1]


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["sociel-ways"], "unknown learned predictor 'sociel-ways', did you mean 'social-ways'"),
        (["anchor-net", "--set", "hiden=3"], "has no attribute 'hiden'"),
        (["anchor-net", "--device", "cuda"], "does not exist: torch finds 0 CUDA devices"),
        (["social-ways", "--device", "cuda:99"], "does not exist: torch finds"),
        (["social-ways", "--updates", "1", "--epochs", "1"], "either updates or epochs"),
        (["social-ways", "--leave-out", "nowhere"], "no recording matches 'nowhere'"),
        (["social-ways", "--set", "hiden=3"], "has no attribute 'hiden', did you mean 'hidden'"),
        (["social-ways", "--settings", "vareity"], "unknown preset 'vareity', did you mean 'variety'"),
    ],
)
def test_wrong_words_are_one_sentence(
    walks: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], why: str
) -> None:
    status, out, err = said(
        ["train", *words, "--data", *walks, "--fps", "25", "--out", str(tmp_path / "out"), "--json"], capsys
    )
    assert (status, out) == (2, "")
    assert why in err
    assert not (tmp_path / "out").exists()


def test_without_torch_it_says_what_to_install(capsys, tmp_path, monkeypatch, recordings):
    import sys

    for name in [name for name in sys.modules if name.startswith("crowdbot.prediction.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "torch", None)
    data = recordings / "eth_ucy_splits" / "all_data" / "crowds_zara01.txt"
    for what in ("anchor-net", "social-ways"):
        assert main(["train", what, "--data", str(data), "--updates", "2", "--out", str(tmp_path / "w")]) == 2
        assert "needs the extra [learn]: pip install" in capsys.readouterr().err
    assert not (tmp_path / "w").exists()


def test_the_scan_network_is_trained_on_generated_scans(tmp_path, capsys):
    words = ["train", "scan-network", "--out", str(tmp_path), "--scans", "12", "--epochs", "1"]
    assert main(words) == 0
    assert "beams of 12 generated scans" in capsys.readouterr().out
    assert (tmp_path / "scan-network.npz").stat().st_size > 10_000
    assert main([*words, "--resume"]) == 2
    assert "cannot be resumed" in capsys.readouterr().err
    assert main([*words, "--data", "walk.csv"]) == 2
    assert "learns from simulated scans" in capsys.readouterr().err


def test_the_scan_predictor_is_trained_on_runs(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("crowdbot.cli.train.learned_scene.TRIALS", (("two-way", {"density": "0.3"}),))
    monkeypatch.setattr("crowdbot.cli.train.learned_scene.DURATION", 3.0)
    words = ["train", "learned-scene", "--out", str(tmp_path), "--runs", "2", "--epochs", "2"]
    assert main([*words, "--json"]) == 0
    fit = json.loads(capsys.readouterr().out)
    assert fit["samples"] > 50
    assert len(fit["straight"]) == len(fit["learned"]) == 4
    assert (tmp_path / "learned-scene.npz").stat().st_size > 10_000
    assert main([*words, "--resume"]) == 2
    assert "cannot be resumed; omit --resume" in capsys.readouterr().err
    assert main([*words[:-3], "0"]) == 2
    assert "--runs 0 must be at least 1" in capsys.readouterr().err
