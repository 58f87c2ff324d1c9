"""Locks of open files, which the system releases when the file is closed or its process ends."""

from __future__ import annotations

import sys
from typing import BinaryIO

LOCKED_BYTE = 1 << 30
"""Position of the locked byte on Windows, beyond any content, since locked bytes cannot be read by others there."""

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl


def lock_file(stream: BinaryIO) -> None:
    """Lock a file that is open for writing, until it is closed.

    It is ``flock`` on Linux and macOS, and on Windows ``msvcrt.locking`` of one byte.

    Raises:
        OSError: it is locked by another process, or by this one through another stream.

    >>> import tempfile
    >>> with tempfile.TemporaryFile() as stream:
    ...     lock_file(stream)
    """
    if sys.platform == "win32":
        place = stream.tell()
        stream.seek(LOCKED_BYTE)
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
        stream.seek(place)
    else:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
