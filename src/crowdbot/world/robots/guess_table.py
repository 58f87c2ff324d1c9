"""Table of the values of a robot folder: which are from the file, which are derived, and which are guesses."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from crowdbot.core import InputError, did_you_mean, parse_number

FILE, DERIVED, GUESS, GIVEN, DOUBTFUL = "file", "derived", "guess", "given", "doubtful"


class Guess(NamedTuple):
    """A value of a robot folder.

    Fields:
        what, value: name and value.
        source: where it is from.
        change: how to change it.
        status: ``file`` (the file gives it), ``derived`` (follows from the file), ``guess``, ``doubtful`` (the file
            gives it, but it is implausible or contradicts another place), or ``given`` by the user.
    """

    what: str
    value: str
    source: str
    change: str
    status: str = FILE

    @property
    def open(self) -> bool:
        """Whether the user has to confirm the value."""
        return self.status in (DERIVED, GUESS, DOUBTFUL)


class GuessTable:
    """Collects values, and replaces those that the user gives.

    Args:
        given: values of the user by name, such as ``{"max-speed": "0.5"}``.

    >>> table = GuessTable({"max-speed": "0.5"})
    >>> table.number("max-speed", 1.0, "a guess", "robot.xml", GUESS, unit="m/s"), table.rows[0].status
    (0.5, 'given')
    """

    def __init__(self, given: Mapping[str, str] | None = None) -> None:
        self.given = dict(given or {})
        self.rows: list[Guess] = []
        self._settable: set[str] = set()

    def add(self, what: str, value: str, source: str, change: str, status: str = FILE) -> None:
        """Add a value that :attr:`given` does not replace."""
        self.rows.append(Guess(what, value, source, change, status))

    def number(self, what: str, value: float, source: str, change: str, status: str = FILE, *, unit: str = "") -> float:
        """Add a number above 0 and return it, or the one that the user gives.

        Raises:
            InputError: the given value is not a number above 0.
        """
        self._settable.add(what)
        if what in self.given:
            try:
                value = parse_number(self.given[what])
            except InputError as error:
                raise InputError(f"--set {what}={self.given[what][:40]} {error}") from None
            if not 0.0 < value <= 1e6:
                raise InputError(f"--set {what}={self.given[what][:40]} must be above 0 and at most 1e6")
            source, status = "--set", GIVEN
        self.add(what, f"{value:.4g} {unit}".strip(), source, f"--set, or {change}", status)
        return value

    def word(self, what: str, value: str, source: str, change: str, status: str, words: tuple[str, ...]) -> str:
        """Add a word and return it, or the one that the user gives.

        Raises:
            InputError: the given word is not one of ``words``.
        """
        self._settable.add(what)
        if what in self.given:
            value = self.given[what]
            if value not in words:
                raise InputError(f"--set {what}={value[:40]} must be {', '.join(words)}{did_you_mean(value, words)}")
            source, status = "--set", GIVEN
        self.add(what, value, source, f"--set, or {change}", status)
        return value

    def check_names(self) -> None:
        """Raise an error if a given name is not in the table."""
        for name in self.given:
            if name not in self._settable:
                meant = did_you_mean(name, self._settable) or f"; it has {', '.join(sorted(self._settable)[:20])}"
                raise InputError(f"--set {name[:60]!r} is not a value of this robot{meant}")
