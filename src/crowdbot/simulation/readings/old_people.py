"""Readings that are late or old: when they arrive, and how people were when they were measured."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.simulation.world_view import WorldView

__all__ = ["arrival_of", "known_people", "people_then"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def arrival_of(sensor: Any, ticks: Ints, due: Ints) -> Ints:
    """Return ``[N]`` the ticks at which the readings of some environments arrive; late ones arrive in their order."""
    arrival: Ints = sensor.schedule.arrives(ticks[due])
    if sensor.lateness is None:
        return arrival
    arrival = arrival + sensor.lateness[due]
    for earlier, readings in sensor.waiting:
        rows, places = np.nonzero(readings.environments[:, None] == due[None, :])
        arrival[places] = np.maximum(arrival[places], earlier[rows])
    return arrival


def people_then(sensor: Any, around: WorldView, due: Ints) -> Floats | None:
    """Return ``[N, A, 4]`` positions [m] and velocities [m/s] of agents now, None for a sensor that keeps none."""
    if not sensor.keeps_people:
        return None
    scene = around.world.scene
    return np.concatenate([scene.position[due], scene.velocity[due]], axis=-1)


def known_people(readings: Any, row: int) -> Floats | None:
    """Return ``[A, 4]`` positions and velocities in a row of readings, None without a reading."""
    if readings is None or readings.people is None:
        return None
    known: Floats = readings.people[row]
    return known
