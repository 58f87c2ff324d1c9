"""MeshFiles: the files that a mesh refers to, its materials and textures."""

from __future__ import annotations

import re
from pathlib import Path
from urllib.parse import unquote

from crowdbot.core import InputError

from .folders import Folders

MOST_BYTES = 32_000_000
MOST_FILES = 100


class MeshFiles:
    """Finds material files and textures of a mesh inside the folders of the robot.

    A name is a path beside the mesh. If there is no such file, a file of the same name in the folder of the mesh is
    taken, as makers often write paths of their own computer.

    Args:
        folders: folders from which files may be read.
        path: the mesh file.

    Attributes:
        found: paths by the names in the mesh.
        remarks: sentences about files that are not used.
    """

    def __init__(self, folders: Folders, path: Path) -> None:
        self.folders, self.path = folders, path
        self.file_name = path.name
        self.found: dict[str, Path] = {}
        self.remarks: list[str] = []

    def get(self, name: str) -> bytes:
        """Return the content of a file.

        Raises:
            OSError: the file is missing, too large or outside the folders; :attr:`remarks` says which.
        """
        text = name if isinstance(name, str) else str(name)
        try:
            path = self.find(text)
            if path is None:
                raise InputError("is missing")
            if path.stat().st_size > MOST_BYTES:
                raise InputError(f"is larger than {MOST_BYTES} bytes, the maximum")
            if len(self.found) >= MOST_FILES:
                raise InputError(f"is left out: a mesh may have at most {MOST_FILES} files")
            data = path.read_bytes()
        except (InputError, OSError) as error:
            reason = str(error) if isinstance(error, InputError) else f"cannot be read: {error.strerror or error}"
            self.remarks.append(f"the file {text[:80]!r} of the mesh {self.path.name} {reason}; its colour is used")
            raise FileNotFoundError(text[:80]) from None
        self.found[text] = path
        return data

    def __getitem__(self, name: str) -> bytes:
        return self.get(name)

    def find(self, name: str) -> Path | None:
        """Return the path of a file, or None if it is missing.

        Raises:
            InputError: the only such file is outside the folders.
        """
        plain = unquote(name.strip().strip('"').replace("\\", "/")).removeprefix("./")
        beside = self.path.parent
        if not plain or "\0" in plain:
            return None
        last = plain.rpartition("/")[2]
        names = [plain, last] if last not in ("", plain) else [plain]
        problem: InputError | None = None
        for item in names:
            if re.match(r"(?i)[a-z]:|https?:", item):
                continue
            try:
                path = self.folders.find(item, beside)
            except InputError as error:
                if "outside the robot folder" not in str(error):
                    return None
                problem = InputError("is outside the folder of the robot")
                continue
            if path is not None:
                return path
        if problem is not None:
            raise problem
        return None
