"""The page of navigators is written from rows that were run, and keeps those that were not."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

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
    kept = _without_others(tool)
    text = tool.PAGE.read_text(encoding="utf-8")
    monkeypatch.setattr(tool, "others", lambda: ["frontal", "leading"])
    monkeypatch.setattr(tool, "SLOW_OTHERS", ["social-force"])
    words = ["--only-others", "--others", "2", "--slow-others", "1", "--parts", "parts"]
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


def _without_others(tool: ModuleType) -> dict[tuple[str, str, str], str]:
    """Return the rows of the page without those of the other trials, and write it so."""
    rows = tool.lines_of_page(tool.PAGE.read_text(encoding="utf-8")).items()
    kept = {key: line for key, line in rows if key[0] != "others"}
    tool.PAGE.write_text(tool.page_text(kept), encoding="utf-8")
    return kept


def test_rows_of_the_page_are_not_run_again(
    tool: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    _without_others(tool)
    monkeypatch.setattr(tool, "others", lambda: ["frontal"])
    monkeypatch.setattr(tool, "SLOW_OTHERS", [])
    words = ["--keep", "--only-others", "--others", "1", "--parts", "parts"]
    tool.main(words)
    page = tool.PAGE.read_text(encoding="utf-8")
    assert "| `frontal` | straight | " in page.split(tool.OTHERS)[1]
    assert page.endswith("|\n")
    tool.main(words)
    assert "0 of 0 rows" in capsys.readouterr().out
    assert tool.PAGE.read_text(encoding="utf-8") == page


def test_an_incomplete_page_has_the_rows_that_are_there(tool: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tool, "others", lambda: ["frontal"])
    kept = _without_others(tool)
    tool.main(["--only-others", "--others", "1", "--minutes", "-1", "--incomplete"])
    assert tool.PAGE.read_text(encoding="utf-8") == tool.page_text(kept)
    with pytest.raises(SystemExit):
        tool.parse_options(["--only-others"])
