"""Submission: a folder with a navigator, packed as a zip file whose bytes depend on its content only."""

from __future__ import annotations

import hashlib
import io
import tomllib
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from crowdbot.core import InputError, did_you_mean, explain_write_errors

DESCRIPTION = "submission.toml"
KEYS = ("name", "authors", "about", "navigator", "command", "parameters")
MOST_FILES = 1000
MOST_BYTES = 200_000_000
LONGEST = 200
"""Characters of a text for people."""


@dataclass(frozen=True)
class Submission:
    """A navigator that somebody submits.

    Fields:
        folder: its folder.
        name, authors, about: for people.
        navigator: class in a file of the folder, ``mine.py:Mine``.
        command: program in the folder that speaks the protocol of process navigators, instead of a class.
        parameters: parameters of the class, ``name=value`` separated by blanks.
    """

    folder: Path
    name: str
    authors: str = ""
    about: str = ""
    navigator: str = ""
    command: str = ""
    parameters: str = ""

    @property
    def files(self) -> list[Path]:
        """All files, sorted by their name."""
        paths = [path for path in self.folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts]
        return sorted(paths, key=lambda path: path.relative_to(self.folder).as_posix())

    @property
    def hash(self) -> str:
        """SHA-256 of names and contents of all files."""
        found = hashlib.sha256()
        for path in self.files:
            content = path.read_bytes()
            found.update(f"{path.relative_to(self.folder).as_posix()}\0{len(content)}\0".encode() + content)
        return found.hexdigest()


def load_submission(folder: Path | str) -> Submission:
    """Read the description of a submission; none of its code runs.

    Raises:
        InputError: the folder has no valid ``submission.toml``, a link, too many files or too many bytes.
    """
    place = Path(folder)
    file = place / DESCRIPTION
    if not file.is_file():
        raise InputError(f"{place} is no submission: it has no {DESCRIPTION}")
    _check_files(place)
    try:
        values = tomllib.loads(file.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{file}: {error}") from None
    try:
        return _submission(place, values)
    except InputError as error:
        raise InputError(f"{file}: {error}") from None


def _submission(place: Path, values: Mapping[str, Any]) -> Submission:
    for name, value in values.items():
        if name not in KEYS:
            raise InputError(f"{name!r} is unknown{did_you_mean(name, KEYS)}; known are {', '.join(KEYS)}")
        if not isinstance(value, str) or len(value) > LONGEST:
            raise InputError(f"{name} must be a text of at most {LONGEST} characters")
    submission = Submission(place, **values) if "name" in values else Submission(place, "", **values)
    if not submission.name.strip():
        raise InputError("'name' is missing")
    if bool(submission.navigator) == bool(submission.command):
        raise InputError("give either navigator = 'mine.py:Mine' or command = './program'")
    file = (submission.navigator or submission.command.split()[0]).partition(":")[0]
    if PurePosixPath(file).is_absolute() or ".." in PurePosixPath(file).parts or not (place / file).is_file():
        raise InputError(f"{file!r} must be a file of the submission")
    if submission.navigator and ("/" in file or not submission.navigator.partition(":")[2].isidentifier()):
        raise InputError(
            f"navigator = {submission.navigator!r} must be a class in a file beside {DESCRIPTION}: mine.py:Mine"
        )
    return submission


def _check_files(place: Path) -> None:
    files = [path for path in place.rglob("*") if not path.is_dir() or path.is_symlink()]
    for path in files:
        if path.is_symlink() or not path.is_file():
            raise InputError(f"{path} is not a plain file")
    if len(files) > MOST_FILES:
        raise InputError(f"{place} has {len(files)} files, at most {MOST_FILES} are allowed")
    size = sum(path.stat().st_size for path in files)
    if size > MOST_BYTES:
        raise InputError(f"{place} has {size} bytes, at most {MOST_BYTES} are allowed")


def pack_submission(submission: Submission, path: Path, extra: Mapping[str, bytes] | None = None) -> None:
    """Write a submission as a zip file; the same files give the same bytes.

    Args:
        submission: the submission.
        path: the zip file.
        extra: further files by name, such as the own result.
    """
    contents = {
        f"submission/{file.relative_to(submission.folder).as_posix()}": file.read_bytes() for file in submission.files
    }
    contents |= extra or {}
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(contents):
            entry = zipfile.ZipInfo(name)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, contents[name])
    with explain_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data.getvalue())


def unpack_submission(path: Path, folder: Path) -> tuple[Submission, dict[str, bytes]]:
    """Write the files of a packed submission into an empty folder; return it and the other files by name.

    Raises:
        InputError: the file is no zip file, is too large, or has a name that leads outside.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
            if len(entries) > MOST_FILES or sum(entry.file_size for entry in entries) > MOST_BYTES:
                raise InputError(f"{path} has more than {MOST_FILES} files or {MOST_BYTES} bytes")
            contents = {entry.filename: _read(archive, entry) for entry in entries if not entry.is_dir()}
    except (OSError, zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError) as error:
        raise InputError(f"{path} is not a packed submission: {error}") from None
    extra = {}
    for name, content in contents.items():
        parts = PurePosixPath(name).parts
        if not parts or parts[0] != "submission":
            extra[name] = content
            continue
        if ".." in parts or PurePosixPath(name).is_absolute() or "\\" in name or ":" in name or "\0" in name:
            raise InputError(f"{path}: {name!r} leads outside of the submission")
        file = folder.joinpath(*parts[1:])
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        except OSError as error:
            raise InputError(f"{path}: {name!r} cannot be written: {error.strerror}") from None
    return load_submission(folder), extra


def _read(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    with archive.open(entry) as stream:
        content = stream.read(entry.file_size + 1)
    if len(content) > entry.file_size:
        raise zipfile.BadZipFile(f"{entry.filename} is larger than it says")
    return content
