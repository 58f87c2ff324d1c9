"""Tests run without the packages of the extra `dev`: what needs one is left out and counted."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

import missing_packages

ROOT = Path(__file__).parents[2]
CONFTEST = """
import importlib.util
import sys
import missing_packages
missing_packages.PACKAGES |= {"no_such_package", "other_package"}
sys.path.insert(0, r"@TESTS@")
spec = importlib.util.spec_from_file_location("outer_conftest", r"@TESTS@/conftest.py")
outer = importlib.util.module_from_spec(spec)
sys.modules["outer_conftest"] = outer
spec.loader.exec_module(outer)
names = "pycollect_makemodule", "collection_modifyitems", "terminal_summary", "testnodedown"
globals().update({f"pytest_{name}": getattr(outer, f"pytest_{name}") for name in names})
def pytest_configure(config):
    config.addinivalue_line("markers", "needs(package): a package")
"""
NEEDS = """
import pytest
def test_plain(): pass
@pytest.mark.needs("no_such_package")
def test_marked(): import no_such_package
@pytest.mark.parametrize("world", ["planar", pytest.param("physics", marks=pytest.mark.needs("no_such_package"))])
def test_value(world): assert world == "planar"
@pytest.mark.needs("yaml")
def test_installed(): import yaml
"""


@pytest.mark.program
@pytest.mark.parametrize("workers", [[], ["-n", "1"]], ids=["alone", "xdist"])
@pytest.mark.parametrize("strict", [False, True])
def test_what_needs_a_missing_package_is_left_out_and_counted(tmp_path, strict, workers):
    (tmp_path / "conftest.py").write_text(CONFTEST.replace("@TESTS@", str(ROOT / "tests")))
    (tmp_path / "test_needs.py").write_text(NEEDS)
    (tmp_path / "test_head.py").write_text("from other_package import thing\ndef test_head(): pass\n")
    environment = {name: value for name, value in os.environ.items() if name not in ("CI", "ALONE")}
    environment |= {"PYTHONPATH": str(ROOT / "tests")} | ({"CI": "true"} if strict else {})
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *workers, "."]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env=environment)
    lines = done.stdout.splitlines()
    remedy = missing_packages.REMEDY
    if strict:
        assert done.returncode != 0
        assert "No module named 'other_package'" in done.stdout
        assert not any("left out" in line for line in lines)
    else:
        assert done.returncode == 0, done.stdout + done.stderr
        assert f"2 tests left out: 2 need the package no_such_package (see {remedy})" in lines
        assert f"1 test files left out: 1 needs other_package ({remedy})" in lines
        assert "3 passed" in done.stdout


def test_only_packages_of_the_project_are_missing():
    unknown = ModuleNotFoundError("No module named 'nmpy'", name="nmpy")
    assert missing_packages.missing_package(unknown) is None
    assert missing_packages.missing_package(ImportError("broken", name="torch")) is None
    assert missing_packages.missing_package(None) is None


def test_dev_holds_what_a_room_needs():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    (whole,) = [line for line in extras["dev"] if line.startswith("crowdbot[")]
    assert "test" in whole.removeprefix("crowdbot[").removesuffix("]").split(",")
    assert {line.split(">")[0] for line in extras["test"]} == {"hypothesis", "pytest", "pytest-timeout", "pytest-xdist"}


def test_hooks_before_a_commit_run_the_tools_of_the_project():
    (repository,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))["repos"]
    assert repository["repo"] == "local"
    assert [hook["id"] for hook in repository["hooks"]] == ["ruff-check", "ruff-format", "house"]
    for hook in repository["hooks"]:
        assert hook["language"] == "system"
        assert hook["entry"].startswith(".venv/bin/")
