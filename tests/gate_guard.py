"""Fails a test of the gate that depends on the machine it runs on, with the marker that it lacks.

``make test`` is deterministic because its tests need no clock, port, network or other program. A process that the test
waits for, such as a command of crowdbot, is allowed if the test says so with the marker ``program``.
"""

from __future__ import annotations

import functools
import multiprocessing.util
import re
import socket
import sys
import threading
import time
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

PACKAGE = Path(__file__).parents[1] / "src" / "crowdbot"
LONGEST_SLEEP = 0.1
"""Longest sleep [s] in the thread of a test of the gate."""
PROCESSES = ("subprocess.Popen", "os.fork", "os.forkpty", "os.posix_spawn", "os.system")
ADDRESSES = ("socket.bind", "socket.connect", "socket.sendto")
INNER = ("uname -p", "fc-list", "import mujoco.egl", "import compile_kernels", str(PACKAGE / "data"))
"""Processes that a library or the product starts for itself, some of them once, in whichever test comes first."""
OUTSIDE = ("live", "sweep", "soak")
LIVE_FIXTURES = {"browser", "chromium", "domain", "modules", "ros1", "roslaunch", "rviz"}
"""Fixtures that make a test a live one: another program, or packages of the npm registry."""
LIVE_WORDS = re.compile(rf"mark\.live\b|\bdef \w+\([^)]*\b(?:page|{'|'.join(sorted(LIVE_FIXTURES))})\b")
"""What stands in a file with live tests: the marker, or a function with one of these fixtures or with the one ``page``,
which asks for the browser."""

GROUP = re.compile(r"^pytestmark = .*\bxdist_group\(['\"](\w+)['\"]\)", re.MULTILINE)
"""Line of a test file that makes it one of a group."""


class GateGuard:
    """Plugin of pytest that watches processes, network addresses and sleeps.

    Examples in docstrings are left out: they open ports and start programs to show how, and nobody answers them.
    """

    def __init__(self) -> None:
        self._watching = False
        self._program: list[str] = []
        self._live: list[str] = []
        self._fixtures: dict[object, tuple[list[str], list[str]]] = {}
        sys.addaudithook(self._audit)  # stays to the end of the process
        self._sleep, self._spawn = time.sleep, multiprocessing.util.spawnv_passfds

    def pytest_itemcollected(self, item: pytest.Item) -> None:
        """Mark a test that asks for another program as ``live``; refuse markers that the text of a file hides."""
        if not LIVE_FIXTURES.isdisjoint(getattr(item, "fixturenames", ())):
            item.add_marker("live")
        if item.get_closest_marker("live") and not may_hold_live_tests(item.path):
            where = f"{item.path.name} has neither @pytest.mark.live nor one of {', '.join(sorted(LIVE_FIXTURES))}"
            raise pytest.UsageError(f"make live would miss {item.nodeid}: {where}; add the marker in this file")
        group = item.get_closest_marker("xdist_group")
        if group and group.args != (group_of(item.path),):
            raise pytest.UsageError(f"the group of {item.nodeid} has no effect: give it to the file, as pytestmark")

    @pytest.hookimpl(optionalhook=True)
    def pytest_xdist_make_scheduler(self, config: pytest.Config, log: object) -> object | None:
        """Send whole files to the workers, and those with the same marker ``xdist_group`` to one of them."""
        if config.getoption("dist") != "loadfile":
            return None
        from xdist.scheduler import LoadFileScheduling

        class GroupScheduling(LoadFileScheduling):
            def _split_scope(self, nodeid: str) -> str:
                file = super()._split_scope(nodeid)
                return group_of(config.rootpath / file) or file

        return GroupScheduling(config, log)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> Iterator[None]:
        """Begin to watch the test with its fixtures."""
        self._program, self._live = [], []
        outside = any(item.get_closest_marker(name) for name in OUTSIDE)
        self._watching = not outside and not isinstance(item, pytest.DoctestItem)
        time.sleep = self._watched_sleep
        multiprocessing.util.spawnv_passfds = self._watched_spawn  # a spawned process raises no audit event
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: object) -> Iterator[object]:
        """Note what a fixture does: it counts for each test that asks for it, not only for the first."""
        watching, before = self._watching, (len(self._program), len(self._live))
        self._watching = True
        try:
            return (yield)
        finally:
            self._watching = watching
            self._fixtures[fixturedef] = self._program[before[0] :], self._live[before[1] :]

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Iterator[None]:
        """Fail the test if it did what its markers do not say."""
        watched = self._watching
        if not watched:
            self._end()
        try:
            result = yield
        finally:
            self._end()
        if not watched:
            return result
        for fixture in fixtures_of(item):
            program, live = self._fixtures.get(fixture, ([], []))
            self._program += program
            self._live += live
        if self._live:
            pytest.fail(missing("live", self._live), pytrace=False)
        if self._program and not item.get_closest_marker("program"):
            pytest.fail(missing("program", self._program), pytrace=False)
        return result

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_teardown(self) -> Iterator[None]:
        """Watch no longer, also after a fixture that failed, or a monkeypatch that puts back what it found."""
        self._end()
        try:
            return (yield)
        finally:
            self._end()

    def _end(self) -> None:
        self._watching = False
        time.sleep, multiprocessing.util.spawnv_passfds = self._sleep, self._spawn

    def _audit(self, event: str, values: tuple[Any, ...]) -> None:
        if not self._watching:
            return
        if event in PROCESSES and not is_importing():
            words = " ".join(map(str, values[1])) if event == "subprocess.Popen" else ""
            if not any(inner in words for inner in INNER):
                self._program.append(f"{event} {words}".strip())
        elif event in ADDRESSES and reaches_network(event, values[0]):
            self._live.append(f"{event} {values[1]}")

    def _watched_sleep(self, seconds: float) -> None:
        if seconds > LONGEST_SLEEP and threading.current_thread() is threading.main_thread():
            self._live.append(f"time.sleep({seconds:g})")
        self._sleep(seconds)

    def _watched_spawn(self, path: bytes, words: list[str], kept: list[int]) -> int:
        self._program.append("a process of multiprocessing")
        return self._spawn(path, words, kept)


@functools.cache
def may_hold_live_tests(path: Path) -> bool:
    """Whether ``make live`` collects a test file: all files with live tests, and a few without."""
    return LIVE_WORDS.search(path.read_text(encoding="utf-8")) is not None


@functools.cache
def group_of(path: Path) -> str | None:
    """Return the name of the marker ``xdist_group`` of a test file, or None without one.

    The process that distributes the tests collects none, so it reads the name in the text. pytest-xdist 3.8 itself
    cannot tell it the group of a test with pytest 9.2.
    """
    found = GROUP.search(path.read_text(encoding="utf-8")) if path.suffix == ".py" and path.is_file() else None
    return found and found[1]


def fixtures_of(item: pytest.Item) -> list[object]:
    """Return the fixtures that a test asks for, also through others."""
    found = getattr(getattr(item, "_fixtureinfo", None), "name2fixturedefs", {})
    return [fixture for fixtures in found.values() for fixture in fixtures]


def reaches_network(event: str, end: socket.socket) -> bool:
    """Return whether a call opens a port or sends; a datagram socket that connects sends nothing."""
    silent = event == "socket.connect" and end.type == socket.SOCK_DGRAM
    return end.family in (socket.AF_INET, socket.AF_INET6) and not silent


def is_importing() -> bool:
    """Return whether a module is being imported: what a package does then comes with whichever test is first."""
    frame: types.FrameType | None = sys._getframe(1)
    while frame is not None:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False


def missing(marker: str, seen: list[str]) -> str:
    """Return the sentence that names the marker a test lacks and why it needs it."""
    shown = "; ".join(dict.fromkeys(item[:200] for item in seen[:3]))
    return f"a test of the gate needs @pytest.mark.{marker} for this: {shown} (see CONTRIBUTING.md, Tiers of tests)"
