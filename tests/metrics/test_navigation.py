"""Navigation metrics against cases worked out by hand, and against slow twins."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot import metrics
from crowdbot.core import InputError, stream
from crowdbot.core.geometry import nearest_on_segment, time_to_contact
from crowdbot.metrics import (
    NAVIGATION_METRICS,
    cause_of,
    clearance,
    contact_events,
    heading_change,
    jerk,
    local_density,
    longest_stall,
    navigation_metrics,
    outcome,
    path_efficiency,
    path_length,
    personal_space_compliance,
    proxemic_shares,
    stalled_time,
    swept_clearance,
    swept_distance,
    time_to_collision,
    wall_clearance,
)

few = settings(max_examples=40, deadline=None)
R = 0.3
"""Radius of everyone in these logs [m]."""


def log(robot, *people, dt=0.1):
    """Return times, position, velocity, radius, active of a log from paths ``[T, 2]``."""
    position = np.stack([np.asarray(path, dtype=float) for path in (robot, *people)], axis=1)
    velocity = np.zeros_like(position)
    velocity[1:] = np.diff(position, axis=0) / dt
    velocity[0] = velocity[1]
    count = position.shape[1]
    return dt * np.arange(len(position)), position, velocity, np.full(count, R), np.ones(position.shape[:2], bool)


def walk(start, velocity, steps, dt=0.1):
    return np.array(start) + dt * np.arange(steps + 1)[:, None] * np.array(velocity)


def ended(robot, *people, goal, tolerance=0.25, dt=0.1, **options):
    times, position, _, radius, active = log(robot, *people, dt=dt)
    return outcome(times, position, radius, active, 0, np.array(goal), tolerance, **options)


# ---- outcome ---------------------------------------------------------------------------------------------------------


def test_success_is_the_first_sample_within_the_tolerance():
    assert ended(walk((0, 0), (1, 0), 30), walk((0, 5), (0, 0), 30), goal=(2, 0)) == ("success", 18)


def test_a_goal_that_is_only_passed_between_samples_is_not_reached():
    assert ended(walk((0, 0), (10, 0), 3), goal=(0.5, 0), tolerance=0.2).name == "timeout"


def test_a_contact_before_the_goal_is_a_collision():
    assert ended(walk((0, 0), (1, 0), 30), walk((1, 0), (0, 0), 30), goal=(2, 0)) == ("collision", 5)


def test_a_contact_after_the_goal_does_not_count():
    assert ended(walk((0, 0), (1, 0), 30), walk((2.2, 0), (0, 0), 30), goal=(1, 0)).name == "success"


def test_contact_and_goal_in_the_same_step_is_a_collision():
    assert ended([(0, 0), (1, 0)], [(1.5, 0), (1.5, 0)], goal=(1, 0)).name == "collision"


def test_samples_miss_a_head_on_contact_but_the_sweep_finds_it():
    robot, person = [(0, 0), (1, 0)], [(1, 0.1), (0, 0.1)]
    times, position, _, radius, active = log(robot, person)
    assert np.all(clearance(position, radius, active, 0)[:, 1] > 0.3)
    assert swept_clearance(times, position, radius, active, 0)[1, 1] == pytest.approx(0.1 - 2 * R)
    assert ended(robot, person, goal=(9, 9)) == ("collision", 1)


def test_time_limit():
    way = walk((0, 0), (1, 0), 30)
    assert ended(way, goal=(2, 0), time_limit=1.0) == ("timeout", 10)
    assert ended(way, goal=(9, 0)) == ("timeout", 30)
    assert ended(way, goal=(2, 0), time_limit=1.85).name == "success"


def test_a_wall_counts_only_when_given():
    wall = np.array([[1.05, -1.0, 1.05, 1.0]])
    assert ended(walk((0, 0), (1, 0), 30), goal=(2, 0), walls=wall) == ("collision", 8)
    assert ended(walk((0, 0), (1, 0), 30), goal=(2, 0)).name == "success"


# ---- proximity -------------------------------------------------------------------------------------------------------


@few
@given(st.lists(st.floats(-5, 5), min_size=4, max_size=4))
def test_swept_distance_is_that_of_the_kernel(numbers):
    a, b = np.array(numbers[:2]), np.array(numbers[2:])
    assert swept_distance(a, b) == pytest.approx(math.hypot(*nearest_on_segment(0.0, 0.0, *a, *b)), abs=1e-12)


@few
@given(st.integers(0, 10_000))
def test_time_to_collision_is_that_of_the_kernel(seed):
    rng = stream(seed, "pairs")
    position, velocity, radius = rng.normal(0, 3, (4, 6, 2)), rng.normal(0, 1, (4, 6, 2)), rng.uniform(0.1, 0.6, 6)
    when = time_to_collision(position, velocity, radius, np.ones((4, 6), bool), 2)
    for t, i in np.ndindex(4, 6):
        s, w = position[t, i] - position[t, 2], velocity[t, i] - velocity[t, 2]
        expected = math.inf if i == 2 else time_to_contact(*s, *w, radius[i] + radius[2])
        assert when[t, i] == pytest.approx(expected, rel=1e-9)


@few
@given(st.integers(0, 10_000))
def test_swept_clearance_is_the_smallest_of_many_samples(seed):
    rng = stream(seed, "ways")
    position, radius = rng.normal(0, 2, (5, 3, 2)), rng.uniform(0.1, 0.6, 3)
    swept = swept_clearance(np.arange(5.0), position, radius, np.ones((5, 3), bool), 0)
    share = np.linspace(0, 1, 2001)[:, None, None]
    for k in range(1, 5):
        between = position[k - 1] + share * (position[k] - position[k - 1])
        fine = clearance(between, radius, np.ones(between.shape[:2], bool), 0).min(axis=0)
        np.testing.assert_allclose(swept[k, 1:], fine[1:], atol=5e-3)
        assert np.all(swept[k, 1:] <= fine[1:] + 1e-12)


def test_who_is_absent_is_infinitely_far():
    times, position, _, radius, active = log(walk((0, 0), (0, 0), 4), walk((1, 0), (0, 0), 4))
    active[2:4, 1] = False
    swept = swept_clearance(times, position, radius, active, 0)
    assert np.isinf(swept[:, 1]).tolist() == [False, False, True, True, False]
    assert np.all(np.isinf(swept[:, 0]))


def test_who_enters_or_jumps_sweeps_nothing():
    person = [(9.0, 0.0), (9.0, 0.0), (-9.0, 0.0), (-9.0, 0.0)]
    times, position, _, radius, active = log(walk((0, 0), (0, 0), 3), person)
    assert swept_clearance(times, position, radius, active, 0)[:, 1].min() == pytest.approx(9.0 - 2 * R)
    active[1, 1] = False
    assert swept_clearance(times, position, radius, active, 0)[2, 1] == pytest.approx(9.0 - 2 * R)


def test_wall_clearance_by_hand():
    path = np.array([[0.0, 0.0], [2.0, 0.0]])
    wall = [[1.0, 0.5, 1.0, 2.0], [-1.0, -0.4, 5.0, -0.4]]
    np.testing.assert_allclose(wall_clearance(path, 0.3, np.array(wall)), [0.1, 0.1])
    np.testing.assert_allclose(wall_clearance(path, 0.3, np.array([[1.0, -1.0, 1.0, 1.0]])), [0.7, -0.3])
    assert np.all(np.isinf(wall_clearance(path, 0.3, np.zeros((0, 4)))))


def test_zones_and_compliance():
    nearest = np.array([-0.2, 0.44, 0.45, 0.5, 1.19, 1.2, 3.59, 3.6, 10.0, np.inf])
    assert proxemic_shares(nearest) == pytest.approx({"intimate": 0.2, "personal": 0.3, "social": 0.2})
    assert personal_space_compliance(nearest) == pytest.approx(0.7)
    assert personal_space_compliance(nearest, space=4.0) == pytest.approx(0.2)


def test_density_counts_centres():
    people = [walk((x, 0), (0, 0), 1) for x in (1.0, 2.4, 2.6)]
    _, position, _, _, active = log(walk((0, 0), (0, 0), 1), *people)
    np.testing.assert_allclose(local_density(position, active, 0), 2 / (math.pi * 2.5**2))
    active[1, 1] = False
    np.testing.assert_allclose(local_density(position, active, 0)[1], 1 / (math.pi * 2.5**2))


# ---- motion ----------------------------------------------------------------------------------------------------------


def test_path():
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0.0]])
    assert path_length(square) == 4.0
    assert path_efficiency(square) == 0.0
    assert path_efficiency(square[:3]) == pytest.approx(math.sqrt(2) / 2)
    assert path_efficiency(walk((0, 0), (0.3, 0.4), 20)) == pytest.approx(1.0)
    assert math.isnan(path_efficiency(np.zeros((3, 2))))


def test_stalls():
    times = np.array([0.0, 0.1, 0.3, 0.6, 1.0])
    velocity = np.array([[0, 0], [0, 0], [0.04, 0], [1, 0], [0, 0.0]])
    assert stalled_time(times, velocity) == pytest.approx(0.1 + 0.2 + 0.4)
    assert longest_stall(times, velocity) == pytest.approx(0.4)
    assert stalled_time(times, velocity, speed=0.01) == pytest.approx(0.1 + 0.4)


@pytest.mark.parametrize("dt", [0.02, 0.05, 0.1])
def test_jerk_does_not_depend_on_the_log_rate(dt):
    times = np.arange(0.0, 3.0 + dt / 2, dt)
    velocity = np.stack([0.5 * 1.5 * times**2, 0.5 * 2.0 * times**2], axis=1)  # jerk 1.5, 2.0: size 2.5
    np.testing.assert_allclose(jerk(times, velocity), 2.5, rtol=1e-6)


def test_jerk_of_a_coarse_log_uses_its_own_step():
    times = np.arange(0.0, 3.1, 0.4)
    np.testing.assert_allclose(jerk(times, np.stack([times**2, 0 * times], axis=1)), 2.0, rtol=1e-6)
    assert len(jerk(times[:2], np.zeros((2, 2)))) == 0


def test_heading_change_goes_the_short_way():
    assert heading_change(np.array([0.0, 0.5, 0.2])) == pytest.approx(0.8)
    assert heading_change(np.array([3.1, -3.1, 3.1])) == pytest.approx(2 * (2 * math.pi - 6.2))
    assert heading_change(np.zeros(0)) == 0.0


# ---- contacts --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("robot", "person", "cause"),
    [
        ((1.0, 0.0), (0.0, 0.0), "robot"),
        ((0.0, 0.0), (-1.0, 0.0), "person"),
        ((1.0, 0.0), (-1.0, 0.0), "mutual"),
        ((1.0, 0.0), (-1.04, 0.0), "mutual"),
        ((1.0, 0.0), (-1.06, 0.0), "person"),
        ((0.04, 0.0), (0.0, 0.0), "person"),  # a standing robot never is the cause
        ((1.2, 0.0), (1.0, 0.0), "robot"),  # from behind
        ((0.0, 1.0), (-0.3, 0.0), "person"),  # moving past
    ],
)
def test_cause(robot, person, cause):
    assert cause_of(np.array([1.0, 0.0]), np.array(robot), np.array(person)) == cause


def test_an_event_by_hand():
    # the person comes at 1 m/s from 1.05 m, turns at 0.35 m: touch at a distance of 0.6 m, after 0.45 s
    person = np.concatenate([walk((1.05, 0), (-1, 0), 7), walk((0.45, 0), (1, 0), 20)])
    times, position, velocity, radius, active = log(np.zeros((len(person), 2)), person)
    (event,) = contact_events(times, position, velocity, radius, active, 0)
    assert (event.person, event.cause) == (1, "person")
    assert event.begin == pytest.approx(0.45)
    assert event.depth == pytest.approx(0.25)
    assert event.end == pytest.approx(1.0)  # 0.55 m at 0.9 s, clear at 1.0 s: that step still overlapped
    assert event.impact_speed == pytest.approx(1.0)


def test_the_impact_from_behind_is_the_difference_of_speeds():
    times, position, velocity, radius, active = log(walk((0, 0), (1.2, 0), 40), walk((1, 0), (1.0, 0), 40))
    (event,) = contact_events(times, position, velocity, radius, active, 0)
    assert event.impact_speed == pytest.approx(0.2)
    assert event.cause == "robot"


def test_a_glancing_contact_has_only_its_normal_part():
    # passes along x at an offset of 0.36 m: at touch the normal has x = 0.48, so 1 m/s closes at 0.8
    times, position, velocity, radius, active = log(walk((0, 0), (1, 0), 30), walk((1.48, 0.36), (0, 0), 30))
    (event,) = contact_events(times, position, velocity, radius, active, 0)
    assert event.begin == pytest.approx(1.0)
    assert event.impact_speed == pytest.approx(0.8)
    assert event.depth == pytest.approx(2 * R - 0.36)


def distances(values, dt=0.1):
    """Return the log of a person at the given distances from a standing robot."""
    values = np.asarray(values, dtype=float)
    return log(np.zeros((len(values), 2)), np.stack([values, 0 * values], axis=1), dt=dt)


def test_short_breaks_do_not_end_an_event():
    short = [1.0, 0.5, *[0.8] * 4, 0.5, *[1.0] * 9]
    long = [1.0, 0.5, *[0.8] * 8, 0.5, *[1.0] * 9]
    near = [1.0, 0.5, *[0.62] * 20, 0.5, *[1.0] * 9]  # never 0.05 m apart
    for values, count in ((short, 1), (long, 2), (near, 1)):
        assert len(contact_events(*distances(values), 0)) == count


def test_a_contact_at_the_end_or_from_the_beginning_is_an_event():
    (last,) = contact_events(*distances([1.0, 0.8, 0.5]), 0)
    assert last.end == pytest.approx(0.2)
    times, position, velocity, radius, active = distances([0.5, 0.5, 0.5])
    velocity[0, 1] = (-0.7, 0.0)
    (first,) = contact_events(times, position, velocity, radius, active, 0)
    assert (first.begin, first.cause) == (0.0, "person")
    assert first.impact_speed == pytest.approx(0.7)


def test_everyone_has_their_own_events_in_order():
    one, two = walk((2, 0), (-1, 0), 30), walk((0, 1.3), (0, -1), 30)
    times, position, velocity, radius, active = log(np.zeros((31, 2)), one, two)
    events = contact_events(times, position, velocity, radius, active, 0)
    assert [event.person for event in events] == [2, 1]
    assert events[0].begin == pytest.approx(0.7)


# ---- all together ----------------------------------------------------------------------------------------------------


def measured(robot, *people, goal=(2.0, 0.0), tolerance=0.25, **options):
    return navigation_metrics(*log(robot, *people), 0, np.array(goal), tolerance, **options)


def test_every_key_is_documented_and_in_order():
    found = measured(walk((0, 0), (1, 0), 30), walk((1, 2), (0, 0), 30))
    assert set(found) == set(NAVIGATION_METRICS)
    assert all(isinstance(value, float) for value in found.values())
    assert all(unit and meaning for unit, meaning in NAVIGATION_METRICS.values())
    assert found["success"] + found["collision"] + found["timeout"] == 1.0


def test_a_free_straight_run_by_hand():
    found = measured(walk((0, 0), (1, 0), 30), walk((1, 2), (0, 0), 30), walls=np.array([[-1.0, -1.0, 9.0, -1.0]]))
    expected = {
        "success": 1.0,
        "duration": 1.8,
        "time_to_goal": 1.8,
        "goal_progress": 0.9,
        "path_length": 1.8,
        "path_efficiency": 1.0,
        "min_clearance": 1.4,
        "min_clearance_time": 1.0,
        "min_wall_clearance": 0.7,
        "personal_space_compliance": 1.0,
        "social_share": 1.0,
        "intimate_share": 0.0,
        "contacts": 0.0,
        "min_ttc": math.inf,
        "stalled_time": 0.0,
        "mean_jerk": 0.0,
        "heading_change": 0.0,
        "max_local_density": 1 / (math.pi * 2.5**2),
    }
    assert {name: found[name] for name in expected} == pytest.approx(expected, abs=1e-9)


def test_a_collision_by_hand():
    found = measured(walk((0, 0), (1, 0), 30), walk((1.05, 0), (0, 0), 30))
    assert (found["collision"], found["contacts"], found["robot_caused_contacts"]) == (1.0, 1.0, 1.0)
    assert math.isnan(found["time_to_goal"])
    assert found["max_impact_speed"] == pytest.approx(1.0)
    assert found["max_penetration"] == pytest.approx(2 * R)
    assert found["min_clearance"] == pytest.approx(-2 * R)
    assert found["min_ttc"] == 0.0
    assert found["contact_time"] == pytest.approx(1.7 - 0.45)  # clear again at 1.65 s, within the step to 1.7 s


def test_time_to_collision_shares():
    found = measured(walk((0, 0), (1, 0), 30), walk((4.6, 0), (0, 0), 30), goal=(1.0, 0.0))  # 4 s at first, 3.2 at last
    assert found["min_ttc"] == pytest.approx(3.2)
    assert found["ttc_below_3s"] == 0.0
    near = measured(walk((0, 0), (1, 0), 30), walk((3.15, 0), (0, 0), 30), goal=(1.0, 0.0))  # 2.55 to 1.75 s
    assert (near["ttc_below_3s"], near["ttc_below_1s"]) == (1.0, 0.0)


def test_a_time_to_collision_of_exactly_the_bound_is_not_below_it():
    # one sample each at 4, 3, 2, 1 and 0.5 s: radii of 0.25 m, 1 m/s, all numbers exact in binary
    place = np.zeros((5, 2, 2))
    place[:, 1, 0] = 0.5 + np.array([4.0, 3.0, 2.0, 1.0, 0.5])
    velocity = np.zeros((5, 2, 2))
    velocity[:, 0, 0] = 1.0
    radius, here = np.full(2, 0.25), np.ones((5, 2), bool)
    found = navigation_metrics(np.arange(5.0), place, velocity, radius, here, 0, np.array([9.0, 9.0]), 0.1)
    assert (found["min_ttc"], found["ttc_below_1s"], found["ttc_below_3s"]) == (0.5, 0.2, 0.6)


def test_someone_who_passes_through_the_robot_between_two_samples_is_a_contact():
    # 4 m in one step of 1 s: at both samples the person is 1.5 m clear, in the middle of the step 0.4 m deep
    place = np.zeros((3, 2, 2))
    place[:, 1] = [[-2.0, 0.1], [2.0, 0.1], [6.0, 0.1]]
    still, radius, here = np.zeros((3, 2, 2)), np.full(2, 0.25), np.ones((3, 2), bool)
    found = navigation_metrics(np.arange(3.0), place, still, radius, here, 0, np.array([9.0, 9.0]), 0.1)
    assert (found["contacts"], found["person_caused_contacts"], found["collision"]) == (1.0, 1.0, 1.0)
    assert found["max_penetration"] == pytest.approx(0.4)


def test_without_people_nothing_is_near():
    found = measured(walk((0, 0), (1, 0), 30))
    assert found["min_clearance"] == found["mean_nearest_distance"] == found["min_ttc"] == math.inf
    assert math.isnan(found["min_clearance_time"])
    assert (found["personal_space_compliance"], found["local_density"]) == (1.0, 0.0)


def test_what_comes_after_the_goal_does_not_count():
    robot = walk((0, 0), (1, 0), 40)
    short = measured(robot[:20], walk((1, 2), (0, 0), 19))
    long = measured(robot, walk((1, 2), (0, 0), 40))
    assert short == pytest.approx(long, nan_ok=True)


def test_heading_is_read_or_taken_from_the_way():
    robot = np.concatenate([walk((0, 0), (1, 0), 5), walk((0.5, 0.1), (0, 1), 9)])
    assert measured(robot)["heading_change"] == pytest.approx(math.pi / 2)
    assert measured(robot, heading=np.linspace(0.0, 3.0, 16))["heading_change"] == pytest.approx(3.0)


@few
@given(st.integers(0, 10_000), st.floats(-3.0, 3.0))
def test_turning_shifting_and_renumbering_change_nothing(seed, angle):
    rng = stream(seed, "log")
    paths = np.cumsum(rng.normal(0, 0.08, (40, 5, 2)), axis=0) + rng.uniform(-2, 2, (5, 2))
    matrix = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    goal = np.array([1.0, 0.5])
    one = measured(*paths.swapaxes(0, 1), goal=goal)
    turned = paths[:, [0, 3, 1, 4, 2]] @ matrix + [3.0, -7.0]
    two = measured(*turned.swapaxes(0, 1), goal=goal @ matrix + [3.0, -7.0])
    assert one == pytest.approx(two, abs=1e-6, nan_ok=True)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"times": np.arange(3.0)}, "times has shape \\[3\\], it must be \\[31\\]"),
        ({"times": np.zeros(31)}, "times must increase"),
        ({"velocity": np.zeros((31, 2))}, "velocity has shape \\[31, 2\\], it must be \\[31, 2, 2\\]"),
        ({"radius": np.ones(3)}, "radius has shape \\[3\\]"),
        ({"heading": np.zeros((31, 2))}, "heading has shape \\[31, 2\\], it must be \\[31\\]"),
        ({"robot": 7}, "robot = 7 is not an index of 2 agents"),
        ({"active": np.zeros((31, 2), bool)}, "robot 0 is absent at 0.0 s"),
        ({"position": np.full((31, 2, 2), np.nan)}, "is not finite"),
    ],
)
def test_wrong_logs_are_explained(change, message):
    names = ("times", "position", "velocity", "radius", "active")
    known = dict(zip(names, log(walk((0, 0), (1, 0), 30), walk((1, 2), (0, 0), 30)), strict=True))
    known |= {"robot": 0, "goal": np.array([2.0, 0.0]), "tolerance": 0.25}
    with pytest.raises(InputError, match=f"navigation metrics: .*{message}"):
        navigation_metrics(**(known | change))


def test_the_room_shows_what_it_measures():
    assert all(hasattr(metrics, name) for name in metrics.__all__)
    assert {"navigation_metrics", "outcome", "contact_events", "swept_clearance"} <= set(metrics.__all__)
