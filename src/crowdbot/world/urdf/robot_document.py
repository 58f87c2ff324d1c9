"""The XML of a robot file, with xacro expanded."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import Element, InputError, RobotError, parse_xml, read_bytes, strict_xml
from crowdbot.world.xacro import expand_xacro, is_xacro

from .folders import Folders, robot_folder
from .sdf import urdf_of_sdf

ENDINGS = (".xacro", ".urdf", ".gazebo", ".xml")
MOST_FILES = 200
MOST_BYTES = 1_000_000
COMMANDS = frozenset(
    ("if", "unless", "property", "macro", "arg", "include", "insert_block", "attribute", "element", "call")
)
"""Elements of xacro that are no calls of macros."""
FILE_NAME = re.compile(r"[\w.+-]+\.(?:xacro|urdf|gazebo|xml)\b")


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
    root = parse_xml(strict_xml(data), place, what="URDF", root="robot", refusal=RobotError)
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


@dataclass(frozen=True)
class _Part:
    """What one file has: included file names, defined macros, called macros, and links."""

    includes: frozenset[str]
    defined: frozenset[str]
    called: frozenset[str]
    links: bool


def find_whole_robots(file: Path, folder: Path) -> tuple[str, ...]:
    """Return the files of a robot folder that use a file, as paths relative to the folder.

    A file is used by the files that include it, also through other files. A file that calls macros which it does not
    have is used by the files that include the definitions. Only files that no other file includes are returned. Nothing
    is expanded: names of included files are read from the text, so an include with a computed name is not found.

    Args:
        file: the part.
        folder: the robot folder; at most 200 files of it are read, links that leave it are not followed.

    >>> find_whole_robots(Path("wheel.xacro"), Path("no-such-folder"))
    ()
    """
    parts = {path: part for path in _files(folder) if (part := _part(path)) is not None}
    mine = parts.get(file.resolve())
    if mine is None:
        return ()
    wanted = {file.name}
    own = _reach({file.name}, parts)
    unmet = mine.called - {name for path, part in parts.items() if path.name in own for name in part.defined}
    wanted |= {path.name for path, part in parts.items() if part.defined & unmet}
    included = {name for part in parts.values() for name in part.includes}
    tops = [
        path
        for path, part in parts.items()
        if path != file.resolve()
        and path.name not in included
        and (part.links or part.called)
        and wanted & _reach(part.includes, parts)
    ]
    return tuple(path.relative_to(folder.resolve()).as_posix() for path in tops)


def _reach(names: Collection[str], parts: dict[Path, _Part]) -> set[str]:
    """Return the names of files with those that they include, at any depth."""
    found, waiting = set(names), list(names)
    while waiting:
        name = waiting.pop()
        new = {include for path, part in parts.items() if path.name == name for include in part.includes} - found
        found |= new
        waiting += new
    return found


def _files(folder: Path) -> Iterator[Path]:
    home, count = folder.resolve(), 0
    for place, folders, names in os.walk(home):
        folders.sort()
        for name in sorted(names):
            path = Path(place) / name
            if path.suffix not in ENDINGS or path.is_symlink():
                continue
            count += 1
            if count > MOST_FILES:
                return
            yield path


def _part(path: Path) -> _Part | None:
    try:
        if path.stat().st_size > MOST_BYTES:
            return None
        root = parse_xml(path.read_bytes(), path.name)
    except (OSError, InputError):
        return None
    elements = list(_elements(root))
    named = [
        (element.tag.removeprefix("xacro:"), element.attributes)
        for element in elements
        if element.tag.startswith("xacro:")
    ]
    includes = {name for tag, row in named if tag == "include" for name in FILE_NAME.findall(row.get("filename", ""))}
    defined = {row.get("name", "").removeprefix("xacro:") for tag, row in named if tag == "macro"}
    called = {tag for tag, _ in named if tag not in COMMANDS}
    links = any(element.tag == "link" for element in elements)
    return _Part(frozenset(includes), frozenset(defined), frozenset(called), links)


def _elements(root: Element) -> Iterator[Element]:
    waiting = [root]
    while waiting:
        element = waiting.pop()
        yield element
        waiting.extend(element.children)
