"""Trial files: maps, areas and recordings in the folder of a trial."""

from __future__ import annotations

from pathlib import Path

from crowdbot.core import InputError

__all__ = ["read_beside", "resolve_file"]


def resolve_file(name: str, folder: Path | None, trust: bool) -> Path:
    """Return the path of a file that a trial names.

    Args:
        name: path in the trial file, relative to its folder.
        folder: folder of the trial (default: the working folder).
        trust: whether the file may lie outside the folder.

    Raises:
        InputError: the file lies outside the folder or does not exist.
    """
    root = folder or Path.cwd()
    try:
        path = (root / name).resolve()
        there = path.is_file()
    except (OSError, ValueError, RuntimeError):
        raise InputError(f"{name[:80]!r} is not a file name") from None
    if not trust and not path.is_relative_to(root.resolve()):
        raise InputError(f"the file {name[:80]!r} lies outside {root}; move it there, or pass --trust to allow it")
    if not there:
        raise InputError(f"there is no file {name[:80]!r} in {root}")
    return path


def read_beside(path: Path, most: int) -> bytes:
    """Return the bytes of a file of limited size.

    Raises:
        InputError: the file is larger or cannot be read.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(most + 1)
    except OSError as error:
        raise InputError(f"{path.name} cannot be read: {error.strerror}") from None
    if len(data) > most:
        raise InputError(f"{path.name} is larger than {most} bytes, which is not read here")
    return data
