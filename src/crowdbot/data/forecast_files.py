"""Files of forecasts: TrajNet++ ndjson, npz and Parquet, for comparisons with predictors of others."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError

from .forecast import Forecast
from .windows import Windows

__all__ = ["ForecastRows", "check_forecast_suffix", "read_forecasts", "write_forecasts"]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

COLUMNS = ("frame", "id", "sample", "step", "x", "y")
"""Columns of npz and Parquet; ``weight`` is optional."""
WHOLE = COLUMNS[:4]
SUFFIXES = (".ndjson", ".npz", ".parquet")


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

    frame: Integers
    id: Integers
    sample: Integers
    step: Integers
    x: Floats
    y: Floats
    weight: Floats


def read_forecasts(path: str | PathLike[str]) -> ForecastRows:
    """Read a file of forecasts, sorted by frame, id, sample and step; the suffix selects the format.

    Parquet and npz have the columns ``frame`` (last observed row), ``id``, ``sample``, ``step`` (from 1), ``x``, ``y``
    and optionally ``weight``. TrajNet++ ndjson has rows of tracks with ``prediction_number`` and ``scene_id``; the last
    observed frame is one step before the first predicted one of the scene.

    Raises:
        InputError: the suffix is unknown.
        DataError: the file is missing, damaged or empty, a column is missing, a number is not finite, or a row is
            duplicated.
    """
    file = Path(path)
    check_forecast_suffix(file)
    if not file.is_file():
        raise DataError(f"there is no file {file}")
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
    with file.open("rb") as stream, np.load(stream, allow_pickle=False) as kept:
        return {name: kept[name] for name in kept.files}


def _read_parquet(file: Path) -> dict[str, Any]:
    import pandas as pd

    table = pd.read_parquet(file)
    return {str(name): table[name].to_numpy() for name in table.columns}


def _read_ndjson(file: Path) -> dict[str, Any]:
    rows = []
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip():
            continue
        track = json.loads(line).get("track")
        if track is None or track.get("prediction_number") is None:
            continue
        if "scene_id" not in track:
            raise DataError(f"{file} line {number}: a predicted row has no scene_id")
        rows.append(tuple(float(track[key]) for key in ("scene_id", "p", "prediction_number", "f", "x", "y")))
    if not rows:
        raise DataError(f"{file} has no predicted rows: tracks with a prediction_number")
    scene, who, sample, at, x, y = np.array(rows).T
    order = np.lexsort((at, sample, who, scene))
    scene, who, sample, at, x, y = (column[order] for column in (scene, who, sample, at, x, y))
    same = (scene[1:] == scene[:-1]) & (who[1:] == who[:-1]) & (sample[1:] == sample[:-1])
    gaps = np.diff(at)[same]
    if not len(gaps) or gaps.min() <= 0.0:
        raise DataError(f"{file}: a future needs at least two rows, at different frames")
    rows_of = np.cumsum(np.concatenate([[True], ~same]))
    first = np.concatenate([[0], np.flatnonzero(~same) + 1])
    step = np.arange(len(at)) - first[rows_of - 1] + 1
    found = np.unique(scene, return_inverse=True)[1]
    earliest = np.full(found.max() + 1, np.inf)
    np.minimum.at(earliest, found, at)
    return {"frame": earliest[found] - np.median(gaps), "id": who, "sample": sample, "step": step, "x": x, "y": y}


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
        if name in WHOLE and np.any(values != np.rint(values)):
            raise DataError(f"{file}: column {name} has {values[values != np.rint(values)][0]}, not a whole number")
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
    if file.suffix not in SUFFIXES:
        raise InputError(f"{file}: the suffix {file.suffix!r} is not one of forecasts: {', '.join(SUFFIXES)}")
