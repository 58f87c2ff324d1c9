"""``crowdbot train`` on recordings of several formats and lengths."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from synthetic_recordings import csv_filtered, episode, sgan_text, trajnetpp

from crowdbot.cli import main

TINY = ["--updates", "2", "--check-every", "2", "--set", "width=16", "social=8", "people=16"]


@pytest.fixture
def files(tmp_path: Path) -> list[str]:
    """One recording of each format, one of 25 rows, and two that are too short, and a cart."""
    (tmp_path / "citr").mkdir()
    made = {
        "crowds.txt": sgan_text, "citr/front.csv": csv_filtered, "hotel.ndjson": trajnetpp, "episode.mcap": episode,
    }  # fmt: skip
    for name, write in made.items():
        write(tmp_path / name)
    for name, count in (("walk.txt", 25), ("brief.txt", 12)):
        (tmp_path / name).write_text("".join(f"{10 * t} 1 {0.5 * t} 0\n" for t in range(count)))
    (tmp_path / "citr" / "cart.csv").write_text(
        "id,frame,label,x_est,y_est\n" + "".join(f"1,{t},veh,{0.1 * t},0\n" for t in range(900))
    )
    rows = "".join(f"1,{t},ped,{0.04 * t},0,1,0\n" for t in range(200))
    (tmp_path / "citr" / "back.csv").write_text("id,frame,label,x_est,y_est,vx_est,vy_est\n" + rows)
    return [str(tmp_path / name) for name in (*made, "walk.txt", "brief.txt", "citr/cart.csv", "citr/back.csv")]


def trained(files: list[str], tmp_path: Path, *more: str) -> int:
    return main(["train", "anchor-net", "--data", *files, "--step", "0.4", "--fps", "citr=29.97",
                 "--out", str(tmp_path / "w"), *TINY, *more])  # fmt: skip


def test_formats_and_lengths_train_together(
    files: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert trained(files, tmp_path) == 0
    err = capsys.readouterr().err
    assert "left out, without a window of 8 + 12 rows of 0.4 s: brief.txt, cart.csv, back.csv\n" in err
    assert "too short for --hold 0.2, used whole: walk.txt for training\n" in err
    assert "5 of 5 recordings have 10 to " in err
    assert ", 5 recordings\n" in err
    assert trained(files, tmp_path, "--resume", "--json") == 0
    done = json.loads(capsys.readouterr().out)
    assert done["without_windows"] == files[-3:]
    assert done["used_whole"] == {"training": ["walk.txt"], "validation": []}


def test_recordings_for_validation_may_be_too_short(
    files: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert trained(files[:2], tmp_path, "--check", files[2], files[-3], "--json") == 0
    done = json.loads(capsys.readouterr().out)
    assert done["without_windows"] == [files[-3]]
    assert done["used_whole"] == {"training": [], "validation": []}


def test_without_any_window_it_is_an_error(
    files: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert trained(files[-3:], tmp_path) == 2
    err = capsys.readouterr().err
    assert "brief.txt: no window of 8 observed and 12 predicted rows was found" in err
    assert "; nor has any other of 3 recordings" in err
    assert not (tmp_path / "w").exists()


def test_values_for_some_files_only(files: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["predict", "--step", "0.4", "--json", "--data", *files[:2]]
    assert main([*asked, "--fps", "25", "--fps", "front=29.97"]) == 0
    scores = json.loads(capsys.readouterr().out)["results"][0]["data"]
    assert set(scores) == set(files[:2])
    assert main([*asked, "--fps", "nowhere=25"]) == 2
    assert "--fps nowhere=25.0: no recording has 'nowhere' in its path" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main([*asked, "--fps", "front=fast"])
    assert "'fast' must be a number" in capsys.readouterr().err
