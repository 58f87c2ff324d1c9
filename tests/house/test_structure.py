"""``tools/house.py``, the check of structure and names: it finds every breach, and the package is within its limits."""

import importlib.util
import shutil
import subprocess
import sys
import tomllib
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


RULES = {
    "deep": {"kernels": ["low.kernel"]},
    "participles": {"words": ["kept", "told", "gone", "desired"], "particles": ["on"], "allowed": ["rows_told"]},
    "contact": {"words": ["touch"], "allowed": ["TouchScreen"]},
}


def breaches(house, folder, **files):
    """Return the breaches of a package ``made`` of these files by rule; a double underscore divides folders."""
    for name, text in files.items():
        path = folder / "made" / (name.replace("__", "/") + ".py")
        path.parent.mkdir(parents=True, exist_ok=True)
        (path.parent / "__init__.py").touch()
        path.write_text(text, encoding="utf-8")
    (folder / "made" / "__init__.py").touch()
    return {rule: found for rule, found in house.measure(folder / "made", RULES).items() if found}


@pytest.mark.program
def test_the_package_is_within_the_limits():
    done = subprocess.run([sys.executable, TOOL], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stdout + done.stderr


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
    assert found == {"modules in import circles": [f"made.{name} (circle of 3)" for name in "abc"]}


def test_imports_without_a_circle_pass(house, tmp_path):
    assert breaches(house, tmp_path, a="from .b import x", b="from .c import y", c="import os") == {}


def test_two_circles_are_told_apart(house):
    edges = {"a": {"b"}, "b": {"a", "c"}, "c": {"d"}, "d": {"e"}, "e": {"c"}, "f": {"f", "a"}}
    assert house.find_circles(edges) == [["c", "d", "e"], ["a", "b"]]


def test_imports_past_the_face_of_a_room_are_counted(house, tmp_path):
    found = breaches(
        house,
        tmp_path,
        low__kernel="x = 1",
        low__other="from .kernel import x\ny = 1",
        high__user="from made.low import kernel\nfrom made.low.kernel import x\nfrom ..low.other import y",
    )
    assert found["deep imports beyond the kernels of core"] == ["high/user.py:3 made.low.other"]
    assert [line.split()[0] for line in found["deep imports"]] == ["high/user.py:1", "high/user.py:2", "high/user.py:3"]


def test_sizes(house, tmp_path):
    long = "def f():\n" + '    """One\n    two."""\n' + "    x = 1\n" * 60
    found = breaches(house, tmp_path, a="x = 1\n" * 901, b=long, **{f"many__m{k}": "" for k in range(25)})
    assert found == {
        "folders above 25 files": ["many: 26"],
        "files above 900 lines": ["a.py: 901"],
        "functions above 60 lines": ["b.py:1 f has 61 lines"],
    }


def test_names(house, tmp_path):
    text = (
        "class One:\n    def kept(self): ...\n"
        "    @property\n    def told(self) -> bool: ...\n    def _told(self): ...\n"
        "def gone_on(): ...\ndef desired_velocity(): ...\ndef rows_told(): ...\ndef is_told(): ...\n"
        "class WheelTouch: ...\nclass TouchScreen: ...\nclass Touchdown: ...\n"
    )
    found = breaches(house, tmp_path, a=text, b="class One: ...\nclass _Two: ...\n", c="class _Two: ...\n")
    assert found == {
        "class names used twice": ["One: a.py:1, b.py:1"],
        "participles among public functions": ["a.py:6 gone_on", "a.py:2 kept"],
        "other words for contact": ["a.py:10 WheelTouch"],
    }


def test_limits_are_lowered_and_never_raised(house, tmp_path, monkeypatch):
    shutil.copy(TOOL.with_suffix(".toml"), tmp_path / "house.toml")
    monkeypatch.setattr(house, "RULES", tmp_path / "house.toml")
    before = tomllib.loads((tmp_path / "house.toml").read_text(encoding="utf-8"))
    house.tighten({"deep imports": 7, "files above 900 lines": 9999})
    after = tomllib.loads((tmp_path / "house.toml").read_text(encoding="utf-8"))
    assert after == {**before, "limits": {**before["limits"], "deep imports": 7}}


def test_a_figure_above_its_limit_fails_and_names_the_breaches(house, tmp_path, capsys):
    (tmp_path / "made").mkdir()
    (tmp_path / "made" / "a.py").write_text("x = 1\n" * 901, encoding="utf-8")
    assert house.main([str(tmp_path / "made")]) == 1
    assert "above the limit\n         a.py: 901\n" in capsys.readouterr().out
