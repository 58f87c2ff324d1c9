"""The page of crowds in trials: its head names what its tables miss, and its text is that of the study."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import trial_crowds
from trial_crowds import FILE, TEXT, Runs, forward_speed, misses, own_trial

PAGE = Path(__file__).parents[2] / "docs" / "results" / "trial-crowds.md"


def page_rows() -> dict[str, list[str]]:
    """Return the rows of the four measured tables of the page, by their name in the study."""
    titles = {"one": "One-way corridor", "two": "Two-way corridor", "file": "Single file", "door": "Doors"}
    parts = dict(part.split("\n", 1) for part in PAGE.read_text(encoding="utf-8").split("\n## ")[1:])
    return {name: re.findall(r"^\| *\d.*\|$", parts[title], re.MULTILINE) for name, title in titles.items()}


def test_the_head_of_the_page_is_that_of_its_tables() -> None:
    rows = page_rows()
    assert [len(own) for own in rows.values()] == [6, 8, 3, 5]
    assert misses(rows) in PAGE.read_text(encoding="utf-8")


def test_the_text_of_the_page_is_that_of_the_study() -> None:
    page = PAGE.read_text(encoding="utf-8")
    parts = re.split(r"\{\w+(?::g)?\}", TEXT)
    places = [page.find(part) for part in parts]
    assert min(places) >= 0, parts[int(np.argmin(places))]
    assert page.startswith(parts[0])
    assert page.endswith(parts[-1])


def test_only_rows_beyond_experiments_are_named() -> None:
    rows = {
        "one": ["| 0.5 | 1.25 (1.2 to 1.3) | 1.30 | -0.05 |", "| 2 | 0.93 (0.9 to 1.0) | 0.61 | +0.32 |"],
        "two": ["| 4 | 1 | 0.98 (0.9 to 1.0) | 0.78 | 0 |", "| 4 | 2 | 0.01 (0.0 to 0.1) | - | 19 |"],
        "file": [],
        "door": ["| 0.8 | 1.58 (1.4 to 1.8) | 6 |", "| 1 | 1.98 (1.8 to 2.1) | 0 |"],
    }
    assert misses(rows).splitlines() == [
        "* Two-way flows jam: 19 of 20 at 2 people/m2 (4 m wide). People walk on.",
        "* One-way crowds against Weidmann 1993: +0.32 m/s at 2 people/m2.",
        "* Crowds of 60 clog in doors: 6 of 20 at 0.8 m.",
    ]


def test_runs_take_other_values_of_the_crowd() -> None:
    trial = own_trial(FILE, count=25)
    speeds = []
    for gap in (0.9, 3.0):
        (episode,) = Runs(seeds=1, seconds=4.0, values={"headway_time_gap": gap}).of(trial)
        assert episode.times[-1] == pytest.approx(4.0)
        speeds.append(forward_speed(episode))
    assert speeds[1] < speeds[0]


def test_an_unknown_row_is_an_error(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.argv", ["trial_crowds.py", "--row", "three-way", "4"])
    with pytest.raises(SystemExit):
        trial_crowds.main()
    assert "--row three-way: there is no such row; give one of one-way, two-way" in capsys.readouterr().err
