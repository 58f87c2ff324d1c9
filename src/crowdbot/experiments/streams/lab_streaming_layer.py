"""The library of the Lab Streaming Layer, an optional package."""

from __future__ import annotations

from typing import Any

from crowdbot.core import MissingExtra


def load_pylsl() -> Any:
    """Return the module ``pylsl``.

    Raises:
        MissingExtra: it is not installed, or without the library ``liblsl``.
    """
    try:
        import pylsl
    except (ImportError, RuntimeError, OSError):  # pylsl raises RuntimeError without liblsl
        raise MissingExtra("the Lab Streaming Layer", "lsl") from None
    return pylsl
