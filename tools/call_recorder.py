"""A plugin of pytest for ``mutate.py``: which functions a test calls, and a run of chosen tests in a given order.

``CALL_RECORDER`` names a JSON file with the plan: ``{"sources": folder, "out": file, "seconds": limit of one test,
"total": limit of all}`` to record, or ``{"tests": [names]}`` to run only these tests. The record of a test is its
outcome, its time on the processor, whether it started another process, and the functions of ``sources`` that it called,
as ``path:line`` of their first line.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import threading
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
    """Keep the chosen tests, in their order."""
    if "tests" in PLAN:
        order = {name: k for k, name in enumerate(PLAN["tests"])}
        config.hook.pytest_deselected(items=[item for item in items if item.nodeid not in order])
        items[:] = sorted((item for item in items if item.nodeid in order), key=lambda item: order[item.nodeid])


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
        calls = {f"{code.co_filename}:{code.co_firstlineno}" for code in seen if code.co_filename.startswith(SOURCES)}
        record = records.setdefault(item.nodeid, {"passed": True})
        record |= {
            "seconds": _spent() - begin,
            "starts": bool(started),
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
