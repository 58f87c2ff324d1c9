"""Messages for errors of the operating system."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from .errors import CrowdbotError, InputError


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
