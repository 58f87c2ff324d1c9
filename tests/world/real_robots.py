"""Robot files of other makers in the folder of inputs that cannot ship, sorted by their content."""

import os
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

FOLDER = Path(os.environ.get("CROWDBOT_SHARED") or Path(__file__).parents[3] / "shared") / "urdf"


def _files(*endings):
    return sorted(path for ending in endings for path in FOLDER.rglob(f"*.{ending}"))


def is_xacro(path):
    """Return whether a file has to be expanded before it is URDF."""
    return re.search(r"<xacro:|=\s*\"[^\"]*\$[{(]", path.read_text(encoding="utf-8")) is not None


def is_empty(path):
    """Return whether a file has no link: a placeholder that other files include."""
    return "<link" not in path.read_text(encoding="utf-8")


XACRO = [path for path in _files("urdf", "xacro") if is_xacro(path)]
"""Xacro files, whatever they are called: robots and parts of robots."""
EMPTY = [path for path in _files("urdf") if not is_xacro(path) and is_empty(path)]
ROBOTS = tuple(
    str(path.relative_to(FOLDER)) for path in _files("urdf") if not is_xacro(path) and not is_empty(path)
) or ("pepper/pepper.urdf",)  # without the folder the tests are still collected, and left out
"""Robots that every reader must take."""


def is_weighed(name):
    """Return whether every link of a robot that has a shape has an inertial too."""
    links = ElementTree.parse(FOLDER / name).iter("link")
    return all(link.find("inertial") is not None for link in links if link.find("visual") is not None)
