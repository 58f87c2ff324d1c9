"""The benchmark of crowd models beside other engines: ``crowdbot bench engines``."""

from __future__ import annotations

import json
import logging
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from crowdbot.benchmark import EngineSizes, measure_engines
from crowdbot.benchmark.engines.peers import JuPedSimPeer, Rvo2Peer
from crowdbot.benchmark.engines.report import kernel_threads, time_steps
from crowdbot.benchmark.speed.workloads import crowd
from crowdbot.cli import main
from crowdbot.core import InputError, MissingExtra

HEADERS = {
    "Vector2.h": """#pragma once
namespace RVO { struct Vector2 { float x, y; Vector2(float a, float b) : x(a), y(b) {} }; }
""",
    "RVOSimulator.h": """#pragma once
#include <cstddef>
#include <vector>
#include "Export.h"
#include "Vector2.h"
namespace RVO {
class RVOSimulator {
 public:
  void setTimeStep(float) {}
  void setAgentDefaults(float, std::size_t, float, float, float, float) {}
  std::size_t addAgent(const Vector2 &place) { places.push_back(place); return places.size() - 1; }
  void setAgentVelocity(std::size_t, const Vector2 &) {}
  void setAgentPrefVelocity(std::size_t, const Vector2 &) {}
  void setAgentRadius(std::size_t, float) {}
  void setAgentMaxSpeed(std::size_t, float) {}
  void doStep();
  std::vector<Vector2> places;
};
}
""",
    "Agent.cc": """#include "RVOSimulator.h"
void RVO::RVOSimulator::doStep() { for (auto &place : places) place.x += 1.0F; }
""",
}
"""A library with the interface of RVO2."""


@pytest.fixture
def no_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("pyrvo", "jupedsim", "navground", "navground.core", "navground.sim", "pysocialforce"):
        monkeypatch.setitem(sys.modules, module, None)


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("CROWDBOT_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "rvo2" / "src"
    folder.mkdir(parents=True)
    for name, text in HEADERS.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder.parent


@pytest.mark.live
@pytest.mark.usefixtures("no_packages")
def test_a_library_is_compiled_from_its_source_and_measured(source: Path, tmp_path: Path, capsys) -> None:
    out = tmp_path / "engines.json"
    words = ["bench", "engines", "--quick", "--repeats", "2", "--rvo2", str(source), "--json", "--out", str(out)]
    assert main(words) == 0
    printed = capsys.readouterr()
    document = json.loads(printed.out)
    assert json.loads(out.read_text()) == document
    rows = [(row["model"], row["engine"], row["people"], row["order"], row["threads"]) for row in document["rows"]]
    assert ("orca", "RVO2", 1000, "random", 1) in rows
    assert ("orca", "RVO2", 1000, "sorted", 1) in rows
    for row in document["rows"]:
        assert row["theirs"] < row["ours"], "adding 1 is faster than ORCA"
        assert 0.0 < row["low"] <= row["ratio"] <= row["high"] < 1.0
    assert document["million"]["people"] == 2000
    assert document["million"]["seconds"] > 0.0
    assert document["million"]["megabytes"] > 50.0
    assert set(document["missing"]) == {"JuPedSim", "navground", "PySocialForce"}
    assert logging.root.manager.disable == logging.NOTSET  # messages of others are silent only while one is imported
    assert "crowdbot: the comparison with JuPedSim needs the extra [peers]" in printed.err
    assert "alternate" in document["protocol"]
    assert any("from source" in engine for engine in document["protocols"])


@pytest.mark.live
@pytest.mark.usefixtures("no_packages")
def test_the_command_names_missing_engines_and_prints_a_table(capsys) -> None:
    assert main(["bench", "engines", "--quick", "--repeats", "1"]) == 0
    printed = capsys.readouterr()
    assert "2000 people, orca:" in printed.out
    assert "the comparison with RVO2 needs the extra [peers]: pip install 'crowdbot[peers]'" in printed.err


def test_jupedsim_walks_in_the_same_run() -> None:
    report = measure_engines(EngineSizes(repeats=1, people=1000, million=0))
    row = next(row for row in report.rows if row.engine == "JuPedSim")
    assert row.model == "collision-free-speed"
    assert row.dt == 0.01
    assert row.ratio > 0.0
    assert report.versions["jupedsim"]
    assert report.million is None


@pytest.mark.parametrize(("count", "expected"), [(1, (1,)), (2, (1, 2)), (8, (1, 2))])
def test_no_row_has_more_threads_than_kernels(count: int, expected: tuple[int, ...], monkeypatch) -> None:
    monkeypatch.setattr("numba.config.NUMBA_NUM_THREADS", count)
    assert JuPedSimPeer().threads() == expected


def test_people_of_jupedsim_move() -> None:
    scene = crowd(30)
    step = JuPedSimPeer().step(scene)
    simulation = step.__self__  # type: ignore[attr-defined]
    before = np.array([agent.position for agent in simulation.agents()])
    for _ in range(10):
        step()
    moved = np.linalg.norm(np.array([agent.position for agent in simulation.agents()]) - before, axis=1)
    assert 0.03 < np.median(moved) < 0.2, "ten steps of 0.01 s"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["engines", "orca-1000"], "engines is measured alone"),
        (["engines", "--data", "x.txt"], "engines is measured alone"),
        (["orca-1000", "--rvo2", "x"], "--rvo2 belongs to crowdbot bench engines"),
        (["engines", "--rvo2", "nowhere"], "nowhere has no source of RVO2: there is no Agent.cc or Agent.cpp"),
        (["engines", "--quick", "--repeats", "0"], "repeats 0 is below 1"),
    ],
)
def test_wrong_engine_options(capsys, words: list[str], message: str) -> None:
    assert main(["bench", *words]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.program
def test_a_broken_source_is_told(source: Path) -> None:
    (source / "src" / "Agent.cc").write_text("void nothing( {", encoding="utf-8")
    with pytest.raises(InputError, match=r"cannot be compiled: .*error"):
        Rvo2Peer(source)


@pytest.mark.usefixtures("no_packages")
def test_without_source_and_package_the_extra_is_named() -> None:
    with pytest.raises(MissingExtra, match="RVO2 needs the extra"):
        Rvo2Peer()


def test_steps_alternate_and_threads_are_given_back() -> None:
    import numba

    before = numba.get_num_threads()
    calls: list[str] = []

    def start(name: str, seconds: float):
        calls.append(name)
        return lambda: time.sleep(seconds)

    with kernel_threads(1):
        assert numba.get_num_threads() == 1
        found = time_steps(lambda: start("a", 0.002), lambda: start("b", 0.02), 2, 3)
    assert numba.get_num_threads() == before
    assert calls == ["a", "b"] * 3
    assert found.shape == (2, 3)
    assert (found[0] > 0.0015).all()
    assert (found[1] > 0.018).all()
