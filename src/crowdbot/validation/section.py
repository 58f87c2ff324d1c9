"""Fundamental diagram of a corridor section: the same measurement for recordings of people and for models."""

from __future__ import annotations

import numpy as np

from crowdbot.data import Trajectories
from crowdbot.measurement import (
    WalkableArea,
    compute_individual_speed,
    compute_individual_voronoi_polygons,
    select_rows,
)
from crowdbot.typing import Floats

from .scenario import CrowdTracks

HALF_SECTION = 4.0
"""Half length of the section in which Voronoi cells are computed [m]."""
MIDDLE = 1.0
"""People within this distance of the middle [m] are measured."""
METHOD = (
    f"Density: 1 / (area of the person's Voronoi cell inside a section of {2.0 * HALF_SECTION:g} m of the corridor)"
    f" [1/m2]. Speed: along the corridor over about 1 s. Both are measured for people within {MIDDLE:g} m of the middle"
    " of the section. Means are in bins of 0.5 /m2"
)


def section_values(tracks: Trajectories, width: float, every: float = 0.5) -> tuple[Floats, Floats]:
    """Return density ``[N]`` [1/m2] and speed ``[N]`` [m/s] of all people in the middle of a section.

    Args:
        tracks: people in a corridor along y, ``0 < x < width``; the section is ``-4 < y < 4``.
        width: width of the corridor [m].
        every: time between measurements [s].
    """
    half = max(1, round(0.5 / tracks.dt)) * tracks.frame_step
    speed = compute_individual_speed(tracks, half, direction=(0.0, 1.0))
    frames = np.unique(tracks.frame)[:: max(1, round(every / tracks.dt))]
    inside = np.isin(tracks.frame, frames) & (np.abs(tracks.y) < HALF_SECTION) & (tracks.x >= 0.0) & (tracks.x <= width)
    # the cells of one or two people reach the ends of the section
    count = np.bincount(tracks.frame[inside] - tracks.frame[0], minlength=1)
    chosen = inside & (count[np.minimum(tracks.frame - tracks.frame[0], len(count) - 1)] >= 3)
    if not np.any(chosen):
        return np.empty(0), np.empty(0)
    section = select_rows(tracks, chosen)
    ends = (-HALF_SECTION, HALF_SECTION)
    corridor = WalkableArea([(0.0, ends[0]), (width, ends[0]), (width, ends[1]), (0.0, ends[1])])
    cells = compute_individual_voronoi_polygons(section, corridor)
    cells = cells[np.abs(section.y) < MIDDLE].merge(speed, on=["id", "frame"])
    return cells.density.to_numpy(), np.abs(cells.speed.to_numpy())


def section_of(walk: CrowdTracks, e: int, length: float, begin: float) -> Trajectories:
    """Return the people of environment ``e`` on a periodic track along x as a recording with the corridor along y.

    People are wrapped onto the track; the middle of the track is y = 0, so no one is measured near the seam.

    Args:
        walk: tracks.
        e: environment.
        length: length of the track [m].
        begin: first time [s].
    """
    late = np.flatnonzero(walk.times >= begin - 1e-9)
    step, id = np.nonzero(walk.present[late, e])
    frame = late[step]
    place = walk.position[frame, e, id]
    along = place[:, 0] - length * np.floor(place[:, 0] / length) - 0.5 * length
    return Trajectories(
        id,
        frame,
        place[:, 1],
        along,
        row_rate=1.0 / float(walk.times[1] - walk.times[0]),
        frame_step=1,
        name="crowd",
    )
