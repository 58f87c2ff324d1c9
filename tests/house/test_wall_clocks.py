"""No test of the gate reads a clock of the machine, by its syntax tree; see CONTRIBUTING.md, Tiers of tests."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from gate_guard import LIVE_FIXTURES, OUTSIDE

TESTS = Path(__file__).parents[1]
CLOCKS = {
    f"time.{name}{unit}" for name in ("time", "monotonic", "perf_counter", "process_time") for unit in ("", "_ns")
} | {f"{prefix}{name}" for prefix in ("", "datetime.") for name in ("datetime.now", "datetime.utcnow", "date.today")}
Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


def readings(text: str) -> list[str]:
    """Return a sentence for each test of the gate in a file that reads a clock, itself or by what it uses there."""
    tree = ast.parse(text)
    full = {
        name.asname or name.name: f"{node.module}.{name.name}"
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.level == 0
        for name in node.names
    }
    full |= {
        name.asname: name.name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for name in node.names
        if name.asname
    }
    places = {node.name: node for node in tree.body if isinstance(node, Definition)}
    always = [node.name for node in places.values() if "autouse=True" in decorators(node)]
    found = []
    for names, test in marked_tests(tree):
        if names & set(OUTSIDE):
            continue
        seen: dict[str, Definition] = {test.name: test}
        waiting: list[Definition] = [test, *(places[name] for name in always)]
        while waiting:
            for name in words_of(waiting.pop()):
                if name in places and name not in seen:
                    seen[name] = places[name]
                    waiting.append(places[name])
        fixtures = {argument.arg for node in seen.values() for argument in arguments_of(node)}
        if fixtures & LIVE_FIXTURES:
            continue
        clocks = [call for node in (*seen.values(), *map(places.get, always)) if node for call in calls(node, full)]
        found += [
            f"{line}: {test.name} reads {clock}: give it a clock of its own, or mark it with @pytest.mark.live"
            for line, clock in sorted(set(clocks))
        ]
    return found


def marked_tests(tree: ast.Module) -> Iterator[tuple[set[str], ast.FunctionDef | ast.AsyncFunctionDef]]:
    """Yield the tests of a file, each with the names of its markers that move it out of the gate."""
    values = {ast.unparse(node.targets[0]): node.value for node in tree.body if isinstance(node, ast.Assign)}
    of_all = values.get("pytestmark", ast.List([]))
    whole = marks(of_all.elts if isinstance(of_all, ast.List) else [of_all], values)
    for node in tree.body:
        inside = node.body if isinstance(node, ast.ClassDef) else [node]
        shared = whole | (marks(node.decorator_list, values) if isinstance(node, ast.ClassDef) else set())
        for test in inside:
            if isinstance(test, ast.FunctionDef | ast.AsyncFunctionDef) and test.name.startswith("test"):
                yield shared | marks(test.decorator_list, values), test


def marks(nodes: list[ast.expr], values: dict[str, ast.expr]) -> set[str]:
    """Return the markers of expressions; ``values`` has those that have a name."""
    found = set()
    for node in nodes:
        one = values.get(node.id, node) if isinstance(node, ast.Name) else node
        if isinstance(one, ast.Call) and ast.unparse(one.func) == "pytest.mark.parametrize":
            cases = [values.get(ast.unparse(case), case) for case in getattr(one.args[1], "elts", [])]
            if cases and all(marks_of(case) for case in cases):
                found |= set().union(*map(marks_of, cases))  # no case is left to the gate
        else:
            found |= marks_of(one)
    return found


def marks_of(node: ast.expr) -> set[str]:
    """Return the markers in the text of an expression."""
    return {name for name in OUTSIDE if f"pytest.mark.{name}" in ast.unparse(node)}


def decorators(node: Definition) -> str:
    """Return the text of the decorators."""
    return " ".join(ast.unparse(one) for one in node.decorator_list)


def arguments_of(node: Definition) -> list[ast.arg]:
    """Return the arguments of a function, which may be fixtures."""
    return [] if isinstance(node, ast.ClassDef) else [*node.args.args, *node.args.kwonlyargs]


def words_of(node: Definition) -> set[str]:
    """Return the names that a function or class uses, and its fixtures."""
    names = {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
    used = {one.value for one in ast.walk(node) if isinstance(one, ast.Constant) and isinstance(one.value, str)}
    return names | used | {one.arg for one in arguments_of(node)}  # usefixtures("name") names a fixture in a string


def calls(node: Definition, full: dict[str, str]) -> Iterator[tuple[int, str]]:
    """Yield line and name of each call of a clock; ``full`` has the full names of what is imported."""
    for one in ast.walk(node):
        if isinstance(one, ast.Call):
            first, _, rest = ast.unparse(one.func).partition(".")
            name = ".".join(filter(None, (full.get(first, first), rest)))
            if name in CLOCKS:
                yield one.lineno, name


def test_no_test_of_the_gate_reads_a_clock() -> None:
    found = [
        f"{path.relative_to(TESTS.parent)}:{sentence}"
        for path in sorted(TESTS.rglob("test_*.py"))
        for sentence in readings(path.read_text(encoding="utf-8"))
    ]
    assert not found, "\n".join(found)


HEAD = "import time, datetime as dt\nfrom time import perf_counter as tick\nimport pytest\n"
SAMPLES = {
    "def test_x():\n    time.monotonic()": "time.monotonic",
    "def test_x():\n    tick()": "time.perf_counter",
    "def test_x():\n    dt.datetime.now(dt.UTC)": "datetime.datetime.now",
    "def wait():\n    time.time_ns()\ndef between():\n    wait()\ndef test_x():\n    between()": "time.time_ns",
    "@pytest.fixture\ndef begin():\n    return time.time()\ndef test_x(begin):\n    pass": "time.time",
    "@pytest.fixture\ndef a():\n    time.time()\n@pytest.mark.usefixtures('a')\ndef test_x():\n    pass": "time.time",
    "@pytest.fixture(autouse=True)\ndef begin():\n    time.time()\ndef test_x():\n    pass": "time.time",
    "class TestA:\n    def test_x(self):\n        time.time()": "time.time",
    "@pytest.mark.program\ndef test_x():\n    time.time()": "time.time",
    "@pytest.mark.parametrize('n', [1, pytest.param(2, marks=pytest.mark.sweep)])\ndef test_x(n):\n    tick()":
        "time.perf_counter",
    "@pytest.mark.parametrize('n', [pytest.param(2, marks=pytest.mark.sweep)])\ndef test_x(n):\n    tick()": "",
    "@pytest.mark.live\ndef test_x():\n    time.time()": "",
    "pytestmark = [pytest.mark.live]\ndef test_x():\n    time.time()": "",
    "@pytest.mark.sweep\nclass TestA:\n    def test_x(self):\n        time.time()": "",
    "def test_x(browser):\n    time.time()": "",
    "def test_x(monkeypatch):\n    monkeypatch.setattr(time, 'time', lambda: 5.0)": "",
    "def unused():\n    time.time()\ndef test_x():\n    time.sleep(0.01)": "",
}  # fmt: skip
"""Test files, each with the clock that its test must not read."""


@pytest.mark.parametrize(("text", "clock"), SAMPLES.items())
def test_a_clock_is_seen_through_names_helpers_and_fixtures(text: str, clock: str) -> None:
    file = HEAD + text
    found = readings(file)
    assert len(found) == bool(clock)
    if clock:
        words = f"test_x reads {clock}: give it a clock of its own, or mark it with @pytest.mark.live"
        (line,) = (
            k
            for k, row in enumerate(file.splitlines(), 1)
            if k > 3 and any(call in row for call in ("time.time", "time.monotonic(", "tick(", "now("))
        )
        assert found == [f"{line}: {words}"]
