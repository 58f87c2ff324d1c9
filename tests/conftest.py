"""Fixtures for inputs that are not part of the repository, and what happens to a test when its input is missing.

A test names its inputs as fixtures: ``recordings``, ``urdf``, ``chromium``, ``digests``, ``drawing``, ``ros1`` and
others. If an input is missing, the tests that need it are deselected, and one line at the end gives their number, the
reason and the remedy. If the variable ``CI`` is set (and ``ALONE`` is not), only rights that a container does not give
are a reason to leave tests out; every other missing input is a failure.

The same holds for packages that only the extra ``dev`` installs, see ``missing_packages.py``.

A test that needs a real clock, a browser, another program, a port or a kill has the marker ``live``: it runs in
``make live``. Who asks for a browser, ROS 1 or RViz as a fixture gets the marker by that.

Property tests draw the same examples in every run; ``HUNT=1`` draws new ones.

PyTorch computes with one thread, unless ``OMP_NUM_THREADS`` says otherwise: its sums are then the same on every
machine, and no thread of one worker spins while it waits for a core that another worker uses. numba does not read it.
"""

from __future__ import annotations

import functools
import gc
import importlib.util
import json
import os
import shutil
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

import missing_packages
from gate_guard import GateGuard

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before a test imports torch

settings.register_profile("same", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("hunt", deadline=None)
settings.load_profile("hunt" if os.environ.get("HUNT") else "same")

ROOT = Path(__file__).parents[1]
SHARED = Path(os.environ.get("CROWDBOT_SHARED") or ROOT.parent / "shared")
"""Folder of the inputs that cannot ship: ``data/`` and ``urdf/``. tests/RECORDINGS.md lists its content."""
collect_ignore = ["bridges/ros1_robot.py"]
"""A program for the Python of the system, which has rospy. A conftest.py beside it would break ``make test``: pytest
then collects two modules of the name ``conftest``."""
WORKER_KEY = "deselected_by_input"
WORKER_FILES = "files_without_package"


def _set(variable: str) -> bool:
    return os.environ.get(variable, "").lower() not in ("", "0", "false", "no")


STRICT = _set("CI") and not _set("ALONE")


@dataclass(frozen=True)
class Input:
    """An input that a machine may lack.

    Attributes:
        what: what the tests need, as the line at the end names it.
        remedy: how to get it.
        find: returns where it is, or None.
        right: whether it is a right of the container, which nobody inside can install.
    """

    what: str
    remedy: str
    find: Callable[[], object | None]
    right: bool = False

    def get(self) -> object:
        """Return where it is; the test fails where it is missing."""
        result = self.find()
        if result is None:
            pytest.fail(f"this test needs {self.what}: {self.remedy}", pytrace=False)
        return result


def _folder(name: str) -> Path | None:
    path = SHARED / name
    return path if path.is_dir() else None


@functools.cache
def _drawing() -> str | None:
    from crowdbot.core import CrowdbotError
    from crowdbot.world.rendering.gl_context import backend

    try:
        return backend()
    except CrowdbotError:
        return None


@functools.cache
def _digests() -> str | None:
    """Return the level of the processor if digests of runs must be those of the files."""
    from builtin_digests import FILE, differences, level

    return None if differences(json.loads(FILE.read_text(encoding="utf-8"))["machine"]) else level()


COPY = "tests/RECORDINGS.md"
PACKAGES = "tests/system-packages"
INPUTS = {
    "recordings": Input("recordings that cannot ship", COPY, lambda: _folder("data")),
    "urdf": Input("robot files that cannot ship", COPY, lambda: _folder("urdf")),
    "chromium": Input("Chromium", PACKAGES, lambda: shutil.which("chromium") or shutil.which("chromium-browser")),
    "digests": Input("the system and libraries of the recorded digests", "constraints.txt", _digests),
    "drawing": Input("OpenGL without a screen", PACKAGES, _drawing),
    "ros1": Input("ROS 1", PACKAGES, lambda: shutil.which("rosmaster") and shutil.which("rosbag")),
    "roslaunch": Input("roslaunch of ROS 1", PACKAGES, lambda: shutil.which("roslaunch")),
    "rviz": Input("RViz 1 and Xvfb", PACKAGES, lambda: shutil.which("Xvfb") and shutil.which("rviz")),
}


@pytest.fixture(scope="session")
def recordings() -> Path:
    """Folder of real pedestrian recordings in their original formats."""
    return INPUTS["recordings"].get()  # type: ignore[return-value]


@pytest.fixture(scope="session")
def urdf() -> Path:
    """Folder of URDF files of real robots."""
    return INPUTS["urdf"].get()  # type: ignore[return-value]


@pytest.fixture(scope="session")
def chromium() -> str:
    """Command of the browser."""
    return INPUTS["chromium"].get()  # type: ignore[return-value]


@pytest.fixture(scope="session")
def roslaunch() -> str:
    """Command that reads and starts launch files of ROS 1."""
    return INPUTS["roslaunch"].get()  # type: ignore[return-value]


@pytest.fixture(scope="session")
def rviz() -> str:
    """Command of RViz 1; its X server without a screen is there, too."""
    return INPUTS["rviz"].get()  # type: ignore[return-value]


@pytest.fixture(scope="session")
def digests() -> str:
    """Level of the processor; runs on this computer are equal to the recorded ones to the last bit."""
    return INPUTS["digests"].get()  # type: ignore[return-value]


@pytest.fixture(scope="session")
def drawing() -> str:
    """Name of the OpenGL backend that draws without a screen."""
    return INPUTS["drawing"].get()  # type: ignore[return-value]


@pytest.fixture(scope="session")
def ros1() -> str:
    """Command of the master of ROS 1; its tools and rospy are there, too."""
    return INPUTS["ros1"].get()  # type: ignore[return-value]


@pytest.fixture
def domain() -> Iterator[int]:
    """A ROS domain that no other run on this computer uses; it is locked until the end of the test."""
    from crowdbot.bridges.stack_link import lock_domain

    number, release = lock_domain()
    yield number
    release()


@pytest.fixture(scope="session")
def reference() -> Path:
    """Folder of one-step answers of other crowd engines: all frames if available, otherwise those that ship."""
    return _folder("reference") or ROOT / "tests" / "reference"


def pytest_configure(config: pytest.Config) -> None:
    """Watch the tests of the gate, the doctests of the package among them."""
    config.pluginmanager.register(GateGuard())


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[object]:
    """Keep what the collection makes out of the garbage collector: hundreds of thousands of objects that stay."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.collect()
        gc.freeze()
        gc.enable()


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> None:
    """End the processes of navigators that the tests of a file have left to the end of Python."""
    processes = sys.modules.get("crowdbot.navigation.process.child_process")
    if processes is not None and (nextitem is None or nextitem.path != item.path):
        processes.close_all()


def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> pytest.Module | None:
    """Leave out a test file that imports a package which is not installed."""
    return None if STRICT else missing_packages.OptionalModule.from_parent(parent, path=module_path)


def input_of(name: str) -> Input:
    """Return the input of a name, which may be that of a package."""
    package = Input(f"the package {name}", missing_packages.REMEDY, lambda: importlib.util.find_spec(name))
    return INPUTS.get(name, package)


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselect the tests whose input is missing, and count them."""
    optional = {name for name, item in INPUTS.items() if item.right or not STRICT}
    needed = {name for item in items for name in getattr(item, "fixturenames", ()) if name in optional}
    missing = [name for name in INPUTS if name in needed and INPUTS[name].find() is None]
    first = [next((name for name in missing if name in getattr(item, "fixturenames", ())), None) for item in items]
    if not STRICT:
        first = [
            name or next(iter(missing_packages.packages_of(item)), None)
            for item, name in zip(items, first, strict=True)
        ]
    files = dict(config.stash.get(missing_packages.FILES, {}))
    if files and hasattr(config, "workeroutput"):
        config.workeroutput[WORKER_FILES] = files
    gone = [item for item, name in zip(items, first, strict=True) if name]
    if not gone:
        return
    config.hook.pytest_deselected(items=gone)
    items[:] = [item for item, name in zip(items, first, strict=True) if not name]
    counts = dict(Counter(name for name in first if name))
    if hasattr(config, "workeroutput"):
        config.workeroutput[WORKER_KEY] = counts
    config.stash[COUNTS] = counts


COUNTS = pytest.StashKey[dict[str, int]]()


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: object) -> None:
    """Take the count from a worker of pytest-xdist; every worker collects the same tests."""
    told = getattr(node, "workeroutput", {})
    for key, place in ((WORKER_KEY, COUNTS), (WORKER_FILES, missing_packages.FILES)):
        if key in told:
            node.config.stash[place] = told[key]  # type: ignore[attr-defined]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Print the line about deselected tests."""
    counts = config.stash.get(COUNTS, {})
    if counts:
        terminalreporter.write_line(summary_line(counts), yellow=True)
    if files := config.stash.get(missing_packages.FILES, None):
        terminalreporter.write_line(missing_packages.files_line(files), yellow=True)


def summary_line(counts: dict[str, int]) -> str:
    """Return how many tests were left out, why, and how to run them, in one line."""
    groups: dict[str, list[str]] = {}
    for name, count in counts.items():
        groups.setdefault(input_of(name).remedy, []).append(f"{count} need {input_of(name).what}")
    reasons = "; ".join(f"{', '.join(group)} (see {remedy})" for remedy, group in groups.items())
    return f"{sum(counts.values())} tests left out: {reasons}"
