"""Density: people per area, and Voronoi cells.

Voronoi density: Steffen, Seyfried 2010, Methods for measuring pedestrian density, flow, speed and direction with
minimal scatter, doi 10.1016/j.physa.2009.12.015. Names are those of PedPy (doi 10.5281/zenodo.7194992).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError
from crowdbot.data import Trajectories

from .geometry import MeasurementArea, WalkableArea
from .rows import Floats, check_metres, every_frame, table

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["CutOff", "compute_classic_density", "compute_individual_voronoi_polygons", "compute_voronoi_density"]


@dataclass(frozen=True)
class CutOff:
    """Largest extent of a Voronoi cell: a regular polygon in the circle of ``radius`` [m] around the person.

    Fields:
        radius: radius of the circle [m].
        quad_segments: edges for a quarter of the circle.

    Raises:
        InputError: a field is not above 0.
    """

    radius: float
    quad_segments: int = 3

    def __post_init__(self) -> None:
        if not self.radius > 0.0 or not np.isfinite(self.radius) or self.quad_segments < 1:
            raise InputError(
                f"cut-off of {self.radius} m with {self.quad_segments} edges: the radius must be above 0 and finite,"
                " with at least 1 edge a quarter"
            )


def compute_classic_density(tracks: Trajectories, area: MeasurementArea) -> pd.DataFrame:
    """Return the classic density N / A in each frame: columns frame, density [1/m2].

    N people are inside the area, those on its border are not.

    >>> tracks = Trajectories([1, 2, 1], [0, 0, 1], [0.5, 1.5, 0.5], [0.5, 0.5, 3.0], row_rate=1.0)
    >>> compute_classic_density(tracks, MeasurementArea([(0, 0), (2, 0), (2, 1), (0, 1)])).density.tolist()
    [1.0, 0.0]
    """
    check_metres(tracks)
    frames = every_frame(tracks)
    inside = tracks.frame[area.contains(tracks.position)]
    count = np.bincount((inside - frames[0]) // tracks.frame_step, minlength=len(frames))
    return table(frame=frames, density=count / area.area)


def compute_individual_voronoi_polygons(
    tracks: Trajectories, walkable: WalkableArea, cut_off: CutOff | None = None
) -> pd.DataFrame:
    """Return the Voronoi cell of every person in each frame: columns id, frame, polygon (shapely), density [1/m2].

    Cells are clipped to the walkable area and to the cut-off. In an area that is not convex, the part of a cell with
    the person is kept.

    Raises:
        DataError: a person is outside the walkable area, two people are at the same position, or the tracks are in
            pixels.

    >>> tracks = Trajectories([1, 2], [0, 0], [0.5, 1.5], [0.5, 0.5], row_rate=1.0)
    >>> hall = WalkableArea([(0, 0), (2, 0), (2, 1), (0, 1)])
    >>> compute_individual_voronoi_polygons(tracks, hall).density.tolist()
    [1.0, 1.0]
    """
    check_metres(tracks)
    outside = np.flatnonzero(~walkable.covers(tracks.position))
    if len(outside):
        first = outside[0]
        raise DataError(
            f"{tracks.name}: {len(outside)} rows are outside the walkable area, the first is id {tracks.id[first]} in"
            f" frame {tracks.frame[first]} at ({tracks.x[first]:.2f}, {tracks.y[first]:.2f})"
        )
    import shapely

    cells = np.empty(len(tracks), dtype=object)
    borders = np.flatnonzero(np.diff(tracks.frame)) + 1
    place = tracks.position
    for rows in np.split(np.arange(len(tracks)), borders):
        if len(np.unique(place[rows], axis=0)) < len(rows):
            raise DataError(f"{tracks.name}: two people are at the same position in frame {tracks.frame[rows[0]]}")
        cells[rows] = _cells(place[rows], walkable.polygon, cut_off)
    return table(id=tracks.id, frame=tracks.frame, polygon=cells, density=1.0 / shapely.area(cells))


def compute_voronoi_density(tracks: Trajectories, polygons: pd.DataFrame, area: MeasurementArea) -> pd.DataFrame:
    """Return the Voronoi density of an area in each frame: columns frame, density [1/m2].

    ``rho(t) = sum_i A(V_i(t) and M) / A(V_i(t)) / A(M)`` with the Voronoi cells V_i and the area M.

    Args:
        tracks: the recording.
        polygons: result of :func:`compute_individual_voronoi_polygons`.
        area: area M.

    >>> tracks = Trajectories([1, 2], [0, 0], [0.5, 1.5], [0.5, 0.5], row_rate=1.0)
    >>> cells = compute_individual_voronoi_polygons(tracks, WalkableArea([(0, 0), (2, 0), (2, 1), (0, 1)]))
    >>> compute_voronoi_density(tracks, cells, MeasurementArea([(0, 0), (1, 0), (1, 1), (0, 1)])).density.tolist()
    [1.0]
    """
    import shapely

    cells = polygons.polygon.to_numpy()
    part = shapely.area(shapely.intersection(cells, area.polygon)) / shapely.area(cells)
    frames = every_frame(tracks)
    slot = ((polygons.frame - frames[0]) // tracks.frame_step).to_numpy()
    return table(frame=frames, density=np.bincount(slot, part, minlength=len(frames)) / area.area)


def _cells(place: Floats, walkable: Any, cut_off: CutOff | None) -> NDArray[np.object_]:
    """Return the Voronoi cells ``[N]`` of the people of one frame."""
    import shapely

    tessellation = shapely.voronoi_polygons(shapely.multipoints(place), extend_to=walkable, ordered=True)
    cells = shapely.intersection(shapely.get_parts(tessellation), walkable)
    if cut_off is not None:
        cells = shapely.intersection(
            cells, shapely.buffer(shapely.points(place), cut_off.radius, quad_segs=cut_off.quad_segments)
        )
    for k in np.flatnonzero(shapely.get_type_id(cells) != shapely.GeometryType.POLYGON):
        cells[k] = _part_with(cells[k], shapely.Point(place[k]))
    return np.asarray(cells)


def _part_with(cell: Any, person: Any) -> Any:
    """Return the polygon of a cell in several parts that is nearest to the person."""
    import shapely

    parts = [part for part in shapely.get_parts(cell) if part.geom_type == "Polygon"]
    return min(parts, key=lambda part: part.distance(person))
