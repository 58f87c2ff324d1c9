"""Comparison of readings with what messages and files return."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

__all__ = ["same"]


def same(one: Any, two: Any, what: str) -> None:
    """Compare what was read with what was measured, at the 32 bits that most standard types have."""
    if dataclasses.is_dataclass(one):
        assert type(one) is type(two), what
        for field in dataclasses.fields(one):
            same(getattr(one, field.name), getattr(two, field.name), f"{what}.{field.name}")
        return
    a, b = np.asarray(one), np.asarray(two)
    assert a.shape == b.shape, what
    if b.dtype.kind == "f":
        assert np.allclose(a, b.astype(np.float32), rtol=3e-7, atol=1e-6, equal_nan=True), what
        assert np.array_equal(np.isposinf(a), np.isposinf(b)), what
        assert np.array_equal(np.isneginf(a), np.isneginf(b)), what
    else:
        assert a.dtype.kind == b.dtype.kind, what
        assert np.array_equal(a, b), what
