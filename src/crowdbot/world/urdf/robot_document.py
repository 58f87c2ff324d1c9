"""The XML of a robot file, with xacro expanded."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import Element, RobotError, parse_xml, read_bytes
from crowdbot.world.xacro import expand_xacro, is_xacro

from .folders import Folders, robot_folder
from .sdf import urdf_of_sdf
from .whole_robots import find_whole_robots

__all__ = ["RobotDocument", "parse_robot_file"]


class RobotDocument(NamedTuple):
    """A parsed robot file.

    Fields:
        root: the root element <robot>.
        place: file name for messages.
        folders: folders from which its files may be read.
        ignored: sentences about what the expansion of xacro left out.
        arguments: names and values of the xacro arguments.
    """

    root: Element
    place: str
    folders: Folders
    ignored: tuple[str, ...] = ()
    arguments: Mapping[str, str] = {}


def parse_robot_file(
    source: str | Path,
    *,
    folder: Path | None = None,
    packages: Mapping[str, Path] | None = None,
    arguments: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
) -> RobotDocument:
    """Return the elements of a URDF, xacro or SDF file as URDF; arguments as in :func:`read_urdf`.

    Raises:
        RobotError: the file is missing, is not XML of a robot, or its xacro has an error.

    >>> parse_robot_file("<robot name='r'><link name='a'/></robot>").root.children[0].tag
    'link'
    """
    path: Path | None = None
    if isinstance(source, str) and source.lstrip().startswith("<"):
        data, place, home = source.encode("utf-8", "replace"), "urdf", folder or Path.cwd()
    else:
        path = Path(source)
        data, place = read_bytes(path, "URDF", RobotError), str(path)
        home = folder or robot_folder(path)
    root = parse_xml(data, place, what="URDF", root="robot", refusal=RobotError)
    beside = None if path is None else path.resolve().parent
    folders = Folders(home, packages, beside, search=folder is None and path is not None)
    if root.tag in ("sdf", "model", "gazebo"):
        if arguments:
            raise RobotError(f"{place}: an SDF file has no argument {next(iter(arguments))[:60]!r}")
        converted = urdf_of_sdf(root, place)
        return RobotDocument(converted.root, place, folders, converted.ignored)
    if not is_xacro(root):
        if arguments:
            raise RobotError(f"{place}: it is not a xacro file and has no argument {next(iter(arguments))[:60]!r}")
        _check_root(root, place)
        _check_links(root, root, place, path, home, "")
        return RobotDocument(root, place, folders)
    _check_root(root, place)
    try:
        found = expand_xacro(root, place, folders, path=path, arguments=arguments, environment=environment)
    except RobotError as error:
        advice = "" if root.each("link") else _advice(path, home)
        raise (RobotError(f"{error}{advice}") if advice else error) from None
    _check_links(root, found.root, place, path, home, ", ".join(sorted(found.macros)[:8]))
    return RobotDocument(found.root, place, folders, found.ignored, found.arguments)


def _check_links(root: Element, made: Element, place: str, path: Path | None, home: Path, macros: str) -> None:
    """Raise an error if there is no link and the file belongs to another one, or only defines macros."""
    if made.each("link"):
        return
    advice = _advice(path, home)
    if macros:
        advice = advice or "; give the file that calls them"
        raise RobotError(f"{place}: it only defines macros ({macros}) and contains no <link>{advice}")
    if advice:
        raise RobotError(f"{place}:{root.line}: <robot> contains no <link>{advice}")


def _advice(path: Path | None, home: Path) -> str:
    """Return which file to give instead of a part of a robot, as the end of a sentence."""
    whole = () if path is None else find_whole_robots(path, home)
    if not whole:
        return ""
    return f"; it is a part of a robot, give {' or '.join(whole[:4])}"


def _check_root(root: Element, place: str) -> None:
    if root.tag != "robot":
        raise RobotError(f"{place}:{root.line}: the root element is <{root.tag[:40]}>, expected <robot>")
