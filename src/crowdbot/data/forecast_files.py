"""Files of forecasts: TrajNet++ ndjson, npz and Parquet, for comparisons with predictors of others."""

from __future__ import annotations

import json
import math
import zipfile
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import DataError, InputError
from crowdbot.typing import Floats, Ints

from .forecast import Forecast
from .rows import LARGEST
from .source import MAX_ROWS, Source
from .windows import Windows

COLUMNS = ("frame", "id", "sample", "step", "x", "y")
"""Columns of npz and Parquet; ``weight`` is optional."""
WHOLE = COLUMNS[:4]
FORECAST_SUFFIXES = (".ndjson", ".npz", ".parquet")


class ForecastRows(NamedTuple):
    """N predicted positions.

    Fields:
        frame: frame number of the last observed row.
        id: identity in the recording.
        sample: number of the future, from 0.
        step: predicted row, from 1.
        x, y: position [m].
        weight: weight of the future.
    """

    frame: Ints
    id: Ints
    sample: Ints
    step: Ints
    x: Floats
    y: Floats
    weight: Floats


def read_forecasts(path: str | PathLike[str]) -> ForecastRows:
    """Read a file of forecasts, sorted by frame, id, sample and step; the suffix selects the format.

    Parquet and npz have the columns ``frame`` (last observed row), ``id``, ``sample``, ``step`` (from 1), ``x``, ``y``
    and optionally ``weight``. TrajNet++ ndjson has rows of tracks with ``prediction_number`` and ``scene_id``; the last
    observed frame is one step before the first predicted one of the scene. A person who is in several scenes of a frame
    counts in the scene of which they are the primary person, else in the one with the lowest number. Neighbors of a
    primary person with fewer rows, or with numbers that are not finite, are left out.

    Raises:
        InputError: the suffix is unknown.
        DataError: the file is missing, damaged, empty, or larger than 2 GiB or 20 million rows; a column, a scene or
            the primary person of a scene is missing; a number is not finite, or a row is duplicated.
    """
    file = Path(path)
    check_forecast_suffix(file)
    Source.of(file)  # refuses a missing, empty or huge file
    try:
        columns = {".ndjson": _read_ndjson, ".npz": _read_npz, ".parquet": _read_parquet}[file.suffix](file)
    except InputError:
        raise
    except Exception as error:  # parsers of damaged files raise anything
        raise DataError(f"{file} is not a file of forecasts, or is damaged: {error}") from None
    return _checked(file, columns)


def write_forecasts(path: str | PathLike[str], past: Windows, future: Windows, forecast: Forecast) -> None:
    """Write the forecast of windows; the suffix selects the format: .ndjson (TrajNet++), .npz or .parquet.

    Args:
        path: output file.
        past, future: windows of the recording; the future gives the frame numbers of TrajNet++.
        forecast: their forecast.

    Raises:
        InputError: the suffix is unknown.
    """
    file = Path(path)
    check_forecast_suffix(file)
    window, sample, step, person = np.nonzero(
        np.broadcast_to((forecast.valid & ~past.robot)[:, None, None], forecast.position.shape[:4])
    )
    place = forecast.position[window, sample, step, person]
    columns = {
        "frame": past.frame[window, -1], "id": past.id[window, person], "sample": sample, "step": step + 1,
        "x": place[:, 0], "y": place[:, 1], "weight": forecast.weight[window, sample],
    }  # fmt: skip
    if file.suffix == ".npz":
        with file.open("wb") as stream:
            np.savez_compressed(stream, **columns)
    elif file.suffix == ".parquet":
        import pandas as pd

        pd.DataFrame(columns).to_parquet(file, index=False)
    else:
        _write_ndjson(file, past, columns | {"window": window, "at": future.frame[window, step]})


def _write_ndjson(file: Path, past: Windows, columns: dict[str, Any]) -> None:
    with file.open("w", encoding="utf-8", newline="\n") as stream:
        for window in np.unique(columns["window"]).tolist():
            rows = np.flatnonzero(columns["window"] == window).tolist()
            scene = {
                "id": window, "p": int(columns["id"][rows[0]]), "s": int(past.frame[window, 0]),
                "e": int(columns["at"][rows].max()), "fps": 1.0 / past.dt,
            }  # fmt: skip
            stream.write(json.dumps({"scene": scene}) + "\n")
            for row in rows:
                track = {
                    "f": int(columns["at"][row]), "p": int(columns["id"][row]), "x": float(columns["x"][row]),
                    "y": float(columns["y"][row]), "prediction_number": int(columns["sample"][row]), "scene_id": window,
                }  # fmt: skip
                stream.write(json.dumps({"track": track}) + "\n")


def _read_npz(file: Path) -> dict[str, Any]:
    with zipfile.ZipFile(file) as archive:
        entries = {entry.filename.removesuffix(".npy"): entry for entry in archive.infolist()}
        npz = {}
        for name in {*COLUMNS, "weight"} & set(entries):
            with archive.open(entries[name]) as stream:
                version = np.lib.format.read_magic(stream)
                read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
                shape, _, kind = read(stream)
            if math.prod(shape) > MAX_ROWS or kind.hasobject or kind.itemsize > 16:  # memory is taken by the header
                raise DataError(f"{file}: column {name} has shape {list(shape)}, more than {MAX_ROWS} numbers")
            with archive.open(entries[name]) as stream:
                npz[name] = np.lib.format.read_array(stream, allow_pickle=False)
    return npz


def _read_parquet(file: Path) -> dict[str, Any]:
    import pyarrow.parquet as pq

    with pq.ParquetFile(file) as table:
        if table.metadata.num_rows > MAX_ROWS:
            raise DataError(f"{file} has {table.metadata.num_rows} rows, more than the limit of {MAX_ROWS}")
        names = [name for name in (*COLUMNS, "weight") if name in table.schema_arrow.names]
        columns = table.read(columns=names)
    return {name: columns.column(name).to_numpy() for name in names}


def _read_ndjson(file: Path) -> dict[str, Any]:
    primary: dict[int, int] = {}
    rows = []
    with file.open(encoding="utf-8") as stream:
        for number, line in enumerate(stream, 1):
            if not line.strip():
                continue
            record = json.loads(line)
            scene, track = (record.get(kind) for kind in ("scene", "track"))
            if isinstance(scene, dict):
                if not all(isinstance(scene.get(key), int) for key in ("id", "p")):
                    raise DataError(f"{file} line {number}: a scene needs the whole numbers id and p")
                primary[scene["id"]] = scene["p"]
            if track is None or track.get("prediction_number") is None:
                continue
            if track.get("scene_id") is None:
                raise DataError(f"{file} line {number}: a predicted row has no scene_id")
            rows.append(tuple(float(track[key]) for key in ("scene_id", "p", "prediction_number", "f", "x", "y")))
            if len(rows) > MAX_ROWS:
                raise DataError(f"{file} has more than {MAX_ROWS} predicted rows")
    if not rows:
        raise DataError(f"{file} has no predicted rows: tracks with a prediction_number")
    table = np.array(rows)
    if not np.all(np.isfinite(table[:, :4])):
        raise DataError(f"{file}: scene_id, p, prediction_number and f must be finite")
    scene, who, sample, at, x, y = _chosen_rows(file, table, primary).T
    same = (scene[1:] == scene[:-1]) & (who[1:] == who[:-1]) & (sample[1:] == sample[:-1])
    gaps = np.diff(at)[same]
    if not len(gaps) or gaps.min() <= 0.0:
        raise DataError(f"{file}: a future needs at least two rows, at different frames")
    rows_of = np.cumsum(np.concatenate([[True], ~same]))
    first = np.concatenate([[0], np.flatnonzero(~same) + 1])
    step = np.arange(len(at)) - first[rows_of - 1] + 1
    frame = _first_frames(scene, at) - np.median(gaps)
    key = np.unique(np.stack([frame, who]), axis=1, return_inverse=True)[1].ravel()
    # A person in several scenes of a frame: the scene about the person counts, else the first one.
    own = np.array([primary.get(int(number)) for number in scene.tolist()]) == who
    rank = np.where(own, -np.inf, scene)
    best = np.full(key.max() + 1, np.inf)
    np.minimum.at(best, key, rank)
    kept = rank == best[key]
    last = np.full(key.max() + 1, -np.inf)
    np.maximum.at(last, key[kept], scene[kept])
    kept &= scene == last[key]
    columns = {"frame": frame, "id": who, "sample": sample, "step": step, "x": x, "y": y}
    return {name: values[kept] for name, values in columns.items()}


def _chosen_rows(file: Path, table: Floats, primary: Mapping[int, int]) -> Floats:
    """Return the rows (scene, person, sample, frame, x, y) in order, without incomplete neighbors.

    TrajNet++ scores the primary person of a scene. Other methods write some neighbors without numbers (people who were
    not observed for long enough), or in the first of several futures only; these neighbors count as not predicted.
    """
    table = table[np.lexsort(table.T[[3, 2, 1, 0]])]
    if not primary:
        return table
    lost = [number for number in np.unique(table[:, 0]).tolist() if number not in primary]
    if lost:
        raise DataError(f"{file}: rows have scene_id {lost[0]:g}, but there is no such scene")
    pair, group, count = np.unique(table[:, :2], axis=0, return_inverse=True, return_counts=True)
    group = group.ravel()
    rows_of = {(int(number), int(person)): int(rows) for (number, person), rows in zip(pair, count, strict=True)}
    for number, person in primary.items():
        if (number, person) not in rows_of:
            raise DataError(f"{file}: scene {number} has no predicted rows of its primary person {person}")
    whole = [rows >= rows_of[number, primary[number]] for (number, _), rows in rows_of.items()]
    finite = np.bincount(group, ~np.isfinite(table[:, 4:]).all(axis=1)) == 0
    own = np.array([primary[number] == person for number, person in rows_of])
    return np.asarray(table[(own | (np.array(whole) & finite))[group]])


def _first_frames(scene: Floats, at: Floats) -> Floats:
    """Return the first predicted frame of the scene of each row."""
    found = np.unique(scene, return_inverse=True)[1]
    earliest = np.full(found.max() + 1, np.inf)
    np.minimum.at(earliest, found, at)
    return np.asarray(earliest[found])


def _checked(file: Path, columns: dict[str, Any]) -> ForecastRows:
    """Return the columns as sorted rows."""
    missing = [name for name in COLUMNS if name not in columns]
    if missing:
        raise DataError(f"{file} has no column {missing[0]}; the columns of forecasts are {', '.join(COLUMNS)}")
    count = len(np.atleast_1d(columns["x"]))
    found = {}
    for name in (*COLUMNS, "weight"):
        values = np.asarray(columns.get(name, np.ones(count)), dtype=np.float64)
        if values.shape != (count,):
            raise DataError(f"{file}: column {name} has shape {list(values.shape)}, it must be [{count}]")
        if not np.all(np.isfinite(values)):
            raise DataError(f"{file}: column {name} has a number that is not finite")
        wrong = (values != np.rint(values)) | (np.abs(values) >= LARGEST)
        if name in WHOLE and np.any(wrong):
            raise DataError(f"{file}: column {name} has {values[wrong][0]}, not a whole number")
        found[name] = values
    if not count:
        raise DataError(f"{file} has no rows")
    if found["weight"].min() < 0.0:
        raise DataError(f"{file}: column weight has a number below 0")
    order = np.lexsort([found[name] for name in reversed(WHOLE)])
    rows = {name: values[order] for name, values in found.items()}
    keys = np.stack([rows[name] for name in WHOLE])
    same = np.flatnonzero(np.all(keys[:, 1:] == keys[:, :-1], axis=0))
    if len(same):
        at = ", ".join(f"{name} {rows[name][same[0]]:g}" for name in WHOLE)
        raise DataError(f"{file} has two rows of {at}")
    frame, id, sample, step = (rows[name].astype(np.int64) for name in WHOLE)
    return ForecastRows(frame, id, sample, step, rows["x"], rows["y"], rows["weight"])


def check_forecast_suffix(file: Path) -> None:
    """Raise :class:`InputError` unless the suffix is one of files of forecasts."""
    if file.suffix not in FORECAST_SUFFIXES:
        raise InputError(f"{file}: the suffix {file.suffix!r} is not one of forecasts: {', '.join(FORECAST_SUFFIXES)}")
