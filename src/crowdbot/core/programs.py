"""Programs that trials name: a server for other machines refuses to start them."""

from __future__ import annotations

import os

from .errors import InputError

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
