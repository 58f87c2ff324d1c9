"""Workspace: the folders that a session may read and write."""

from __future__ import annotations

import contextlib
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.parsers import expat  # expat loads no external entity; declarations of entities are refused below

from crowdbot.core import InputError
from crowdbot.trials import Trial, builtin_trials, load_builtin_trial, load_trial

SESSIONS = "sessions"
"""Folder of the other sessions, which lie inside the folder of the first one."""
BEGINNING = 65_536
"""Bytes of an XML file in which its first element is looked for."""


class Workspace:
    """The folder of a session, and folders that it may only read.

    Names of files come from the browser, so they are resolved and compared with the folders; links that lead outside
    are refused, too.

    Args:
        folder: files are read and written here; made if it does not exist.
        readable: more folders whose files may be read.
        limit: size of the folder above which nothing is written [B].

    >>> import tempfile
    >>> space = Workspace(Path(tempfile.mkdtemp()))
    >>> space.writable("../outside.xml")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: file '../outside.xml' is outside the folder of the app
    """

    def __init__(self, folder: Path, readable: tuple[Path, ...] = (), limit: float = math.inf) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder.resolve()
        self.limit = limit
        self.readable_folders = (self.folder, *(item.resolve() for item in readable))

    def readable(self, name: str) -> Path:
        """Return the path of a file that may be read.

        Raises:
            InputError: the file is outside the folders or does not exist.
        """
        path = self._resolve(name)
        if not any(
            path.is_relative_to(readable_folder) for readable_folder in self.readable_folders
        ) or self._is_of_others(path):
            raise InputError(f"file {name!r} is outside the folder of the app")
        if not path.is_file():
            raise InputError(f"file {name!r} does not exist in {self.folder.name}")
        return path

    def writable(self, name: str) -> Path:
        """Return the path of a file that may be written; its folder is made.

        Raises:
            InputError: the file is outside the folder of the app, or the folder is full.
        """
        path = self._resolve(name)
        if not path.is_relative_to(self.folder) or path == self.folder or self._is_of_others(path):
            raise InputError(f"file {name!r} is outside the folder of the app")
        self.check_space()
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def files(self, pattern: str = "*") -> list[str]:
        """Return the names of the files of the folder that match, relative to it, at most 1 000."""
        found = (item.relative_to(self.folder) for item in sorted(self.folder.rglob(pattern)) if item.is_file())
        shown = (
            one.as_posix()
            for one in found
            if one.parts[0] != SESSIONS and not any(part.startswith(".") for part in one.parts)
        )
        return [item for _, item in zip(range(1000), shown, strict=False)]

    def trials(self) -> list[str]:
        """Return the names of the trial files, and of those that are no XML, which a user can mend."""
        return [name for name in self.files("*.xml") if _root(self.folder / name) in ("trial", "")]

    def trial(self, name: str, values: Mapping[str, Any] | None = None) -> Trial:
        """Load a built-in trial or a trial file that may be read; values can name files of the same folder only.

        Args:
            name: name of the trial, or of the file with its ending.
            values: parameters, or values by path, as for :func:`crowdbot.trials.load_trial`.

        Raises:
            InputError: there is no such trial, it is outside the folders, or it has errors.
        """
        if name not in builtin_trials() and (Path(name).suffix or len(Path(name).parts) > 1):
            return load_trial(self.readable(name), values)
        return load_builtin_trial(name, values, folder=self.folder)

    def size(self) -> int:
        """Return the size of all files of the folder, without those of other sessions [B]."""
        total, folders = 0, [self.folder]
        while folders:
            with contextlib.suppress(OSError), os.scandir(folders.pop()) as entries:
                for entry in entries:
                    if entry.is_dir(follow_symlinks=False):
                        if entry.path != str(self.folder / SESSIONS):
                            folders.append(Path(entry.path))
                    else:
                        with contextlib.suppress(OSError):
                            total += entry.stat(follow_symlinks=False).st_size
        return total

    def check_space(self, more: float = 0.0) -> None:
        """Check that there is space for more bytes.

        Raises:
            InputError: the folder would be larger than its limit.
        """
        if math.isinf(self.limit):
            return
        used = self.size()
        if used + more > self.limit:
            raise InputError(
                f"your folder is full: {used / 1e6:.0f} of {self.limit / 1e6:.0f} MB are used;"
                " remove jobs with their results, or ask the person who runs the server for more"
            )

    def _is_of_others(self, path: Path) -> bool:
        return path.is_relative_to(self.folder / SESSIONS)

    def _resolve(self, name: str) -> Path:
        if not name or "\0" in name or len(name) > 1000 or name.encode(errors="ignore").decode() != name:
            raise InputError(f"name of a file = {name!r:.60}: expected 1 to 1000 characters of Unicode")
        return (self.folder / name).resolve()


def shown_path(path: str | Path) -> str:
    """Return a path relative to the working folder, if the file is inside it."""
    here = Path.cwd()
    return os.path.relpath(path, here) if Path(path).is_relative_to(here) else str(path)


def _root(path: Path) -> str:
    """Return the tag of the first element of an XML file, an empty text if there is none in its beginning."""
    tags = list[str]()

    def stop(*declaration: object) -> None:
        raise ValueError("entities are not expanded")

    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda tag, attributes: tags.append(tag)
    parser.EntityDeclHandler = stop
    with contextlib.suppress(OSError, ValueError, expat.ExpatError), path.open("rb") as file:
        parser.Parse(file.read(BEGINNING), False)
    return tags[0] if tags else ""
