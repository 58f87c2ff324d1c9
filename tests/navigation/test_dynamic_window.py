"""The dynamic window: its cost against a slow twin, its limits, and plain cases."""

import math

import numpy as np
import pytest
from exhaustive_window import Start, cost_of, exhaustive_twist, people_of, walls_of
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import Twist, Walls, stream
from crowdbot.navigation import DriveLimits, Observation, VisiblePeople, WindowCosts, dynamic_window_twist
from crowdbot.navigation.window_search import MATCH, STEP, WINDOW

LIMITS = DriveLimits(1.0, 1.5, 1.0, 3.0)
few = settings(max_examples=40, deadline=None)


def observed(seed, count=6, twist=None):
    rng = stream(seed, "window")
    people = VisiblePeople(
        rng.uniform(-3, 3, (count, 2)) + [2.0, 0.0], rng.normal(0, 1, (count, 2)), rng.uniform(0.2, 0.4, count)
    )
    return Observation(
        pose=(float(rng.normal()), float(rng.normal()), float(rng.uniform(-3, 3))),
        goal=(9.0, 0.0),
        radius=0.3,
        limits=LIMITS,
        dt=0.1,
        twist=twist or Twist(float(rng.uniform(0, 1)), float(rng.uniform(-1, 1))),
        people=people,
        walls=Walls.of([[(-9.0, -2.0), (9.0, -2.5)], [(-9.0, 3.0), (9.0, 3.0)]]),
    )


def segment_distance(a, b):
    """Distance of the origin to segment a-b by trying many points."""
    share = np.linspace(0.0, 1.0, 20_001)[:, None]
    return float(np.min(np.hypot(*(a + share * (b - a)).T)))


def slowcost_of(forward, turn, seen, wish, caution):
    """The twin: follow the way, then look at it as a whole."""
    steps = round(caution.look / STEP)
    place, heading, v, w = [np.zeros(2)], [seen.heading], seen.twist.forward, seen.twist.turn
    for _ in range(steps):
        v += float(np.clip(forward - v, -LIMITS.max_acceleration * STEP, LIMITS.max_acceleration * STEP))
        w += float(np.clip(turn - w, -LIMITS.max_turn_acceleration * STEP, LIMITS.max_turn_acceleration * STEP))
        middle = heading[-1] + 0.5 * w * STEP
        place.append(place[-1] + v * STEP * np.array([math.cos(middle), math.sin(middle)]))
        heading.append(heading[-1] + w * STEP)
    facing = np.array([math.cos(heading[MATCH]), math.sin(heading[MATCH])])
    cost = np.linalg.norm(place[MATCH] / (MATCH * STEP) - wish)
    cost += caution.facing * (np.linalg.norm(wish) - facing @ wish)
    near, contact, touch = [0.0], [0.0], [0.0]
    for k in range(steps):
        fade = 1.0 - k / steps
        for p, u, r in zip(seen.people.position - seen.position, seen.people.velocity, seen.people.radius, strict=True):
            before, after = p + u * k * STEP - place[k], p + u * (k + 1) * STEP - place[k + 1]
            gap = segment_distance(before, after) - r - seen.radius
            near.append(fade * (caution.margin - gap) / caution.margin)
            contact.append(fade if gap < caution.skin else 0.0)
        for wall in seen.walls.segments():
            a, b = wall[:2] - seen.position - place[k + 1], wall[2:] - seen.position - place[k + 1]
            touch.append((caution.wall_margin - segment_distance(a, b) + seen.radius) / caution.wall_margin)
    return cost + caution.near * max(near) + caution.contact * max(contact) + caution.wall * max(touch)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.0, 1.0), st.floats(-1.5, 1.5), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_the_cost_is_that_of_the_slow_twin(seed, forward, turn, x, y):
    seen, wish = observed(seed), np.array([x, y])
    caution = WindowCosts(near=1.7, contact=0.0, wall=3.0, facing=0.6)  # the jump at a contact is tested below
    start = Start(seen.heading, seen.twist.forward, seen.twist.turn, 0.3, STEP, 3.0 * STEP)
    fast = cost_of(forward, turn, start, wish, people_of(seen), walls_of(seen), caution)
    assert fast == pytest.approx(slowcost_of(forward, turn, seen, wish, caution), abs=0.02)


def test_a_contact_costs_the_more_the_sooner():
    costs = []
    for away in (0.8, 1.0, 1.3, 4.0):
        person = VisiblePeople(np.array([[away, 0.0]]), np.zeros((1, 2)), np.array([0.3]))
        seen = Observation(pose=(0, 0, 0), goal=(9, 0), radius=0.3, limits=LIMITS, dt=0.1, people=person)
        start = Start(0.0, 1.0, 0.0, 0.3, STEP, 3.0 * STEP)
        costs.append(cost_of(1.0, 0.0, start, np.array([1.0, 0.0]), people_of(seen), walls_of(seen), WindowCosts()))
    assert sorted(costs, reverse=True) == costs
    assert costs[0] > 8.0
    assert costs[-1] == pytest.approx(0.0, abs=1e-12)


@few
@given(st.integers(0, 10_000), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(0.0, 1.0), st.floats(-1.5, 1.5))
def test_it_asks_for_what_the_drive_can_reach(seed, x, y, forward, turn):
    twist = dynamic_window_twist(observed(seed, twist=Twist(forward, turn)), (x, y), speed=0.8)
    assert 0.0 <= twist.forward <= 0.8
    assert abs(twist.turn) <= 1.5
    assert abs(twist.forward - min(forward, 0.8)) <= WINDOW * 1.0 + 1e-12
    assert abs(twist.turn - turn) <= WINDOW * 3.0 + 1e-12
    assert twist.left == 0.0


def clear(**changes):
    known = {"pose": (0.0, 0.0, 0.0), "goal": (9.0, 0.0), "radius": 0.3, "limits": LIMITS, "dt": 0.1}
    return Observation(**(known | changes))


def test_free_it_takes_the_wish():
    moving = clear(twist=Twist(0.8, 0.0))
    assert dynamic_window_twist(moving, (0.8, 0.0), speed=1.0).forward == pytest.approx(0.8, abs=0.05)
    assert dynamic_window_twist(moving, (0.8, 0.0), speed=1.0).turn == 0.0
    assert dynamic_window_twist(moving, (0.0, 0.8), speed=1.0).turn > 0.5
    assert dynamic_window_twist(moving, (0.0, -0.8), speed=1.0).turn < -0.5


def test_it_stops_for_a_wall_and_never_drives_into_it():
    walls = Walls.of([[(1.5, -9.0), (1.5, 9.0)]])
    x, speed = 0.0, 0.0
    for _ in range(100):
        seen = clear(pose=(x, 0.0, 0.0), twist=Twist(speed), walls=walls, limits=DriveLimits(1.0, 1e-6, 1.0, 3.0))
        wanted = dynamic_window_twist(seen, (1.0, 0.0), speed=1.0).forward
        speed += float(np.clip(wanted - speed, -0.1, 0.1))
        x += speed * 0.1
    assert 0.8 < x < 1.2
    assert speed < 0.02


def test_with_unknown_accelerations_it_works_too():
    twist = dynamic_window_twist(clear(limits=DriveLimits(1.0, 2.0)), (1.0, 0.0), speed=1.0)
    assert twist == Twist(1.0, 0.0, 0.0)


def test_same_input_same_twist():
    one, two = (dynamic_window_twist(observed(11, count=20), (0.7, 0.4), speed=1.0) for _ in range(2))
    assert one == two


@pytest.mark.parametrize("seed", range(4))
def test_the_search_finds_the_bits_of_trying_every_candidate(seed):
    rng = stream(seed, "search")
    for k in range(60):
        seen = observed(1000 * seed + k, count=int(rng.integers(0, 15)))
        wish, speed = (float(rng.normal()), float(rng.normal())), float(rng.uniform(0.2, 1.2))
        low, high = [0.3, 0.05, 0.1, 0.0, 0.1, 0.02, 0.1, 0.0], [3.0, 0.5, 2.0, 0.2, 10.0, 0.5, 20.0, 1.0]
        caution = WindowCosts(*rng.uniform(low, high).tolist()) if k % 2 else None
        assert dynamic_window_twist(seen, wish, speed, caution) == exhaustive_twist(seen, wish, speed, caution)


def test_negative_weights_are_searched_completely():
    reward = WindowCosts(near=-0.5, wall=-0.1)
    for seed in range(20):
        seen = observed(seed)
        assert dynamic_window_twist(seen, (0.6, 0.3), 1.0, reward) == exhaustive_twist(seen, (0.6, 0.3), 1.0, reward)
