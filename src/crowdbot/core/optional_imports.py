"""Optional: a library that crowdbot works without until somebody asks for what needs it."""

from __future__ import annotations

import importlib
from typing import Any

from .errors import MissingExtra

__all__ = ["import_optional"]


def import_optional(module: str, what: str, extra: str) -> Any:
    """Return a library of an optional part.

    Args:
        module: its name.
        what: cannot be done without it.
        extra: the part of crowdbot that it is installed with.

    Raises:
        MissingExtra: it is not installed.

    >>> import_optional("nothing_of_this_name", "a dream", "sim")
    Traceback (most recent call last):
    crowdbot.core.errors.MissingExtra: a dream needs the extra [sim]: pip install 'crowdbot[sim]'
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        raise MissingExtra(what, extra) from None
