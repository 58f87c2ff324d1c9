"""Trial files: maps, areas and recordings in the folder of a trial."""

from __future__ import annotations

from pathlib import Path

from crowdbot.core import InputError
from crowdbot.data import folder_files


def resolve_file(name: str, folder: Path | None, trust: bool) -> Path:
    """Return the path of a file that a trial names.

    Args:
        name: path in the trial file, relative to its folder.
        folder: folder of the trial (default: the working folder).
        trust: whether the file may lie outside the folder.

    Raises:
        InputError: the file lies outside the folder or does not exist.
    """
    path = _inside(name, folder, trust)
    if not path.is_file():
        raise InputError(f"there is no file {name[:80]!r} in {folder or Path.cwd()}")
    return path


def resolve_recording(name: str, folder: Path | None, trust: bool) -> Path:
    """Return the path of a recording that a trial names: a file, or a folder that is one recording.

    Args:
        name, folder, trust: see :func:`resolve_file`; they hold for each file of a folder.

    Raises:
        InputError: it does not exist, or a file of it lies outside the folder of the trial.
        DataError: the folder has no files, or too many.
    """
    path = _inside(name, folder, trust)
    if not path.is_dir():
        return resolve_file(name, folder, trust)
    recording_files(name, folder, trust)
    return path


def recording_files(name: str, folder: Path | None, trust: bool) -> dict[str, Path]:
    """Return the paths of the files of a recording by their names in the trial.

    Raises:
        InputError, DataError: as :func:`resolve_recording`.
    """
    path = _inside(name, folder, trust)
    if not path.is_dir():
        return {name: resolve_file(name, folder, trust)}
    names = [f"{name.rstrip('/')}/{file.name}" for file in folder_files(path)]
    return {file: resolve_file(file, folder, trust) for file in names}


def _inside(name: str, folder: Path | None, trust: bool) -> Path:
    """Return the path of a file or folder, which may be missing."""
    root = folder or Path.cwd()
    try:
        path = (root / name).resolve()
        path.is_file()
    except (OSError, ValueError, RuntimeError):
        raise InputError(f"{name[:80]!r} is not a file name") from None
    if not trust and not path.is_relative_to(root.resolve()):
        raise InputError(f"the file {name[:80]!r} lies outside {root}; move it there, or pass --trust to allow it")
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
