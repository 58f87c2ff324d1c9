"""Exceptions of crowdbot.

    CrowdbotError
    ├── InputError (ValueError)        invalid input
    │   ├── DataError                  a recording of tracks cannot be read or has no usable data
    │   ├── TrialError                 invalid trial file, with all problems
    │   ├── EpisodeError               a recorded episode cannot be read, or its replay differs
    │   ├── RobotError                 invalid robot (URDF or robot file), with all problems
    │   └── UnknownName (LookupError)  unknown name, with a suggestion
    └── MissingExtra (ImportError)     an optional dependency is not installed, with the pip command

A message is one sentence: what is wrong, the value, where, what is allowed. The command line prints it after
``crowdbot: `` and exits with status 2.
"""

from __future__ import annotations

import contextlib
import difflib
import importlib
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any


class CrowdbotError(Exception):
    """Base class of the exceptions of crowdbot.

    >>> try:
    ...     raise InputError("speed = -1 m/s must be at least 0")
    ... except CrowdbotError as error:
    ...     print(error)
    speed = -1 m/s must be at least 0
    """


class InputError(CrowdbotError, ValueError):
    """Invalid input."""


class DataError(InputError):
    """A recording of tracks cannot be read or has no usable data."""


class TrialError(InputError):
    """Invalid trial file; ``problems`` are all messages in file order."""

    def __init__(self, *problems: str) -> None:
        self.problems = problems
        super().__init__("\n".join(problems))


class RobotError(InputError):
    """Invalid robot (URDF or robot file); ``problems`` are all messages in file order."""

    def __init__(self, *problems: str) -> None:
        self.problems = problems
        super().__init__("\n".join(problems))


class EpisodeError(InputError):
    """A recorded episode cannot be read, or its replay differs from the recording."""


class UnknownName(InputError, LookupError):
    """Unknown name; with ``address`` the message says that the address of a class is accepted too."""

    def __init__(self, kind: str, name: str, known: Iterable[str], address: bool = False) -> None:
        known = sorted(known)
        also = " (or an address: package.module:Name, file.py:Name)" if address else ""
        super().__init__(f"unknown {kind} {name!r}{did_you_mean(name, known)}; known are {', '.join(known)}{also}")


class MissingExtra(CrowdbotError, ImportError):
    """An optional dependency is not installed."""

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f"{what} needs the extra [{extra}]: pip install 'crowdbot[{extra}]'")


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return ``, did you mean 'x'?`` if a known word is similar, otherwise an empty string.

    >>> did_you_mean("kalmann", ["kalman", "orca"])
    ", did you mean 'kalman'?"
    """
    near = nearest_name(word, known)
    return f", did you mean {near!r}?" if near else ""


def nearest_name(word: str, known: Iterable[str]) -> str:
    """Return the most similar known word, or an empty string.

    >>> nearest_name("Kalmann", ["kalman", "orca"]), nearest_name("x", ["kalman"])
    ('kalman', '')
    """
    known = list(known)
    near = difflib.get_close_matches(word.lower(), [k.lower() for k in known], n=1, cutoff=0.6)
    return next(k for k in known if k.lower() == near[0]) if near else ""


@contextlib.contextmanager
def explain_write_errors(path: Path) -> Iterator[None]:
    """Replace an ``OSError`` inside the block, such as a full disk, by an ``InputError`` that names the file.

    Args:
        path: file or folder that is written; named if the error names no file.

    Raises:
        InputError: a file cannot be written.

    >>> with explain_write_errors(Path("nowhere")):
    ...     raise OSError(28, "No space left on device")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: cannot write nowhere: No space left on device
    """
    try:
        yield
    except (CrowdbotError, BrokenPipeError):
        raise
    except OSError as error:
        raise InputError(f"cannot write {error.filename or path}: {error.strerror or error}") from None


def import_optional(module: str, what: str, extra: str) -> Any:
    """Import an optional dependency.

    Args:
        module: name of the module.
        what: feature that requires it, for the message.
        extra: the extra of crowdbot that installs it.

    Raises:
        MissingExtra: the module is not installed.

    >>> import_optional("nothing_of_this_name", "a dream", "sim")
    Traceback (most recent call last):
    crowdbot.core.errors.MissingExtra: a dream needs the extra [sim]: pip install 'crowdbot[sim]'
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        raise MissingExtra(what, extra) from None


PROGRAMS = "CROWDBOT_PROGRAMS"
"""Variable of the environment; ``refuse`` for processes that start no programs named by trials. Children inherit it."""


def check_programs(what: str) -> None:
    """Raise :class:`InputError` if this process must not start programs that a trial names.

    Args:
        what: who needs the program, for the message.

    >>> check_programs("navigator mine")
    """
    if os.environ.get(PROGRAMS) == "refuse":
        raise InputError(
            f"{what} is a program, and this server starts no programs named by trials;"
            " the person who runs it can allow them with --programs"
        )
