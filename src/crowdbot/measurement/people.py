"""Speed, acceleration and Voronoi cell of each person, by PedPy (doi 10.5281/zenodo.7194992).

Voronoi cells: Steffen, Seyfried 2010, Methods for measuring pedestrian density, flow, speed and direction with minimal
scatter, doi 10.1016/j.physa.2009.12.015.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import DataError, InputError, did_you_mean
from crowdbot.data import Trajectories
from crowdbot.typing import Floats, Ints

from .geometry import WalkableArea
from .rows import check_metres, check_step, table

if TYPE_CHECKING:
    import pandas as pd


BORDERS = {
    "exclude": "rows whose window is not complete are left out",
    "adaptive": "the window shrinks symmetrically towards the ends of a track",
    "single-sided": "at the ends of a track, only one half of the window is used",
}
"""What is done at the ends of a track."""


def pedpy_tracks(tracks: Trajectories) -> Any:
    """Return a recording as ``pedpy.TrajectoryData``, for all functions of PedPy.

    Most of them count frames one by one: resample a recording with more than one frame between two rows first.

    Raises:
        DataError: the tracks are in pixels.

    >>> import pedpy
    >>> tracks = Trajectories([1, 2, 1], [0, 0, 1], [0.5, 1.5, 0.5], [0.5, 0.5, 3.0], row_rate=1.0)
    >>> area = pedpy.MeasurementArea([(0, 0), (2, 0), (2, 1), (0, 1)])
    >>> pedpy.compute_classic_density(traj_data=pedpy_tracks(tracks), measurement_area=area).density.tolist()
    [1.0, 0.0]
    """
    import pedpy

    check_metres(tracks)
    rows = table(id=tracks.id, frame=tracks.frame, x=tracks.x, y=tracks.y)
    return pedpy.TrajectoryData(rows, frame_rate=tracks.fps)


@dataclass(frozen=True)
class ContinuousTracks:
    """The parts of tracks without a gap, each with an id of its own and with consecutive frame numbers.

    PedPy counts rows where it means frames. In a track with a gap its windows would be longer than asked for, and a
    person would cross lines while nobody saw it.

    Fields:
        data: the parts as ``pedpy.TrajectoryData``; their frames are numbered from the first frame of the recording.
        owner: ``[P]`` id of the person of each part.
        shift: ``[P]`` frame of the recording of number 0.
        frame_step: frames of the recording from one number to the next.
    """

    data: Any
    owner: Ints
    shift: Ints
    frame_step: int

    @classmethod
    def of(cls, tracks: Trajectories) -> ContinuousTracks:
        """Return the parts of all tracks of a recording.

        Raises:
            DataError: the tracks are in pixels.
        """
        import pedpy

        check_metres(tracks)
        order = np.lexsort((tracks.frame, tracks.id))
        id, frame = tracks.id[order], tracks.frame[order]
        first = np.ones(len(order), dtype=np.bool_)
        first[1:] = (id[1:] != id[:-1]) | (np.diff(frame) != tracks.frame_step)
        part = np.empty(len(order), dtype=np.int64)
        part[order] = np.cumsum(first) - 1
        number = (tracks.frame - tracks.frame[0]) // tracks.frame_step
        shift = (tracks.frame - number * tracks.frame_step)[order[first]]
        rows = table(id=part, frame=number, x=tracks.x, y=tracks.y)
        return cls(pedpy.TrajectoryData(rows, frame_rate=tracks.row_rate), id[first], shift, tracks.frame_step)

    def restore(self, result: pd.DataFrame, *frames: str) -> pd.DataFrame:
        """Return a table of PedPy with the ids and frames of the recording, in its order.

        Args:
            result: table with the column id and columns of frame numbers.
            frames: names of the columns of frame numbers.
        """
        part = result["id"].to_numpy()
        columns: dict[str, Any] = {name: self.shift[part] + self.frame_step * result[name] for name in frames}
        restored = result.assign(id=self.owner[part], **columns)
        return restored.sort_values([frames[0], "id"], ignore_index=True)


def compute_individual_speed(
    tracks: Trajectories, frame_step: int, direction: ArrayLike | None = None, border: str = "exclude"
) -> pd.DataFrame:
    """Return speed and velocity of every person and frame: columns id, frame, speed, v_x, v_y [m/s].

    ``v_i(t) = |x_i(t + n/fps) - x_i(t - n/fps)| / (2 n / fps)`` with n the frame step. A track ends at a gap.

    Args:
        tracks: the recording.
        frame_step: frames of the recording before and after a frame that are compared.
        direction: ``[2]`` only the movement along this vector counts, signed (default: any direction).
        border: ``exclude``, ``adaptive`` or ``single-sided``, see ``BORDERS``.

    Raises:
        InputError: an argument is not allowed.
        DataError: the tracks are in pixels.

    >>> tracks = Trajectories([1, 1, 1], [0, 1, 2], [0.0, 0.5, 1.0], [0.0, 0.0, 0.0], row_rate=2.0)
    >>> compute_individual_speed(tracks, 1).speed.tolist()
    [1.0]
    >>> compute_individual_speed(tracks, 1, border="single-sided").speed.tolist()
    [1.0, 1.0, 1.0]
    """
    import pedpy

    check_step(tracks, frame_step)
    if border not in BORDERS:
        raise InputError(f"unknown border {border!r}{did_you_mean(border, BORDERS)}; known are {', '.join(BORDERS)}")
    parts = ContinuousTracks.of(tracks)
    speed = pedpy.compute_individual_speed(
        traj_data=parts.data,
        frame_step=frame_step // tracks.frame_step,
        compute_velocity=True,
        movement_direction=_unit(direction),
        speed_calculation=pedpy.SpeedCalculation[f"BORDER_{border.replace('-', '_').upper()}"],
    )
    # a part of one row has no window, and PedPy divides by it
    return parts.restore(speed.dropna(), "frame")


def compute_individual_acceleration(
    tracks: Trajectories, frame_step: int, direction: ArrayLike | None = None
) -> pd.DataFrame:
    """Return the acceleration of every person and frame: columns id, frame, acceleration, a_x, a_y [m/s2].

    ``a_i(t) = |x(t) - 2 x(t - n/fps) + x(t - 2 n/fps)| / (n / fps)^2``; rows without both earlier rows are left out.

    Raises:
        InputError, DataError: as in :func:`compute_individual_speed`.

    >>> tracks = Trajectories([1, 1, 1], [0, 1, 2], [0.0, 0.5, 2.0], [0.0, 0.0, 0.0], row_rate=1.0)
    >>> compute_individual_acceleration(tracks, 1).acceleration.tolist()
    [1.0]
    """
    import pedpy

    check_step(tracks, frame_step)
    parts = ContinuousTracks.of(tracks)
    acceleration = pedpy.compute_individual_acceleration(
        traj_data=parts.data,
        frame_step=frame_step // tracks.frame_step,
        compute_acceleration_components=True,
        movement_direction=_unit(direction),
    )
    return parts.restore(acceleration, "frame")


def compute_individual_voronoi_polygons(
    tracks: Trajectories, walkable: WalkableArea, cut_off: float | None = None
) -> pd.DataFrame:
    """Return the Voronoi cell of every person in each frame: columns id, frame, polygon (shapely), density [1/m2].

    Cells are clipped to the walkable area and to the cut-off. In an area that is not convex, the part of a cell with
    the person is kept.

    Args:
        tracks: the recording.
        walkable: where people can walk.
        cut_off: radius of the circle [m] around a person whose dodecagon holds its cell (default: none).

    Raises:
        InputError: the cut-off is not above 0.
        DataError: a person is outside the walkable area, two people are at the same position, or the tracks are in
            pixels.

    >>> tracks = Trajectories([1, 2], [0, 0], [0.5, 1.5], [0.5, 0.5], row_rate=1.0)
    >>> hall = WalkableArea([(0, 0), (2, 0), (2, 1), (0, 1)])
    >>> compute_individual_voronoi_polygons(tracks, hall).density.tolist()
    [1.0, 1.0]
    """
    import pedpy

    if cut_off is not None and not 0.0 < cut_off < np.inf:
        raise InputError(f"cut-off of {cut_off} m: the radius must be above 0 and finite")
    outside = np.flatnonzero(~walkable.covers(tracks.position))
    if len(outside):
        first = outside[0]
        raise DataError(
            f"{tracks.name}: {len(outside)} rows are outside the walkable area, the first is id {tracks.id[first]} in"
            f" frame {tracks.frame[first]} at ({tracks.x[first]:.2f}, {tracks.y[first]:.2f})"
        )
    places = np.column_stack([tracks.frame, tracks.position])
    kinds, count = np.unique(places, axis=0, return_counts=True)
    if len(kinds) < len(places):
        frame = int(kinds[np.argmax(count > 1), 0])
        raise DataError(f"{tracks.name}: two people are at the same position in frame {frame}")
    try:
        # the walkable area of PedPy refuses an area in several parts, such as on both sides of a wall
        cells: pd.DataFrame = pedpy.compute_individual_voronoi_polygons(
            traj_data=pedpy_tracks(tracks),
            walkable_area=walkable,
            cut_off=None if cut_off is None else pedpy.Cutoff(radius=cut_off, quad_segments=3),
        )
    except pedpy.PedPyError as error:  # a person on the border of an area that is not convex
        raise DataError(f"{tracks.name}: {error}") from error
    return cells


def _unit(direction: ArrayLike | None) -> Floats | None:
    """Return a direction with length 1; PedPy scales movements by other lengths."""
    if direction is None:
        return None
    axis = np.asarray(direction, dtype=np.float64)
    if axis.shape != (2,) or not np.all(np.isfinite(axis)) or not np.any(axis):
        raise InputError("the direction of a movement must be two finite numbers that are not both 0")
    return np.asarray(axis / np.hypot(*axis))
