"""Readings with person ids instead of agent indices."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.sensors import Reading, TrackedPeople

__all__ = ["name_by_id", "tracked_columns"]

Ints = NDArray[np.int64]


def name_by_id(reading: Reading, ids: Ints) -> Reading:
    """Return a reading of one environment with person ids instead of agent indices."""
    if np.array_equal(ids, np.arange(len(ids))):
        return reading
    if isinstance(reading, TrackedPeople):
        return _tracked(reading, ids)
    hit = getattr(reading, "hit", None)
    if hit is None:
        return reading
    return dataclasses.replace(reading, hit=np.where(hit >= 0, ids[np.maximum(hit, 0)], hit))  # type: ignore[call-arg]


def _tracked(reading: TrackedPeople, ids: Ints) -> TrackedPeople:
    """Return the rows ordered by id: row k belongs to person k."""
    there = np.flatnonzero(ids >= 0)
    count = int(ids.max(initial=-1)) + 1
    rows: dict[str, Any] = {}
    for part in ("present", "position", "velocity", "radius", "heading"):
        value = getattr(reading, part)
        wide = np.full((len(value), count, *value.shape[2:]), False if part == "present" else np.nan)
        wide[:, ids[there]] = value[:, there]
        rows[part] = wide
    return dataclasses.replace(reading, **rows)


def tracked_columns(reading: TrackedPeople, agents: Ints) -> TrackedPeople:
    """Return the rows of some agents."""
    parts = ("present", "position", "velocity", "radius", "heading")
    return dataclasses.replace(reading, **{part: getattr(reading, part)[:, agents] for part in parts})
