"""Shards as tar files for WebDataset: the files of one sample have the same name before the first dot."""

from __future__ import annotations

import io
import json
import math
import tarfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Table = Mapping[str, NDArray[Any]]


def write_webdataset(tables: Mapping[str, Table], path: Path, compressed: bool, seeds: Sequence[int]) -> list[Path]:
    """Write the samples of a shard as ``PATH.tar`` (``.tar.gz`` if compressed) and return the file.

    A sample is an instant of a run at which a sensor measured: ``KEY.json`` has the agents and labels, and each array
    of a sensor is ``KEY.ROBOT-SENSOR.FIELD.npy``; colour images are ``.png``.
    """
    file = path.with_name(f"{path.name}.tar{'.gz' if compressed else ''}")
    rows: dict[tuple[int, int], dict[str, int]] = {}
    for name, table in tables.items():
        for row, when in enumerate(zip(table["episode"].tolist(), table["nanoseconds"].tolist(), strict=True)):
            rows.setdefault(when, {})[name] = row
    with file.open("wb") as raw, _stream(raw, compressed) as stream, tarfile.open(fileobj=stream, mode="w") as tar:
        for episode, nanoseconds in sorted(rows):
            found = rows[episode, nanoseconds]
            if set(found) != {"agents"}:
                facts = {"seed": int(seeds[episode]), "episode": episode, "nanoseconds": nanoseconds}
                _write_sample(tar, f"{path.name}-{episode:03d}-{nanoseconds:013d}", facts, tables, found)
    return [file]


def _write_sample(
    tar: tarfile.TarFile, key: str, facts: dict[str, Any], tables: Mapping[str, Table], rows: Mapping[str, int]
) -> None:
    """Write the files of one sample: a row of some tables."""
    for name, row in rows.items():
        label = name.replace("/", "-")
        facts[label] = {}
        for field, array in tables[name].items():
            if field in ("episode", "nanoseconds") or field.startswith("shared."):
                continue
            if name != "agents" and _is_data(field, array[row]):
                _add(tar, *_file(f"{key}.{label}.{field}", field, array[row]))
            else:
                facts[label][field] = _plain(array[row])
    _add(tar, f"{key}.json", json.dumps(facts, allow_nan=False).encode())


def _stream(raw: Any, compressed: bool) -> Any:
    if not compressed:
        return raw
    import gzip

    return gzip.GzipFile(filename="", mode="wb", fileobj=raw, mtime=0)


def _is_data(field: str, value: NDArray[Any]) -> bool:
    labels = ("ids", "returns", "occluded", "boxes", "pose_position", "pose_rotation")
    return value.ndim > 0 and field not in labels


def _file(name: str, field: str, value: NDArray[Any]) -> tuple[str, bytes]:
    content = io.BytesIO()
    if field == "rgb":
        from PIL import Image

        Image.fromarray(value).save(content, format="PNG")
        return f"{name}.png", content.getvalue()
    np.save(content, value)
    return f"{name}.npy", content.getvalue()


def _plain(value: Any) -> Any:
    """Return an array as lists; values that are not finite are None."""
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list):
        return [_plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _add(tar: tarfile.TarFile, name: str, content: bytes) -> None:
    entry = tarfile.TarInfo(name)
    entry.size, entry.mtime, entry.mode = len(content), 0, 0o644
    tar.addfile(entry, io.BytesIO(content))
