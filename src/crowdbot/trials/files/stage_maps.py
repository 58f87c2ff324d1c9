"""Stage maps: areas from WKT or GeoJSON and ROS maps, as polygons of limited size."""

from __future__ import annotations

import functools
import io
import json
import math
import re
import warnings
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, did_you_mean, parse_yaml
from crowdbot.core.fields import LARGEST
from crowdbot.data import WIDEST_DEGREES

from .trial_files import read_beside, resolve_file

if TYPE_CHECKING:
    import shapely


FARTHEST_FILE = 1e8
"""Largest coordinate in a file [m], above those of UTM (1e7) and Web Mercator (2e7); at it, a double has 1e-8 m."""
MOST_CORNERS = 20_000
MOST_DETAIL = 120_000
MOST_TEXT = 4_000_000
MOST_CELLS = 16_000_000
MOST_IMAGE = 64_000_000
MODES = ("trinary", "scale", "raw")
IMAGES = ("PPM", "PNG", "BMP", "JPEG")
"""Formats of map images; PPM includes PGM and PBM."""
RAW_OCCUPIED = 100
"""Largest value of a cell with a known occupancy [%] in the mode raw."""
GEOGRAPHIC = re.compile(r"CRS84|EPSG:+(?:[0-9.]+:)?(4326|4258|4269|4979)\b", re.IGNORECASE)
"""Names of reference systems in degrees: WGS 84, ETRS89 and NAD83."""
WKT = re.compile(r"\s*(MULTI)?(POLYGON|GEOMETRYCOLLECTION)\b", re.IGNORECASE)


class FilePlacement(NamedTuple):
    """Where the coordinates of a file lie in the trial: they are moved by the offset, then turned about the origin.

    >>> FilePlacement((-10.0, 0.0), 0.5 * math.pi).of(np.array([[11.0, 0.0]])).round(9).tolist()
    [[0.0, 1.0]]
    """

    offset: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0

    def of(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points ``[N, 2]`` [m] of the file in coordinates of the trial."""
        moved: NDArray[np.float64] = points + np.array(self.offset)
        if self.rotation == 0.0:  # no change of any bit
            return moved
        cos, sin = math.cos(self.rotation), math.sin(self.rotation)
        return np.asarray(moved @ np.array([[cos, sin], [-sin, cos]]))

    def place(self, shapes: Any, what: str) -> Any:
        """Return geometries of a file in coordinates of the trial.

        Raises:
            InputError: they are too far from the origin of the trial.
        """
        import shapely

        corners = shapely.get_coordinates(shapes)
        if len(corners) and np.any(np.abs(self.of(corners)) > LARGEST):
            x, y = (-0.5 * (corners.min(axis=0) + corners.max(axis=0))).round() + 0.0
            raise InputError(
                f"{what} has corners more than {LARGEST:g} m from the origin of the trial;"
                f' with offset="{x:.0f},{y:.0f}" its centre is the origin'
            )
        return shapes if self == IN_PLACE else shapely.transform(shapes, self.of)


IN_PLACE = FilePlacement()


def area_of(text: str, folder: Path | None, trust: bool, placement: FilePlacement = IN_PLACE) -> shapely.Geometry:
    """Return the polygon or polygons of an area in coordinates of the trial.

    Args:
        text: WKT, or the name of a WKT or GeoJSON file in the folder.
        folder: folder of the trial.
        trust: whether the file may lie outside the folder.
        placement: place of the coordinates of the text or file in the trial.

    Raises:
        InputError: the text is neither, has no valid polygon or too many corners, or is too far from the origin.

    >>> area_of("POLYGON ((0 0, 4 0, 4 3, 0 3, 0 0))", None, False).area
    12.0
    """
    import shapely

    if is_area_file(text):
        path = resolve_file(text, folder, trust)
        stamp = path.stat()
        return placement.place(_from_file(path, stamp.st_mtime_ns, stamp.st_size), path.name)
    try:
        shape = shapely.from_wkt(text)
    except (shapely.errors.ShapelyError, ValueError) as error:
        raise InputError(f"is not WKT: {_first(error)}") from None
    return placement.place(_checked(shape, "the WKT"), "the WKT")


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
    whole = _checked(shape, path.name)
    if not WKT.match(text):
        _check_degrees(text, whole, path.name)
    return whole


def _check_degrees(text: str, whole: shapely.Geometry, name: str) -> None:
    """Refuse GeoJSON in degrees, which its standard (RFC 7946) prescribes but an area cannot use."""
    west, south, east, north = whole.bounds
    if max(abs(west), abs(east)) > 180.0 or max(abs(south), abs(north)) > 90.0:
        return
    project = "project it to metres, for example to UTM, and give the stage an offset"
    kind = _reference_system(text)
    if GEOGRAPHIC.search(kind):
        raise InputError(f'{name} is in degrees ({kind[:60]}): {project}; remove its "crs" if the numbers are metres')
    size = max(east - west, north - south)
    if size < WIDEST_DEGREES and max(abs(west), abs(south)) > 1.0:
        raise InputError(
            f"{name} is {east - west:.3g} m x {north - south:.3g} m: its coordinates look like degrees of longitude and"
            f" latitude; {project}"
        )


def _reference_system(text: str) -> str:
    """Return the name of the reference system in a GeoJSON text (a member of the format of 2008), empty without one."""
    document: Any
    try:
        document = json.loads(text)
    except (ValueError, RecursionError):  # shapely reads some texts that Python does not
        return ""
    for key in ("crs", "properties", "name"):
        document = document.get(key) if isinstance(document, dict) else None
    return document if isinstance(document, str) else ""


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
    if not np.all(np.isfinite(corners)) or np.any(np.abs(corners) > FARTHEST_FILE):
        raise InputError(f"{what} has corners that are not finite, or more than {FARTHEST_FILE:g} m from the origin")
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
    return [shape] if inner is None else [part for item in inner for part in _parts(item)]


class _Map(NamedTuple):
    """Content of the ``.yaml`` file of a map."""

    image: str
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied: float
    free: float
    mode: str


def map_of(
    name: str, unknown: str, folder: Path | None, trust: bool, placement: FilePlacement = IN_PLACE
) -> tuple[shapely.Polygon, ...]:
    """Return the occupied cells of a ROS map (map_server, a ``.yaml`` file with an image) as polygons.

    Cells are read as by nav2_map_server in the modes ``trinary``, ``scale`` and ``raw``. Cells that touch only at a
    corner are connected there, by a square with a diagonal of one cell. Borders are simplified by at most one cell.

    Args:
        name: name of the ``.yaml`` file in the folder.
        unknown: treatment of unknown cells, ``occupied`` or ``free``.
        folder: folder of the trial.
        trust: whether the files may lie outside the folder.
        placement: place of the coordinates of the map in the trial.

    Raises:
        InputError: a file is missing, too large or not a map, or the map is too far from the origin.
    """
    _, row, image = _map_of(name, folder, trust)
    stamp = image.stat()
    solids = _solids(image, stamp.st_mtime_ns, stamp.st_size, row, unknown)
    return tuple(placement.place(np.array(solids, dtype=object), name)) if solids else ()


def image_solids(path: Path, width: float, height: float) -> list[shapely.Polygon]:
    """Return the dark half of an image that covers a world as polygons without holes.

    Args:
        path: image in one of the formats of maps.
        width, height: extent [m] of the image, whose lower left corner is the origin.

    Raises:
        InputError: the image is too large or detailed, or cannot be read.
    """
    import shapely

    stamp = path.stat()
    rows, columns = _pixels(read_beside(path, MOST_IMAGE), path.name)[0].shape[:2]
    cells = _Map(path.name, 1.0, (0.0, 0.0, 0.0), False, 0.5, 0.5, "scale")
    scale = np.array([width / columns, height / rows])
    solids = _solids(path, stamp.st_mtime_ns, stamp.st_size, cells, "free")
    pieces = [piece for solid in solids for piece in _without_holes(solid)]
    return [shapely.transform(piece, lambda points: points * scale) for piece in pieces]


def _without_holes(shape: shapely.Polygon) -> list[shapely.Polygon]:
    """Return the polygon, divided at the middle hole until no part has one."""
    import shapely

    if not shape.interiors:
        return [shape]
    middles = sorted(ring.centroid.x for ring in shape.interiors)
    at = middles[len(middles) // 2]
    west, south, east, north = shape.bounds
    halves = (shapely.box(west, south, at, north), shapely.box(at, south, east, north))
    parts = [part for half in halves for part in _parts(shape.intersection(half))]
    return [piece for part in parts if part.geom_type == "Polygon" for piece in _without_holes(part)]


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
    """Read a map file."""
    rows = parse_yaml(data.decode("utf-8", "replace"), name)
    rows = rows if isinstance(rows, dict) else {}
    missing = [key for key in ("image", "resolution", "origin") if rows.get(key) is None]
    if missing:
        raise InputError(f"{name} is not a ROS map: it does not say {' and '.join(missing)}")
    origin = rows["origin"]
    if not isinstance(origin, list) or len(origin) != 3:
        raise InputError(f"{name}: origin = {str(origin)[:40]} must be a list of three numbers: x, y [m], yaw [rad]")
    x, y, yaw = (_number(value, "origin", name, FARTHEST_FILE) for value in origin)
    resolution = _number(rows["resolution"], "resolution", name)
    if resolution <= 0.0:
        raise InputError(f"{name}: resolution = {resolution:g} m must be above 0")
    occupied, free = (
        _number(rows.get(key, normal), key, name) for key, normal in (("occupied_thresh", 0.65), ("free_thresh", 0.196))
    )
    for key, value in (("occupied_thresh", occupied), ("free_thresh", free)):
        if not 0.0 <= value <= 1.0:
            hint = f"; {value:g} % is {value / 100.0:g}" if 1.0 < value <= 100.0 else ""
            raise InputError(f"{name}: {key} = {value:g} must be from 0 to 1{hint}")
    if free > occupied:
        raise InputError(f"{name}: free_thresh = {free:g} must not be above occupied_thresh = {occupied:g}")
    mode = str(rows.get("mode", "trinary"))
    if mode not in MODES:
        raise InputError(f"{name}: mode = {mode[:40]!r} is unknown{did_you_mean(mode, MODES)}; use {', '.join(MODES)}")
    negate = rows.get("negate", 0)
    if negate not in (0, 1):
        raise InputError(f"{name}: negate = {str(negate)[:40]} must be 0 or 1")
    return _Map(str(rows["image"]), resolution, (x, y, yaw), bool(negate), occupied, free, mode)


def _number(value: Any, key: str, name: str, largest: float = LARGEST) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{name}: {key} has {str(value)[:40]!r}, which is not a number")
    if not math.isfinite(value) or abs(value) > largest:
        raise InputError(f"{name}: {key} has {value:g}, which is not finite, or larger than {largest:g}")
    return float(value)


@functools.lru_cache(maxsize=4)
def _solids(image: Path, changed: int, size: int, row: _Map, unknown: str) -> tuple[shapely.Polygon, ...]:
    import shapely

    solid = _solid_cells(read_beside(image, MOST_IMAGE), image.name, row, unknown)[::-1]  # an image begins at its top
    edge = np.zeros((solid.shape[0], 1), dtype=np.int8)
    change = np.diff(np.concatenate([edge, solid.astype(np.int8), edge], axis=1), axis=1)
    line, begin = np.nonzero(change == 1)
    end = np.nonzero(change == -1)[1]
    if len(line) == 0:
        return ()
    _check_detail(image, len(line), "runs of solid cells")
    corner_x, corner_y = _diagonal_corners(solid)
    _check_detail(image, len(corner_x), "corners at which solid cells touch")
    bridge = 0.5 * np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
    bridges = shapely.polygons(np.stack([corner_x, corner_y], axis=-1)[:, None] + bridge)
    whole = shapely.union_all(np.concatenate([shapely.box(begin, line, end, line + 1), bridges]))
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


def _diagonal_corners(solid: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return x and y of the corners [cells] at which two solid cells touch and the two others are free.

    Without material there, each cell is a polygon of its own, and simplifying them opens gaps between them.
    """
    low, high = solid[:-1], solid[1:]
    rising, falling = low[:, :-1] & high[:, 1:], low[:, 1:] & high[:, :-1]
    y, x = np.nonzero(rising & ~(low[:, 1:] | high[:, :-1]) | falling & ~(low[:, :-1] | high[:, 1:]))
    return x + 1, y + 1


def _check_detail(image: Path, count: int, what: str) -> None:
    """Refuse noise: to simplify it takes minutes."""
    if count > MOST_DETAIL:
        raise InputError(f"{image.name} has {count} {what}, more than {MOST_DETAIL}; clean or shrink the map")


def _solid_cells(data: bytes, name: str, row: _Map, unknown: str) -> NDArray[np.bool_]:
    """Return ``[H, W]`` whether each pixel is solid, by the rules of nav2_map_server (``map_io.cpp``)."""
    colour, opacity = _pixels(data, name)
    if row.mode == "raw":  # the value of a pixel is the occupancy in percent, whatever `negate` says
        value = np.round(colour.mean(axis=2) * 255.0)
        solid, known = value >= 100.0 * row.occupied, value <= RAW_OCCUPIED
    else:
        opaque = np.ones(colour.shape[:2]) if opacity is None else opacity
        if row.mode == "trinary" and opacity is not None:  # the opacity counts as a fourth colour
            colour = np.concatenate([colour, opacity[..., None]], axis=2)
        dark = colour.mean(axis=2) if row.negate else 1.0 - colour.mean(axis=2)
        solid, known = dark > row.occupied, opaque == 1.0
        if row.mode == "trinary":
            known = solid | (dark < row.free)
    return np.asarray(solid & known if unknown == "free" else solid | ~known)


def _pixels(data: bytes, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Return colours ``[H, W, C]`` and the opacity ``[H, W]`` of an image, if it has one, from 0 to 1."""
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # the number of cells is limited below
            image = Image.open(io.BytesIO(data), formats=IMAGES)
        with image:
            if image.width * image.height > MOST_CELLS:
                raise InputError(f"{name} has {image.width} x {image.height} cells; at most {MOST_CELLS} are read")
            deep = image.mode.startswith("I")
            kind = "I" if deep else {"1": "L", "L": "L", "LA": "LA", "RGB": "RGB"}.get(image.mode, "RGBA")
            if "transparency" in image.info:
                deep, kind = False, "RGBA"
            cells = np.atleast_3d(np.asarray(image.convert(kind), dtype=np.float64)) / (65_535.0 if deep else 255.0)
    except Image.DecompressionBombError:
        raise InputError(f"{name} has too many cells; at most {MOST_CELLS} are read") from None
    except UnidentifiedImageError:
        raise InputError(f"{name} is not an image that can be read: a map is a PGM, PNG, BMP or JPEG image") from None
    except (OSError, ValueError, SyntaxError, EOFError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{name} is cut off or damaged: {_first(error)}") from None
    return (cells[..., :-1], cells[..., -1]) if kind in ("LA", "RGBA") else (cells, None)
