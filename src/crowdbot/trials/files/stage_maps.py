"""Stage maps: areas from WKT or GeoJSON and ROS maps, as polygons of limited size."""

from __future__ import annotations

import functools
import math
import re
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.trials.fields import LARGEST

from .trial_files import read_beside, resolve_file

if TYPE_CHECKING:
    import shapely

__all__ = ["area_of", "is_area_file", "map_files", "map_of"]

MOST_CORNERS = 20_000
MOST_DETAIL = 120_000
MOST_TEXT = 4_000_000
MOST_CELLS = 16_000_000
MOST_IMAGE = 64_000_000
WKT = re.compile(r"\s*(MULTI)?(POLYGON|GEOMETRYCOLLECTION)\b", re.IGNORECASE)


def area_of(text: str, folder: Path | None, trust: bool) -> shapely.Geometry:
    """Return the polygon or polygons of an area.

    Args:
        text: WKT, or the name of a WKT or GeoJSON file in the folder.
        folder: folder of the trial.
        trust: whether the file may lie outside the folder.

    Raises:
        InputError: the text is neither, or has no valid polygon or too many corners.

    >>> area_of("POLYGON ((0 0, 4 0, 4 3, 0 3, 0 0))", None, False).area
    12.0
    """
    import shapely

    if is_area_file(text):
        path = resolve_file(text, folder, trust)
        stamp = path.stat()
        return _from_file(path, stamp.st_mtime_ns, stamp.st_size)
    try:
        shape = shapely.from_wkt(text)
    except (shapely.errors.ShapelyError, ValueError) as error:
        raise InputError(f"is not WKT: {_first(error)}") from None
    return _checked(shape, "the WKT")


def is_area_file(text: str) -> bool:
    """Return whether an area is a file name and not WKT.

    >>> is_area_file("hall.geojson"), is_area_file("POLYGON ((0 0, 4 0, 4 3, 0 0))")
    (True, False)
    """
    return not WKT.match(text)


@functools.lru_cache(maxsize=8)
def _from_file(path: Path, changed: int, size: int) -> shapely.Geometry:
    import shapely

    data = read_beside(path, MOST_TEXT)
    try:
        text = data.decode("utf-8-sig")
        shape = shapely.from_wkt(text) if WKT.match(text) else shapely.from_geojson(text)
    except UnicodeDecodeError:
        raise InputError(f"{path.name} is not text; an area is a file of WKT or GeoJSON") from None
    except (shapely.errors.ShapelyError, ValueError) as error:
        raise InputError(f"{path.name} is neither WKT nor GeoJSON of an area: {_first(error)}") from None
    return _checked(shape, path.name)


def _first(error: Exception) -> str:
    return (str(error).splitlines() or [""])[0][:100]


def _checked(shape: Any, what: str) -> shapely.Geometry:
    import shapely

    if shape is None:
        raise InputError(f"{what} contains no polygon")
    found = [part for part in _parts(shape) if not part.is_empty]
    parts = [part for part in found if part.geom_type == "Polygon"]
    if not parts:
        kind = found[0].geom_type if found else "nothing"
        raise InputError(f"{what} holds {kind}, it must hold polygons")
    corners = shapely.get_coordinates(parts)
    if len(corners) > MOST_CORNERS:
        raise InputError(f"{what} has {len(corners)} corners, more than {MOST_CORNERS}; simplify it")
    if not np.all(np.isfinite(corners)) or np.any(np.abs(corners) > LARGEST):
        raise InputError(f"{what} has corners that are not finite, or more than {LARGEST:g} m from the origin")
    wrong = next((part for part in parts if not part.is_valid), None)
    if wrong is not None:
        raise InputError(f"{what} has a polygon that is not simple: {shapely.is_valid_reason(wrong).lower()}")
    whole: shapely.Geometry = shapely.union_all(shapely.force_2d(parts))
    if whole.area <= 0.0:
        raise InputError(f"{what} has no area")
    return whole


def _parts(shape: Any) -> list[Any]:
    """Return the geometries of a collection, nested ones included."""
    inner = getattr(shape, "geoms", None)
    return [shape] if inner is None else [part for one in inner for part in _parts(one)]


class _Map(NamedTuple):
    """Content of the ``.yaml`` file of a map."""

    image: str
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied: float
    free: float


def map_of(name: str, unknown: str, folder: Path | None, trust: bool) -> tuple[shapely.Polygon, ...]:
    """Return the occupied cells of a ROS map (map_server, ``.yaml`` with ``.pgm``) as polygons.

    Borders are simplified by at most one cell.

    Args:
        name: name of the ``.yaml`` file in the folder.
        unknown: treatment of unknown cells, ``occupied`` or ``free``.
        folder: folder of the trial.
        trust: whether the files may lie outside the folder.

    Raises:
        InputError: a file is missing, too large or not a map.
    """
    _, row, image = _map_of(name, folder, trust)
    stamp = image.stat()
    return _solids(image, stamp.st_mtime_ns, stamp.st_size, row, unknown)


def map_files(name: str, folder: Path | None, trust: bool) -> dict[str, Path]:
    """Return the files of a map by name, the ``.yaml`` file and its image; arguments as in :func:`map_of`."""
    path, row, image = _map_of(name, folder, trust)
    return {name: path, (PurePosixPath(name).parent / row.image).as_posix(): image}


def _map_of(name: str, folder: Path | None, trust: bool) -> tuple[Path, _Map, Path]:
    path = resolve_file(name, folder, trust)
    row = _yaml(read_beside(path, 100_000), path.name)
    image = resolve_file(row.image, path.parent, trust)
    if not trust and not image.is_relative_to((folder or Path.cwd()).resolve()):
        raise InputError(f"the file {row.image[:80]!r} lies outside the folder of the trial")
    return path, row, image


def _yaml(data: bytes, name: str) -> _Map:
    """Read the flat keys and values of a map file."""
    rows = {}
    for line in data.decode("utf-8", "replace").splitlines():
        key, colon, value = line.partition(":")
        if colon and not line.startswith((" ", "#", "-")):
            rows[key.strip()] = value.split(" #")[0].strip().strip("\"'")
    missing = [key for key in ("image", "resolution", "origin") if not rows.get(key)]
    if missing:
        raise InputError(f"{name} is not a ROS map: it does not say {' and '.join(missing)}")
    try:
        resolution = float(rows["resolution"])
        origin = [float(part) for part in rows["origin"].strip("[]").split(",")]
        negate = rows.get("negate", "0") in ("1", "true", "True")
        occupied, free = float(rows.get("occupied_thresh", "0.65")), float(rows.get("free_thresh", "0.196"))
    except ValueError as error:
        raise InputError(f"{name} is not a ROS map: {error}") from None
    numbers = (resolution, *origin, occupied, free)
    if not all(math.isfinite(one) and abs(one) <= LARGEST for one in numbers) or resolution <= 0.0:
        raise InputError(f"{name} has a resolution or an origin that is not finite, too large, or not above 0")
    if len(origin) != 3:
        raise InputError(f"{name} has an origin of {len(origin)} numbers, it must have x, y and yaw")
    return _Map(rows["image"], resolution, (origin[0], origin[1], origin[2]), negate, occupied, free)


@functools.lru_cache(maxsize=4)
def _solids(image: Path, changed: int, size: int, row: _Map, unknown: str) -> tuple[shapely.Polygon, ...]:
    import shapely

    grey = _pgm(read_beside(image, MOST_IMAGE), image.name)
    dark = grey if row.negate else 1.0 - grey
    solid = dark > row.occupied if unknown == "free" else dark >= row.free
    solid = solid[::-1]  # the first row of an image is its top
    edge = np.zeros((solid.shape[0], 1), dtype=np.int8)
    change = np.diff(np.concatenate([edge, solid.astype(np.int8), edge], axis=1), axis=1)
    line, begin = np.nonzero(change == 1)
    end = np.nonzero(change == -1)[1]
    if len(line) == 0:
        return ()
    _check_detail(image, len(line), "runs of solid cells")
    whole = shapely.union_all(shapely.box(begin, line, end, line + 1))
    _check_detail(image, len(shapely.get_coordinates(whole)), "corners of cells")
    parts = shapely.get_parts(shapely.simplify(whole, 1.0, preserve_topology=True))
    corners = len(shapely.get_coordinates(parts))
    if corners > MOST_CORNERS:
        raise InputError(f"{image.name} has {corners} corners, more than {MOST_CORNERS}; clean or shrink the map")
    x, y, yaw = row.origin
    cos, sin = row.resolution * math.cos(yaw), row.resolution * math.sin(yaw)
    turn = np.array([[cos, sin], [-sin, cos]])
    placed = shapely.transform(parts, lambda cells: cells @ turn + np.array([x, y]))
    return tuple(part for part in np.atleast_1d(placed) if part.geom_type == "Polygon" and part.area > 0.0)


def _check_detail(image: Path, count: int, what: str) -> None:
    """Refuse noise: to simplify it takes minutes."""
    if count > MOST_DETAIL:
        raise InputError(f"{image.name} has {count} {what}, more than {MOST_DETAIL}; clean or shrink the map")


def _pgm(data: bytes, name: str) -> NDArray[np.float64]:
    """Return the grey values ``[H, W]`` from 0 to 1 of a PGM image, binary (P5) or text (P2)."""
    head = re.match(rb"(P[25])(?:\s+(?:#[^\n]*\n\s*)*)(\d{1,6})(?:\s+(?:#[^\n]*\n\s*)*)(\d{1,6})"
                    rb"(?:\s+(?:#[^\n]*\n\s*)*)(\d{1,5})\s", data)  # fmt: skip
    if head is None:
        raise InputError(f"{name} is not a PGM image (P5 or P2); save the map as .pgm")
    width, height, top = (int(head[k]) for k in (2, 3, 4))
    if not (0 < width * height <= MOST_CELLS and 0 < top < 65_536):
        raise InputError(f"{name} has {width} x {height} cells of up to {top}; at most {MOST_CELLS} cells are read")
    body = data[head.end() :]
    if head[1] == b"P5":
        kind = np.dtype(np.uint8 if top < 256 else ">u2")
        if len(body) < width * height * kind.itemsize:
            raise InputError(f"{name} is cut off: {len(body)} bytes for {width} x {height} cells")
        cells: NDArray[Any] = np.frombuffer(body, kind, width * height)
    else:
        words = body.split()
        if len(words) < width * height or not all(word.isdigit() and len(word) < 6 for word in words):
            raise InputError(f"{name} is cut off, or holds something that is not a number")
        cells = np.array(words[: width * height], dtype=np.int64)
    grey: NDArray[np.float64] = cells.reshape(height, width).astype(np.float64) / top
    return np.minimum(grey, 1.0)
