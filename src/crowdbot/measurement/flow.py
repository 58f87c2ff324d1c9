"""Flow at a line: crossing times, N(t), and flow through the Voronoi cells at the line.

Definitions and names are those of PedPy (doi 10.5281/zenodo.7194992). Its functions are not called for these: it loses
people whose step ends just behind the line, its table of flows lacks the frame of each row, and its three tables at the
line take 15 to 30 times as long. Flow by first and last person: Seyfried et al. 2009, New insights into pedestrian flow
through bottlenecks, doi 10.1287/trsc.1090.0263.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError
from crowdbot.data import Trajectories
from crowdbot.typing import Floats

from .geometry import MeasurementLine
from .rows import check_metres, every_frame, rows_at, table

if TYPE_CHECKING:
    import pandas as pd


ON_LINE = 1e-5
"""People nearer to a line than this [m] at the end of a step have not crossed it yet."""


def compute_crossing_frames(tracks: Trajectories, line: MeasurementLine) -> pd.DataFrame:
    """Return all crossings of a line in either direction: columns id, frame, the first frame behind the line.

    A step that ends within 0.01 mm of the line has not crossed it yet: the step that leaves the line counts.

    Args:
        tracks: the recording; a gap in a track is bridged by no movement.
        line: the line; it ends at its ends.

    >>> tracks = Trajectories([1] * 4, [0, 1, 2, 3], [-1.0, 0.0, 1.0, 2.0], [0.0] * 4, row_rate=1.0)
    >>> compute_crossing_frames(tracks, MeasurementLine((0, -1), (0, 1))).frame.tolist()
    [2]
    """
    check_metres(tracks)
    before = rows_at(tracks, tracks.frame - tracks.frame_step)
    after = np.flatnonzero(before >= 0)
    start, end = tracks.position[before[after]], tracks.position[after]
    across = _intersects(start, end, line)
    near = _distance(end, line) < ON_LINE
    step = np.full(len(tracks.frame), -1)  # step that ends at each row
    step[after] = np.arange(len(after))
    # a step may end just behind the line: the next one does not meet it any more, and still has to count
    for k in np.flatnonzero(across & near):
        later = _next_step(tracks, after, step, int(k))
        while later >= 0 and near[later]:
            later = _next_step(tracks, after, step, later)
        if later >= 0:
            across[later] = True
    across &= ~near
    kept = after[across]
    order = np.lexsort((tracks.frame[kept], tracks.id[kept]))
    return table(id=tracks.id[kept][order], frame=tracks.frame[kept][order])


def _next_step(tracks: Trajectories, after: NDArray[np.int64], step: NDArray[np.int64], k: int) -> int:
    """Return the step of the same person that begins where step ``k`` ends, -1 if the track ends there."""
    row = after[k]
    found = rows_at(tracks, tracks.frame[row : row + 1] + tracks.frame_step, tracks.id[row : row + 1])[0]
    return int(step[found]) if found >= 0 else -1


def compute_n_t(tracks: Trajectories, line: MeasurementLine) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return N(t), the people who have crossed a line, and the first crossing of each person.

    The first table has the columns frame, cumulative_pedestrians, time [s] (since the first frame); the second id,
    frame, sorted by frame.

    >>> x = [-0.5, -1.5, 0.5, -0.5, 1.5, 0.5]
    >>> tracks = Trajectories([1, 2] * 3, [0, 0, 1, 1, 2, 2], x, [0.0] * 6, row_rate=1.0)
    >>> compute_n_t(tracks, MeasurementLine((0, -1), (0, 1)))[0].cumulative_pedestrians.tolist()
    [0, 1, 2]
    """
    crossings = compute_crossing_frames(tracks, line)
    first = crossings.groupby("id")["frame"].min().reset_index().sort_values(["frame", "id"], ignore_index=True)
    frames = every_frame(tracks)
    passed = np.searchsorted(first.frame.to_numpy(), frames, side="right")
    time = (frames - frames[0]) / tracks.fps
    return table(frame=frames, cumulative_pedestrians=passed, time=time), first


def crossing_times(tracks: Trajectories, line: MeasurementLine) -> Floats:
    """Return the sorted times [s] since the first frame at which people first cross a line.

    >>> tracks = Trajectories([1] * 3, [0, 1, 2], [-1.5, -0.5, 0.5], [0.0] * 3, row_rate=2.0)
    >>> crossing_times(tracks, MeasurementLine((0, -1), (0, 1))).tolist()
    [1.0]
    """
    first = compute_n_t(tracks, line)[1]
    rows = rows_at(tracks, first.frame.to_numpy(), first.id.to_numpy())
    return np.sort(tracks.time[rows])


def mean_flow(times: ArrayLike, end: float | None = None) -> float:
    """Return the flow ``(n - 1) / (t_n - t_1)`` [1/s] of n people; NaN for fewer than two.

    Args:
        times: sorted crossing times ``[n]`` [s].
        end: time [s] instead of the last crossing, if not all people have crossed.

    >>> mean_flow([1.0, 2.0, 3.0]), mean_flow([1.0, 2.0, 3.0], end=5.0)
    (1.0, 0.5)
    """
    when = np.asarray(times, dtype=np.float64)
    last = float(when[-1]) if end is None and len(when) else end
    if len(when) < 2 or last is None or not last > when[0]:
        return float("nan")
    return float((len(when) - 1) / (last - float(when[0])))


def compute_flow(
    tracks: Trajectories, n_t: pd.DataFrame, crossings: pd.DataFrame, speed: pd.DataFrame, delta_frame: int
) -> pd.DataFrame:
    """Return flow and speed at a line over consecutive intervals: columns flow [1/s], mean_speed [m/s], frame.

    Intervals of about ``delta_frame`` frames begin and end with a person: ``J = dN / dt`` with dt from the last person
    before the interval to the last in it, and the mean speed of these people when they cross.

    Args:
        tracks: the recording.
        n_t, crossings: result of :func:`compute_n_t`.
        speed: result of :func:`~crowdbot.measurement.compute_individual_speed`.
        delta_frame: frames of an interval.

    Raises:
        InputError: the interval is below 1 frame.
    """
    if delta_frame < 1:
        raise InputError(f"flow is measured over intervals of at least 1 frame, not {delta_frame}")
    passed, frames = n_t.cumulative_pedestrians.to_numpy(), n_t.frame.to_numpy()
    joined = crossings.merge(speed, on=["id", "frame"])
    rows: list[tuple[float, float, int]] = []
    some = np.flatnonzero(passed > 0)
    before_frame, before = (int(frames[some[0]]), 0) if len(some) else (int(frames[-1]), 0)
    for frame in range(before_frame + delta_frame, int(frames[-1]), delta_frame):
        count = int(passed[np.searchsorted(frames, frame, side="right") - 1])
        last = int(frames[np.searchsorted(passed, count)]) + tracks.frame_step
        if count != before:
            own = joined.speed[joined.frame.between(before_frame, last)]
            flow = (count - before) / (last - before_frame) * tracks.fps
            rows.append((flow, float(own.mean()), last))
            before, before_frame = count, last
    flow_, speed_, end = zip(*rows, strict=True) if rows else ((), (), ())
    return table(flow=np.asarray(flow_, float), mean_speed=np.asarray(speed_, float), frame=np.asarray(end, np.int64))


def compute_line_flow(
    tracks: Trajectories,
    polygons: pd.DataFrame,
    line: MeasurementLine,
    speed: pd.DataFrame,
    species: pd.DataFrame,
) -> pd.DataFrame:
    """Return density, speed and specific flow at a line, from the Voronoi cells at the line in each frame.

    With the share w_i / w of the line in the cell V_i of person i and the normal n of the line::

        density = sum_i w_i / w / A(V_i)        [1/m2]
        speed   = sum_i |v_i n| w_i / w         [m/s]
        flow    = sum_i |v_i n| w_i / w / A(V_i) [1/(m s)]

    Each is given for both species (``_sp+1``, ``_sp-1``) and in total; a person who turns round counts negative. Times
    the length of the line, the flow is in people per second.

    Returns:
        Columns frame, density_sp+1, density_sp-1, density, speed_sp+1, speed_sp-1, speed, flow_sp+1, flow_sp-1, flow.
    """
    import shapely

    near = polygons[shapely.intersects(polygons.polygon.to_numpy(), line.line)]
    joined = near.merge(species, on="id", how="left").merge(speed, on=["id", "frame"])
    part = shapely.length(shapely.intersection(joined.polygon.to_numpy(), line.line)) / line.length
    normal = line.normal
    orthogonal = (joined.v_x.to_numpy() * normal[0] + joined.v_y.to_numpy() * normal[1]) * part
    density = joined.density.to_numpy()
    frames = every_frame(tracks)
    slot = ((joined.frame - frames[0]) // tracks.frame_step).to_numpy()
    columns: dict[str, Any] = {"frame": frames}
    for name, values in (("density", density * part), ("speed", orthogonal), ("flow", orthogonal * density)):
        total = np.zeros(len(frames))
        for side in (1, -1):
            mine = (joined.species == side).to_numpy()
            sign = 1.0 if name == "density" else float(side)
            columns[f"{name}_sp{side:+d}"] = sign * np.bincount(slot[mine], values[mine], minlength=len(frames))
            total = total + columns[f"{name}_sp{side:+d}"]
        columns[name] = total
    return table(**columns)


def _intersects(start: Floats, end: Floats, line: MeasurementLine) -> NDArray[np.bool_]:
    """Return whether the ways ``[N, 2]`` from start to end meet the line, ends included."""
    import shapely

    ways = shapely.linestrings(np.stack([start, end], axis=1))
    return np.asarray(shapely.intersects(ways, line.line))


def _distance(place: Floats, line: MeasurementLine) -> Floats:
    import shapely

    return np.asarray(shapely.distance(shapely.points(place), line.line))
