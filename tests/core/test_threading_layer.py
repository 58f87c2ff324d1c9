"""Parallel kernels after a fork, from several Python threads, and both, on every threading layer."""

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from crowdbot.core import threading_layer
from samples import sample

PROGRAM = Path(__file__).with_name("parallel_work.py")
STEPS = ["work", "fork", "threads", "fork-threads"]
RESTING = ["work", "fork-during", "fork-from-thread"]
"""Steps in which a fork waits until the threads of the layer sleep."""
CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
LAYERS = ["tbb", "workqueue"] if CORES > 1 else ["workqueue"]
"""Layers that may run: oneTBB has no threads of its own on one core."""

NESTED = """
import numpy as np
from numba import prange
from crowdbot.core import kernel


@kernel(parallel=True)
def double(values, out):
    for i in prange(len(values)):
        out[i] = 2.0 * values[i]


@kernel(parallel=True)
def both(values, out):
    double(values, out)
    for i in prange(len(values)):
        out[i] += 1.0


@kernel
def serial(values, out):
    double(values, out)
    out[0] = -1.0


found = np.zeros(4)
both(np.arange(4.0), found)
print(found.tolist())
serial(np.arange(4.0), found)
print(found.tolist(), double.__name__, double.__doc__, type(serial) is type(double))
"""


def run(program, *words, **environment):
    kept = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    done = subprocess.run(
        [sys.executable, str(program), *words],
        env={**kept, "NUMBA_NUM_THREADS": "2", **environment},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def results(*words, **environment):
    lines = [line.split() for line in run(PROGRAM, *words, **environment).splitlines() if line.startswith("result ")]
    return {word: value for _, word, *value in lines}


def assert_same_bytes(steps, layer):
    found = results(*steps, "layer", NUMBA_THREADING_LAYER=layer)
    assert found.pop("layer") == [layer]
    assert set(found) == set(steps)
    assert len(found["work"]) == 1
    assert {step: value for step, value in found.items() if value != found["work"]} == {}


@pytest.mark.program
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no fork")
@pytest.mark.parametrize("layer", LAYERS)
def test_forks_and_threads_get_the_same_bytes(layer):
    assert_same_bytes(STEPS, layer)


@pytest.mark.live
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no fork")
@pytest.mark.parametrize("layer", LAYERS)
def test_forks_beside_and_in_other_threads_get_the_same_bytes(layer):
    assert_same_bytes(RESTING, layer)


@pytest.mark.sweep
def test_every_layer_and_number_of_threads_gives_the_same_bytes():
    found = [results("work", NUMBA_THREADING_LAYER=layer, NUMBA_NUM_THREADS=n) for layer in LAYERS for n in "12"]
    assert found[0]["work"]
    assert all(other == found[0] for other in found)


@pytest.mark.program
def test_tbb_is_found_in_its_wheel_and_gives_the_bytes_of_one_thread():
    found = results("work", "layer")
    assert found["layer"] == [LAYERS[0]]
    assert found["work"] == results("work", NUMBA_THREADING_LAYER="workqueue", NUMBA_NUM_THREADS="1")["work"]


@pytest.mark.program
@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not bind a process to cores so")
def test_on_one_core_a_program_that_begins_in_another_thread_ends(tmp_path):
    program = tmp_path / "on_one_core.py"
    program.write_text(
        "import os, runpy\n"
        "os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n"
        f"runpy.run_path({str(PROGRAM)!r}, run_name='__main__')\n"
    )
    found = [line.split()[1:] for line in run(program, "threads", "fork", "layer").splitlines()]
    assert found[2] == ["layer", "workqueue"]
    assert found[0][1] == found[1][1]


@pytest.mark.program
def test_workqueue_is_taken_if_there_is_no_tbb(monkeypatch, tmp_path):
    program = tmp_path / "without_tbb.py"
    program.write_text(
        "import importlib.metadata, runpy, sys\n"
        "real = importlib.metadata.files\n"
        "def files(name):\n"
        "    if name == 'tbb':\n"
        "        raise importlib.metadata.PackageNotFoundError(name)\n"
        "    return real(name)\n"
        "importlib.metadata.files = files\n"
        f"runpy.run_path({str(PROGRAM)!r}, run_name='__main__')\n"
    )
    done = run(program, "threads", "layer").splitlines()
    assert done[1].split()[1:] in (["layer", "workqueue"], ["layer", "tbb"])  # tbb: one that the system itself offers
    assert len(done[0].split()) == 3


@pytest.mark.program
@pytest.mark.parametrize("layer", sample(LAYERS, 1))
def test_other_kernels_call_parallel_ones(layer, tmp_path):
    program = tmp_path / "nested.py"
    program.write_text(NESTED)
    printed = run(program, NUMBA_THREADING_LAYER=layer, CROWDBOT_CACHE=str(tmp_path / "cache")).splitlines()
    assert printed == ["[1.0, 3.0, 5.0, 7.0]", "[-1.0, 2.0, 4.0, 6.0] double None True"]


@pytest.mark.program
def test_without_the_compiler_a_kernel_is_the_function_itself(tmp_path):
    program = tmp_path / "nested.py"
    program.write_text(NESTED)
    assert run(program, NUMBA_DISABLE_JIT="1").startswith("[1.0, 3.0, 5.0, 7.0]\n")


@pytest.mark.program
@pytest.mark.parametrize("given", sample(["omp workqueue tbb", None], 1))
def test_an_order_of_layers_given_by_the_user_stays(given, tmp_path):
    program = tmp_path / "order.py"
    program.write_text(
        "import numba; from crowdbot.core.geometry import time_to_contact\n"
        "time_to_contact(2.0, 0.0, 1.0, 0.0, 1.0)\n"
        "print(*numba.config.THREADING_LAYER_PRIORITY)"
    )
    settings = {} if given is None else {"NUMBA_THREADING_LAYER_PRIORITY": given}
    chosen = "tbb workqueue omp" if CORES > 1 else "workqueue tbb omp"
    assert run(program, **settings).strip() == (given or chosen)


def test_a_library_that_does_not_load_is_left_out(monkeypatch, tmp_path):
    broken = tmp_path / threading_layer.LIBRARY
    broken.write_text("no library")
    tried = []

    class File:
        name = broken.name

        def locate(self):
            tried.append(self.name)
            return broken

    monkeypatch.setattr("importlib.metadata.files", lambda name: [File()])
    threading_layer.prefer_safe_layers()
    assert tried == [broken.name]


def test_a_library_without_the_function_leaves_the_count_of_numba():
    assert threading_layer._allowed_threads(None) == numba.config.NUMBA_DEFAULT_NUM_THREADS
    assert threading_layer._allowed_threads(ctypes.CDLL(None)) == numba.config.NUMBA_DEFAULT_NUM_THREADS


@pytest.mark.live
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no fork")
def test_a_fork_waits_for_kernels_of_other_threads_but_not_for_ever(monkeypatch):
    monkeypatch.setattr(threading_layer, "PATIENCE", 0.2)
    threading_layer._running.add("a kernel that never ends")
    child = os.fork()
    if child == 0:
        os._exit(len(threading_layer._running))
    threading_layer._running.clear()
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
