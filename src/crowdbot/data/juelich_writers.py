"""Writers of the formats of Forschungszentrum Jülich: SQLite of JuPedSim and PedPy, text of PeTrack.

Both number the frames of a recording without gaps, since PedPy measures frame by frame: a recording with a row every 10
frames of 25 Hz is written with frames at 2.5 Hz. Positions and times are kept exactly.
"""

from __future__ import annotations

import contextlib
from typing import IO

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.typing import Floats

from .trajectories import Trajectories
from .walkable import walkable_rings

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
