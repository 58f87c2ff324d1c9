"""``tools/house.py``, the check of structure and names: it finds every breach, and the package passes."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TOOL = ROOT / "tools" / "house.py"


@pytest.fixture(scope="module")
def house():
    """Return the tool as a module."""
    spec = importlib.util.spec_from_file_location("house", TOOL)
    module = importlib.util.module_from_spec(spec)
    sys.modules["house"] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules["house"]


def breaches(house, folder, **files):
    """Return the breaches of a package ``made`` of these files by rule; a double underscore divides folders."""
    for name, text in files.items():
        path = folder / "made" / (name.replace("__", "/") + ".py")
        path.parent.mkdir(parents=True, exist_ok=True)
        (path.parent / "__init__.py").touch()
        path.write_text(text, encoding="utf-8")
    (folder / "made" / "__init__.py").touch()
    measured = house.measure(folder / "made", {"low.kernel"}, {"mujoco"})
    return {rule: found for rule, found in measured.items() if found}


@pytest.mark.program
def test_the_package_has_no_circular_or_deep_import():
    done = subprocess.run([sys.executable, TOOL], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(done.stdout.splitlines()) == 7


@pytest.mark.parametrize(
    "back",
    [
        "from .b import x",
        "def f():\n    from . import b\n",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import made.b\n",
        "def f():\n    def g():\n        from made.b import x\n",
    ],
    ids=["plain", "in a function", "type-only", "nested"],
)
def test_a_circle_of_any_kind_is_found(house, tmp_path, back):
    found = breaches(
        house, tmp_path, a=back, b="from .c import y\nx = 1", c="from . import a\ny = 1", d="from . import a"
    )
    assert found[house.CIRCLES] == [f"made.{name} (circle of 3)" for name in "abc"]


def test_imports_without_a_circle_pass(house, tmp_path):
    found = breaches(house, tmp_path, a="from .b import x", b="from .c import y", c="import os")
    assert house.CIRCLES not in found


def test_two_circles_are_told_apart(house):
    edges = {"a": {"b"}, "b": {"a", "c"}, "c": {"d"}, "d": {"e"}, "e": {"c"}, "f": {"f", "a"}}
    assert house.find_circles(edges) == [["c", "d", "e"], ["a", "b"]]


def test_imports_past_the_face_of_a_room(house, tmp_path):
    found = breaches(
        house,
        tmp_path,
        low__kernel="x = 1",
        low__other="from .kernel import x\ny = 1",
        low__listed="z = 1",
        high__user="from made.low import kernel\nfrom made.low.kernel import x\nfrom ..low.other import y",
        high__more="from made.low import listed",
    )
    assert found[house.DEEP] == ["high/more.py:1 made.low.listed", "high/user.py:3 made.low.other"]
    (tmp_path / "made" / "low" / "__init__.py").write_text('__all__ = ["listed"]\n', encoding="utf-8")
    assert breaches(house, tmp_path)[house.DEEP] == ["high/user.py:3 made.low.other"]


def test_class_names(house, tmp_path):
    found = breaches(house, tmp_path, a="class One: ...", b="class One: ...\nclass _Two: ...", c="class _Two: ...")
    assert found == {"class names used twice": ["One: a.py:1, b.py:1"]}


def test_small_modules_with_one_importer(house, tmp_path):
    rule = "modules below 120 lines with one importer"
    files = {
        "a": "x = 1\n" * 119,
        "long": "x = 1\n" * 120,
        "shared": "x = 1",
        "exported": "x = 1",
        "user": "from .a import x\nfrom .long import x as y\nfrom .shared import x as z",
        "other": "from .shared import x",
    }
    (tmp_path / "made").mkdir()
    (tmp_path / "made" / "__init__.py").write_text("from .exported import x\n", encoding="utf-8")
    assert breaches(house, tmp_path, **files) == {rule: ["a.py: 119 lines, used by user.py"]}


def test_implementations_of_one_contract_may_be_small(house, tmp_path):
    contract = "class Sensor:\n    def measure(self):\n        raise NotImplementedError\n"
    found = breaches(
        house,
        tmp_path,
        sensors__sensor=contract,
        sensors__sonar="from .sensor import Sensor\nclass Sonar(Sensor): ...",
        sensors__lidar="from .sensor import Sensor\nclass Lidar(Sensor): ...",
        sensors__mount="from .sonar import Sonar\nfrom .lidar import Lidar",
    )
    assert found == {}


def test_bases_with_one_subclass(house, tmp_path):
    rule = "bases with one subclass"
    two = "class Base: ...\nclass One(Base): ...\nclass Two(Base): ...\n"
    assert breaches(house, tmp_path / "two", a=two) == {}
    one = "class Base: ...\nclass One(Base): ...\n"
    assert breaches(house, tmp_path / "one", a=one) == {rule: ["a.py:1 Base: One in a.py"]}
    # a class of a library may have the name of an own one
    library = "import argparse\nclass Action: ...\nclass Own(argparse.Action): ...\n"
    assert breaches(house, tmp_path / "library", a=library) == {}
    # a private name means the class of its own module
    private = {"a": "class _Base: ...\nclass One(_Base): ...", "b": "class _Base: ...\nclass Two(_Base): ..."}
    assert len(breaches(house, tmp_path / "private", **private)[rule]) == 2
    # a public contract is abstract and exported
    contract = "from abc import ABC\nclass Base(ABC): ...\nclass One(Base): ...\n"
    assert rule in breaches(house, tmp_path / "contract", room__a=contract)
    (tmp_path / "contract" / "made" / "room" / "__init__.py").write_text('__all__ = ["Base"]', encoding="utf-8")
    assert rule not in breaches(house, tmp_path / "contract")


def test_private_names_of_other_objects(house, tmp_path):
    text = (
        "from .b import _hidden\n"
        "class One:\n    def __init__(self): self._x = 1\n"
        "    def equals(self, other): return self._x == other._x\n"
        "    def steal(self, other): return other._y\n"
        "def read(one): return one._x, one._replace(), one.__class__, os._exit\n"
    )
    assert breaches(house, tmp_path, a=text, b="", c="from . import b") == {
        "uses of private names of other objects": ["a.py:1 import _hidden", "a.py:5 other._y", "a.py:6 one._x"]
    }


def test_any_away_from_untyped_libraries(house, tmp_path):
    text = "from typing import Any\ndef f(x: Any) -> Any: ...\ny: dict[str, Any] = {}\n"
    found = breaches(house, tmp_path, a=text, b="def f():\n    import mujoco\n" + text)
    assert found == {"lines with Any away from untyped libraries": ["a.py:2", "a.py:3"]}


def test_only_circular_and_deep_imports_fail(house, tmp_path, capsys):
    (tmp_path / "made").mkdir()
    (tmp_path / "made" / "__init__.py").touch()
    (tmp_path / "made" / "a.py").write_text("class One: ...\nclass Two(One): ...\n", encoding="utf-8")
    assert house.main([str(tmp_path / "made")]) == 0
    assert "    1  bases with one subclass\n" in capsys.readouterr().out
    assert house.main([str(tmp_path / "made"), "--list"]) == 0
    assert "a.py:1 One: Two in a.py\n" in capsys.readouterr().out
    (tmp_path / "made" / "b.py").write_text("from . import c\n", encoding="utf-8")
    (tmp_path / "made" / "c.py").write_text("from . import b\n", encoding="utf-8")
    assert house.main([str(tmp_path / "made")]) == 1
    printed = capsys.readouterr().out
    assert "modules in import circles  <- must be 0\n         made.b (circle of 2)\n" in printed
