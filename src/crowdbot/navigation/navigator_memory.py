"""Copies of the memory of a navigator, for branches and saved states of a simulation."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from typing import Any

from crowdbot.core import InputError

DEEPEST = 20
"""Largest depth at which the part that cannot be copied is searched."""


def copy_memory(memory: Any, navigator: str = "") -> Any:
    """Return a deep copy of the memory of a navigator.

    Args:
        memory: the memory.
        navigator: name of the navigator, for error messages.

    Raises:
        InputError: a part of the memory cannot be copied, such as an open file, a lock or a generator.

    >>> copy_memory({"seen": [1, 2]})
    {'seen': [1, 2]}
    >>> copy_memory({"rows": iter(row for row in "ab")}, "Reader")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: navigator Reader: memory['rows'] is a generator, which cannot be copied (cannot \
pickle 'generator' object); store plain values
    """
    try:
        return copy.deepcopy(memory)
    except Exception as error:
        path, part, reason = _culprit(memory, "memory", error, 0)
        name = f"navigator {navigator}: " if navigator else ""
        raise InputError(
            f"{name}{path} is a {type(part).__name__}, which cannot be copied ({reason}); store plain values"
        ) from error


def _culprit(value: Any, path: str, error: Exception, depth: int) -> tuple[str, Any, Exception]:
    """Return path, value and error of the smallest part that cannot be copied."""
    for part_path, part in _parts(value, path) if depth < DEEPEST else ():
        try:
            copy.deepcopy(part)
        except Exception as reason:
            return _culprit(part, part_path, reason, depth + 1)
    return path, value, error


def _parts(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield path and value of each part of a container or object."""
    if isinstance(value, Mapping):
        yield from ((f"{path}[{key!r}]", part) for key, part in value.items())
    elif isinstance(value, list | tuple):
        yield from ((f"{path}[{k}]", part) for k, part in enumerate(value))
    else:
        yield from ((f"{path}.{name}", part) for name, part in getattr(value, "__dict__", {}).items())
