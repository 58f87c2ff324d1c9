"""Locks of ROS domains, so that two runs on a computer never hear each other."""

from __future__ import annotations

import functools
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

from crowdbot.core import InputError

__all__ = ["lock_domain"]

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
    import fcntl  # rclpy in lock step is for systems with fork

    for number in range(FIRST, LAST + 1):
        path = Path(tempfile.gettempdir()) / f"crowdbot-domain-{os.getuid()}-{number}.lock"
        place = os.open(path, os.O_CREAT | os.O_RDWR | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(place)
            continue
        return number, functools.partial(os.close, place)
    raise InputError(f"the ROS domains from {FIRST} to {LAST} are all in use")
