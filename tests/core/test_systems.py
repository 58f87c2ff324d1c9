"""What differs between operating systems: folders, locks, memory, and the sentence of a refusal."""

import ctypes
import math
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from crowdbot.core import (
    InputError,
    lock_file,
    machine_memory,
    peak_memory,
    refuse_system,
    system_name,
    systems,
    user_data_folder,
)
from crowdbot.core.systems import user_cache_folder

PEAK = """
import numpy as np
from crowdbot.core import peak_memory
before = peak_memory()
room = np.ones(2**25)
del room
print(before / 2**20, peak_memory() / 2**20)
"""


@pytest.mark.parametrize(
    ("system", "cache", "data"),
    [
        ("linux", ".cache", ".local/share"),
        ("darwin", "Library/Caches", "Library/Application Support"),
        ("win32", "AppData/Local", "AppData/Local"),
    ],
)
def test_folders_of_the_user(monkeypatch, tmp_path, system, cache, data):
    for name in ("XDG_CACHE_HOME", "XDG_DATA_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    monkeypatch.setattr(sys, "platform", system)
    assert user_cache_folder() == tmp_path / cache / "crowdbot"
    assert user_data_folder() == tmp_path / data / "crowdbot"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "own"))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "own"))
    assert (user_cache_folder() == tmp_path / "own" / "crowdbot") == (system != "darwin")


@pytest.mark.parametrize(("system", "name"), [("linux", "Linux"), ("darwin", "macOS"), ("win32", "Windows")])
def test_a_refusal_says_what_and_where_and_what_instead(monkeypatch, system, name):
    monkeypatch.setattr(sys, "platform", system)
    assert system_name() == name
    with pytest.raises(InputError) as caught:
        refuse_system("the hourglass", "Multics", "use a clock")
    assert str(caught.value) == f"the hourglass needs Multics, this is {name}; use a clock"


def test_a_file_is_locked_once(tmp_path):
    path = tmp_path / "log"
    with path.open("xb") as first, path.open("r+b") as second:
        lock_file(first)
        with pytest.raises(OSError, match="unavailable|denied"):
            lock_file(second)
    with path.open("r+b") as third:
        lock_file(third)
        assert third.tell() == 0


def test_the_lock_of_windows_is_beyond_the_content(monkeypatch, tmp_path):
    seen = []
    with (tmp_path / "log").open("w+b") as stream:
        stream.write(b"abc")
        lock = SimpleNamespace(LK_NBLCK=2, locking=lambda number, mode, size: seen.append((stream.tell(), mode, size)))
        monkeypatch.setattr(systems, "msvcrt", lock, raising=False)
        monkeypatch.setattr(sys, "platform", "win32")
        lock_file(stream)
        assert stream.tell() == 3
    assert seen == [(1 << 30, 2, 1)]


@pytest.mark.program
def test_peak_memory_counts_an_array_that_is_gone():
    done = subprocess.run([sys.executable, "-c", PEAK], capture_output=True, text=True, check=True)
    before, after = map(float, done.stdout.split())
    assert 5.0 < before < 2000.0
    assert 200.0 < after - before < 300.0  # the array has 256 MiB


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no module resource")
@pytest.mark.parametrize(("system", "factor"), [("darwin", 1), ("linux", 1024)])
def test_peak_memory_without_proc(monkeypatch, tmp_path, system, factor):
    import resource

    monkeypatch.setattr(systems, "STATUS", tmp_path / "nowhere")
    monkeypatch.setattr(resource, "getrusage", lambda who: SimpleNamespace(ru_maxrss=5000))
    monkeypatch.setattr(sys, "platform", system)
    assert peak_memory() == 5000 * factor


def test_memory_of_windows(monkeypatch):
    def status(reference):
        assert reference._obj[0] == ctypes.sizeof(reference._obj) == 64
        reference._obj[1] = total

    def counters(process, reference, size):
        assert size == ctypes.sizeof(reference._obj) == 72
        reference._obj[1] = 3 * 2**30

    kernel = SimpleNamespace(
        GlobalMemoryStatusEx=status, K32GetProcessMemoryInfo=counters, GetCurrentProcess=lambda: -1
    )
    monkeypatch.setattr(ctypes, "windll", SimpleNamespace(kernel32=kernel), raising=False)
    monkeypatch.setattr(sys, "platform", "win32")
    total = 8 * 2**30
    assert machine_memory() == total
    assert peak_memory() == 3 * 2**30
    total = 0
    assert machine_memory() == math.inf
