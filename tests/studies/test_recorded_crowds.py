"""Two trainings of a navigator among recorded people: cases, pairs of weights, and paired differences."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

import recorded_crowds
from crowdbot.core import InputError
from crowdbot.navigation import policy_file


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """Four people who walk 8 m in 8 s, one after another, and one who stands still."""
    rows = [(f"{k},{4.0 * k + t:.1f},{t - 4.0:.1f},{3.0 * k:.1f}") for k in range(4) for t in range(9)]
    rows += [f"4,{t}.0,20.0,20.0" for t in range(20)]
    path = tmp_path / "hall" / "walkers.csv"
    path.parent.mkdir()
    path.write_text("\n".join(["id,time,x,y", *rows]) + "\n", encoding="utf-8")
    return path


def test_robots_replace_people_who_walk_far_enough(recording: Path) -> None:
    every = recorded_crowds.cases(recording, "reactive", 10)
    assert [trial.name for trial in every] == ["hall-0", "hall-1", "hall-2", "hall-3"]
    assert [trial.recorded[0].exclude for trial in every] == ["0", "1", "2", "3"]
    assert {trial.recorded[0].mode for trial in every} == {"reactive"}
    assert every[1].recorded[0].begin == pytest.approx(4.0)
    assert [trial.duration for trial in every] == pytest.approx([24.0] * 4)
    assert [trial.name for trial in recorded_crowds.cases(recording, "replayed", 2)] == ["hall-0", "hall-3"]
    standing = recording.with_name("standing.csv")
    standing.write_text("id,time,x,y\n" + "".join(f"1,{t}.0,0.0,0.0\n" for t in range(20)), encoding="utf-8")
    with pytest.raises(InputError, match=r"standing.csv: nobody ends at least 5 m from the start"):
        recorded_crowds.cases(standing, "replayed", 2)


def test_differences_are_those_of_the_same_cases() -> None:
    nan = np.nan
    first = np.array([[[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0], [10.0, nan, 12.0, nan]]])
    second = np.array([[[1.0, 1.0, 1.0, 0.0], [0.0, 0.0, 0.0, 0.0], [9.0, 8.0, 10.0, nan]]])
    words = recorded_crowds.row("hall", "replayed", first, second).strip("| ").split(" | ")
    assert words[:3] == ["hall", "replayed", "4"]
    assert [float(word.split()[0]) for word in words[3:]] == [0.5, 0.75, 0.25, -0.5, -1.5]
    gone = np.full((1, 3, 1), nan)  # an impossible case
    more = [np.concatenate([values, gone], axis=2) for values in (first, second)]
    assert recorded_crowds.row("hall", "replayed", *more).strip("| ").split(" | ") == words
    swapped = recorded_crowds.row("hall", "replayed", second, first).strip("| ").split(" | ")
    assert [float(word.split()[0]) for word in swapped[5:]] == [-0.25, 0.5, 1.5]
    both = np.concatenate([first, second])  # two trainings: the second one of each is the same
    half = recorded_crowds.row("hall", "replayed", both, np.concatenate([second, second])).strip("| ").split(" | ")
    assert [float(word.split()[0]) for word in half[3:]] == [0.625, 0.75, 0.125, -0.25, pytest.approx(-0.5)]


def test_differences_of_several_trainings_that_cancel_out_are_0() -> None:
    first = np.zeros((10, 3, 3))
    second = first.copy()
    second[:6, 0, 0], second[:4, 0, 1], second[:2, 0, 2] = 1.0, -1.0, -1.0  # 0.6 - 0.4 - 0.2 leaves 5.6e-17
    words = recorded_crowds.row("hall", "replayed", first, second).strip("| ").split(" | ")
    assert words[5].startswith("0 [")


def test_equal_weights_do_not_differ(
    recording: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for folder in ("one/seed-0", "one/seed-1", "two/seed-1"):
        Path(folder).mkdir(parents=True)
        shutil.copy(policy_file("policy"), folder)
    recorded_crowds.main([str(recording), "--weights", "one", "two", "--people", "2"])
    lines = capsys.readouterr().out.splitlines()
    assert "success, one | success, two" in lines[0]
    assert [line.split(" | ")[:3] for line in lines[2:4]] == [["| hall", "replayed", "2"], ["| hall", "reactive", "2"]]
    assert lines[2].endswith("| 1 [1, 1] | 1 [1, 1] | 0 [0, 0] | 0 [0, 0] | 0 [0, 0] |")
    assert lines[-1] == f"Trainings of each: {Path('seed-1', 'policy.npz')}"
    with pytest.raises(SystemExit):
        recorded_crowds.main([str(recording), "--weights", "one", "none"])
    assert "one and none have no weights of the same name" in capsys.readouterr().err
