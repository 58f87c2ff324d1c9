"""Contact events: the release distance that separates two contacts, and the instant of a graze."""

import numpy as np
import pytest

from crowdbot.metrics import contact_events

STEP = 0.1
RADIUS = np.array([0.25, 0.25])


def events_of(gaps):
    """Return the contact events of a standing robot and a person at these clearances [m], one each 0.1 s."""
    position = np.zeros((len(gaps), 2, 2))
    position[:, 1, 0] = 0.5 + np.asarray(gaps)
    velocity, active = np.zeros_like(position), np.ones(position.shape[:2], dtype=bool)
    return contact_events(STEP * np.arange(len(gaps)), position, velocity, RADIUS, active, robot=0)


@pytest.mark.parametrize(("apart", "count"), [(0.02, 1), (0.049, 1), (0.051, 2), (0.2, 2)])
def test_a_contact_ends_only_beyond_the_release_distance(apart, count):
    found = events_of([0.3, -0.1, *[apart] * 8, -0.1, 0.3])
    assert len(found) == count
    assert found[-1].end == pytest.approx(1.0 + 0.1 * (found[-1].end > 1.05))


@pytest.mark.parametrize(("samples", "count"), [(5, 1), (6, 2), (7, 2)])
def test_a_contact_ends_only_after_the_hold_time(samples, count):
    assert len(events_of([0.3, -0.1, *[0.2] * samples, -0.1, 0.3])) == count


def test_a_graze_begins_where_the_distance_is_smallest():
    """A person passes at 0.4999 m, 0.1 mm deep: first touch is just before the closest point, the normal sideways."""
    position = np.zeros((2, 2, 2))
    position[:, 1] = [[-1.0, 0.4999], [1.0, 0.4999]]
    velocity, active = np.zeros_like(position), np.ones((2, 2), dtype=bool)
    (event,) = contact_events(np.array([0.0, 1.0]), position, velocity, RADIUS, active, robot=0)
    half = np.sqrt(0.5**2 - 0.4999**2)
    assert event.begin == pytest.approx(0.5 * (1.0 - half), abs=1e-9)
    assert event.depth == pytest.approx(1e-4, abs=1e-9)
    assert event.impact_speed == pytest.approx(2.0 * half / 0.5, abs=1e-9)


def test_a_touch_without_overlap_is_at_the_closest_point():
    """Rounding may leave a graze without an intersection: its time is that of the smallest distance."""
    from crowdbot.metrics.contacts import _touch

    assert _touch(np.array([-1.0, 0.5]), np.array([2.0, 0.0]), 0.4) == pytest.approx(0.5)
    assert _touch(np.array([-1.0, 0.0]), np.array([2.0, 0.0]), 0.4) == pytest.approx(0.3)
    assert _touch(np.array([1.0, 0.0]), np.array([2.0, 0.0]), 0.4) == 0.0
