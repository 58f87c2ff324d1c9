"""CSV and Parquet with named columns; CSV without names, whose columns are numbered; and folders of tables.

A table without names has the columns 1, 2, 3, ... A second line of units (``"s","","m","m"``, as in Pathfinder) gives
the units. A table without a column of ids is one person if its times ascend; a folder of such tables is one recording.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.rows import integers
from crowdbot.data.source import MAX_ROWS, Source, parse_errors
from crowdbot.data.track_table import PrimaryScene
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .clock import regular_rows, row_rate_of_times
from .columns import (
    DECIMAL_COMMA,
    TIME_UNITS,
    Columns,
    Lines,
    check_columns,
    find_columns,
    ids,
    labels,
    numbers,
    parts_of_seconds,
    time_unit,
)
from .plausibility import FileColumns
from .reader import Reader, ReadOptions

ROBOT = "robot"
"""Tracks with this label are robots."""
DELIMITERS = ";\t|,"
"""Delimiters in the order in which they are looked for: commas may be decimal commas."""
SEPARATOR_LINE = re.compile(r"sep=(.)\s*$", re.IGNORECASE)
"""First line of tables of spreadsheets."""
DUPLICATE = " (column "
ROW_UNITS = ("m", "cm", "mm", "ft")
OWN_ID = "id of the file"
"""Column that is added to tables of one person."""
ONE_PERSON = "no column of ids and ascending times: all rows are of one person"
LAST_NUMBER = re.compile(r"\d{1,15}(?=\D*$)")
EPOCH = 1e8
"""Smallest time in seconds since 1970 of a recording: 1973."""
ATC_COLUMNS = {"time": "1", "id": "2", "x": "3", "y": "4"}
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


def has_numbers(source: Source) -> bool:
    """Return whether the first lines are numbers, perhaps with decimal commas, so that columns have numbers."""
    lines = _data_lines(source)[:50]
    return bool(lines) and all(is_nameless(_words(line)) for line in lines)


def read_csv(source: Source, options: ReadOptions) -> Trajectories:
    """Read a table with or without a line of names; delimiters are commas, semicolons, tabs or blanks, "#" begins a
    comment.
    """
    columns, units, line = _csv_columns(source)
    return _tracks(source, options, columns, {"units": units} if units else {}, line)


def _csv_columns(source: Source) -> tuple[Columns, str, NDArray[np.int64]]:
    """Return the columns of a text by name, the unit of x and y if a line of units names it, and the lines of rows."""
    head = _data_lines(source)
    if not head:
        raise DataError(f"{source.name} is not a text with a line of column names")
    delimiter = _delimiter(head[0])
    text = source.text()
    if SEPARATOR_LINE.match(text.partition("\n")[0]):
        text = "\n" + text.partition("\n")[2]
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter or " ", skipinitialspace=True)
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
    if is_nameless(rows[0]):
        names, first = [str(number) for number in range(1, len(rows[0]) + 1)], 0
    else:
        names, first = _distinct([name.strip() for name in rows[0]]), 1
    wrong = next((index for index in range(first, len(rows)) if len(rows[index]) != len(names)), None)
    if wrong is not None:
        other = "the line of names" if first else "the first line"
        commas = any(DECIMAL_COMMA.match(word) for word in (",".join(rows[wrong][-2:]),)) and delimiter == ","
        why = "; commas are delimiters here, numbers with decimal commas need another one" if commas else ""
        raise DataError(
            f"{source.name} line {lines[wrong]} has {len(rows[wrong])} columns, {other} has {len(names)}{why}"
        )
    units = _units_row(names, rows[first]) if first and len(rows) > 1 else ""
    first += bool(units)
    cells = zip(*rows[first:], strict=True) if rows[first:] else [()] * len(names)
    columns = {name: np.asarray(column, dtype=np.str_) for name, column in zip(names, cells, strict=True)}
    return columns, units, np.asarray(lines[first:], dtype=np.int64)


def is_nameless(words: Sequence[str]) -> bool:
    """Return whether all words of a first line are numbers, perhaps with decimal commas, so that there are no names."""
    return all(_is_number(word.strip()) for word in words)


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return word != "" and DECIMAL_COMMA.match(word) is not None
    return True


def _distinct(names: list[str]) -> list[str]:
    """Return names of which the second of a kind has its number, so that no column replaces another.

    >>> _distinct(["t", "x", "x"])
    ['t', 'x', 'x (column 3)']
    """
    return [f"{name}{DUPLICATE}{k + 1})" if name in names[:k] else name for k, name in enumerate(names)]


def _units_row(names: list[str], row: list[str]) -> str:
    """Return the unit of x and y if a row has units instead of numbers, else an empty text."""
    found, _ = find_columns(names)
    cells = {row[names.index(found[axis])].strip() for axis in "xy" if axis in found}
    unit = cells.pop() if len(cells) == 1 else ""
    return unit if unit in ROW_UNITS else ""


def read_atc(source: Source, options: ReadOptions) -> Trajectories:
    """Read a day of the ATC shopping center."""
    options = dataclasses.replace(options, columns={**ATC_COLUMNS, **options.columns})
    return _tracks(source, options, *_atc(source))


def _atc(source: Source) -> tuple[Columns, dict[str, Any], NDArray[np.int64]]:
    columns, _, line = _csv_columns(source)
    return columns, {"units": "mm"}, line


def sniff_atc(source: Source) -> bool:
    """Return whether the first rows have eight numbers with commas: a time in seconds, no frame, and angles [rad] last.

    Boxes of trackers have eight columns, too, of which the first counts frames.
    """
    if not source.lines or source.lines[0].count(",") != 7 or not source.numeric(8):
        return False
    values = np.asarray(source.rows, dtype=np.float64)
    whole, frames = (bool(np.all(values[:, k] == np.rint(values[:, k]))) for k in (1, 0))
    if frames and np.max(values[:, 0]) < EPOCH:
        return False
    return whole and bool(np.all(np.abs(values[:, 6:]) <= 2.0 * np.pi) and np.max(np.abs(values[:, 2:4])) > 100.0)


def read_persons(sources: Sequence[Source], folder: Path, options: ReadOptions) -> Trajectories:
    """Read tables of one person each as one recording.

    If the tables have a column of ids, it must have one id in each and another in every table. Without one, the number
    in the name of a file is the id, if all have one.

    Raises:
        DataError: a table cannot be read, has other columns than the first one, or is of several persons.
    """
    tables, units = list[Columns](), ""
    own_ids = dict[str, str]()
    for source in sources:
        columns, units, _ = _csv_columns(source)
        if tables and list(columns) != list(tables[0]):
            raise DataError(
                f"{source.name} has the columns {', '.join(columns)}, {sources[0].name} has {', '.join(tables[0])};"
                " move files of another kind out of the folder"
            )
        found, _ = find_columns(list(columns), _by_name(options.columns, list(columns)))
        if "id" in found:
            _check_one_id(columns[found["id"]], found["id"], source.name, own_ids)
        tables.append(columns)
    numbers = [LAST_NUMBER.search(source.path.name.partition(".")[0]) for source in sources]
    ids = [int(number[0]) for number in numbers if number is not None]
    if len(set(ids)) < len(sources):
        ids = list(range(1, len(sources) + 1))
    whole = {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}
    if not own_ids:
        counts = [len(next(iter(table.values()))) for table in tables]
        whole[OWN_ID] = np.repeat(np.asarray(ids, dtype=np.int64), counts)
        options = dataclasses.replace(options, columns={**options.columns, "id": OWN_ID})
    tracks = _tracks(Source(folder, b"", False), options, whole, {"units": units} if units else {}, None)
    note = f"{len(sources)} files of one person each"
    return dataclasses.replace(tracks, note="; ".join(filter(None, (note, tracks.note))))


def _check_one_id(values: NDArray[Any], column: str, name: str, before: dict[str, str]) -> None:
    """Raise :class:`DataError` unless all values are one new id; ``before`` has the files by id, and gets this one."""
    held = list(dict.fromkeys(value.strip() for value in values.tolist()))
    if len(held) > 1:
        raise DataError(
            f"{name} has a column of ids, {column}, with {len(held)} persons; it is a recording of its own, so give the"
            " files instead of the folder"
        )
    if held and held[0] in before:
        raise DataError(
            f"{name} has the id {held[0][:40]} in {column}, as {before[held[0]]} has; files of one person each need"
            " ids of their own, give files that are recordings instead of the folder"
        )
    before |= dict.fromkeys(held, name)


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
    lines = [line for line in source.lines if not line.lstrip().startswith("#")]
    return lines[1:] if lines and SEPARATOR_LINE.match(lines[0]) else lines


def _delimiter(line: str) -> str | None:
    return next((mark for mark in DELIMITERS if mark in line), None)


def _words(line: str) -> list[str]:
    return [word.strip().strip('"') for word in line.split(_delimiter(line))]


def _tracks(source: Source, options: ReadOptions, columns: Columns, extra: dict[str, Any], line: Lines) -> Trajectories:
    name = source.name
    options = dataclasses.replace(options, columns=_by_name(options.columns, list(columns)))
    found, units = find_columns(list(columns), options.columns)
    one = ""
    if "id" not in found and "id" not in options.columns and _is_one_person(columns, found):
        columns, one = {**columns, OWN_ID: np.ones(len(columns[found["x"]]), dtype=np.int64)}, ONE_PERSON
        found["id"] = OWN_ID
    check_columns(found, list(columns), name, options.columns)
    twice = next((c for what, c in found.items() if what not in options.columns and _is_twice(c, columns)), "")
    if twice:
        raise DataError(f"{name} has several columns called {twice!r}; choose one by its number, such as --columns y=4")
    known = [meaning for meaning in ("frame", "time", "x", "y", "height") if meaning in found]
    values = {meaning: numbers(columns[found[meaning]], found[meaning], name, line) for meaning in known}
    seconds, remark = found.get("time", ""), ""
    if "time" in found and (unit := time_unit(found["time"], options.columns)):
        values["time"] *= TIME_UNITS[unit]
        seconds, remark = "", f"{found['time']} is read as {unit}"
    elif "time" in found and (rest := parts_of_seconds(found["time"], list(columns))):
        values["time"] += 1e-9 * numbers(columns[rest], rest, name, line)
        remark = f"times are {found['time']} with the nanoseconds of {rest}"
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
        times = values.get("time")
        notes = "; ".join(filter(None, (one, renamed, remark)))
        seconds = seconds if options.fps is None else ""
    else:
        regular = regular_rows(id, values["time"], values["x"], values["y"], options.fps, name, line)
        rows = {"id": regular.id, "frame": regular.frame, "x": regular.x, "y": regular.y, "fps": regular.fps}
        beside["clock_origin"], times = regular.origin, None
        line = line if regular.id is id else None  # positions that are interpolated are on no line
        notes = "; ".join(filter(None, (one, renamed, remark, regular.note)))
    evidence = FileColumns(seconds, found.get("height", ""), values.get("height"), found["x"], found["y"])
    tracks = assemble(source, options, line=line, columns=evidence, **{**rows, "note": notes, **beside, **extra})
    if times is None:
        return tracks
    known_times = np.flatnonzero(np.isfinite(times))
    if not len(known_times):
        return tracks
    first = int(known_times[0])
    origin = float(times[first]) - float(rows["frame"][first]) / tracks.fps
    return dataclasses.replace(tracks, clock_origin=origin)


def _by_name(given: Mapping[str, str], names: list[str]) -> dict[str, str]:
    """Return the columns of the user by name; a number that is no name counts columns from 1."""
    numbered = {str(number): name for number, name in enumerate(names, 1)}
    return {what: column if column in names else numbered.get(column, column) for what, column in given.items()}


def _is_twice(column: str, columns: Columns) -> bool:
    return any(name.startswith(f"{column}{DUPLICATE}") for name in columns)


def _is_one_person(columns: Columns, found: dict[str, str]) -> bool:
    """Return whether there are positions and ascending times or frames."""
    if not {"x", "y"} <= set(found) or not {"time", "frame"} & set(found):
        return False
    try:
        clock = columns[found.get("time") or found["frame"]].astype(np.float64)
    except (ValueError, TypeError):
        return False
    return len(clock) > 1 and bool(np.all(np.diff(clock) > 0.0))


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


ATC = Reader("atc", "ATC shopping center: time, person, x, y [mm], ... without names", sniff_atc, read_atc)
CSV = Reader("csv", "CSV with named columns: id, frame or time, x, y", sniff_csv, read_csv)
PARQUET = Reader("parquet", "Parquet with named columns", lambda source: source.kind == "parquet", read_parquet)
