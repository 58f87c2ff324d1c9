"""Planted feet stay on random paths: starts, stops, changes of pace and turns, drawn by hypothesis."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st
from walks import slip, soles

from crowdbot.humans import Gait, People

DT = 0.02
FORCE = 1.5
"""Nobody speeds up, slows down or is pulled round a bend faster than this [m/s2]."""
TURN = 2.0
"""Nobody turns faster than this [rad/s] while walking, nor than twice this on the spot."""
PIECES = st.lists(st.tuples(st.floats(0.0, 1.8), st.floats(-TURN, TURN), st.floats(0.4, 2.0)), min_size=2, max_size=5)


def _path(pieces):
    """Positions, velocities and headings of a body that is asked for speed and turn rate, piece by piece."""
    place, heading, speed, turn = np.zeros(2), 0.0, 0.0, 0.0
    for ask, rate, time in pieces:
        for _ in range(round(time / DT)):
            speed += np.clip(ask - speed, -FORCE * DT, FORCE * DT)
            most = min(abs(rate), FORCE / max(speed, 1e-3))
            turn += np.clip(np.sign(rate) * most - turn, -8.0 * DT, 8.0 * DT)
            heading += turn * DT
            velocity = speed * np.array([np.cos(heading), np.sin(heading)])
            place = place + velocity * DT
            yield place, velocity, heading


@settings(max_examples=25, deadline=None)
@given(PIECES, st.integers(0, 10_000))
@example([(1.4, 0.0, 1.5), (0.0, 0.0, 1.5)], 0)
@example([(0.0, 4.0, 1.0), (1.2, 0.0, 1.0), (0.0, -4.0, 1.0)], 1)
@example([(1.8, 2.0, 2.0), (0.0, -2.0, 0.4), (1.8, -2.0, 2.0)], 2)
def test_feet_that_stand_do_not_slip(pieces, seed):
    people = People.of(["man-38", "woman-20", "girl-09"])
    gait = Gait(people, seed=seed)
    count = len(people)
    state = gait.start(np.zeros((count, 2)), np.zeros(count))
    states, points = [state], [soles(gait, gait.posture(state))]
    for place, velocity, heading in _path(pieces):
        state = gait.step(state, np.tile(place, (count, 1)), np.tile(velocity, (count, 1)), np.full(count, heading), DT)
        states.append(state)
        points.append(soles(gait, gait.posture(state)))
    points = np.array(points)
    assert np.nanmax(slip(states, points, DT)) < 0.02
    assert np.array([s.planted for s in states]).max(axis=-1).min() == 1.0  # one foot always stands
    assert points[..., 2].min() > -1e-9
