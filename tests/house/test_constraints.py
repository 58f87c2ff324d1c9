"""The file of tested versions names everything that the tests install."""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import pin  # noqa: E402


def test_every_package_of_the_tests_has_its_version_in_the_constraints():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    assert lines[0] == pin.HEADER
    written = dict(line.split("==") for line in lines[1:])
    assert list(written) == sorted(written)
    installed = pin.pinned()
    assert len(installed) > 200
    assert {name: written.get(name) for name in installed} == installed, "run tools/pin.py > constraints.txt"
