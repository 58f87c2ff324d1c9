"""Kernels of the first trial are compiled by other processes, which never outlive the server."""

import subprocess
import sys
import threading

import pytest

from crowdbot.core import cache_folder
from crowdbot.web.simulator import kernel_preparation
from crowdbot.web.simulator.kernel_preparation import MARK, PROGRAMS, prepare_kernels

pytestmark = pytest.mark.live


@pytest.fixture
def cold(tmp_path, monkeypatch):
    """An empty folder of kernels, and the programs that were started for it."""
    started, inner = [], subprocess.Popen

    def start(words, **options):
        started.append(inner(words, **options))
        return started[-1]

    monkeypatch.setattr(kernel_preparation, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(kernel_preparation.subprocess, "Popen", start)
    return tmp_path, started


def test_the_kernels_of_the_first_trial_are_in_the_cache_afterwards():
    mark = cache_folder() / MARK
    mark.unlink(missing_ok=True)
    told = []
    prepare_kernels(lambda: False, lambda: told.append("compiling"))
    assert mark.is_file()
    prepare_kernels(lambda: False, lambda: told.append("again"))
    assert told == ["compiling"]


def test_each_program_ends_well():
    for program in PROGRAMS:
        with subprocess.Popen([sys.executable, "-c", program], stdin=subprocess.PIPE) as process:
            assert process.wait(600) == 0


def test_sessions_that_start_together_compile_once(cold, monkeypatch):
    folder, started = cold
    program = f"import pathlib, time; time.sleep(1); pathlib.Path({str(folder / MARK)!r}).touch()"
    monkeypatch.setattr(kernel_preparation, "PROGRAMS", (program, program))
    threads = [threading.Thread(target=prepare_kernels, args=(lambda: False, lambda: None)) for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert (folder / MARK).is_file()
    assert len(started) == 2


def test_a_process_that_fails_is_not_repeated(cold, monkeypatch):
    _, started = cold
    wait = "import sys; sys.stdin.read()"
    monkeypatch.setattr(kernel_preparation, "PROGRAMS", ("raise SystemExit(3)", wait))
    prepare_kernels(lambda: False, lambda: None)
    assert started[0].returncode == 3
    assert [item.poll() is None for item in started] == [False, False]


def test_closing_ends_the_process_and_the_wait_for_another(cold, monkeypatch):
    _, started = cold
    wait = "import sys; sys.stdin.read()"
    monkeypatch.setattr(kernel_preparation, "PROGRAMS", (wait, wait))
    prepare_kernels(lambda: bool(started), lambda: None)
    assert [item.returncode in (None, 0) for item in started] == [False, False]
    with kernel_preparation._ONE:
        prepare_kernels(lambda: True, lambda: None)
    assert len(started) == 2


def test_the_process_ends_with_a_server_that_is_killed():
    words = PROGRAMS[0].replace("compile_run", "_end_with_parent") + "; import time; time.sleep(600)"
    with subprocess.Popen([sys.executable, "-c", words], stdin=subprocess.PIPE) as process:
        assert process.poll() is None
        process.stdin.close()  # as the system does
        assert process.wait(60) == 1
