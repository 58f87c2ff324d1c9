"""The house rules that a machine can check: sizes, names, public lists, light imports, tests that assert."""

import ast
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
HEAVY = ("numba", "pandas", "torch", "matplotlib", "mujoco", "rosbags", "mcap", "h5py", "pyarrow", "shapely", "rich")


def _length(node):
    doc = ast.get_docstring(node, clean=False)
    return node.end_lineno - node.lineno + 1 - (doc.count("\n") + 1 if doc else 0)


def _functions(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT / "src")))
def test_files_and_functions_are_short(path):
    assert path.read_text(encoding="utf-8").count("\n") <= 400
    assert {f.name: _length(f) for f in _functions(path) if _length(f) > 60} == {}


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT / "src")))
def test_every_module_and_public_name_is_documented(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert ast.get_docstring(tree), "the module has no docstring"
    public = [n for n in tree.body if isinstance(n, ast.FunctionDef | ast.ClassDef) and not n.name.startswith("_")]
    methods = [
        m
        for c in public
        if isinstance(c, ast.ClassDef)
        for m in c.body
        if isinstance(m, ast.FunctionDef) and not m.name.startswith("_")
    ]
    overloads = {
        n for n in public + methods if any("overload" in ast.unparse(d) for d in getattr(n, "decorator_list", ()))
    }
    assert [n.name for n in public + methods if n not in overloads and not ast.get_docstring(n)] == []


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


def test_no_test_lacks_an_assertion_or_is_skipped():
    for path in TESTS:
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"@pytest\.mark\.(skip|xfail)|pytest\.skip\(|importorskip", text) or path == Path(__file__)
        for function in _functions(path):
            if not function.name.startswith("test"):
                continue
            held = any(
                isinstance(n, ast.Assert)
                or (isinstance(n, ast.Call) and re.search(r"raises|assert|check|warns", ast.unparse(n.func)))
                for n in ast.walk(function)
            )
            assert held, f"{path.name}: {function.name} asserts nothing"


@pytest.mark.parametrize("name", PACKAGES)
def test_every_room_lists_what_it_shows(name):
    room = importlib.import_module(f"crowdbot.{name}")
    assert room.__all__
    assert all(hasattr(room, word) for word in room.__all__)
    assert len(set(room.__all__)) == len(room.__all__)


def test_the_front_door_opens_on_every_name():
    for name in crowdbot.__all__:
        assert getattr(crowdbot, name) is not None
    assert set(crowdbot.__all__) <= set(dir(crowdbot))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        crowdbot.nothing  # noqa: B018


def test_importing_crowdbot_is_light():
    program = "import sys, json, crowdbot; print(json.dumps([m for m in sys.modules if '.' not in m]))"
    loaded = set(json.loads(subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout))
    assert loaded.isdisjoint(HEAVY)


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
