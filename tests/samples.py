"""Samples of long tests: `make test` runs a part of the values, `make sweeps` the others (marker ``sweep``)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def sample(values: Iterable[Any], keep: Iterable[Any] | int, *, rows: bool = False) -> list[Any]:
    """Return all values for ``parametrize``; those that are not kept, or come after the first ``keep``, are sweeps.

    With ``rows`` each value is a tuple with a value for each of several names.
    """
    every = list(values)
    kept = every[:keep] if isinstance(keep, int) else list(keep)
    missing = [value for value in kept if value not in every]
    assert not missing, f"{missing} are not among the values"
    return [
        value if value in kept else pytest.param(*(value if rows else (value,)), marks=pytest.mark.sweep)
        for value in every
    ]


def sizes(*small_and_full: Any) -> list[Any]:
    """Return small sizes for ``parametrize`` and, as a sweep, the last and full one."""
    *small, full = small_and_full
    return [*small, pytest.param(full, marks=pytest.mark.sweep)]
