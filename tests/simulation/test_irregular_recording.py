"""Recordings whose period is not a whole number of time steps."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from crowdbot.core import FreeClock, InputError
from crowdbot.simulation import tracks_of


def recorded(rate: int, seconds: int, first: int = 0) -> Any:
    """A person who walks at 1 m/s along x, recorded every 0.1 s in steps of 1/rate s from record ``first`` on."""
    clock = FreeClock(1.0 / rate)
    schedule = clock.schedule(0.1)
    times = np.array([schedule.tick_of(k) * clock.step_ns / 1e9 for k in range(first, first + 10 * seconds + 1)])
    position = np.zeros((len(times), 1, 2))
    position[:, 0, 0] = times
    active = np.ones((len(times), 1), dtype=bool)
    return SimpleNamespace(
        schedule=schedule, times=times, position=position, active=active, ids=np.array([0]), robots=(), walls=()
    )


@pytest.mark.parametrize("rate", [60, 72, 90])
@pytest.mark.parametrize("first", [0, 3, 17])
def test_a_frame_is_the_recorded_step_at_or_after_its_time(rate: int, first: int) -> None:
    tracks = tracks_of(recorded(rate, 600, first), "walk", 0.4)
    assert len(tracks) == 1501
    late = np.asarray(tracks.x) - (0.1 * first + 0.4 * np.arange(1501))
    assert tracks.dt == pytest.approx(0.4)
    assert late.min() > -1e-4  # the step is rounded to whole nanoseconds
    assert late.max() < 1.0 / rate + 1e-4


def test_the_time_between_frames_is_a_multiple_of_the_recording_period() -> None:
    with pytest.raises(
        InputError, match=r"tracks every 0.25 s: the episode was recorded every 0.1 s, dt must be a mul"
    ):
        tracks_of(recorded(72, 4), "walk", 0.25)
