"""Lazy import of MuJoCo."""

from __future__ import annotations

from typing import Any

from crowdbot.core import import_optional


def engine() -> Any:
    """Return the module ``mujoco``.

    Raises:
        MissingExtra: mujoco is not installed.

    >>> engine().__name__
    'mujoco'
    """
    return import_optional("mujoco", "the physics world", "sim")
