"""Formats of Forschungszentrum Jülich: HDF5 of the pedestrian data archive, and SQLite output of JuPedSim."""

from __future__ import annotations

import contextlib
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.source import MAX_ROWS, Source, parse_errors
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .hdf5_arrays import run_hdf5_program
from .hdf5_program import COLUMNS
from .reader import Reader, ReadOptions

UNIT = re.compile(r"\[\s*(mm|cm|m)\s*\]")


def read_hdf5(source: Source, options: ReadOptions) -> Trajectories:
    """Read the dataset ``trajectory`` (id, frame, x, y, z; attribute fps) and the walkable area as walls."""
    about, columns = _read_hdf5_table(source)
    if "held" in about:
        held = ", ".join(about["held"]) or "nothing"
        raise DataError(f"{source.name} is HDF5 without a table 'trajectory'; it holds {held}")
    missing = [column for column in COLUMNS if column not in about["names"]]
    if missing:
        found = ", ".join(about["names"]) or "no named columns"
        raise DataError(f"{source.name}: table 'trajectory' lacks {', '.join(missing)}; it has {found}")
    if about["rows"] > MAX_ROWS:
        raise DataError(f"{source.name} has {about['rows']} rows, more than the limit of {MAX_ROWS}")
    unit = UNIT.search(about["unit"])
    return assemble(
        source,
        options,
        **columns,
        fps=None if about["fps"] is None else _number(about["fps"], "fps", source.name),
        units=unit.group(1) if unit else "m",
        walls=_walls(about["area"], source.name),
    )


def _read_hdf5_table(source: Source) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return content and columns of the file, read in a process of its own; see :mod:`.hdf5_program`."""
    with parse_errors(source, "HDF5"):
        return run_hdf5_program(source.path, MAX_ROWS)


def read_sqlite(source: Source, options: ReadOptions) -> Trajectories:
    """Read the tables ``trajectory_data`` and ``metadata`` of JuPedSim, and its first geometry as walls."""
    import sqlite3

    address = f"{source.path.resolve().as_uri()}?mode=ro&immutable=1"
    with parse_errors(source, "sqlite"), contextlib.closing(sqlite3.connect(address, uri=True)) as base:
        held = {name for (name,) in base.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
        if not {"trajectory_data", "metadata"} <= held:
            raise DataError(
                f"{source.name} is sqlite without the tables trajectory_data and metadata of JuPedSim;"
                f" it holds {', '.join(sorted(held)) or 'nothing'}"
            )
        query = "SELECT id, frame, pos_x, pos_y FROM trajectory_data LIMIT ?"
        rows = base.execute(query, (MAX_ROWS + 1,)).fetchall()
        metadata = dict(base.execute("SELECT key, value FROM metadata"))
        area = base.execute("SELECT wkt FROM geometry").fetchone() if "geometry" in held else None
    id, frame, x, y = (np.asarray(column) for column in zip(*rows, strict=True)) if rows else np.empty((4, 0))
    fps = metadata.get("fps")
    return assemble(
        source,
        options,
        id=id,
        frame=frame,
        x=x,
        y=y,
        fps=None if fps is None else _number(fps, "fps", source.name),
        walls=_walls(area[0] if area else None, source.name),
    )


def _number(value: Any, what: str, name: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise DataError(f"{name}: its {what} {value!r} is not a number") from None


def _walls(wkt: str | None, name: str) -> tuple[NDArray[np.float64], ...]:
    """Return the rings of a walkable area: the border clockwise, holes counter-clockwise."""
    if not wkt:
        return ()
    import shapely

    try:
        area = shapely.from_wkt(wkt)
    except shapely.errors.ShapelyError:
        raise DataError(f"{name}: its walkable area {wkt[:40]!r} is not well-known text") from None
    polygons = [part for part in getattr(area, "geoms", [area]) if part.geom_type == "Polygon"]
    rings = []
    for polygon in polygons:
        turned = shapely.geometry.polygon.orient(polygon, sign=-1.0)
        rings += [np.asarray(ring.coords)[:-1, :2] for ring in (turned.exterior, *turned.interiors)]
    return tuple(np.ascontiguousarray(ring, dtype=np.float64) for ring in rings)


HDF5 = Reader(
    "juelich-hdf5", "HDF5 of the Jülich pedestrian data archive", lambda source: source.kind == "hdf5", read_hdf5
)
SQLITE = Reader("jupedsim", "sqlite output of JuPedSim", lambda source: source.kind == "sqlite", read_sqlite)
