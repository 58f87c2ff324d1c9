"""Reference measurements from recordings of real people.

Files are found by name anywhere below the folder.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import DataError
from crowdbot.data import Trajectories, load
from crowdbot.measurement import (
    MeasurementLine,
    compute_fundamental_diagram,
    compute_headways,
    compute_individual_speed,
    crossing_times,
    lane_order,
    walking_direction,
)
from crowdbot.typing import Floats

from .bottleneck import steady_flow
from .scenario import Report, line_speed, weidmann_speed
from .section import METHOD, section_values

LEAST = 20
"""Minimum number of values of a mean."""
FAR = 1e3
"""Half length [m] of lines that end outside all walls."""

METHODS = {
    "single-file": "n56_cam1.csv, 3 m of a ring with 56 people. Density: 2 / (distance between the person ahead and the"
    " person behind) [1/m]. Speed: along the track over 0.8 s. Means are in bins of 0.2 /m. The frame rate of 25 Hz is"
    " inferred from the velocities in the file",
    "corridor": f"four one-way runs of HERMES in corridors of 1.8 and 2.4 m, every 0.5 s. {METHOD}",
    "lanes": "two-way runs in corridors of 3.6 and 4 m. Lane order: as for the models, for all people in the section,"
    " once per second while at least five people walk in each direction",
    "bottleneck": "as for the models: flow (n - 1) / (t_n - t_1) of the crossings of a line in the bottleneck, without"
    " the first and last sixth of the people",
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
    gaps = compute_headways(tracks)
    joined = gaps.merge(compute_individual_speed(tracks, tracks.frame_step, direction=(1.0, 0.0)), on=["id", "frame"])
    joined = joined[joined.density.notna()]
    binned = _bins(joined.density.to_numpy(), np.abs(joined.speed.to_numpy()), 0.2)
    return {**binned, "distance": _distance(binned, line_speed)}


def _corridors(found: Callable[[str], Trajectories | None]) -> dict[str, Any] | None:
    runs: dict[str, Any] = {}
    for corridor in CORRIDORS:
        tracks = found(f"{corridor.name}.txt")
        if tracks is not None:
            runs[corridor.name] = _bins(*section_values(tracks, corridor.width), 0.5)
    if not runs:
        return None
    pooled = {key: [value for run in runs.values() for value in run[key]] for key in ("density", "speed")}
    return {"runs": runs, "distance": _distance(pooled, weidmann_speed)}


def _lanes(found: Callable[[str], Trajectories | None]) -> dict[str, Any] | None:
    runs = {}
    for section in SECTIONS:
        tracks = found(section.file)
        if tracks is not None:
            runs[section.file] = _order(tracks, section)
    return runs or None


def _order(tracks: Trajectories, section: _Section) -> dict[str, Any]:
    along, across = (tracks.y, tracks.x) if section.along_y else (tracks.x, tracks.y)
    side = walking_direction(tracks, along)
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
        times = crossing_times(tracks, MeasurementLine((-FAR, door.line), (FAR, door.line)))
        flow = steady_flow(times)
        flows.append({"file": door.file, "width": door.width, "flow": flow, "people": len(times), "who": door.who})
    return flows


def _bins(density: Floats, speed: Floats, width: float) -> dict[str, Any]:
    diagram = compute_fundamental_diagram(density, speed, width, least=LEAST)
    return {name: diagram[name].tolist() for name in ("density", "speed", "spread")}


def _distance(points: dict[str, Any], curve: Callable[[Any], Floats]) -> float:
    return float(np.sqrt(np.mean((np.asarray(points["speed"]) - curve(points["density"])) ** 2)))
