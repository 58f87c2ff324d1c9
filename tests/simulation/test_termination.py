"""Termination: first events of environments."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from crowdbot.core import stream
from crowdbot.simulation import simulate
from crowdbot.simulation.termination import may_be_near, note_events
from crowdbot.trials import load_trial


def controls(*arrived: np.ndarray) -> list[SimpleNamespace]:
    """Return controls of robots that are no ghosts."""
    return [SimpleNamespace(robot=SimpleNamespace(ghost=False), arrived=item) for item in arrived]


def test_the_first_event_stays() -> None:
    event = np.array([0, 0, 0, 1, 2], dtype=np.int8)
    arrived = np.array([True, True, False, True, True])
    note_events(event, [1, 4], controls(arrived, np.ones(5, dtype=np.bool_)), 1, 2)
    assert event.tolist() == [2, 1, 0, 1, 2]
    note_events(event, [], controls(np.zeros(5, dtype=np.bool_)), 1, 2)
    assert event.tolist() == [2, 1, 0, 1, 2]


def test_success_needs_all_robots_and_at_least_one() -> None:
    event = np.zeros(2, dtype=np.int8)
    note_events(event, [], [], 1, 2)
    note_events(event, [], controls(np.array([True, True]), np.array([False, True])), 1, 2)
    assert event.tolist() == [0, 2]


def test_an_agent_that_is_near_is_never_missed() -> None:
    place = stream(1, "near").uniform(-2.0, 2.0, (2000, 1, 2))
    away = np.hypot(place[:, 0, 0] - 0.5, place[:, 0, 1] + 0.25)
    point = np.array([[0.5, -0.25]])
    for e in range(len(place)):
        for distance in (away[e], np.nextafter(away[e], 9.0), 0.9 * away[e]):
            may = may_be_near(place[e : e + 1], 0, point, np.array([distance]))
            assert may or not away[e] < distance
    assert not may_be_near(place[:1], 0, point, 0.9 * away[:1])


def test_a_duration_that_no_goal_cuts_short_is_a_planned_end() -> None:
    for goal, outcome in ((True, "timeout"), (False, "finished")):
        episode = simulate(load_trial("frontal", {"duration": 1.0, "end/goal": goal}))
        assert (episode.outcome, episode.metrics["timeout"]) == (outcome, 1.0)  # the metric: the goal was missed
