"""The notebooks run from top to bottom, hold no outputs, and show drawings."""

from __future__ import annotations

import ast
import json
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from pages import ROOT

import crowdbot as cb
from crowdbot.core import Disc, Path2D, draw_svg
from crowdbot.data import Forecast
from crowdbot.recording import record
from crowdbot.trials import builtin_trials
from samples import sample

NOTEBOOKS = sorted((ROOT / "examples").glob("*.ipynb"))


def cells(file: Path) -> list[dict[str, Any]]:
    return [cell for cell in json.loads(file.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]


def stem(file: Path) -> str:
    return file.stem


def run(source: str, names: dict[str, Any]) -> object:
    """Run one cell and return the value of its last expression, as a notebook shows it."""
    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    return None if last is None else eval(compile(ast.Expression(last.value), "cell", "eval"), names)


@pytest.mark.parametrize("file", sample(NOTEBOOKS, [ROOT / "examples" / "predict_a_recording.ipynb"]), ids=stem)
def test_a_notebook_runs(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "__main__"}
    shown = [run("".join(cell["source"]), names) for cell in cells(file)]
    drawings = [value._repr_svg_() for value in shown if hasattr(value, "_repr_svg_")]
    assert drawings
    for drawing in drawings:
        assert ElementTree.fromstring(drawing).tag.endswith("svg")


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_stores_no_output(file: Path) -> None:
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells(file))


def test_there_are_notebooks() -> None:
    listed = (ROOT / "examples" / "README.md").read_text(encoding="utf-8")
    assert len(NOTEBOOKS) == 5
    assert all(f"]({file.name})" in listed for file in NOTEBOOKS)


def test_every_builtin_trial_shows_itself() -> None:
    for name in builtin_trials():
        drawing = cb.load_trial(name)._repr_svg_()
        assert name in drawing
        assert "nan" not in ElementTree.fromstring(drawing).attrib["viewBox"]


@pytest.mark.parametrize("name", ["whole", "branch", "killed"])
def test_a_recorded_episode_shows_itself(name: str, tmp_path: Path) -> None:
    file = tmp_path / "episode.mcap"
    record(replace(cb.load_trial("frontal"), duration=2.0), 3, file)
    if name == "branch":
        file = tmp_path / "branch.mcap"
        cb.branch(tmp_path / "episode.mcap", 1.0, seed=9, out=file)
    elif name == "killed":
        whole = file.read_bytes()
        file.write_bytes(whole[: len(whole) * 3 // 4])
    episode = cb.read_episode(file)
    assert episode.complete == (name != "killed")
    drawing = episode._repr_svg_()
    assert f"{episode.name}, seed {episode.seed}" in drawing
    tracks = episode.tracks(0.2)
    assert len(np.unique(tracks.frame)) == (len(episode.times) + 1) // 2
    assert "nan" not in ElementTree.fromstring(drawing).attrib["viewBox"]


def test_a_drawing_keeps_to_its_axes() -> None:
    drawing = ElementTree.fromstring(draw_svg([Path2D(np.array([[0.0, 0.0], [4.0, 2.0]]))], [Disc(4.0, 2.0, 0.0)]))
    path, disc = drawing
    x, y = path.attrib["d"].removeprefix("M").split()[1].split(",")
    assert (disc.attrib["cx"], disc.attrib["cy"]) == (x, y)
    left, bottom = path.attrib["d"].removeprefix("M").split()[0].split(",")
    assert float(left) < float(x)
    assert float(bottom) > float(y)  # y points upwards


def test_gaps_and_nothing_are_drawn() -> None:
    gap = np.array([[0.0, 0.0], [1.0, 0.0], [np.nan, np.nan], [2.0, 0.0], [3.0, 0.0]])
    (path,) = ElementTree.fromstring(draw_svg([Path2D(gap)]))
    assert path.attrib["d"].count("M") == 2
    assert len(ElementTree.fromstring(draw_svg([]))) == 0


def test_a_forecast_without_windows_or_people_shows_itself() -> None:
    none = Forecast.of(np.zeros((0, 1, 3, 2, 2)), np.zeros((0, 2), dtype=bool), 0.4, "mine")
    empty = Forecast.of(np.zeros((1, 1, 3, 2, 2)), np.zeros((1, 2), dtype=bool), 0.4, "mine")
    assert "no windows" in none._repr_svg_()
    assert "0 people" in empty._repr_svg_()
