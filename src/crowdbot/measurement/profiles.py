"""Profiles: density, speed and flow on a grid of square cells.

Definitions are those of PedPy (doi 10.5281/zenodo.7194992).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.data import Trajectories

from .geometry import WalkableArea
from .rows import Floats, Integers

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["DENSITY_PROFILES", "SPEED_PROFILES", "Grid", "compute_density_profile", "compute_speed_profile"]

DENSITY_PROFILES = ("voronoi", "classic", "gaussian")
SPEED_PROFILES = ("voronoi", "arithmetic", "mean", "gaussian")
MOST_CELLS = 250_000


@dataclass(frozen=True)
class Grid:
    """Square cells over the bounding box of an area; row 0 is at the top (largest y), as in an image.

    Fields:
        x0, y1: the left upper corner [m].
        size: edge of a cell [m].
        rows, columns: number of cells.
    """

    x0: float
    y1: float
    size: float
    rows: int
    columns: int

    @classmethod
    def over(cls, area: WalkableArea, size: float) -> Grid:
        """Return the grid that covers an area.

        Raises:
            InputError: the size is not above 0, or there would be more than 250 000 cells.

        >>> Grid.over(WalkableArea([(0, 0), (2, 0), (2, 1), (0, 1)]), 0.5)
        Grid(x0=0.0, y1=1.0, size=0.5, rows=2, columns=4)
        """
        if not (size > 0.0 and math.isfinite(size)):
            raise InputError(f"the cells of a grid must be larger than {size} m")
        x0, y0, x1, y1 = area.bounds
        rows, columns = (max(1, math.ceil(round(length / size, 9))) for length in (y1 - y0, x1 - x0))
        if rows * columns > MOST_CELLS:
            raise InputError(f"cells of {size} m give {rows} x {columns} of them, more than the limit of {MOST_CELLS}")
        return cls(float(x0), float(y1), size, rows, columns)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top [m], as in ``matplotlib.imshow``."""
        return self.x0, self.x0 + self.columns * self.size, self.y1 - self.rows * self.size, self.y1

    def centers(self) -> Floats:
        """Return the centers ``[rows, columns, 2]`` [m]."""
        x = self.x0 + (np.arange(self.columns) + 0.5) * self.size
        y = self.y1 - (np.arange(self.rows) + 0.5) * self.size
        return np.stack(np.broadcast_arrays(x[None, :], y[:, None]), axis=-1)

    def cells(self) -> Any:
        """Return the cells ``[rows * columns]`` as shapely boxes, row by row."""
        import shapely

        x, y = np.moveaxis(self.centers().reshape(-1, 2), -1, 0)
        half = 0.5 * self.size
        return shapely.box(x - half, y - half, x + half, y + half)

    def cell_of(self, position: Floats) -> Integers:
        """Return the number of the cell ``[N]`` of each point ``[N, 2]`` [m], -1 outside the grid."""
        column = np.floor((position[:, 0] - self.x0) / self.size).astype(np.int64)
        row = np.floor((self.y1 - position[:, 1]) / self.size).astype(np.int64)
        inside = (row >= 0) & (row < self.rows) & (column >= 0) & (column < self.columns)
        return np.where(inside, row * self.columns + column, -1)


def compute_density_profile(
    tracks: Trajectories, grid: Grid, polygons: pd.DataFrame | None = None, method: str = "voronoi", width: float = 0.5
) -> Floats:
    """Return the mean density over time in each cell, ``[rows, columns]`` [1/m2].

    Args:
        tracks: the recording.
        grid: cells.
        polygons: Voronoi cells of the people, for ``voronoi``.
        method: ``voronoi`` (area of the Voronoi cells in a cell over their areas), ``classic`` (people per cell) or
            ``gaussian`` (a normalised Gaussian around each person).
        width: full width at half maximum of the Gaussian [m].

    Raises:
        InputError: the method is unknown, or ``polygons`` is missing.
    """
    _check_method(method, DENSITY_PROFILES, polygons)
    frames = len(np.unique(tracks.frame))
    total = np.zeros(grid.rows * grid.columns)
    if method == "classic":
        cell = grid.cell_of(tracks.position)
        total += np.bincount(cell[cell >= 0], minlength=len(total)) / grid.size**2
    elif method == "gaussian":
        total += _gaussian(grid, tracks.position, np.ones(len(tracks)), width)
    else:
        assert polygons is not None
        cell, person, area = _overlaps(grid, polygons)
        total += np.bincount(cell, area * polygons.density.to_numpy()[person], minlength=len(total)) / grid.size**2
    return (total / frames).reshape(grid.rows, grid.columns)


def compute_speed_profile(
    tracks: Trajectories,
    grid: Grid,
    speed: pd.DataFrame,
    polygons: pd.DataFrame | None = None,
    method: str = "voronoi",
    width: float = 0.5,
) -> Floats:
    """Return the mean speed in each cell, ``[rows, columns]`` [m/s]; NaN where nobody is.

    Args:
        tracks: the recording.
        grid: cells.
        speed: result of :func:`~crowdbot.measurement.compute_individual_speed`.
        polygons: Voronoi cells of the people, for ``voronoi`` and ``arithmetic``.
        method: ``voronoi`` (weighted by the area of the Voronoi cells in a cell), ``arithmetic`` (all people whose
            Voronoi cell meets a cell), ``mean`` (people in a cell) or ``gaussian`` (weights by the distance).
        width: full width at half maximum of the Gaussian [m].

    Raises:
        InputError: the method is unknown, or ``polygons`` is missing.
    """
    _check_method(method, SPEED_PROFILES, polygons)
    size = grid.rows * grid.columns
    if method == "gaussian":
        joined = tracks.to_frame().merge(speed, on=["id", "frame"])
        place = joined[["x", "y"]].to_numpy()
        total = _gaussian(grid, place, joined.speed.to_numpy(), width)
        count = _gaussian(grid, place, np.ones(len(place)), width)
    else:
        cell, value, weight = _cell_speeds(tracks, grid, speed, polygons, method)
        total = np.asarray(np.bincount(cell, weight * value, minlength=size))
        count = np.asarray(np.bincount(cell, weight, minlength=size))
    mean = np.where(count > 0.0, total / np.where(count > 0.0, count, 1.0), np.nan)
    return mean.reshape(grid.rows, grid.columns)


def _cell_speeds(
    tracks: Trajectories, grid: Grid, speed: pd.DataFrame, polygons: pd.DataFrame | None, method: str
) -> tuple[Integers, Floats, Floats]:
    """Return cells, the speeds of people in them and their weights."""
    if method == "mean":
        joined = tracks.to_frame().merge(speed, on=["id", "frame"])
        cell = grid.cell_of(joined[["x", "y"]].to_numpy())
        inside = cell >= 0
        return cell[inside], joined.speed.to_numpy()[inside], np.ones(int(inside.sum()))
    assert polygons is not None
    joined = polygons.merge(speed, on=["id", "frame"])
    cell, person, area = _overlaps(grid, joined)
    return cell, joined.speed.to_numpy()[person], area if method == "voronoi" else np.ones(len(area))


def _check_method(method: str, known: tuple[str, ...], polygons: Any) -> None:
    if method not in known:
        raise InputError(f"unknown profile {method!r}{did_you_mean(method, known)}; known are {', '.join(known)}")
    if polygons is None and method in ("voronoi", "arithmetic"):
        raise InputError(f"a profile by {method} needs the Voronoi cells of the people")


def _overlaps(grid: Grid, polygons: pd.DataFrame) -> tuple[Integers, Integers, Floats]:
    """Return cell, row of ``polygons`` and common area [m2] of all pairs that overlap."""
    import shapely

    cells, people = grid.cells(), polygons.polygon.to_numpy()
    person, cell = shapely.STRtree(cells).query(people, predicate="intersects")
    area = shapely.area(shapely.intersection(people[person], cells[cell]))
    kept = area > 0.0
    return cell[kept], person[kept], area[kept]


def _gaussian(grid: Grid, place: Floats, weight: Floats, width: float) -> Floats:
    """Return ``sum_i weight_i g(c - x_i)`` at the centers c of cells, with a Gaussian g [1/m2]."""
    if not width > 0.0:
        raise InputError(f"the width of a Gaussian must be above 0, not {width}")
    sigma = width / (2.0 * math.sqrt(2.0 * math.log(2.0)))
    centers = grid.centers()
    total = np.zeros((grid.rows, grid.columns))
    for first in range(0, len(place), 1000):
        few = place[first : first + 1000]
        x = np.exp(-0.5 * ((centers[0, :, 0][:, None] - few[:, 0]) / sigma) ** 2)
        y = np.exp(-0.5 * ((centers[:, 0, 1][:, None] - few[:, 1]) / sigma) ** 2)
        total += np.einsum("rn,cn,n->rc", y, x, weight[first : first + 1000], optimize=True)
    return (total / (2.0 * math.pi * sigma**2)).ravel()
