"""Locks of ROS domains, so that two runs on a computer never hear each other."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from crowdbot.core import InputError, lock_file

FIRST, LAST = 101, 200
"""Domains that are given to runs; those below are left to people."""


def lock_domain() -> tuple[int, Callable[[], None]]:
    """Return a ROS domain that no other run on this computer has, and a function that releases it.

    Raises:
        InputError: all domains are in use.

    >>> first, release = lock_domain()
    >>> second, also = lock_domain()
    >>> first != second
    True
    >>> release(), also()
    (None, None)
    """
    for number in range(FIRST, LAST + 1):
        stream = os.fdopen(os.open(_lock_path(number), os.O_CREAT | os.O_RDWR, 0o600), "r+b")
        try:
            lock_file(stream)
        except OSError:
            stream.close()
            continue
        return number, stream.close
    raise InputError(f"the ROS domains from {FIRST} to {LAST} are all in use")


def _lock_path(number: int) -> Path:
    folder = Path(tempfile.gettempdir())
    if sys.platform == "win32":  # the folder belongs to one user
        return folder / f"crowdbot-domain-{number}.lock"
    else:
        return folder / f"crowdbot-domain-{os.getuid()}-{number}.lock"
