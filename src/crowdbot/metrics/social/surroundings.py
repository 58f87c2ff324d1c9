"""Crowd around a robot: density within several radii, nearness, speeds of people near it, and its worst-off people."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.metrics.proximity import ZONES
from crowdbot.typing import Floats

from .robot_log import RobotLog
from .voronoi_density import voronoi_metrics

RADII = {"2_5m": 2.5, "3m": 3.0, "5m": 5.0, "10m": 10.0}
"""Radii [m] of densities (CrowdBot)."""
LONG = 0.5
"""Time [s] in the intimate or personal zone after which a person counts as disturbed."""


def density_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``density``."""
    away = np.hypot(*np.moveaxis(log.people_position - log.position[:, None], -1, 0))
    away = np.where(log.present, away, np.inf)
    found: dict[str, float] = {}
    for name, radius in RADII.items():
        density = (away < radius).sum(axis=1) / (math.pi * radius**2)
        found |= {f"density_{name}": float(np.mean(density)), f"max_density_{name}": float(np.max(density))}
    near = log.nearest[np.isfinite(log.nearest)]
    spread = float(np.std(near) / np.mean(near)) if len(near) and np.mean(near) != 0.0 else math.nan
    speed = np.hypot(log.people_velocity[..., 0], log.people_velocity[..., 1])
    everyone = speed[log.present]
    found |= {
        "proximity_variation": spread,
        "people_speed": float(np.mean(everyone)) if len(everyone) else math.nan,
        "nearest_person_speed": _nearest_speed(log, away, speed),
    }
    for name, radius in (("2_5m", 2.5), ("5m", 5.0)):
        inner, outer = speed[away < radius], speed[log.present & (away >= radius)]
        known = len(inner) and len(outer) and np.mean(outer) > 0.0
        found[f"velocity_loss_{name}"] = 1.0 - float(np.mean(inner) / np.mean(outer)) if known else math.nan
    return found | voronoi_metrics(log)


def _nearest_speed(log: RobotLog, away: Floats, speed: Floats) -> float:
    rows = np.flatnonzero(np.isfinite(away).any(axis=1))
    return float(np.mean(speed[rows, np.argmin(away[rows], axis=1)])) if len(rows) else math.nan


def person_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``people``: values of the worst-off people, not means over time."""
    if not log.present.shape[1]:
        names = (
            "worst_decile_clearance",
            "worst_person_intrusion_time",
            "intimate_people_share",
            "personal_people_share",
        )
        return dict.fromkeys(names, math.nan)
    least = np.sort(log.least_gap.min(axis=0))
    steps = np.diff(log.times, prepend=log.times[0])
    times = {zone: steps @ (log.gap < ZONES[zone]) for zone in ("intimate", "personal")}
    return {
        "worst_decile_clearance": float(np.mean(least[: max(1, math.ceil(len(least) / 10))])),
        "worst_person_intrusion_time": float(np.max(times["personal"])),
        **{f"{zone}_people_share": float(np.mean(time > LONG)) for zone, time in times.items()},
    }
