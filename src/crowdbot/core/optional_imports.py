"""Imports of optional dependencies."""

from __future__ import annotations

import importlib
from typing import Any

from .errors import MissingExtra


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
