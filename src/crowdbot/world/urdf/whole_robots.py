"""The files of a robot folder that a part of a robot belongs to."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

from crowdbot.core import Element, InputError, parse_xml

__all__ = ["find_whole_robots"]

ENDINGS = (".xacro", ".urdf", ".gazebo", ".xml")
MOST_FILES = 200
MOST_BYTES = 1_000_000
COMMANDS = frozenset(
    ("if", "unless", "property", "macro", "arg", "include", "insert_block", "attribute", "element", "call")
)
"""Elements of xacro that are no calls of macros."""
FILE_NAME = re.compile(r"[\w.+-]+\.(?:xacro|urdf|gazebo|xml)\b")


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
        new = {one for path, part in parts.items() if path.name == name for one in part.includes} - found
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
    named = [(one.tag.removeprefix("xacro:"), one.attributes) for one in elements if one.tag.startswith("xacro:")]
    includes = {name for tag, row in named if tag == "include" for name in FILE_NAME.findall(row.get("filename", ""))}
    defined = {row.get("name", "").removeprefix("xacro:") for tag, row in named if tag == "macro"}
    called = {tag for tag, _ in named if tag not in COMMANDS}
    links = any(one.tag == "link" for one in elements)
    return _Part(frozenset(includes), frozenset(defined), frozenset(called), links)


def _elements(root: Element) -> Iterator[Element]:
    waiting = [root]
    while waiting:
        element = waiting.pop()
        yield element
        waiting.extend(element.children)
