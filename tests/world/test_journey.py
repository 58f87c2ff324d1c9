"""Stops and journeys: points, directions, zones, chains, and what people do at the end."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Scene
from crowdbot.models import ORCA
from crowdbot.world import (
    Direction,
    JourneyAssignment,
    PlanarWorld,
    Point,
    Router,
    WaypointSequence,
    Zone,
)
from crowdbot.world.crowd.journey import STOP
from crowdbot.world.crowd.person_random import uniform
from crowdbot.world.crowd.waypoint import PersonRandom

STAR = [(0, 0), (4, 1), (8, 0), (7, 4), (8, 8), (4, 7), (0, 8), (1, 4)]
HALL = Zone(((10.0, 0.0), (12.0, 0.0), (12.0, 4.0), (10.0, 4.0)))
NOBODY = PersonRandom(np.zeros(0, int), np.zeros(0, int))


def luck(count, seed=0):
    return PersonRandom(np.full(count, seed), np.arange(count), ("test",))


def walk(world, seconds):
    scenes = [world.scene]
    while world.clock.time < seconds:
        scenes.append(world.step({}))
    return scenes


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 999))
def test_the_nearest_point_of_a_zone_is_what_shapely_says(seed):
    place = np.random.default_rng(seed).uniform(-3.0, 11.0, (40, 2))
    zone, area = Zone(STAR), shapely.Polygon(STAR)
    points = shapely.points(place)
    assert np.array_equal(zone.contains(place), shapely.contains(area, points))
    goal = zone.goal(place, NOBODY)
    np.testing.assert_allclose(np.hypot(*(goal - place).T), shapely.distance(area, points), atol=1e-9)
    inside = shapely.contains(area, points)
    assert np.array_equal(goal[inside], place[inside])


def test_random_points_fill_the_zone_evenly():
    goal = Zone(STAR, aim="random").goal(np.zeros((4000, 2)), luck(4000))
    area = shapely.Polygon(STAR)
    assert np.all(shapely.covers(area, shapely.points(goal)))
    half = area.intersection(shapely.box(0, 0, 3, 8)).area / area.area
    assert np.mean(goal[:, 0] < 3.0) == pytest.approx(half, abs=0.03)


def test_chance_follows_the_person_not_the_place():
    ids = np.array([[4, 9, 2]])
    numbers = uniform(7, ids, "a")
    assert uniform(7, ids[:, ::-1], "a").tolist() == numbers[:, ::-1].tolist()
    assert uniform(np.array([[3], [7]]), np.repeat(ids, 2, axis=0), "a")[1].tolist() == numbers[0].tolist()
    assert uniform(8, ids, "a").tolist() != numbers.tolist()
    assert uniform(7, ids, "b").tolist() != numbers.tolist()
    many = uniform(-5, np.arange(100_000)[None], "c")[0]
    assert (many.min() >= 0.0, many.max() < 1.0) == (True, True)
    assert np.histogram(many, 10, (0, 1))[0] == pytest.approx(10_000, rel=0.05)
    assert abs(np.corrcoef(many[1:], many[:-1])[0, 1]) < 0.01


def test_a_chain_of_stops_is_walked_in_order_and_people_leave_or_stay():
    stops = (Point(4.0, 0.0), Point(4.0, 4.0), HALL)
    journeys = JourneyAssignment((WaypointSequence(stops, "leave"), WaypointSequence(stops, "stay")), which=[0, 1, -1])
    start = Scene.of([[0.0, 0.0], [0.0, 9.0], [0.0, 20.0]], goal=[[0.0, 0.0], [0.0, 0.0], [3.0, 20.0]])
    scenes = walk(PlanarWorld(start, ORCA(), {}, 0.1, journeys=journeys), 25.0)
    track = np.array([scene.position[0] for scene in scenes])
    active = np.array([scene.active[0] for scene in scenes])
    for person in (0, 1):
        near = [np.argmax(np.hypot(*(track[:, person] - [p.x, p.y]).T) < 0.3) for p in stops[:2]]
        assert 0 < near[0] < near[1]
    assert not active[-1, 0]
    last = track[active[:, 0], 0][-1]
    assert last[0] > 10.0 - 0.3 - 0.2
    assert active[-1].tolist() == [False, True, True]
    assert HALL.contains(track[-1, 1:2])[0] or track[-1, 1, 0] > 9.6
    assert np.hypot(*(track[-1, 1] - track[-10, 1])) < 0.05
    assert track[-1, 2].tolist() == pytest.approx([3.0, 20.0])
    assert scenes[-1].memory[STOP][0, 1] == 3


def test_a_direction_is_walked_for_ever():
    journeys = JourneyAssignment((WaypointSequence((Direction(math.pi / 2),)),))
    scene = walk(PlanarWorld(Scene.of([[0.0, 0.0]]), ORCA(), {}, 0.1, journeys=journeys), 20.0)[-1]
    np.testing.assert_allclose(scene.position[0, 0], [0.0, 26.0], atol=1e-6)


def test_random_goals_are_the_same_alone_in_a_batch_and_renumbered():
    journeys = JourneyAssignment((WaypointSequence((Zone(STAR, "random"), Point(20.0, 0.0))),))
    place = np.random.default_rng(1).uniform(-9.0, -1.0, (2, 20, 2))
    batch = PlanarWorld(Scene.of(place), ORCA(), {}, 0.1, seed=5, journeys=journeys)
    alone = PlanarWorld(Scene.of(place[1]), ORCA(), {}, 0.1, seed=6, journeys=journeys)
    order = np.random.default_rng(0).permutation(20)
    mixed = PlanarWorld(Scene.of(place[1, order]), ORCA(), {}, 0.1, seed=6, journeys=journeys, ids=order)
    assert batch.scene.goal[1].tobytes() == alone.scene.goal[0].tobytes()
    assert len(np.unique(alone.scene.goal[0], axis=0)) == 20
    for _ in range(100):
        batch.step({}), alone.step({}), mixed.step({})
    assert batch.scene.position[1].tobytes() == alone.scene.position[0].tobytes()
    assert mixed.scene.position[0].tobytes() == alone.scene.position[0, order].tobytes()
    assert mixed.scene.goal[0].tobytes() == alone.scene.goal[0, order].tobytes()


def test_random_goals_keep_clear_of_walls_when_there_is_a_router():
    pillar = [(1.0, 1.0), (7.0, 1.0), (7.0, 7.0), (1.0, 7.0)]
    square = Zone(((0, 0), (8, 0), (8, 8), (0, 8)), aim="random")
    scene = Scene.of(np.random.default_rng(2).uniform(-9.0, -1.0, (60, 2)), walls=[pillar])
    world = PlanarWorld(
        scene,
        ORCA(),
        {},
        0.1,
        journeys=JourneyAssignment((WaypointSequence((square,)),)),
        router=Router.of([pillar], 0.3),
    )
    away = shapely.distance(shapely.Polygon(pillar), shapely.points(world.scene.goal[0]))
    assert away.min() > 0.29


def test_people_reach_a_zone_behind_walls():
    screen = [(3.0, -5.0), (3.0, 5.0)]
    scene = Scene.of(np.random.default_rng(3).uniform(-3.0, 2.0, (10, 2)), walls=[screen])
    journeys = JourneyAssignment((WaypointSequence((Zone(((5, -1), (7, -1), (7, 1), (5, 1))),)),))
    world = PlanarWorld(scene, ORCA(), {}, 0.1, journeys=journeys, router=Router.of([screen], 0.3), heading_jitter=1e-3)
    assert not np.any(walk(world, 40.0)[-1].active)
    stuck = PlanarWorld(scene, ORCA(), {}, 0.1, journeys=journeys)
    assert np.any(walk(stuck, 40.0)[-1].active)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Point(math.nan, 0.0), 'Point: x="nan" is not finite'),
        (lambda: Point(0.0, 0.0, tolerance=0.0), 'Point: tolerance="0.0" must be above 0 m and at most 1000000 m'),
        (lambda: Direction(math.inf), 'Direction: heading="inf" is not finite'),
        (lambda: Zone(((0, 0), (1, 1))), "must be at least 3 different points"),
        (lambda: Zone(((0, 0), (1, 1), (2, 2))).ring, "enclose 0 m2, the area must be above 0"),
        (lambda: Zone(STAR, aim="randon"), 'aim="randon" must be nearest or random, did you mean'),
        (lambda: WaypointSequence(()), "must be one or more waypoints"),
        (lambda: WaypointSequence((Point(0, 0),), then="stays"), "did you mean 'stay'"),
        (
            lambda: JourneyAssignment((WaypointSequence((Point(0, 0),)),), which=[0, 1]),
            "must be from 0 to 0, or -1",
        ),
        (lambda: JourneyAssignment((WaypointSequence((Point(0, 0),)),), which=[0.5]), "must be from 0 to 0"),
    ],
)
def test_wrong_stops_are_explained(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_wrong_worlds_of_journeys_are_explained():
    journeys = JourneyAssignment((WaypointSequence((Point(0, 0),)),), which=[0, 0, 0])
    with pytest.raises(InputError, match=r"which has shape \[3\], expected \[1, 2\]"):
        PlanarWorld(Scene.of(np.zeros((2, 2))), ORCA(), {}, 0.1, journeys=journeys)
    given_velocity = Scene.of(np.zeros((3, 2)), preferred_velocity=np.ones((3, 2)))
    with pytest.raises(InputError, match="the scene has preferred velocities instead of goals"):
        PlanarWorld(given_velocity, ORCA(), {}, 0.1, journeys=journeys)
    walled = Zone(((1, 1), (2, 1), (2, 2), (1, 2)), aim="random")
    pillar = [(0, 0), (3, 0), (3, 3), (0, 3)]
    with pytest.raises(InputError, match="no free position for a body was found in the zone"):
        PlanarWorld(
            Scene.of([[-2.0, 0.0]], walls=[pillar]), ORCA(), {}, 0.1,
            journeys=JourneyAssignment((WaypointSequence((walled,)),)), router=Router.of([pillar]),
        )  # fmt: skip
