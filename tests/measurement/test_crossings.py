"""Crossings of a line by steps that end on it, or just behind it."""

import numpy as np

from crowdbot.data import Trajectories
from crowdbot.measurement import MeasurementLine, compute_crossing_frames, crossing_times

LINE = MeasurementLine((0.0, -1.0), (0.0, 1.0))


def _walk(*x):
    return Trajectories([1] * len(x), list(range(len(x))), list(x), [0.0] * len(x), row_rate=1.0)


def _frames(*x):
    return compute_crossing_frames(_walk(*x), LINE).frame.tolist()


def test_a_step_that_ends_just_behind_the_line_is_counted_once():
    assert _frames(-1.0, 1.0) == [1]
    assert _frames(-1.0, 4e-6, 1.0, 2.0) == [2]
    assert _frames(-1.0, 0.0, 1.0, 2.0) == [2]
    assert _frames(-1.0, 4e-6, 5e-6, 6e-6, 1.0) == [4]  # stands there


def test_a_step_that_ends_just_before_the_line_is_counted_once():
    assert _frames(-1.0, -4e-6, 1.0, 2.0) == [2]
    assert _frames(-1.0, -4e-6, -1.0, -2.0) == []


def test_a_track_that_ends_on_the_line_has_not_crossed_it():
    assert _frames(-1.0, 4e-6) == []


def test_everybody_who_passes_is_counted_wherever_the_steps_end():
    rng = np.random.default_rng(3)
    people, rows = 200, 5
    x = np.cumsum(rng.uniform(0.3, 0.6, (rows, people)), axis=0) - 1.2
    x += rng.choice([0.0, 3e-6, 9e-6, -3e-6], people) - x[2]  # the third row is on the line or within 0.01 mm of it
    tracks = Trajectories(
        np.tile(np.arange(people), rows), np.repeat(np.arange(rows), people), x.ravel(), np.zeros(x.size), row_rate=1.0
    )
    assert len(crossing_times(tracks, LINE)) == people
    assert compute_crossing_frames(tracks, LINE).id.tolist() == list(range(people))
