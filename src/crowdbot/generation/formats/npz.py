"""Shards as npz files: one array for each field of each table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray


def write_npz(
    tables: Mapping[str, Mapping[str, NDArray[Any]]], path: Path, compressed: bool, seeds: Sequence[int]
) -> list[Path]:
    """Write the tables of a shard as ``PATH.npz`` and return the file.

    The arrays are named ``table/field``; ``seeds`` has the seed of each episode.
    """
    arrays = {f"{name}/{key}": array for name, table in tables.items() for key, array in table.items()}
    arrays["seeds"] = np.asarray(seeds, dtype=np.int64)
    file = path.with_name(f"{path.name}.npz")
    with file.open("wb") as stream:
        (np.savez_compressed if compressed else np.savez)(stream, **arrays)  # type: ignore[arg-type]
    return [file]
