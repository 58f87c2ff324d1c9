"""Reference measurements from recordings of real people.

Files are found by name anywhere below the folder.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data import Trajectories, load

from .lanes import lane_order
from .literature import line_speed, weidmann_speed
from .scenario import Floats, Report

__all__ = ["METHODS", "measure_recordings"]

LEAST = 20
"""Minimum number of values of a mean."""

METHODS = {
    "single-file": "n56_cam1.csv, 3 m of a ring with 56 people. Density: 2 / (distance between the person ahead and the"
    " person behind) [1/m]. Speed: along the track over 0.8 s. Means are in bins of 0.2 /m. The frame rate of 25 Hz is"
    " inferred from the velocities in the file",
    "corridor": "four one-way runs of HERMES in corridors of 1.8 and 2.4 m. Density: 1 / (area of the Voronoi cell of"
    " the person inside the corridor) [1/m2]. Speed: along the corridor over 1 s. Both are measured every 0.5 s for"
    " people within 1 m of the middle of the section. Means are in bins of 0.5 /m2",
    "lanes": "two-way runs in corridors of 3.6 and 4 m. Lane order: as for the models, for all people in the section,"
    " once per second while at least five people walk in each direction",
    "bottleneck": "flow (n - 1) / (t_n - t_1) for the first crossings of a line in the bottleneck by n people",
}
"""Measured quantities and methods."""


class _Corridor(NamedTuple):
    name: str
    width: float


CORRIDORS = (
    _Corridor("uo-050-180-180", 1.8),
    _Corridor("uo-080-240-240", 2.4),
    _Corridor("uo-180-180-120", 1.8),
    _Corridor("uo-180-180-070", 1.8),
)


class _Door(NamedTuple):
    file: str
    width: float
    line: float
    who: str


DOORS = (
    _Door("040_c_56_h-.txt", 0.5, -0.5, "Wuppertal 2018, entrance gate"),
    _Door("uo-180-180-070.txt", 0.7, -4.2, "HERMES 2009"),
    _Door("00_01a.h5", 0.8, 0.0, "Wuppertal 2014, pupils"),
    _Door("uo-180-180-120.txt", 1.2, -4.2, "HERMES 2009"),
)
"""People walk towards -y in all of them."""


class _Section(NamedTuple):
    file: str
    along_y: bool
    low: float
    high: float
    width: float


SECTIONS = (
    _Section("bi_corr_400_b_03.txt", False, -5.0, 4.0, 4.0),
    _Section("bo-360-090-090.txt", True, -4.0, 4.0, 3.6),
    _Section("bot-360-075-075.txt", True, -4.0, 4.0, 3.6),
)


def measure_recordings(folder: Path, report: Report) -> dict[str, Any]:
    """Return the measurements of the recordings in a folder, and the names of missing files.

    Raises:
        DataError: the folder does not exist or contains none of the recordings.
    """
    if not folder.is_dir():
        raise DataError(f"--data {folder} is not a folder; give the folder of the recordings")
    missing: list[str] = []

    def found(file: str) -> Trajectories | None:
        paths = sorted(folder.rglob(file))
        if not paths:
            missing.append(file)
        return load(paths[0]) if paths else None

    result: dict[str, Any] = {}
    parts: tuple[tuple[str, Callable[..., Any]], ...] = (
        ("single-file", _single_file),
        ("corridor", _corridors),
        ("lanes", _lanes),
        ("bottleneck", _doors),
    )
    for k, (name, part) in enumerate(parts):
        result[name] = part(found)
        report((k + 1) / len(parts))
    if not any(result.values()):
        raise DataError(f"{folder} contains none of the reference recordings: {', '.join(missing)}")
    return {**result, "missing": sorted(set(missing))}


def _single_file(found: Callable[[str], Trajectories | None]) -> dict[str, Any] | None:
    tracks = found("n56_cam1.csv")
    if tracks is None:
        return None
    place = dict(zip(zip(tracks.id.tolist(), tracks.frame.tolist(), strict=True), tracks.x.tolist(), strict=True))
    step, values = tracks.frame_step, []
    for frame in np.unique(tracks.frame).tolist():
        here = tracks.frame == frame
        order = np.argsort(tracks.x[here])
        x, id = tracks.x[here][order], tracks.id[here][order]
        for k in range(1, len(x) - 1):
            before, after = place.get((id[k], frame - step)), place.get((id[k], frame + step))
            if before is not None and after is not None:
                values.append((2.0 / (x[k + 1] - x[k - 1]), abs(after - before) / (2.0 * tracks.dt)))
    binned = _bins(np.asarray(values), 0.2)
    return {**binned, "distance": _distance(binned, line_speed)}


def _corridors(found: Callable[[str], Trajectories | None]) -> dict[str, Any] | None:
    runs: dict[str, Any] = {}
    for corridor in CORRIDORS:
        tracks = found(f"{corridor.name}.txt")
        if tracks is not None:
            runs[corridor.name] = _bins(_voronoi(tracks, corridor.width), 0.5)
    if not runs:
        return None
    pooled = {key: [value for run in runs.values() for value in run[key]] for key in ("density", "speed")}
    return {"runs": runs, "distance": _distance(pooled, weidmann_speed)}


def _voronoi(tracks: Trajectories, width: float) -> Floats:
    """Return density [1/m2] and speed [m/s] of all people in the middle of a section, as rows ``[N, 2]``."""
    import shapely

    corridor = shapely.box(0.0, -4.0, width, 4.0)
    place = dict(zip(zip(tracks.id.tolist(), tracks.frame.tolist(), strict=True), tracks.y.tolist(), strict=True))
    half, values = round(0.5 / tracks.dt) * tracks.frame_step, []
    for frame in np.unique(tracks.frame)[:: round(0.5 / tracks.dt)].tolist():
        here = (tracks.frame == frame) & (np.abs(tracks.y) < 4.0)
        if here.sum() < 3:
            continue
        points = tracks.position[here]
        cells = shapely.voronoi_polygons(shapely.multipoints(points), extend_to=corridor, ordered=True)
        area = shapely.area(shapely.intersection(shapely.get_parts(cells), corridor))
        for k, id in enumerate(tracks.id[here].tolist()):
            before, after = place.get((id, frame - half)), place.get((id, frame + half))
            if abs(points[k, 1]) < 1.0 and before is not None and after is not None:
                values.append((1.0 / area[k], abs(after - before) / (2.0 * half / tracks.frame_step * tracks.dt)))
    return np.asarray(values)


def _lanes(found: Callable[[str], Trajectories | None]) -> dict[str, Any] | None:
    runs = {}
    for section in SECTIONS:
        tracks = found(section.file)
        if tracks is not None:
            runs[section.file] = _order(tracks, section)
    return runs or None


def _order(tracks: Trajectories, section: _Section) -> dict[str, Any]:
    along, across = (tracks.y, tracks.x) if section.along_y else (tracks.x, tracks.y)
    first = np.unique(tracks.id, return_index=True)[1]
    last = len(tracks) - 1 - np.unique(tracks.id[::-1], return_index=True)[1]
    side = np.sign(along[last] - along[first])[np.searchsorted(tracks.ids, tracks.id)]
    inside = (along > section.low) & (along < section.high)
    rows: list[tuple[float, float, float]] = []
    for frame in np.unique(tracks.frame)[:: round(1.0 / tracks.dt)]:
        here = inside & (tracks.frame == frame)
        if min(np.sum(side[here] > 0.0), np.sum(side[here] < 0.0)) >= 5:
            time = (frame - tracks.frame[0]) / tracks.frame_step * tracks.dt
            area = (section.high - section.low) * section.width
            rows.append((float(time), lane_order(across[here], side[here]), float(here.sum()) / area))
    time, order, density = np.asarray(rows).T
    speed = np.hypot(*tracks.velocities().T)[inside]
    return {
        "time": time.tolist(),
        "order": order.tolist(),
        "mean": float(order.mean()),
        "density": float(density.mean()),
        "speed": float(np.nanmedian(speed)),
    }


def _doors(found: Callable[[str], Trajectories | None]) -> list[dict[str, Any]]:
    flows = []
    for door in DOORS:
        tracks = found(door.file)
        if tracks is None:
            continue
        times = np.sort([t for id in tracks.ids for t in _crossing(tracks, int(id), door.line)])
        flow = (len(times) - 1) / float(times[-1] - times[0])
        flows.append({"file": door.file, "width": door.width, "flow": flow, "people": len(times), "who": door.who})
    return flows


def _crossing(tracks: Trajectories, id: int, line: float) -> list[float]:
    """Return the first time [s] at which a person passes ``line`` [m], as a list that is empty if there is none."""
    mine = tracks.id == id
    y: NDArray[np.float64] = tracks.y[mine]
    over = np.flatnonzero((y[:-1] > line) & (y[1:] <= line))
    return [float(tracks.time[mine][over[0] + 1])] if len(over) else []


def _bins(values: Floats, width: float) -> dict[str, Any]:
    number = np.floor(values[:, 0] / width).astype(np.int64)
    kept = [n for n in np.unique(number) if np.sum(number == n) >= LEAST]
    return {
        "density": [float((n + 0.5) * width) for n in kept],
        "speed": [float(values[number == n, 1].mean()) for n in kept],
        "spread": [float(values[number == n, 1].std()) for n in kept],
    }


def _distance(points: dict[str, Any], curve: Callable[[Any], Floats]) -> float:
    return float(np.sqrt(np.mean((np.asarray(points["speed"]) - curve(points["density"])) ** 2)))
