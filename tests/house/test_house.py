"""The house rules that a machine can check: names, public lists, light imports, tests that assert."""

import ast
import collections
import doctest
import functools
import importlib
import json
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import pytest

import crowdbot

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "src" / "crowdbot").rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("*.py"))
PACKAGES = [m.name for m in pkgutil.iter_modules(crowdbot.__path__) if m.ispkg]
SKIPS = re.compile(r"@pytest\.mark\.(skip\b|xfail|skipif\((?!sys\.platform [!=]= \"))|pytest\.skip\(|importorskip")
"""Only a test of one operating system may name it: ``skipif(sys.platform == "win32", ...)``."""
CLOCK = re.compile(r"time\.(time|perf_counter|monotonic|process_time)\(")
CALL = re.compile(r"(time|perf_counter|monotonic|process_time)\s*\(")
"""What stands in the text of a file with such a clock; unparsing every assertion takes ten times as long."""
HEAVY = ("numba", "pandas", "torch", "matplotlib", "mujoco", "rosbags", "mcap", "h5py", "pyarrow", "shapely", "rich")


def _functions(tree):
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]


@functools.cache
def _tree(path):
    return ast.parse(path.read_text(encoding="utf-8"))


@functools.cache
def _classes():
    """Return the classes of the package by name, with the files that define them."""
    classes = collections.defaultdict(list)
    for path in SOURCES:
        for node in ast.walk(_tree(path)):
            if isinstance(node, ast.ClassDef):
                classes[node.name].append((path, node))
    return classes


def _methods(owner):
    return [node for node in owner.body if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]


def _overrides_documented(owner, name):
    """Return whether a class of the package above ``owner`` documents a method of this name."""
    for base in owner.bases:
        found = _classes().get(ast.unparse(base).partition("[")[0].rpartition(".")[2], [])
        if len(found) == 1 and found[0][1] is not owner:
            above = found[0][1]
            documented = any(m.name == name and ast.get_docstring(m) for m in _methods(above))
            if documented or _overrides_documented(above, name):
                return True
    return False


def _undocumented(path):
    """Return the public names of a module that lack a docstring; overloads and documented overrides need none."""
    tree = _tree(path)
    public = [n for n in tree.body if isinstance(n, ast.FunctionDef | ast.ClassDef) and not n.name.startswith("_")]
    methods = [
        m
        for c in public
        if isinstance(c, ast.ClassDef)
        for m in _methods(c)
        if not m.name.startswith("_") and not _overrides_documented(c, m.name)
    ]
    needed = [n for n in public + methods if not any("overload" in ast.unparse(d) for d in n.decorator_list)]
    module = [] if ast.get_docstring(tree) else ["the module"]
    return module + [n.name for n in needed if not ast.get_docstring(n)]


def test_an_override_of_a_documented_method_has_no_line_of_its_own():
    """What differs is a comment, or a longer docstring with its errors or arguments."""
    breaches = [
        f"{path.name}:{method.lineno} {owner.name}.{method.name}"
        for places in _classes().values()
        for path, owner in places
        for method in _methods(owner)
        if method.name != "__init__" and len(method.body) > 1 and ast.get_docstring(method)
        if method.body[0].lineno == method.body[0].end_lineno and _overrides_documented(owner, method.name)
    ]
    assert breaches == []


def test_every_module_and_public_name_is_documented():
    breaches = {str(path.relative_to(ROOT / "src")): _undocumented(path) for path in SOURCES}
    assert {path: names for path, names in breaches.items() if names} == {}


def test_no_name_says_nothing():
    assert {p.stem for p in SOURCES} & {
        "utils",
        "util",
        "helpers",
        "helper",
        "common",
        "misc",
        "manager",
        "base",
    } == set()


def test_no_test_lacks_an_assertion_is_skipped_or_reads_the_clock():
    breaches = []
    for path in TESTS:
        text = path.read_text(encoding="utf-8")
        if SKIPS.search(text) and path != Path(__file__):
            breaches.append(f"{path.name} skips a test")
        may_read = CALL.search(text) is not None
        for function in _functions(ast.parse(text)):
            if function.name.startswith("test") and not _asserts(function):
                breaches.append(f"{path.name}: {function.name} asserts nothing")
            asserts = (n for n in ast.walk(function) if isinstance(n, ast.Assert)) if may_read else ()
            if any(CLOCK.search(ast.unparse(n)) for n in asserts):
                breaches.append(f"{path.name}: {function.name} asserts how long something takes")
    assert breaches == []


def _asserts(function):
    return any(
        isinstance(n, ast.Assert)
        or (isinstance(n, ast.Call) and re.search(r"raises|assert|check|warns|^expect\(", ast.unparse(n.func)))
        for n in ast.walk(function)
    )


def test_every_room_lists_what_it_shows():
    rooms = {name: importlib.import_module(f"crowdbot.{name}") for name in PACKAGES}
    assert {name: room for name, room in rooms.items() if not room.__all__} == {}
    missing = {n: [word for word in room.__all__ if not hasattr(room, word)] for n, room in rooms.items()}
    assert {name: words for name, words in missing.items() if words} == {}
    assert [name for name, room in rooms.items() if len(set(room.__all__)) != len(room.__all__)] == []


def _type_checked_names(path):
    """Return the names that a module imports for type checkers and documentation only."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    blocks = [n for n in tree.body if isinstance(n, ast.If) and ast.unparse(n.test) == "TYPE_CHECKING"]
    imports = [n for block in blocks for n in block.body if isinstance(n, ast.ImportFrom)]
    return {alias.asname or alias.name for item in imports for alias in item.names}


def test_names_that_a_room_loads_on_first_use_are_there_for_type_checkers():
    rooms = [path for path in SOURCES if path.name == "__init__.py" and "__getattr__" in path.read_text("utf-8")]
    assert rooms
    for path in rooms:
        room = importlib.import_module(".".join(["crowdbot", *path.parent.relative_to(ROOT / "src/crowdbot").parts]))
        eager = {name for name in room.__all__ if name in vars(room) and not hasattr(vars(room)[name], "__path__")}
        assert set(room.__all__) - eager <= _type_checked_names(path), path


def test_the_front_door_opens_on_every_name():
    for name in crowdbot.__all__:
        assert getattr(crowdbot, name) is not None
    assert set(crowdbot.__all__) <= set(dir(crowdbot))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        crowdbot.nothing  # noqa: B018


FRONT_DOOR = """
load_trial Trial run Episode Simulation Robot | read_episode replay branch | evaluate EvaluationPlan parse_methods
| load save Trajectories Windows | ConstantVelocity Kalman Simulated AnchorNet Live Forecast score
| Calibrator ORCA SocialForce
| CrowdModel Predictor Navigator Observation Sensor LogMetric Scene Pose Twist | CrowdbotError cite
"""


def test_the_front_door_has_these_names_by_job_each_with_an_example():
    jobs = [[name for names in modules.values() for name in names] for modules in crowdbot.JOBS.values()]
    assert jobs == [job.split() for job in FRONT_DOOR.split("|")]
    assert {*crowdbot.__all__} == {name for job in jobs for name in job} | {"__version__"}
    examples = {
        name: doctest.DocTestParser().get_examples(getattr(crowdbot, name).__doc__) for job in jobs for name in job
    }
    assert [name for name, found in examples.items() if not found] == []  # the doctests run them


def test_the_tour_lists_the_front_door_by_job():
    text = (ROOT / "docs/getting-started/tour.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([A-Z][^|]*) \| (`cb\.[^|]*) \|$", text, re.MULTILINE)
    listed = {job: re.findall(r"`cb\.(\w+)`", names) for job, names in rows}
    assert listed == {
        job: [name for names in modules.values() for name in names] for job, modules in crowdbot.JOBS.items()
    }


@pytest.mark.program
def test_importing_crowdbot_is_light():
    program = "import sys, json, crowdbot; print(json.dumps([m for m in sys.modules if '.' not in m]))"
    loaded = set(json.loads(subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout))
    assert loaded.isdisjoint(HEAVY)


@pytest.mark.program
@pytest.mark.parametrize(
    "words", [["--help"], ["--version"], ["run", "--help"], ["predict", "--help"], ["demo", "--help"]]
)
def test_help_loads_nothing_heavy(words):
    program = (
        "import sys, json, contextlib, io\nfrom crowdbot.cli import main\n"
        f"with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):\n    main({words!r})\n"
        "print(json.dumps([m for m in sys.modules if '.' not in m]))"
    )
    loaded = set(json.loads(subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout))
    assert loaded.isdisjoint((*HEAVY, "numpy"))


def test_the_version_stands_in_one_place():
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert f'version = "{crowdbot.__version__}"' in text
    assert f"version: {crowdbot.__version__}" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_constraints_pin_every_dependency():
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    needed = set(re.findall(r'^  "([A-Za-z0-9-]+)>=', project, flags=re.M))
    pinned = set(re.findall(r"^([A-Za-z0-9-]+)==", (ROOT / "constraints.txt").read_text(encoding="utf-8"), flags=re.M))
    assert needed
    assert needed <= pinned
