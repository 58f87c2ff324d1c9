"""Where the files of a robot may lie: in its own folder or in a package folder that was given, nowhere else."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from urllib.parse import unquote

from crowdbot.core import InputError, parse_xml

__all__ = ["Folders", "robot_folder"]

INNER = ("urdf", "robots")
"""Folders inside a robot's folder that hold the URDF, beside one with the meshes, as ROS packages have them."""
MOST_PACKAGE_BYTES = 100_000


def robot_folder(urdf: Path) -> Path:
    """Return the folder of the robot whose URDF this is.

    It is the nearest folder above, at most two up, that holds a ``package.xml``; otherwise the folder of the URDF, or
    the one above when it is called ``urdf`` or ``robots``.
    """
    here = urdf.resolve().parent
    for folder in (here, *list(here.parents)[:2]):
        if (folder / "package.xml").is_file():
            return folder
    return here.parent if here.name in INNER else here


class Folders:
    """Finds the files that a URDF names.

    Args:
        root: folder of the robot.
        packages: folders of ROS packages by their names.
        beside: folder from which relative paths are counted (default: the root).
    """

    def __init__(self, root: Path, packages: Mapping[str, Path] | None = None, beside: Path | None = None) -> None:
        self.root = root.resolve()
        self.beside = self.root if beside is None else beside.resolve()
        self.packages = {name: Path(folder).resolve() for name, folder in (packages or {}).items()}
        self.name = _package_name(self.root)

    def find(self, reference: str) -> Path | None:
        """Return the file that ``package://``, ``file://`` or a relative path means, None when it is not there.

        Raises:
            InputError: the reference is of another kind, or leaves the folders.
        """
        scheme, _, rest = reference.partition("://")
        if not rest and "://" not in reference:
            candidates = [self.beside / reference]
        elif scheme in ("package", "model"):
            candidates = self._in_packages(rest)
        elif scheme == "file":
            candidates = [Path(unquote(rest))]
        else:
            raise InputError(
                f"{_cut(reference)} is not read: a file is named by package://, file:// or a relative path"
            )
        if len(reference) > 1000 or any(len(part.encode()) > 255 for part in reference.split("/")):
            raise InputError(f"{_cut(reference)} is too long for the name of a file")
        for candidate in candidates:
            place = self._inside(candidate, reference)
            if place.is_file():
                return place
        return None

    def _in_packages(self, rest: str) -> list[Path]:
        """Return where a package's file may lie, the likeliest first.

        A robot's folder that was copied out of its package keeps the end of the path: ``robots/arm/meshes/a.stl`` may
        lie at ``meshes/a.stl``.
        """
        name, _, path = rest.partition("/")
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
            raise InputError(f"{_cut(reference)} names no file: {error}") from None
        if not any(place.is_relative_to(folder) for folder in (self.root, *self.packages.values())):
            raise InputError(
                f"{_cut(reference)} leaves the robot's folder {self.root};"
                " put the file inside, or name its package folder"
            )
        return place


def _package_name(folder: Path) -> str:
    """Return the name in the folder's ``package.xml``, or the folder's own."""
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
