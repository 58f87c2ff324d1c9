"""The page "write your first trial": every step of it is done, as a reader would do it."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from crowdbot.cli import main
from crowdbot.trials import load_trial

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "tutorials" / "first-trial.md").read_text(encoding="utf-8")
ELEMENTS = (DOCS / "reference" / "trial-file.md").read_text(encoding="utf-8")
STEPS = re.split(r"^## \d+\. ", PAGE.split("\n## More")[0], flags=re.M)[1:]


def blocks(step: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", step, flags=re.S)


def test_there_are_fewer_than_ten_steps() -> None:
    assert 6 <= len(STEPS) < 10


def test_each_step_does_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "hall.xml"
    said = []
    for number, step in enumerate(STEPS, 1):
        for block in blocks(step, "xml"):
            if block.startswith("<trial"):
                file.write_text(block, encoding="utf-8")
            else:
                file.write_text(file.read_text(encoding="utf-8").replace("</trial>", block + "</trial>"))
            load_trial(file)
        for command in (line for block in blocks(step, "console") for line in block.splitlines() if line[:2] == "$ "):
            words = shlex.split(command[2:])
            assert words[0] == "crowdbot"
            assert main(words[1:]) == 0, (number, command)
            said.append(capsys.readouterr().out)
    check, run, replay, straight, many, sixth, new, people = said
    assert check == "hall.xml: OK\n"
    assert "outcome" in run
    assert "replays with the same digest" in replay
    assert "hall, seed 5" in straight
    assert many.count("[count") == 12
    assert "[count 10, seed 1]" in sixth
    assert new.startswith("wrote people.xml\n")
    assert "crossing-flows, seed 3" in people
    assert len(load_trial(tmp_path / "people.xml").agents) == 40
    assert sorted(path.name for path in tmp_path.iterdir()) == ["first", "hall.xml", "people.xml", "test_people.py"]


def test_every_element_of_the_pages_exists() -> None:
    from crowdbot.trials import schema

    known = set(re.findall(r'<xs:element name="([a-z-]+)"', schema()))
    for page in (PAGE, ELEMENTS):
        assert set(re.findall(r"`?<([a-z-]+)[ >`/]", page)) <= known


def test_every_attribute_of_the_reference_exists() -> None:
    from crowdbot.trials import schema

    known = set(re.findall(r'<xs:attribute name="([a-z-]+)"', schema()))
    elements = re.findall(r"`<[a-z-]+ ([^<>`]*)/?>`", ELEMENTS)
    named = {word for text in elements for word in re.findall(r"[a-z-]+", re.sub(r'"[^"]*"', "", text))}
    named |= set(re.findall(r'`([a-z-]+)="', ELEMENTS))
    assert len(named) > 30
    assert named <= known
