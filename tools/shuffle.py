"""A plugin of pytest for a random order: ``SHUFFLE=7 PYTHONPATH=tools python -m pytest -p shuffle PATH``.

The order depends on the seed and the names of the tests only. Files are shuffled, then the classes and functions in a
file, so that a fixture of a file, class or session is made as often as without the plugin. ``SHUFFLE_OUT`` names a file
to which each test adds a line of JSON when it begins and one with its outcome when it ends, so a run that dies tells
how far it came.
"""

from __future__ import annotations

import json
import os
import random
from pathlib import Path

import pytest

SEED = os.environ.get("SHUFFLE", "0")
OUT = os.environ.get("SHUFFLE_OUT", "")
WORST = ("passed", "skipped", "failed", "error")
"""Outcomes from good to bad; that of a test is the worst of its phases."""


def order(names: list[str], seed: str) -> list[str]:
    """Return the names of tests in the order of a seed: files in random order, then groups of a file, then tests."""

    def key(name: str) -> tuple[float, ...]:
        file, *parts = name.partition("[")[0].split("::")
        levels = [file, "::".join([file, *parts[:1]]), name]
        return tuple(random.Random(f"{seed}:{level}").random() for level in levels)  # noqa: S311

    return sorted(sorted(names), key=key)


def pytest_report_header() -> str:
    """Name the seed."""
    return f"order of the tests: SHUFFLE={SEED}"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the tests into the order of the seed; pytest then brings together what shares a fixture with values."""
    places = {name: k for k, name in enumerate(order([item.nodeid for item in items], SEED))}
    items.sort(key=lambda item: places[item.nodeid])


def write_line(test: str, outcome: str) -> None:
    """Add a line to the file of outcomes."""
    if OUT:
        with Path(OUT).open("a", encoding="utf-8") as file:
            print(json.dumps([test, outcome]), file=file)


def pytest_runtest_logstart(nodeid: str) -> None:
    """Note that a test begins."""
    write_line(nodeid, "begun")


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Note the outcome of a phase of a test; a failure of a fixture is an error."""
    outcome = "error" if report.failed and report.when != "call" else report.outcome
    if report.when == "call" or outcome != "passed":
        write_line(report.nodeid, outcome)


def outcomes(text: str) -> dict[str, str]:
    """Return the outcome of each test from the lines of a run; ``begun`` is a test that did not end."""
    result: dict[str, str] = {}
    for line in text.splitlines():
        test, outcome = json.loads(line)
        known = result.get(test, "begun")
        result[test] = max(known, outcome, key=("begun", *WORST).index)
    return result
