"""Trial orders of the CrowdBot simulator of 2021, from its configurations and order files."""

from __future__ import annotations

import contextlib
import functools
import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from crowdbot.core import InputError, TrialError
from crowdbot.trials.files.trial_files import resolve_file

MOST_LINES = 1000
MOST_USERS = 100
MOST_FILES = 100_000
DEFAULT = "./Scenario/Test/FileOrder{USER}.csv"


@dataclass(frozen=True)
class Plan:
    """The order of trials in a configuration or an order file.

    Fields:
        path: the configuration or order file.
        folder: its folder; names in it are relative to this folder.
        pattern: name of the order files; ``{USER}`` is the participant, ``{TWO}`` the participant modulo 2.
        user: participant that the configuration names.
        first: first line of the order, counted from 0.
        notes: one sentence for everything that is not imported.
        root: folder that is searched for files instead of ``folder``, None for none.
    """

    path: Path
    folder: Path
    pattern: str = DEFAULT
    user: int = 0
    first: int = 0
    notes: tuple[str, ...] = ()
    root: Path | None = None

    def fill_in(self, name: str, user: int) -> str:
        """Return a name with the number of a participant filled in."""
        return name.replace("\\", "/").replace("{USER}", str(user)).replace("{TWO}", str(user % 2))

    def entries(self, user: int) -> tuple[str, ...]:
        """Return the names of the trials of a participant in their order.

        Raises:
            TrialError: the order file does not exist or is not text.
        """
        order = self.fill_in(self.pattern, user)
        try:
            file = self.find(order)
            lines = [line.strip() for line in file.read_text(encoding="utf-8-sig").splitlines() if line.strip()]
        except (InputError, UnicodeDecodeError, OSError) as error:
            raise TrialError(f"{self.path}: the order file {order[:80]!r} cannot be read: {error}") from None
        chosen = lines[self.first : self.first + MOST_LINES]
        return tuple(self.fill_in(line.split(";")[0].split(",")[0].strip(), user) for line in chosen)

    def users(self) -> tuple[int, ...]:
        """Return the participants, from 0, with an order file; without any, the one of the configuration."""
        if "{USER}" not in self.pattern and "{TWO}" not in self.pattern:
            return (self.user,)
        most = MOST_USERS if "{USER}" in self.pattern else 2
        return tuple(user for user in range(most) if self._is_there(user)) or (self.user,)

    def find(self, name: str) -> Path:
        """Return the path of a file named in a configuration or an order.

        Names begin at the root of the simulator's project, such as ``./Assets/Scenario/a.xml``. Leading folders that
        do not exist here are dropped. A file in ``folder`` comes first. With a ``root``, the file in it that shares
        most of the end of the name is next; otherwise the three folders above ``folder`` are searched.

        Raises:
            InputError: the file does not exist, or two files match equally well.
        """
        with contextlib.suppress(InputError):
            return resolve_file(name, self.folder, trust=False)
        if self.root is not None:
            return self._find_in_root(name, self.root)
        for folder in (self.folder, *self.folder.resolve().parents[:3]):
            for end in (name, *_ends(name)):
                try:
                    return resolve_file(end, folder, trust=False)
                except InputError:
                    continue
        return resolve_file(name, self.folder, trust=False)

    def _find_in_root(self, name: str, root: Path) -> Path:
        for end in (name, *_ends(name)):
            try:
                return resolve_file(end, root, trust=False)
            except InputError:
                fits = [path for path in self._files.get(PurePosixPath(end).name, ()) if path.endswith(f"/{end}")]
            if len(fits) > 1:
                raise InputError(f"{len(fits)} files in {root} end with {end[:80]!r}: {', '.join(fits[:3])[:300]}")
            if fits:
                return resolve_file(fits[0].lstrip("/"), root, trust=False)
        return resolve_file(name, root, trust=False)

    @functools.cached_property
    def _files(self) -> Mapping[str, tuple[str, ...]]:
        """The files in ``root``, by name: each path begins with ``/``."""
        found: dict[str, list[str]] = {}
        if self.root is not None:
            for path in itertools.islice(self.root.rglob("*"), MOST_FILES):
                if path.is_file():
                    found.setdefault(path.name, []).append(f"/{path.relative_to(self.root).as_posix()}")
        return {name: tuple(sorted(paths)) for name, paths in found.items()}

    def _is_there(self, user: int) -> bool:
        try:
            return self.find(self.fill_in(self.pattern, user)).is_file()
        except InputError:
            return False


def _ends(name: str) -> list[str]:
    """Return the ends of a path, the longest first.

    >>> _ends("./Assets/Scenario/a.xml")
    ['Assets/Scenario/a.xml', 'Scenario/a.xml', 'a.xml']
    """
    parts = [part for part in PurePosixPath(name).parts if part not in (".", "..", "/")][-20:]
    return ["/".join(parts[k:]) for k in range(len(parts))]
