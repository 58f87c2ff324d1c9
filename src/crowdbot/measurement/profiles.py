"""Profiles: density and speed on a grid of square cells."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .geometry import WalkableArea
from .rows import table

if TYPE_CHECKING:
    import pandas as pd


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
        """Return the centers ``[rows * columns, 2]`` [m], row by row."""
        x = self.x0 + (np.arange(self.columns) + 0.5) * self.size
        y = self.y1 - (np.arange(self.rows) + 0.5) * self.size
        return np.stack(np.broadcast_arrays(x[None, :], y[:, None]), axis=-1).reshape(-1, 2)


def compute_profiles(grid: Grid, polygons: pd.DataFrame, speed: pd.DataFrame) -> pd.DataFrame:
    """Return mean density and speed over time in each cell: columns x, y [m], density [1/m2], speed, flow [1/(m s)].

    The density is that of PedPy, the mean over frames of the Voronoi density of the cell. The speed is the mean of the
    people in all frames, weighted by the area of their Voronoi cells in the cell; NaN where nobody is.

    Args:
        grid: cells.
        polygons: result of :func:`~crowdbot.measurement.compute_individual_voronoi_polygons`.
        speed: result of :func:`~crowdbot.measurement.compute_individual_speed`.

    >>> hall = WalkableArea([(0, 0), (2, 0), (2, 1), (0, 1)])
    >>> cells = table(id=[1], frame=[0], polygon=[hall.polygon], density=[0.5])
    >>> compute_profiles(Grid.over(hall, 1.0), cells, table(id=[1], frame=[0], speed=[1.2]))[["density", "speed"]]
       density  speed
    0      0.5    1.2
    1      0.5    1.2
    """
    import shapely

    x, y = grid.centers().T
    half = 0.5 * grid.size
    cells = shapely.box(x - half, y - half, x + half, y + half)
    people = polygons.merge(speed, on=["id", "frame"])
    # PedPy makes a matrix of all cells by all rows; the tree needs a third of its time and memory for what overlaps
    shapes = people.polygon.to_numpy()
    person, cell = shapely.STRtree(cells).query(shapes, predicate="intersects")
    area = shapely.area(shapely.intersection(shapes[person], cells[cell]))
    inside = area > 0.0
    person, cell, area = person[inside], cell[inside], area[inside]
    people_here, covered, moved = (
        np.asarray(np.bincount(cell, area * values[person], minlength=len(cells)), dtype=np.float64)
        for values in (people.density.to_numpy(), np.ones(len(people)), people.speed.to_numpy())
    )
    density = people_here / (grid.size**2 * polygons.frame.nunique())
    mean = np.where(covered > 0.0, moved / np.where(covered > 0.0, covered, 1.0), np.nan)
    return table(x=x, y=y, density=density, speed=mean, flow=density * mean)
