"""No test of the gate reads a clock of the machine, by its syntax tree; see CONTRIBUTING.md, Tiers of tests."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from gate_guard import LIVE_FIXTURES, OUTSIDE

TESTS = Path(__file__).parents[1]
CLOCKS = {
    f"time.{name}{unit}" for name in ("time", "monotonic", "perf_counter", "process_time") for unit in ("", "_ns")
} | {f"{prefix}{name}" for prefix in ("", "datetime.") for name in ("datetime.now", "datetime.utcnow", "date.today")}
REMEDY = "give it a clock of its own, or mark it with @pytest.mark.live"
Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
Part = Definition | ast.Module
"""A function or class of the tests, or a whole program that a test starts."""


@dataclass(frozen=True, eq=False)
class TestFile:
    """A file of the tests by its syntax tree.

    Attributes:
        path: the file.
        tree: its syntax tree.
        places: functions and classes at its top, by name.
        fixtures: those of them that are fixtures, by the name that tests ask for.
        always: fixtures that every test of the file has.
        full: full names of imported names, such as ``time.monotonic`` for ``monotonic``.
        modules: imported modules, by the name that the file gives them.
        texts: texts in the values at its top, by name.
    """

    __test__ = False

    path: Path
    tree: ast.Module
    places: dict[str, Definition]
    fixtures: dict[str, Definition]
    always: list[Definition]
    full: dict[str, str]
    modules: dict[str, str]
    texts: dict[str, set[str]]

    @classmethod
    def read(cls, path: Path) -> TestFile:
        """Read a file; imports inside functions count, too."""
        tree = ast.parse(path.read_text(encoding="utf-8"))
        full, modules = {}, {}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                full |= {name.asname or name.name: f"{node.module}.{name.name}" for name in node.names}
            elif isinstance(node, ast.Import):
                full |= {name.asname: name.name for name in node.names if name.asname}
                modules |= {name.asname or name.name: name.name for name in node.names}
        places = {node.name: node for node in tree.body if isinstance(node, Definition)}
        fixtures = {fixture_name(node): node for node in places.values() if is_fixture(node)}
        always = [node for node in fixtures.values() if "autouse=True" in decorators(node)]
        values = [assigned for node in tree.body if isinstance(node, ast.Assign) for assigned in assignments(node)]
        texts = {name: texts_of(value) for name, value in values}
        return cls(path, tree, places, fixtures, always, full, modules, texts)


@dataclass(frozen=True)
class Contents:
    """What a function, class or program contains, found in one walk through its syntax tree.

    Attributes:
        names: names that it uses.
        texts: texts in it, which may name fixtures, as for ``getfixturevalue``.
        attributes: attributes of a name, as the two words.
        calls: line and dotted name of each call.
    """

    names: set[str]
    texts: set[str]
    attributes: list[tuple[str, str]]
    calls: list[tuple[int, str]]

    @classmethod
    def of(cls, node: Part) -> Contents:
        """Walk through the tree."""
        names, texts, attributes, calls = set(), set(), [], []
        for item in ast.walk(node):
            if isinstance(item, ast.Name):
                names.add(item.id)
            elif isinstance(item, ast.Constant) and isinstance(item.value, str):
                texts.add(item.value)
            elif isinstance(item, ast.Attribute) and isinstance(item.value, ast.Name):
                attributes.append((item.value.id, item.attr))
            elif isinstance(item, ast.Call):
                calls.append((item.lineno, dotted_name(item.func)))
        return cls(names, texts, attributes, calls)


Found = tuple[TestFile, Part]


class Imports:
    """Finds the functions and classes of the tests that a file uses, also in other files of the tests.

    Args:
        tests: folder of the tests; a module there is known by the name of its file, as pytest imports it.
    """

    def __init__(self, tests: Path) -> None:
        self._tests = tests
        self._files: dict[Path, TestFile] = {}
        self._paths: dict[str, list[Path]] = {}
        self._used: dict[Found, list[Found]] = {}
        self._clocks: dict[Found, set[tuple[Path, int, str]]] = {}
        self._asked: dict[Part, tuple[set[str], bool]] = {}
        self._contents: dict[Part, Contents] = {}
        for path in sorted(tests.rglob("*.py")):
            self._paths.setdefault(path.stem, []).append(path)

    def file(self, path: Path) -> TestFile:
        """Return a file, which is read once."""
        if path not in self._files:
            self._files[path] = TestFile.read(path)
        return self._files[path]

    def module(self, name: str, user: TestFile) -> TestFile | None:
        """Return the file of the tests that a file imports by a name; that of its own folder comes first."""
        paths = self._paths.get(name, [])
        near = [path for path in paths if path.parent in (user.path.parent, self._tests)]
        return self.file(max(near or paths, key=lambda path: len(path.parts))) if paths else None

    def fixtures(self, user: TestFile) -> list[TestFile]:
        """Return the files whose fixtures a file has: itself, and each conftest.py from its folder up."""
        folders = [folder for folder in user.path.parents if folder.is_relative_to(self._tests)]
        return [user, *(self.file(path) for folder in folders if (path := folder / "conftest.py").exists())]

    def used_by(self, user: TestFile, node: Part) -> list[Found]:
        """Return the functions and classes of the tests that a function or class uses, and its fixtures."""
        if (user, node) not in self._used:
            self._used[user, node] = list(self._search(user, node))
        return self._used[user, node]

    def clocks_of(self, user: TestFile, node: Part) -> set[tuple[Path, int, str]]:
        """Return file, line and name of each clock that a function, class or program itself reads."""
        if (user, node) not in self._clocks:
            self._clocks[user, node] = {
                (user.path, line, name)
                for line, called in self.contents(node).calls
                if (name := full_name(called, user.full)) in CLOCKS
            }
        return self._clocks[user, node]

    def contents(self, node: Part) -> Contents:
        """Return what a function, class or program contains."""
        if node not in self._contents:
            self._contents[node] = Contents.of(node)
        return self._contents[node]

    def asked(self, node: Part) -> tuple[set[str], bool]:
        """Return the names of fixtures that a function or class asks for, and whether it is a fixture itself."""
        if node not in self._asked:
            self._asked[node] = asked_by(node), is_fixture(node)
        return self._asked[node]

    def programs(self, user: TestFile, node: Part) -> Iterator[TestFile]:
        """Yield the programs among the tests whose file names are in a part of a file, or in a value that it uses."""
        used = [self._value(user, name) for name in self.contents(node).names]
        for text in self.contents(node).texts.union(*used):
            name = text.rpartition("/")[2]
            paths = self._paths.get(name.removesuffix(".py"), []) if name.endswith(".py") else []
            if paths and not name.startswith(("test_", "conftest")) and name != user.path.name:
                yield self.file(next((path for path in paths if path.parent == user.path.parent), paths[0]))

    def _value(self, user: TestFile, name: str) -> set[str]:
        """Return the texts in a value at the top of a file, which may come from another file of the tests."""
        module, _, original = user.full.get(name, "").rpartition(".")
        other = self.module(module, user) if module else None
        return other.texts.get(original, set()) if other else user.texts.get(name, set())

    def _search(self, user: TestFile, node: Part) -> Iterator[Found]:
        for program in self.programs(user, node):
            yield program, program.tree
        for name in self.contents(node).names:
            if found := self._named(user, name):
                yield found
        for name in self.asked(node)[0] | self.contents(node).texts:
            for file in self.fixtures(user):
                if (found := file.fixtures.get(name)) is not None:
                    yield file, found
                    break
        for name, attribute in self.contents(node).attributes:
            file = self.module(user.modules[name], user) if name in user.modules else None
            if file and (found := self._named(file, attribute)):
                yield found

    def _named(self, file: TestFile, name: str) -> Found | None:
        """Return what a name in a file means, if it is a function or class of the tests."""
        if name in file.places:
            return file, file.places[name]
        module, _, original = file.full.get(name, "").rpartition(".")
        other = self.module(module, file) if module else None
        return self._named(other, original) if other and other is not file else None


def readings(path: Path, imports: Imports) -> list[str]:
    """Return a sentence for each test of the gate in a file that reads a clock, itself or by what it uses."""
    file = imports.file(path)
    always = [(place, node) for place in imports.fixtures(file) for node in place.always]
    found = []
    for names, test in marked_tests(file.tree):
        if names & set(OUTSIDE):
            continue
        waiting: list[Found] = [(file, test), *always]
        seen: dict[Found, None] = dict.fromkeys(waiting)
        while waiting:
            for item in imports.used_by(*waiting.pop()):
                if item not in seen:
                    seen[item] = None
                    waiting.append(item)
        asked = [names for _, node in seen for names, fixture in [imports.asked(node)] if fixture or node is test]
        if LIVE_FIXTURES & set().union(*asked):
            continue
        clocks = set().union(*(imports.clocks_of(*item) for item in seen))
        found += [
            f"{line if where == path else test.lineno}: {test.name} reads {clock}"
            f"{'' if where == path else f' in {where.name}:{line}'}: {REMEDY}"
            for where, line, clock in sorted(clocks)
        ]
    return found


def marked_tests(tree: ast.Module) -> Iterator[tuple[set[str], ast.FunctionDef | ast.AsyncFunctionDef]]:
    """Yield the tests of a file, each with the names of its markers that move it out of the gate."""
    values = dict(assigned for node in tree.body if isinstance(node, ast.Assign) for assigned in assignments(node))
    of_all = values.get("pytestmark", ast.List([]))
    whole = marks(of_all.elts if isinstance(of_all, ast.List) else [of_all], values)
    for node in tree.body:
        inside = node.body if isinstance(node, ast.ClassDef) else [node]
        shared = whole | (marks(node.decorator_list, values) if isinstance(node, ast.ClassDef) else set())
        for test in inside:
            if isinstance(test, ast.FunctionDef | ast.AsyncFunctionDef) and test.name.startswith("test"):
                yield shared | marks(test.decorator_list, values), test


def assignments(node: ast.Assign) -> Iterator[tuple[str, ast.expr]]:
    """Yield names and values of an assignment, also of several at once."""
    target, value = node.targets[0], node.value
    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        yield from zip(map(ast.unparse, target.elts), value.elts, strict=False)
    yield ast.unparse(target), value


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
    return " ".join(ast.unparse(item) for item in node.decorator_list)


def is_fixture(node: Part) -> bool:
    """Return whether a function is a fixture."""
    return not isinstance(node, ast.Module) and "fixture" in decorators(node)


def fixture_name(node: Definition) -> str:
    """Return the name of a fixture, which its decorator may give."""
    words = [word for item in node.decorator_list if isinstance(item, ast.Call) for word in item.keywords]
    return next((ast.literal_eval(word.value) for word in words if word.arg == "name"), node.name)


def asked_by(node: Part) -> set[str]:
    """Return the names of fixtures that a function asks for: its arguments, and what ``usefixtures`` names."""
    if isinstance(node, ast.Module):
        return set()
    arguments = [] if isinstance(node, ast.ClassDef) else [*node.args.args, *node.args.kwonlyargs]
    marks = [item for item in node.decorator_list if "usefixtures" in ast.unparse(item)]
    return {argument.arg for argument in arguments}.union(*map(texts_of, marks))


def texts_of(node: ast.AST) -> set[str]:
    """Return the texts in a part of a file, which may name fixtures, as for ``getfixturevalue``."""
    return {item.value for item in ast.walk(node) if isinstance(item, ast.Constant) and isinstance(item.value, str)}


def full_name(name: str, full: dict[str, str]) -> str:
    """Return a dotted name with the full name of what is imported; ``full`` has the full names."""
    first, _, rest = name.partition(".")
    return ".".join(filter(None, (full.get(first, first), rest)))


def dotted_name(node: ast.expr) -> str:
    """Return the text of a name with attributes, such as ``time.monotonic``; empty for another expression.

    ``ast.unparse`` takes ten times as long.
    """
    words = []
    while isinstance(node, ast.Attribute):
        words.append(node.attr)
        node = node.value
    return ".".join([node.id, *reversed(words)]) if isinstance(node, ast.Name) else ""


def test_no_test_of_the_gate_reads_a_clock() -> None:
    imports = Imports(TESTS)
    found = [
        f"{path.relative_to(TESTS.parent)}:{sentence}"
        for path in sorted(TESTS.rglob("test_*.py"))
        for sentence in readings(path, imports)
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
    "SHORT, LONG = pytest.param(1, marks=pytest.mark.sweep), pytest.param(9, marks=pytest.mark.soak)\n"
    "@pytest.mark.parametrize('n', [SHORT, LONG])\ndef test_x(n):\n    tick()": "",
    "@pytest.mark.usefixtures('browser')\ndef test_x():\n    time.time()": "",
    "def test_x(browser):\n    time.time()": "",
    "def test_x(monkeypatch):\n    monkeypatch.setattr(time, 'time', lambda: 5.0)": "",
    "def unused():\n    time.time()\ndef test_x():\n    time.sleep(0.01)": "",
}  # fmt: skip
"""Test files, each with the clock that its test must not read."""


HELPERS = {
    "conftest.py": "import time\nimport pytest\n"
    "@pytest.fixture(name='now')\ndef now_fixture():\n    return time.time()\n",
    "elsewhere/waits.py": "def wait():\n    pass\n",
    "here/waits.py": "from time import monotonic\nimport deep\n"
    "def wait():\n    monotonic()\ndef wait_twice():\n    deep.wait()\ndef add(browser):\n    monotonic()\n",
    "elsewhere/deep.py": "import time\ndef wait():\n    time.time_ns()\n"
    "class Robot:\n    def move(self):\n        time.time()\n",
    "here/robot.py": "import time\ndef main():\n    time.sleep(0.1)\n    time.monotonic()\nmain()\n",
    "here/starts.py": "from pathlib import Path\nROBOT = Path(__file__).with_name('robot.py')\n"
    "def start():\n    return run(ROBOT)\n",
}
"""Other files of the tests, which the files below are beside in the folder here."""
IMPORTS = {
    "from waits import wait\ndef test_x():\n    wait()": "time.monotonic in waits.py:4",
    "from waits import wait as until\ndef test_x():\n    until()": "time.monotonic in waits.py:4",
    "def test_x():\n    from waits import wait\n    wait()": "time.monotonic in waits.py:4",
    "import waits\ndef test_x():\n    waits.wait()": "time.monotonic in waits.py:4",
    "import waits\ndef test_x():\n    waits.wait_twice()": "time.time_ns in deep.py:3",
    "from waits import add\ndef test_x():\n    add(1)": "time.monotonic in waits.py:8",
    "from deep import Robot\ndef test_x():\n    Robot().move()": "time.time in deep.py:6",
    "def test_x(now):\n    pass": "time.time in conftest.py:5",
    "def test_x():\n    run('here/robot.py')": "time.monotonic in robot.py:4",
    "PROGRAM = FOLDER / 'robot.py'\ndef test_x():\n    run(PROGRAM)": "time.monotonic in robot.py:4",
    "from starts import ROBOT\ndef test_x():\n    run(ROBOT)": "time.monotonic in robot.py:4",
    "from starts import start\ndef test_x():\n    start()": "time.monotonic in robot.py:4",
    "PROGRAM = 'robot.py'\ndef test_x():\n    pass": "",
    "import pytest\n@pytest.mark.live\ndef test_x():\n    run('robot.py')": "",
    "import pytest\nfrom waits import wait\n@pytest.mark.live\ndef test_x():\n    wait()": "",
    "from waits import wait\ndef test_x():\n    pass": "",
    "import waits\ndef wait():\n    pass\ndef test_x():\n    wait()": "",
}
"""Test files that use others, each with the clock that its test must not read."""


@pytest.mark.parametrize(("text", "clock"), SAMPLES.items())
def test_a_clock_is_seen_through_names_helpers_and_fixtures(text: str, clock: str, tmp_path: Path) -> None:
    file = HEAD + text
    path = tmp_path / "test_sample.py"
    path.write_text(file, encoding="utf-8")
    found = readings(path, Imports(tmp_path))
    assert len(found) == bool(clock)
    if clock:
        words = f"test_x reads {clock}: {REMEDY}"
        (line,) = (
            k
            for k, row in enumerate(file.splitlines(), 1)
            if k > 3 and any(call in row for call in ("time.time", "time.monotonic(", "tick(", "now("))
        )
        assert found == [f"{line}: {words}"]


@pytest.mark.parametrize(("text", "clock"), IMPORTS.items())
def test_a_clock_is_seen_in_other_files_of_the_tests(text: str, clock: str, tmp_path: Path) -> None:
    for name, content in {**HELPERS, "here/test_sample.py": text}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(content, encoding="utf-8")
    found = readings(tmp_path / "here" / "test_sample.py", Imports(tmp_path))
    line = next(k for k, row in enumerate(text.splitlines(), 1) if "def test_x" in row)
    assert found == ([f"{line}: test_x reads {clock}: {REMEDY}"] if clock else [])


def test_compressed_bytes_do_not_hold_the_time() -> None:
    """Two workers that import a file in different seconds would otherwise collect different cases."""
    found = [
        f"{path.relative_to(TESTS.parent)}:{node.lineno}: give gzip.compress mtime=0"
        for path in sorted(TESTS.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and dotted_name(node.func) == "gzip.compress"
        if all(word.arg != "mtime" for word in node.keywords)
    ]
    assert not found, "\n".join(found)
