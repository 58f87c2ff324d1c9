"""The errors of crowdbot, as one tree.

    CrowdbotError
    ├── InputError (ValueError)        something given by the user is wrong
    │   ├── DataError                  a recording of tracks cannot be read, or holds nothing usable
    │   ├── TrialError                 a trial file is wrong; carries every problem found
    │   ├── EpisodeError               a recorded episode cannot be read or does not replay
    │   ├── RobotError                 a robot (URDF or robot file) is wrong; carries every problem found
    │   └── UnknownName (LookupError)  a name that no room knows, with what may have been meant
    └── MissingExtra (ImportError)     an optional part is not installed, with the pip command

A message is one sentence: what is wrong, its value, where, what is allowed, what to do. The command line prints it
after ``crowdbot: `` and leaves with status 2.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable

__all__ = [
    "CrowdbotError",
    "DataError",
    "EpisodeError",
    "InputError",
    "MissingExtra",
    "RobotError",
    "TrialError",
    "UnknownName",
    "did_you_mean",
    "nearest_name",
]


class CrowdbotError(Exception):
    """The root of every error that crowdbot raises on purpose."""


class InputError(CrowdbotError, ValueError):
    """Something given by the user is wrong."""


class DataError(InputError):
    """A recording of tracks cannot be read, or holds nothing that can be used."""


class TrialError(InputError):
    """A trial file is wrong. ``problems`` holds every sentence found, in file order."""

    def __init__(self, *problems: str) -> None:
        self.problems = problems
        super().__init__("\n".join(problems))


class RobotError(InputError):
    """A robot is wrong: its URDF or its robot file. ``problems`` holds every sentence found, in file order."""

    def __init__(self, *problems: str) -> None:
        self.problems = problems
        super().__init__("\n".join(problems))


class EpisodeError(InputError):
    """A recorded episode cannot be read, or its replay differs from the recording."""


class UnknownName(InputError, LookupError):
    """A name that no room knows; ``address`` says whether the address of a class would do as well."""

    def __init__(self, kind: str, name: str, known: Iterable[str], address: bool = False) -> None:
        known = sorted(known)
        also = " (or an address: package.module:Name, file.py:Name)" if address else ""
        super().__init__(f"unknown {kind} {name!r}{did_you_mean(name, known)}; known are {', '.join(known)}{also}")


class MissingExtra(CrowdbotError, ImportError):
    """An optional part is not installed."""

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f"{what} needs the extra [{extra}]: pip install 'crowdbot[{extra}]'")


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return ``, did you mean 'x'?`` when a known word is near, otherwise an empty string.

    >>> did_you_mean("kalmann", ["kalman", "orca"])
    ", did you mean 'kalman'?"
    """
    near = nearest_name(word, known)
    return f", did you mean {near!r}?" if near else ""


def nearest_name(word: str, known: Iterable[str]) -> str:
    """Return the known word that is near, empty when none is.

    >>> nearest_name("Kalmann", ["kalman", "orca"]), nearest_name("x", ["kalman"])
    ('kalman', '')
    """
    known = list(known)
    near = difflib.get_close_matches(word.lower(), [k.lower() for k in known], n=1, cutoff=0.6)
    return next(k for k in known if k.lower() == near[0]) if near else ""
