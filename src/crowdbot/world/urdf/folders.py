"""Folders from which the files of a robot may be read: its own folder and the given package folders."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping
from pathlib import Path
from urllib.parse import unquote

from crowdbot.core import InputError, nearest_name, parse_xml

INNER = ("urdf", "robots")
"""Subfolders of a robot folder that contain the URDF, as in ROS packages."""
MOST_PACKAGE_BYTES = 100_000
MOST_ENTRIES = 2000
"""Maximum number of entries of a folder that is searched for packages."""


def robot_folder(urdf: Path) -> Path:
    """Return the robot folder of a URDF file.

    This is the nearest parent folder, at most two levels up, with a ``package.xml``; otherwise the folder of the URDF,
    or its parent if that folder is named ``urdf`` or ``robots``.
    """
    here = urdf.resolve().parent
    for folder in (here, *list(here.parents)[:2]):
        if (folder / "package.xml").is_file():
            return folder
    return here.parent if here.name in INNER else here


def find_package(name: str, near: Path) -> Path | None:
    """Return the folder of a ROS package near another folder, or None.

    Searched are the folder, its three parents, and the folders beside and two levels below these parents if the folder
    itself is a package. A package is a folder with a ``package.xml`` that has this name.
    """
    near = near.resolve()
    above = [near, *list(near.parents)[:3]]
    path = next((folder for folder in above if _is_package(folder, name)), None)
    if path is not None or not re.fullmatch(r"[A-Za-z][\w-]*", name, re.ASCII):
        return path
    if not (near / "package.xml").is_file():
        return None
    for parent in list(near.parents)[:2]:
        for folder in (parent / name, *(inner / name for inner in _folders(parent))):
            if _is_package(folder, name):
                return folder
    return None


class Folders:
    """Finds the files referenced by a URDF.

    Args:
        root: the robot folder.
        packages: ROS package folders by name.
        beside: base folder of relative paths (default: the root).
        search: whether packages are searched near the robot folder, see :func:`find_package`.
    """

    def __init__(
        self,
        root: Path,
        packages: Mapping[str, Path] | None = None,
        beside: Path | None = None,
        search: bool = False,
    ) -> None:
        self.root, self.search = root.resolve(), search
        self.beside = self.root if beside is None else beside.resolve()
        self.packages = {name: Path(folder).resolve() for name, folder in (packages or {}).items()}
        self.name = _package_name(self.root)

    def find(self, reference: str, beside: Path | None = None) -> Path | None:
        """Return the file of a ``package://`` or ``file://`` URI or a relative path, or None if it does not exist.

        Args:
            reference: the URI or path.
            beside: base folder of a relative path (default: that of the folders).

        Raises:
            InputError: the scheme is not supported, or the path leaves the folders.
        """
        if reference.startswith("file://package://"):  # "file://$(find NAME)/..." of a xacro file
            reference = reference.removeprefix("file://")
        scheme, _, rest = reference.partition("://")
        if not rest and "://" not in reference:
            candidates = [(beside or self.beside) / reference]
        elif scheme in ("package", "model"):
            candidates = self._in_packages(rest)
        elif scheme == "file":
            candidates = [Path(unquote(rest))]
        else:
            raise InputError(f"{_cut(reference)} is not supported; use package://, file:// or a relative path")
        if len(reference) > 1000 or any(len(part.encode()) > 255 for part in reference.split("/")):
            raise InputError(f"{_cut(reference)} is too long for a file name")
        for candidate in candidates:
            place = self._inside(candidate, reference)
            if place.is_file():
                return place
        return None

    def missing_package(self, reference: str) -> str:
        """Return the name of the package of a ``package://`` URI whose folder is not known; otherwise ``""``."""
        scheme, _, rest = reference.partition("://")
        name = rest.partition("/")[0] if scheme == "package" else ""
        return "" if name in (self.name, *self.packages) else name

    def lack(self, reference: str) -> str:
        """Return why a ``package://`` URI has no file: its package is not known, or its folder lacks the file.

        >>> Folders(Path("."), {"arm": Path("/opt/arm")}).lack("package://hand/meshes/a.stl")
        'give --package hand=FOLDER if you have it'
        """
        scheme, _, rest = reference.partition("://")
        if scheme != "package":
            return ""
        name, _, path = rest.partition("/")
        if name not in self.packages:
            return f"give --package {name[:60]}=FOLDER if you have it"
        folder = (self.packages[name] / path).parent
        held = [entry.name for entry in _entries(folder) if entry.is_file()]
        near = nearest_name(Path(path).name, held)
        what = f"it has {near}" if near else f"its folder {Path(path).parent} has {', '.join(held[:5]) or 'no files'}"
        return (
            f"the folder {self.packages[name]} of the package {name[:60]} lacks it, {what}; if that is another version,"
            f" give the right one with --package {name[:60]}=FOLDER"
        )

    def _in_packages(self, rest: str) -> list[Path]:
        """Return the candidate paths of a file in a package, the most likely first.

        A robot folder copied out of its package keeps the end of the path: ``robots/arm/meshes/a.stl`` may be at
        ``meshes/a.stl``.
        """
        name, _, path = rest.partition("/")
        if name not in self.packages and self.search:
            folder = None if self.name == name else find_package(name, self.root)
            if folder is not None:
                self.packages[name] = folder.resolve()
        if name in self.packages:
            return [self.packages[name] / path]
        parts = path.split("/")
        own = [self.root / "/".join(parts[k:]) for k in range(max(1, len(parts)))]
        if ".." in parts:
            own = own[:1]
        if self.name == name:
            return own
        return [self.root / path, self.root / name / path, *own[1:]]

    def _inside(self, candidate: Path, reference: str) -> Path:
        try:
            place = candidate.resolve()
        except (OSError, RuntimeError, ValueError) as error:
            raise InputError(f"{_cut(reference)} is not a valid file name: {error}") from None
        if not any(place.is_relative_to(folder) for folder in (self.root, *self.packages.values())):
            raise InputError(
                f"{_cut(reference)} is outside the robot folder {self.root};"
                " move the file into it, or give its package folder"
            )
        return place


def _is_package(folder: Path, name: str) -> bool:
    return (folder / "package.xml").is_file() and _package_name(folder) == name


def _folders(parent: Path) -> list[Path]:
    return [inner for inner in _entries(parent) if inner.is_dir()]


def _entries(parent: Path) -> list[Path]:
    """Return the entries of a folder in order; none if it cannot be read."""
    try:
        return sorted(itertools.islice(parent.iterdir(), MOST_ENTRIES))
    except (OSError, ValueError):
        return []


def _package_name(folder: Path) -> str:
    """Return the name in the ``package.xml`` of the folder, or the folder name."""
    file = folder / "package.xml"
    try:
        if file.is_file() and file.stat().st_size < MOST_PACKAGE_BYTES:
            names = parse_xml(file.read_bytes(), file.name).each("name")
            return names[0].stray if names else folder.name
    except (OSError, InputError):
        return folder.name
    return folder.name


def _cut(text: str) -> str:
    return repr(text if len(text) <= 80 else text[:77] + "...")
