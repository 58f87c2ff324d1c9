"""The kernel cache: keyed by sources, placed where asked, warm in the next process."""

import gc
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba.core import event

import crowdbot
from crowdbot.core import kernels, prange
from crowdbot.typing import Floats

LENGTH, TABLE = 1.0, np.zeros(2)


@kernels.kernel
def inner(x):
    return x * LENGTH


@kernels.kernel
def outer(x):
    return inner(x) + TABLE[1]


@kernels.kernel
def add(values: Floats, index: int, amount: float) -> None:
    values[index] += amount


@kernels.kernel(parallel=True)
def add_everywhere(values: Floats) -> None:
    for k in prange(len(values)):
        add(values, k, 1.0)


@kernels.kernel
def add_at_three(values: Floats, index: int) -> None:
    add(values, 0, 1.0)
    add(values, 1, 1.0)
    add(values, index, 1.0)


PROGRAM = """
import sys
from crowdbot.core import kernels
from crowdbot.core.geometry import ray_to_disc
before = kernels.is_cold()
assert ray_to_disc(0.0, 0.0, 1.0, 0.0, 5.0, 0.0, 1.0) == 4.0
print(before, kernels.is_cold(), sum(ray_to_disc.dispatcher.stats.cache_hits.values()))
"""


TOLD = """
import sys
import numba
from crowdbot.cli.output import progress
from crowdbot.core.geometry import ray_to_disc
own = numba.njit(lambda x: x + 1)
with progress(sys.argv[1] == "quiet") as report:
    assert own(1) == 2
    print("a", end=" ", file=sys.stderr, flush=True)
    assert ray_to_disc(0.0, 0.0, 1.0, 0.0, 5.0, 0.0, 1.0) == 4.0
    assert ray_to_disc(0, 0, 1.0, 0.0, 5.0, 0.0, 1.0) == 4.0
"""


def _run(folder, program=PROGRAM, *words, path=None):
    places = {"CROWDBOT_CACHE": str(folder)} | ({"PYTHONPATH": str(path)} if path else {})
    done = subprocess.run(
        [sys.executable, "-c", program, *words],
        env={**os.environ, **places},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split() if program == PROGRAM else done.stderr


def test_constants_and_indices_of_parallel_loops_compile_nothing_anew(monkeypatch, tmp_path):
    monkeypatch.setattr(kernels, "cache_folder", lambda: tmp_path)  # nothing is there from an earlier run of the test
    values = np.zeros(3)
    add_at_three(values, 2)
    assert values.tolist() == [1.0, 1.0, 1.0]
    add_everywhere(values)
    assert values.tolist() == [2.0, 2.0, 2.0]
    assert len(add.signatures) == 1
    add(values, 0, 1.0)
    assert values.tolist() == [3.0, 2.0, 2.0]
    assert len(add.signatures) == 2  # with the wrapper for calls from Python, which calls in kernels do without


def test_garbage_is_collected_seldom_while_a_kernel_is_compiled_and_as_before_afterwards():
    assert add.dispatcher  # numba is loaded
    usual = gc.get_threshold()
    with event.trigger_event("numba:compile"):
        with event.trigger_event("numba:compile"):
            assert gc.get_threshold()[0] == kernels.OBJECTS
        assert gc.get_threshold() == (kernels.OBJECTS, *usual[1:])
    assert gc.get_threshold() == usual


@pytest.mark.program
def test_cold_then_warm(tmp_path):
    assert _run(tmp_path) == ["True", "False", "0"]
    assert _run(tmp_path) == ["False", "False", "1"]


@pytest.mark.program
def test_another_installation_of_the_same_sources_is_warm(tmp_path):
    source = Path(crowdbot.__file__).parent
    for name in ("one", "other"):
        for path in source.rglob("*.py"):
            place = tmp_path / name / path.relative_to(source.parent)
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, place)
    found = [_run(tmp_path / "cache", path=tmp_path / name) for name in ("one", "other")]
    assert found == [["True", "False", "0"], ["False", "False", "1"]]


def test_a_constant_of_another_file_is_part_of_the_key_of_a_kernel(monkeypatch):
    locator, stamps = kernels._PackageLocator(outer.py_func, Path()), []
    for length, table in ((1.0, np.zeros(5000)), (2.0, np.zeros(5000)), (2.0, np.eye(5000)[2500])):
        monkeypatch.setitem(globals(), "LENGTH", length)
        monkeypatch.setitem(globals(), "TABLE", table)
        stamps.append(locator.get_source_stamp())
    assert len(set(stamps)) == 3
    assert locator.get_source_stamp() == stamps[2]


@pytest.mark.program
def test_who_waits_for_kernels_of_ours_is_told_once_and_why(tmp_path):
    told = _run(tmp_path, TOLD, "plain")
    assert told.startswith("a first run: compiling kernels once, into " + str(tmp_path))
    assert told.count("\n") == told.count("compiling") == 1
    assert _run(tmp_path, TOLD, "plain") == "a "
    assert _run(tmp_path / "other", TOLD, "quiet") == "a "


def test_the_key_changes_with_any_kernel_source(tmp_path, monkeypatch):
    package = tmp_path / "crowdbot"
    (package / "core").mkdir(parents=True)
    (package / "models").mkdir()
    (package / "core" / "kernels.py").write_text("")
    model = package / "models" / "model.py"
    model.write_text("@kernel\ndef f(x): return x\n")
    monkeypatch.setattr(kernels, "__file__", str(package / "core" / "kernels.py"))
    first = kernels._source_key()
    model.write_text("@kernel\ndef f(x): return 2 * x\n")
    second = kernels._source_key()
    (package / "models" / "words.py").write_text("no kernel here")
    assert first != second == kernels._source_key()
