"""The page of navigators is written from rows that were run, and keeps those that were not."""

from __future__ import annotations

import importlib.util
import re
import shutil
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from crowdbot.navigation import policy_file

TOOL = Path(__file__).parents[2] / "studies" / "navigators.py"


@pytest.fixture
def tool(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The tool with one other trial, two navigators, and a page of its own."""
    spec = importlib.util.spec_from_file_location("navigators_tool", TOOL)
    assert spec is not None
    assert spec.loader is not None
    module_type = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module_type)
    page = tmp_path / "page.md"
    page.write_text(module_type.PAGE.read_text(encoding="utf-8"), encoding="utf-8")
    monkeypatch.setattr(module_type, "PAGE", page)
    monkeypatch.setattr(module_type, "QUICK_OTHERS", ["straight"])
    monkeypatch.chdir(tmp_path)
    return module_type


def test_the_page_is_what_the_tool_writes_from_its_rows(tool: ModuleType) -> None:
    page = tool.PAGE.read_text(encoding="utf-8")
    lines = tool.lines_of_page(page)
    assert ("crowdnav", "crowdnav-circle-5", "ORCA, margin 0.15 m") in lines
    assert ("severity", "crowdnav-circle-10", "`policy`") in lines
    assert tool.page_text(lines) == page


def test_other_trials_come_behind_the_rows_that_are_kept(tool: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = _without(tool, "others")
    text = tool.PAGE.read_text(encoding="utf-8")
    monkeypatch.setattr(tool, "others", lambda: ["frontal", "leading"])
    monkeypatch.setattr(tool, "SLOW_OTHERS", ["social-force"])
    words = ["--only", "others", "--others", "2", "--slow-others", "1", "--parts", "parts"]
    tool.main([*words, "--minutes", "-1"])
    assert tool.PAGE.read_text(encoding="utf-8") == text
    tool.main(words)
    after = tool.PAGE.read_text(encoding="utf-8")
    assert after.startswith(text)
    lines = tool.lines_of_page(after)
    assert {key: lines[key] for key in kept} == kept
    found = [line.split(" | ")[:3] for key, line in lines.items() if key[0] == "others"]
    rows = [["straight", "2"], ["`social-force`", "1"]]
    assert found == [[f"| `{trial}`", *row] for trial in ("frontal", "leading") for row in rows]


def _without(tool: ModuleType, table: str) -> dict[tuple[str, ...], str]:
    """Return the rows of the page without those of a table, and write it so."""
    rows = tool.lines_of_page(tool.PAGE.read_text(encoding="utf-8")).items()
    kept = {key: line for key, line in rows if key[0] != table}
    tool.PAGE.write_text(tool.page_text(kept), encoding="utf-8")
    return kept


def test_rows_of_the_page_are_not_run_again(
    tool: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    _without(tool, "others")
    monkeypatch.setattr(tool, "others", lambda: ["frontal"])
    monkeypatch.setattr(tool, "SLOW_OTHERS", [])
    words = ["--keep", "--only", "others", "--others", "1", "--parts", "parts"]
    tool.main(words)
    page = tool.PAGE.read_text(encoding="utf-8")
    assert "| `frontal` | straight | " in page.split(tool.OTHERS)[1]
    assert page.endswith("|\n")
    tool.main(words)
    assert "0 of 0 rows" in capsys.readouterr().out
    assert tool.PAGE.read_text(encoding="utf-8") == page


def test_an_incomplete_page_has_the_rows_that_are_there(tool: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tool, "others", lambda: ["frontal"])
    kept = _without(tool, "others")
    tool.main(["--only", "others", "--others", "1", "--minutes", "-1", "--incomplete"])
    assert tool.PAGE.read_text(encoding="utf-8") == tool.page_text(kept)
    with pytest.raises(SystemExit):
        tool.parse_options(["--only", "others"])


def test_the_table_of_crowds_has_crowds_perception_and_trainings(
    tool: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(tool, "CROWDED", ("circle-crossing people=1",))
    monkeypatch.setattr(tool, "CROWDS", ("social-force",))
    monkeypatch.setattr(tool, "ALL", ["policy"])
    for seed in (0, 1):
        (tmp_path / "weights" / f"seed-{seed}").mkdir(parents=True)
        shutil.copy(policy_file("policy"), tmp_path / "weights" / f"seed-{seed}")
    words = ["--only", "crowds", "--crowds", "1", "--weights", "weights"]
    rows = tool.rows_of(tool.parse_options(words))
    variants = [row.variant() for row in rows]
    assert [len(row.files) for row in rows] == [0, 0, 2, 2]
    assert [type(trial.crowd).__name__ for trial in variants] == ["SocialForce"] * 4
    assert [trial.robots[0].people for trial in variants] == ["true", "tracked"] * 2
    before = _without(tool, "crowds")
    tool.main(words)
    page = tool.PAGE.read_text(encoding="utf-8")
    lines = tool.lines_of_page(page)
    assert {key: lines[key] for key in before} == before
    assert tool.page_text(lines) == page
    found = {key[2:]: text.strip("| ").split(" | ")[4:] for key, text in lines.items() if key[0] == "crowds"}
    assert len(found) == 4
    one, many = (found["social-force", "tracked", name] for name in ("`policy`", "`policy`, 2 trainings"))
    assert (one[0], many[0], len(one), len(many)) == ("1", "2", 7, 7)
    assert many[1] == f"{one[1].split()[0]} ± 0"
    section = page.split(tool.COMBINED)[1].split(tool.OTHERS)[0]
    assert "| navigator | social-force, true | social-force, tracked |" in section
    assert f"| `policy`, 2 trainings | {float(one[1].split()[0]):.2f} / " in section
    capsys.readouterr()
    tool.main(words)
    assert tool.PAGE.read_text(encoding="utf-8") == page  # nothing ran again, also not the measured times
    with pytest.raises(SystemExit):
        tool.parse_options(["--only", "crowds"])
    assert "--only crowds needs the number of seeds of this table, such as --crowds 10" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        tool.parse_options([*words[:4], "--weights", "none"])
    assert "--weights none has no trainings" in capsys.readouterr().err


def test_what_the_table_of_crowds_shows_is_in_its_means(tool: ModuleType) -> None:
    rows = [text.strip("| ").split(" | ") for text in tool.summary(_lines(tool)).splitlines()[2:]]
    means = {name: np.array([[float(word) for word in cell.split(" / ")] for cell in cells]) for name, *cells in rows}
    knows = np.mean([value for name, value in means.items() if name != "straight" and "scan" not in name], axis=0)[:, 0]
    best = np.stack([means[f"`{name}`"][:4, 0] for name in ("mppi", "mpc", "attention-policy")])
    whole = {name: value.mean(axis=0) for name, value in means.items()}
    numbers = [
        *(best.min(), best.max(), max(value[4:, 0].max() for value in means.values())),
        *knows,
        *(whole["`social-force`"][1], whole["`social-force`"][0], whole["`policy`"][0]),
        *(whole["`attention-policy`"][0], whole["`attention-policy`, 5 trainings"][0]),
    ]
    told = re.findall(r"0\.\d\d", tool.SHOWN)
    assert len(told) == len(numbers)
    for number, text in zip(numbers, told, strict=True):
        assert float(text) == pytest.approx(number, abs=0.006)
    assert " 0.6 ± 0.55 " in _lines(tool)["crowds", "doorway", "orca", "true", "`attention-policy`, 5 trainings"]


def _lines(tool: ModuleType) -> dict[tuple[str, ...], str]:
    found: dict[tuple[str, ...], str] = tool.lines_of_page(tool.PAGE.read_text(encoding="utf-8"))
    return found


def test_means_over_trials_need_all_of_them(tool: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tool, "CROWDED", ("block", "doorway"))
    text = "| `block` | orca | true | `mpc` | 10 | 0.5 [0.2, 0.8] | 0.1 [0, 0.3] | 0.4 [0.1, 0.7] | 9 | 0 | 2 |"
    lines = {("crowds", "block", "orca", "true", "`mpc`"): text}
    columns = 2 * len(tool.CROWDS)
    assert tool.summary(lines).splitlines()[-1] == f"| `mpc` | {' | '.join('-' * columns)} |"
    lines["crowds", "doorway", "orca", "true", "`mpc`"] = text.replace("0.5 [", "1 [")
    assert tool.summary(lines).splitlines()[-1].split(" | ")[3] == "0.75 / 0.10"
