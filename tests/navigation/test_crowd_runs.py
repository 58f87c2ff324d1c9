"""Closed loop: navigators among 40 people who walk both ways (rates over 50 seeds: run corridor.py)."""

import numpy as np
import pytest
from corridor import run, share

from crowdbot.navigation import ORCANavigator, Straight
from samples import sample


@pytest.mark.parametrize("way", sample(["across", "diagonal", "along"], 1))
def test_orca_gets_through_people_who_see_it(way):
    rows = run(ORCANavigator(), range(8), way, length=20.0 if way == "across" else 30.0)
    assert share(rows, "success") >= 7 / 8
    assert share(rows, "contacts") <= 1 / 8
    assert min(row["min_wall_clearance"] for row in rows) > 0.0
    assert share(rows, "path_efficiency") > 0.6


@pytest.mark.sweep
def test_orca_hurts_fewer_than_straight_among_people_who_do_not_see_it():
    setting = {"way": "diagonal", "width": 10.0, "length": 40.0, "visible": False}
    blind, careful = (run(navigator, range(12), **setting) for navigator in (Straight(), ORCANavigator()))
    assert share(blind, "success") <= 0.35
    assert share(careful, "success") >= share(blind, "success") + 0.25
    assert share(careful, "robot_caused_contacts") <= 0.1


def test_a_run_repeats_and_does_not_depend_on_its_neighbours():
    together = run(ORCANavigator(), range(3), limit=4.0)
    again = run(ORCANavigator(), range(3), limit=4.0)
    alone = run(ORCANavigator(), [2], limit=4.0)
    for item, two in zip(together, again, strict=True):
        np.testing.assert_equal(item, two)
    np.testing.assert_equal(alone[0], together[2])
