"""A plugin of pytest for ``mutate.py`` and ``changed.py``: which functions a test calls, and a run of chosen tests.

``CALL_RECORDER`` names a JSON file with the plan: ``{"sources": folder, "out": file, "seconds": limit of one test,
"total": limit of all}`` to record, or ``{"tests": [names of tests or whole files]}`` to run only these in this order;
no test begins after ``"until"`` seconds, if the plan has it. The record of a test is its outcome, its time on the
processor, whether it started another process, and the functions of ``sources`` that it called, as ``path:name``. What
a fixture of several tests does counts for each of them.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest

PLAN: dict[str, Any] = json.loads(Path(os.environ["CALL_RECORDER"]).read_text(encoding="utf-8"))
SOURCES: str = PLAN.get("sources", "")
STARTS = ("subprocess.Popen", "os.fork", "os.posix_spawn", "os.exec")

seen: set[CodeType] = set()
started: list[str] = []
records: dict[str, dict[str, Any]] = {}
shared: dict[object, tuple[set[CodeType], list[str]]] = {}
"""What fixtures of several tests called and started."""
late: list[str] = []
"""Tests that did not begin, since the time was over."""
BEGIN = time.monotonic()


def _watch(frame: FrameType, event: str, arg: object) -> None:
    seen.add(frame.f_code)


def _spent() -> float:
    """Return the time on the processor of this process and of those that it waited for [s]."""
    both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in both)


def _end(number: int, frame: FrameType | None) -> None:
    raise TimeoutError("the test takes too long for mutation testing")


if SOURCES:
    sys.addaudithook(lambda event, arguments: started.append(event) if event in STARTS else None)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keep the chosen tests and those of whole files, in their order."""
    if "tests" not in PLAN:
        return
    order = {name: k for k, name in enumerate(PLAN["tests"])}

    def place(item: pytest.Item) -> int | None:
        return order.get(item.nodeid, order.get(item.nodeid.split("::")[0]))

    config.hook.pytest_deselected(items=[item for item in items if place(item) is None])
    items[:] = sorted((item for item in items if place(item) is not None), key=lambda item: place(item) or 0)


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: pytest.FixtureDef[Any]) -> Iterator[object]:
    """Note what a fixture of several tests calls."""
    if not SOURCES or fixturedef.scope == "function":
        return (yield)
    before, started_before = set(seen), list(started)
    seen.clear()
    started.clear()
    try:
        return (yield)
    finally:
        shared[fixturedef] = set(seen), list(started)
        seen.update(before)
        started.extend(started_before)


def _shared_by(item: pytest.Item) -> tuple[set[CodeType], bool]:
    """Return what the fixtures of a test called when they were made for it or an earlier one."""
    groups = getattr(getattr(item, "_fixtureinfo", None), "name2fixturedefs", {}).values()
    found = [shared[fixture] for fixtures in groups for fixture in fixtures if fixture in shared]
    return {code for codes, _ in found for code in codes}, any(starts for _, starts in found)


@pytest.hookimpl(tryfirst=True, specname="pytest_runtest_protocol")
def pytest_leave_out(item: pytest.Item) -> bool | None:
    """Begin no test when the time is over."""
    if time.monotonic() - BEGIN <= PLAN.get("until", float("inf")):
        return None
    late.append(item.nodeid)
    return True


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many tests did not begin."""
    if late:
        terminalreporter.write_line(f"{len(late)} tests left out: {PLAN['until']:g} s are over", yellow=True)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Record the calls of one test, its fixtures included."""
    if not SOURCES:
        return (yield)
    seen.clear()
    started.clear()
    begin = _spent()
    signal.signal(signal.SIGPROF, _end)
    signal.setitimer(signal.ITIMER_PROF, PLAN["seconds"])
    threading.settrace(_watch)
    sys.settrace(_watch)
    try:
        return (yield)
    finally:
        sys.settrace(None)
        threading.settrace(None)  # type: ignore[arg-type]
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        codes, starts = _shared_by(item)
        codes |= seen
        calls = {f"{code.co_filename}:{code.co_qualname}" for code in codes if code.co_filename.startswith(SOURCES)}
        record = records.setdefault(item.nodeid, {"passed": True})
        record |= {
            "seconds": _spent() - begin,
            "starts": bool(started) or starts,
            "calls": sorted(call.removeprefix(SOURCES) for call in calls),
        }


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup() -> None:
    """Skip what is left when the time for recording is over."""
    if SOURCES and _spent() > PLAN["total"]:
        pytest.skip("the time for recording is over")


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Record the outcome."""
    if SOURCES and report.outcome != "passed":
        records.setdefault(report.nodeid, {})["passed"] = False


def pytest_sessionfinish() -> None:
    """Write the records."""
    if SOURCES:
        Path(PLAN["out"]).write_text(json.dumps(records), encoding="utf-8")
