"""Which trials the participants of the CrowdBot simulator of 2021 went through: its configurations and order files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from crowdbot.core import InputError, TrialError
from crowdbot.trials.files.trial_files import resolve_file

__all__ = ["Plan"]

MOST_LINES = 1000
MOST_USERS = 100
DEFAULT = "./Scenario/Test/FileOrder{USER}.csv"


@dataclass(frozen=True)
class Plan:
    """What a configuration or an order file says of the trials.

    Fields:
        path: of the file that was given.
        folder: what names are relative to.
        pattern: name of the order files; ``{USER}`` is the participant, ``{TWO}`` the participant modulo 2.
        user: the participant it names.
        first: the line of the order to begin with, from 0.
        notes: what cannot be carried over.
    """

    path: Path
    folder: Path
    pattern: str = DEFAULT
    user: int = 0
    first: int = 0
    notes: tuple[str, ...] = ()

    def named(self, name: str, user: int) -> str:
        """Return a name with the number of a participant filled in."""
        return name.replace("\\", "/").replace("{USER}", str(user)).replace("{TWO}", str(user % 2))

    def entries(self, user: int) -> tuple[str, ...]:
        """Return the names of the trials of a participant in their order.

        Raises:
            TrialError: there is no order file, or it is no text.
        """
        order = self.named(self.pattern, user)
        try:
            file = resolve_file(order, self.folder, trust=False)
            lines = [line.strip() for line in file.read_text(encoding="utf-8-sig").splitlines() if line.strip()]
        except (InputError, UnicodeDecodeError, OSError) as error:
            raise TrialError(f"{self.path}: the order file {order[:80]!r} cannot be read: {error}") from None
        chosen = lines[self.first : self.first + MOST_LINES]
        return tuple(self.named(line.split(";")[0].split(",")[0].strip(), user) for line in chosen)

    def users(self) -> tuple[int, ...]:
        """Return the participants, from 0, who have an order file of their own; only that of the file without any."""
        if "{USER}" not in self.pattern and "{TWO}" not in self.pattern:
            return (self.user,)
        most = MOST_USERS if "{USER}" in self.pattern else 2
        return tuple(user for user in range(most) if self._is_there(user)) or (self.user,)

    def place(self, entry: str) -> Path:
        """Return the file of a trial: in the folder, or below one of the three folders around it.

        Raises:
            InputError: there is none.
        """
        for folder in (self.folder, *self.folder.resolve().parents[:3]):
            try:
                return resolve_file(entry, folder, trust=False)
            except InputError:
                continue
        return resolve_file(entry, self.folder, trust=False)

    def _is_there(self, user: int) -> bool:
        try:
            return resolve_file(self.named(self.pattern, user), self.folder, trust=False).is_file()
        except InputError:
            return False
