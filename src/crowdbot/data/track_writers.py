"""Write a recording atomically.

The formats of Forschungszentrum Jülich (SQLite of JuPedSim and PedPy, text of PeTrack) number frames without gaps,
since PedPy measures frame by frame: a recording with a row every 10 frames of 25 Hz is written with frames at 2.5 Hz.
Positions and times are kept exactly.
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, did_you_mean
from crowdbot.typing import Floats

from .place_layout import walkable_rings
from .readers.tables import ROBOT
from .rows import runs
from .track_table import PrimaryScene
from .trajectories import Trajectories

VERSION = 2
"""Version of the database layout of JuPedSim 1."""
TABLES = """
CREATE TABLE trajectory_data(frame INTEGER NOT NULL, id INTEGER NOT NULL, pos_x REAL NOT NULL, pos_y REAL NOT NULL,
    ori_x REAL NOT NULL, ori_y REAL NOT NULL);
CREATE TABLE metadata(key TEXT NOT NULL UNIQUE PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE geometry(hash INTEGER NOT NULL, wkt TEXT NOT NULL);
CREATE UNIQUE INDEX geometry_hash on geometry(hash);
CREATE TABLE frame_data(frame INTEGER NOT NULL, geometry_hash INTEGER NOT NULL);
CREATE INDEX frame_id_idx ON trajectory_data(frame, id);
"""


def write_jupedsim(tracks: Trajectories, file: IO[bytes]) -> None:
    """Write tracks and walkable area as a database of JuPedSim, which PedPy reads too.

    Raises:
        DataError: the tracks are in pixels.
    """
    import sqlite3

    import shapely

    frame, fps = _numbered(tracks, "jupedsim")
    border, obstacles = walkable_rings(tracks)
    area = shapely.Polygon(border)
    for ring in obstacles:
        area = area.difference(shapely.Polygon(ring))
    facing = _orientation(tracks)
    x0, y0, x1, y1 = area.bounds
    about = {"version": VERSION, "fps": fps, "xmin": x0, "xmax": x1, "ymin": y0, "ymax": y1}
    columns = (frame, tracks.id, tracks.x, tracks.y, facing[:, 0], facing[:, 1])
    with contextlib.closing(sqlite3.connect(":memory:")) as base:
        base.executescript(TABLES)
        rows = zip(*(column.tolist() for column in columns), strict=True)
        base.executemany("INSERT INTO trajectory_data VALUES(?, ?, ?, ?, ?, ?)", rows)
        base.executemany("INSERT INTO metadata VALUES(?, ?)", [(key, str(value)) for key, value in about.items()])
        base.execute("INSERT INTO geometry VALUES(1, ?)", (shapely.to_wkt(area, rounding_precision=-1),))
        base.executemany(
            "INSERT INTO frame_data VALUES(?, 1)", [(k,) for k in range(int(frame[0]), int(frame[-1]) + 1)]
        )
        base.commit()
        file.write(base.serialize())


def write_petrack(tracks: Trajectories, file: IO[bytes]) -> None:
    """Write tracks as text of PeTrack: id, frame, x, y, z in metres, z is 0.

    Raises:
        DataError: the tracks are in pixels.
    """
    frame, fps = _numbered(tracks, "petrack")
    name = " ".join(tracks.name.split())
    head = f"# PeTrack text of {name}\n# framerate: {fps!r} fps\n# id frame x/m y/m z/m\n"
    order = np.lexsort((frame, tracks.id))
    columns = (column[order].tolist() for column in (tracks.id, frame, tracks.x, tracks.y))
    rows = (f"{id} {when} {x!r} {y!r} 0\n" for id, when, x, y in zip(*columns, strict=True))
    file.write((head + "".join(rows)).encode())


def _numbered(tracks: Trajectories, format: str) -> tuple[NDArray[np.int64], float]:
    """Return frames ``[N]`` without gaps and their rate [1/s]."""
    if tracks.units != "m":
        raise DataError(f"{tracks.name} is in pixels; {format} files are in metres, see Trajectories.metres")
    first, step = int(tracks.frame[0]), tracks.frame_step
    since = tracks.frame - first
    if np.any(since % step):
        return tracks.frame, tracks.fps
    return first // step + since // step, tracks.row_rate


def _orientation(tracks: Trajectories) -> Floats:
    """Return the unit vector ``[N, 2]`` of the last movement up to each row, before any the next; else (1, 0)."""
    facing = np.tile([1.0, 0.0], (len(tracks), 1))
    order = np.lexsort((tracks.frame, tracks.id))
    for rows in np.split(order, np.flatnonzero(np.diff(tracks.id[order])) + 1):
        step = np.diff(tracks.position[rows], axis=0)
        length = np.hypot(step[:, 0], step[:, 1])
        moving = np.flatnonzero(length > 0.0)
        if len(moving):
            last = np.searchsorted(moving, np.arange(len(rows)) - 1, side="right") - 1
            used = moving[np.maximum(last, 0)]
            facing[rows] = step[used] / length[used, None]
    return facing


SCENE_ROWS = 21
"""Rows of a TrajNet++ scene: 9 observed and 12 predicted."""


def save(tracks: Trajectories, path: str | PathLike[str], format: str | None = None) -> None:
    """Write tracks; loading restores all rows exactly.

    The formats differ in what they keep: ``parquet`` keeps everything; ``csv`` the rows, their times [s], labels,
    robots, and pixels (as ``x_px``); ``trajnetpp`` the rows, the row rate and the scenes (without scenes, one per 21
    rows of a track); ``sgan`` (text: frame id x y) the rows only, so loading may need ``fps=tracks.fps``; ``jupedsim``
    (SQLite of JuPedSim and PedPy) the rows, the row rate and the walkable area, ``petrack`` (text: id frame x y z) the
    rows and the row rate. The last two number the frames without gaps.

    Args:
        tracks: the recording.
        path: output file; its suffix selects the format: .txt, .csv, .parquet, .ndjson or .sqlite.
        format: ``sgan``, ``csv``, ``parquet``, ``trajnetpp``, ``jupedsim`` or ``petrack`` (default: by the suffix).

    Raises:
        InputError: the format is unknown.
        DataError: the file cannot be written; an existing file is unchanged.

    >>> import tempfile
    >>> from crowdbot.data import Trajectories, load
    >>> tracks = Trajectories([7, 7], [0, 1], [0.0, 0.5], [2.0, 2.0], row_rate=2.5)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save(tracks, f"{folder}/tracks.csv")
    ...     load(f"{folder}/tracks.csv").x.tolist()
    [0.0, 0.5]
    """
    path = Path(path)
    if format is not None and format not in _WRITERS:
        near = did_you_mean(str(format), _WRITERS)
        raise InputError(f"unknown format {format!r} to write{near}; known are {', '.join(_WRITERS)}")
    name = format or SUFFIXES.get(path.suffix.lower())
    if name is None:
        raise InputError(f"{path}: no format has the suffix {path.suffix!r}; suffixes are {', '.join(SUFFIXES)}")
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with part.open("xb") as file:
            _WRITERS[name](tracks, file)
        part.replace(path)
    except OSError as error:
        raise DataError(f"cannot write {path}: {error.strerror or error}") from None
    finally:
        part.unlink(missing_ok=True)


def _write_text(tracks: Trajectories, file: IO[bytes]) -> None:
    rows = zip(tracks.frame.tolist(), tracks.id.tolist(), tracks.x.tolist(), tracks.y.tolist(), strict=True)
    file.write("".join(f"{frame}\t{id}\t{x!r}\t{y!r}\n" for frame, id, x, y in rows).encode())


def _write_csv(tracks: Trajectories, file: IO[bytes]) -> None:
    import csv
    import io

    labels = _labels(tracks)
    unit = "_px" if tracks.units == "px" else ""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["id", "frame", "time", f"x{unit}", f"y{unit}", *(["label"] if labels else [])])
    columns = [values.tolist() for values in (tracks.id, tracks.frame, tracks.clock, tracks.x, tracks.y)]
    if labels:
        columns.append([labels.get(id, "") for id in columns[0]])
    writer.writerows(zip(*columns, strict=True))
    file.write(text.getvalue().encode())


def _write_parquet(tracks: Trajectories, file: IO[bytes]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    labels = _labels(tracks)
    columns: dict[str, Any] = {
        "id": tracks.id,
        "frame": tracks.frame,
        "time": tracks.clock,
        "x": tracks.x,
        "y": tracks.y,
    }
    if labels:
        columns["label"] = [labels.get(id) for id in tracks.id.tolist()]
    beside = {
        "frame_rate": tracks.row_rate,
        "frame_step": tracks.frame_step,
        "units": tracks.units,
        "note": tracks.note,
        "homography": None if tracks.homography is None else np.asarray(tracks.homography).tolist(),
        "robots": sorted(tracks.robots),
        "walls": [np.asarray(ring).tolist() for ring in tracks.walls],
        "labels": sorted(tracks.labels.items()),
        "scenes": tracks.scenes,
    }
    table = pa.table(columns)
    pq.write_table(table.replace_schema_metadata({"crowdbot": json.dumps(beside)}), file)


def _write_trajnetpp(tracks: Trajectories, file: IO[bytes]) -> None:
    for scene in tracks.scenes or _scenes(tracks):
        head = {"id": scene.id, "p": scene.person, "s": scene.first, "e": scene.last, "fps": tracks.row_rate}
        tag = {"tag": [scene.tag[0], list(scene.tag[1:])]} if scene.tag else {}
        file.write(json.dumps({"scene": {**head, **tag}}).encode() + b"\n")
    rows = zip(tracks.frame.tolist(), tracks.id.tolist(), tracks.x.tolist(), tracks.y.tolist(), strict=True)
    lines = (f'{{"track": {{"f": {frame}, "p": {id}, "x": {x!r}, "y": {y!r}}}}}\n' for frame, id, x, y in rows)
    file.write("".join(lines).encode())


def _scenes(tracks: Trajectories) -> list[PrimaryScene]:
    """Return a scene for every 21 rows of a run of a person; the longest run when none has so many."""
    found = runs(tracks.id, tracks.frame, tracks.frame_step)
    id, frame = tracks.id[found.order], tracks.frame[found.order]
    ends = np.flatnonzero((found.behind % SCENE_ROWS == 0) & ~np.isin(id, sorted(tracks.robots)))
    rows = SCENE_ROWS
    if len(ends) == 0:
        ends = np.asarray([int(np.argmax(found.behind))])
        rows = int(found.behind[ends[0]])
    return [
        PrimaryScene(number, int(id[end]), int(frame[end - rows + 1]), int(frame[end]))
        for number, end in enumerate(ends.tolist())
    ]


def _labels(tracks: Trajectories) -> dict[int, str]:
    return {**tracks.labels, **dict.fromkeys(tracks.robots, ROBOT)}


_WRITERS: dict[str, Callable[[Trajectories, IO[bytes]], None]] = {
    "sgan": _write_text,
    "csv": _write_csv,
    "parquet": _write_parquet,
    "trajnetpp": _write_trajnetpp,
    "jupedsim": write_jupedsim,
    "petrack": write_petrack,
}
SUFFIXES = {".txt": "sgan", ".csv": "csv", ".parquet": "parquet", ".ndjson": "trajnetpp", ".sqlite": "jupedsim"}
"""File suffixes and their formats."""
