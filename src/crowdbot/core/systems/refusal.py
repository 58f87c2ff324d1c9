"""Refusal of a feature on a system that has no such feature."""

from __future__ import annotations

import platform
import sys
from typing import NoReturn

from crowdbot.core.errors import InputError

NAMES = {"linux": "Linux", "darwin": "macOS", "win32": "Windows"}


def system_name() -> str:
    """Return the name of this operating system for messages.

    >>> system_name() in ("Linux", "macOS", "Windows")
    True
    """
    return NAMES.get(sys.platform) or platform.system()


def refuse_system(what: str, systems: str, instead: str) -> NoReturn:
    """Raise the exception of a feature that this operating system lacks.

    Args:
        what: the feature, in the singular.
        systems: where it works.
        instead: what the user can do on this system.

    Raises:
        InputError: always.

    >>> refuse_system("the hourglass", "Multics", "use a clock")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: the hourglass needs Multics, this is ...; use a clock
    """
    raise InputError(f"{what} needs {systems}, this is {system_name()}; {instead}")
