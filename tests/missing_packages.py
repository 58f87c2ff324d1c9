"""What happens to tests that need a package which the extra ``test`` does not install.

A test says ``@pytest.mark.needs("mujoco")``; without the package it is deselected and counted. A file that imports the
package at its head cannot be collected without it: it is left out as a whole, and counted as a file.
"""

from __future__ import annotations

import importlib.util
from collections import Counter
from collections.abc import Iterable, Mapping

import pytest

REMEDY = 'pip install -c constraints.txt -e ".[dev]"'
PACKAGES = {
    "av", "cbor2", "cv2", "gymnasium", "jsonschema", "jupedsim", "lxml", "mujoco", "natnet", "onnx",
    "onnxruntime", "pettingzoo", "playwright", "pylsl", "pymoo", "qi", "ray", "rclpy", "roslibpy", "segno",
    "stable_baselines3", "stonesoup", "torch", "trimesh", "vhacdx", "websockets", "yaml", "yourdfpy",
}  # fmt: skip
"""Packages of the extra ``dev`` that tests import."""
FILES = pytest.StashKey[Counter[str]]()
"""Test files that are left out, by the package that they lack."""


def is_missing(package: str) -> bool:
    """Return whether a package is not installed."""
    return importlib.util.find_spec(package) is None


def missing_package(error: BaseException | None) -> str | None:
    """Return the package of the extra ``dev`` that an import did not find, or None if it is another failure."""
    name = (getattr(error, "name", None) or "").split(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    return name if name in PACKAGES and is_missing(name) else None


class OptionalModule(pytest.Module):
    """A test file that has no tests if a package is missing that it imports."""

    def collect(self) -> Iterable[pytest.Item | pytest.Collector]:
        """Return the tests of the file."""
        try:
            return super().collect()
        except self.CollectError as error:
            package = missing_package(error.__cause__)
            if package is None:
                raise
            self.config.stash.setdefault(FILES, Counter())[package] += 1
            return []


def packages_of(item: pytest.Item) -> list[str]:
    """Return the missing packages that a test says it needs."""
    named = [str(name) for mark in item.iter_markers("needs") for name in mark.args]
    if unknown := [name for name in named if name not in PACKAGES]:
        raise pytest.UsageError(f"{item.nodeid}: tests/missing_packages.py does not know the package {unknown[0]}")
    return [name for name in named if is_missing(name)]


def files_line(counts: Mapping[str, int]) -> str:
    """Return how many test files were left out, and why, in one line."""
    reasons = ", ".join(f"{count} need{'s' * (count == 1)} {name}" for name, count in sorted(counts.items()))
    return f"{sum(counts.values())} test files left out: {reasons} ({REMEDY})"
