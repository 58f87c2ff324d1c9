"""Workspace: the folders that a session may read and write."""

from __future__ import annotations

from pathlib import Path

from crowdbot.core import InputError

__all__ = ["Workspace"]


class Workspace:
    """The folder of a session, and folders that it may only read.

    Names of files come from the browser, so they are resolved and compared with the folders; links that lead outside
    are refused, too.

    Args:
        folder: files are read and written here; made if it does not exist.
        readable: more folders whose files may be read.

    >>> import tempfile
    >>> space = Workspace(Path(tempfile.mkdtemp()))
    >>> space.writable("../outside.xml")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: file '../outside.xml' is outside the folder of the app
    """

    def __init__(self, folder: Path, readable: tuple[Path, ...] = ()) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder.resolve()
        self.readable_folders = (self.folder, *(one.resolve() for one in readable))

    def readable(self, name: str) -> Path:
        """Return the path of a file that may be read.

        Raises:
            InputError: the file is outside the folders or does not exist.
        """
        path = self._resolve(name)
        if not any(path.is_relative_to(one) for one in self.readable_folders):
            raise InputError(f"file {name!r} is outside the folder of the app")
        if not path.is_file():
            raise InputError(f"file {name!r} does not exist in {self.folder.name}")
        return path

    def writable(self, name: str) -> Path:
        """Return the path of a file that may be written; its folder is made.

        Raises:
            InputError: the file is outside the folder of the app.
        """
        path = self._resolve(name)
        if not path.is_relative_to(self.folder) or path == self.folder:
            raise InputError(f"file {name!r} is outside the folder of the app")
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def files(self, pattern: str = "*") -> list[str]:
        """Return the names of the files of the folder that match, relative to it, at most 1 000."""
        found = (one for one in sorted(self.folder.rglob(pattern)) if one.is_file() and not one.name.startswith("."))
        return [one.relative_to(self.folder).as_posix() for _, one in zip(range(1000), found, strict=False)]

    def _resolve(self, name: str) -> Path:
        if not name or "\0" in name or len(name) > 1000:
            raise InputError(f"name of a file = {name!r:.60}: expected 1 to 1000 characters")
        return (self.folder / name).resolve()
