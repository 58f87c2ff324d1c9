"""CSV and Parquet with named columns."""

from __future__ import annotations

import csv
import io
import json
import re
from typing import Any

import numpy as np

from crowdbot.core import DataError
from crowdbot.data.rows import integers
from crowdbot.data.source import MAX_ROWS, Source, parse_errors
from crowdbot.data.track_table import PrimaryScene
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .clock import regular_rows, row_rate_of_times
from .columns import (
    TIME_UNITS,
    Columns,
    Lines,
    check_columns,
    find_columns,
    ids,
    labels,
    numbers,
    time_unit,
)
from .plausibility import FileColumns
from .reader import Reader, ReadOptions

__all__ = ["CSV", "PARQUET", "ROBOT"]

ROBOT = "robot"
"""Tracks with this label are robots."""
DELIMITERS = ",;\t"
NAME = re.compile(r"^[A-Za-z_][\w .:/()\[\]-]*$")


def sniff_csv(source: Source) -> bool:
    """Return whether the first line has column names: two known names, or one word per value of the next line."""
    lines = _data_lines(source)
    if not lines:
        return False
    names = _words(lines[0])
    if len(find_columns(names)[0]) >= 2:
        return True
    marked = any(mark in lines[0] for mark in DELIMITERS) and all(NAME.match(name) for name in names)
    return marked and len(lines) > 1 and len(_words(lines[1])) == len(names)


def read_csv(source: Source, options: ReadOptions) -> Trajectories:
    """Read a table with a line of names; delimiters are commas, semicolons, tabs or blanks, "#" begins a comment."""
    head = _data_lines(source)
    if not head:
        raise DataError(f"{source.name} is not a text with a line of column names")
    delimiter = _delimiter(head[0])
    reader = csv.reader(io.StringIO(source.text(), newline=""), delimiter=delimiter or " ", skipinitialspace=True)
    rows: list[list[str]] = []
    lines: list[int] = []
    try:
        for row in reader:
            if any(row) and not row[0].startswith("#"):
                rows.append(row if delimiter else [word for word in row if word])
                lines.append(reader.line_num)
    except csv.Error as error:
        raise DataError(f"{source.name} line {reader.line_num} cannot be read as a table: {error}") from None
    if not rows:
        raise DataError(f"{source.name} has no line of column names")
    names = [name.strip() for name in rows.pop(0)]
    wrong = next((index for index, row in enumerate(rows) if len(row) != len(names)), None)
    if wrong is not None:
        place = f"{source.name} line {lines[wrong + 1]}"
        raise DataError(f"{place} has {len(rows[wrong])} columns, the line of names has {len(names)}")
    cells = zip(*rows, strict=True) if rows else [()] * len(names)
    columns = {name: np.asarray(column, dtype=np.str_) for name, column in zip(names, cells, strict=True)}
    return _tracks(source, options, columns, {}, np.asarray(lines[1:], dtype=np.int64))


def read_parquet(source: Source, options: ReadOptions) -> Trajectories:
    """Read a Parquet table; files of crowdbot keep all fields in their metadata."""
    import pyarrow.parquet as pq

    with parse_errors(source, "Parquet"), pq.ParquetFile(source.path) as file:
        count = file.metadata.num_rows
        if count > MAX_ROWS:
            raise DataError(f"{source.name} has {count} rows, more than the limit of {MAX_ROWS}")
        table = file.read()
        columns = {name: table.column(name).to_numpy() for name in table.column_names}
    return _tracks(source, options, columns, _metadata_fields(source.name, table.schema.metadata or {}), None)


def _data_lines(source: Source) -> list[str]:
    return [line for line in source.lines if not line.lstrip().startswith("#")]


def _delimiter(line: str) -> str | None:
    return next((mark for mark in DELIMITERS if mark in line), None)


def _words(line: str) -> list[str]:
    return [word.strip().strip('"') for word in line.split(_delimiter(line))]


def _tracks(source: Source, options: ReadOptions, columns: Columns, extra: dict[str, Any], line: Lines) -> Trajectories:
    name = source.name
    found, units = find_columns(list(columns), options.columns)
    check_columns(found, list(columns), name, options.columns)
    known = [meaning for meaning in ("frame", "time", "x", "y", "height") if meaning in found]
    values = {meaning: numbers(columns[found[meaning]], found[meaning], name, line) for meaning in known}
    seconds, remark = found.get("time", ""), ""
    if "time" in found and (unit := time_unit(found["time"], options.columns)):
        values["time"] *= TIME_UNITS[unit]
        seconds, remark = "", f"{found['time']} is read as {unit}"
    id, renamed = ids(columns[found["id"]], found["id"], name, line)
    named = labels(columns[found["label"]], id) if "label" in found else {}
    beside: dict[str, Any] = {
        "units": units or "m",
        "labels": {key: label for key, label in named.items() if label != ROBOT},
        "robots": frozenset(key for key, label in named.items() if label == ROBOT),
    }
    if "frame" in found:
        frame = integers(values["frame"], found["frame"], name, line)
        rate = row_rate_of_times(id, frame, values["time"]) if "time" in found else None
        rows: dict[str, Any] = {"id": id, "frame": frame, "x": values["x"], "y": values["y"], "row_rate": rate}
        notes = "; ".join(filter(None, (renamed, remark)))
        seconds = seconds if options.fps is None else ""
    else:
        regular = regular_rows(id, values["time"], values["x"], values["y"], options.fps, name, line)
        rows = {"id": regular.id, "frame": regular.frame, "x": regular.x, "y": regular.y, "fps": regular.fps}
        line = line if regular.id is id else None  # positions that are interpolated are on no line
        notes = "; ".join(filter(None, (renamed, remark, regular.note)))
    evidence = FileColumns(seconds, found.get("height", ""), values.get("height"), named=True)
    return assemble(source, options, line=line, columns=evidence, **{**rows, "note": notes, **beside, **extra})


def _metadata_fields(name: str, metadata: dict[bytes, bytes]) -> dict[str, Any]:
    """Return the fields that crowdbot writes to the metadata of a table."""
    try:
        extra = json.loads(metadata.get(b"crowdbot", b"{}"))
        if not extra:
            return {}
        return {
            "row_rate": float(extra["frame_rate"]),
            "frame_step": int(extra["frame_step"]),
            "units": str(extra["units"]),
            "note": str(extra["note"]),
            "homography": None if extra["homography"] is None else np.asarray(extra["homography"], dtype=np.float64),
            "robots": frozenset(map(int, extra["robots"])),
            "walls": tuple(np.asarray(ring, dtype=np.float64) for ring in extra["walls"]),
            "labels": {int(key): str(label) for key, label in extra["labels"]},
            "scenes": tuple(_scene(scene) for scene in extra["scenes"]),
        }
    except (ValueError, TypeError, KeyError, IndexError) as error:
        raise DataError(f"{name}: the metadata written by crowdbot is damaged: {error!r}") from None


def _scene(extra: list[Any]) -> PrimaryScene:
    id, person, first, last, tag = extra
    return PrimaryScene(int(id), int(person), int(first), int(last), tuple(map(int, tag)))


CSV = Reader("csv", "CSV with named columns: id, frame or time, x, y", sniff_csv, read_csv)
PARQUET = Reader("parquet", "Parquet with named columns", lambda source: source.kind == "parquet", read_parquet)
