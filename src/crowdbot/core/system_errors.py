"""Errors of the system at writing, as sentences."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from .errors import CrowdbotError, InputError

__all__ = ["write_errors"]


@contextlib.contextmanager
def write_errors(path: Path) -> Iterator[None]:
    """Turn an error of the system inside the block into a sentence, such as on a full disk.

    Args:
        path: file or folder that is written; named in the sentence if the error names no file.

    Raises:
        InputError: something cannot be written.

    >>> with write_errors(Path("nowhere")):
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
