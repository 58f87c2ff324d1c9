"""Paths around walls, and robots that follow them to their goals."""

import copy
import math

import numpy as np
import pytest
import shapely

from crowdbot import models
from crowdbot.core import InputError, Scene, Walls, stream
from crowdbot.navigation import DriveLimits, ObservationBatch, ORCANavigator, PathPlanner, Straight
from crowdbot.world import DifferentialDrive, Omnidirectional, PlanarWorld, Twists

L_ROOM = [
    [(0.0, 0.0), (0.0, 10.0), (4.0, 10.0), (4.0, 4.0), (10.0, 4.0), (10.0, 0.0)],  # clockwise: free space inside
    [(0.0, 5.0), (1.4, 5.0)],
    [(2.6, 5.0), (4.0, 5.0)],  # a door of 1.2 m
]
DRIVES = {
    "differential": (DifferentialDrive(1.0, 1.5, 1.0, 3.0), DriveLimits(1.0, 1.5, 1.0, 3.0)),
    "omnidirectional": (Omnidirectional(1.0, 1.5, 1.0, 3.0), DriveLimits(1.0, 1.5, 1.0, 3.0, holonomic=True)),
}
DT, CONTROL = 0.05, 2


def drive(navigator, kind, starts, goals, walls=L_ROOM, plan=True, limit=60.0, people=()):
    """Drive one robot in each environment; return the times of arrival [s] and the smallest wall clearances [m]."""
    motion, limits = DRIVES[kind]
    E = len(starts)
    others = np.broadcast_to(np.array(people, dtype=float).reshape(-1, 2), (E, len(people), 2))
    place = np.concatenate([np.array(starts, dtype=float)[:, None], others], axis=1)
    goal = np.concatenate([np.array(goals, dtype=float)[:, None], others], axis=1)
    robot = np.arange(1 + len(people)) == 0
    scene = Scene.of(place, goal=goal, radius=np.where(robot, 0.3, 0.25), external=robot, walls=walls)
    world = PlanarWorld(scene, models.ORCA(), {0: motion}, DT)
    planner = PathPlanner.of(scene.walls, 0.3) if plan else None
    path, twist = None, np.zeros((E, 3))
    arrival, clearance = np.full(E, math.inf), np.full(E, math.inf)
    for step in range(round(limit / DT)):
        if step % CONTROL == 0:
            now = world.twists[0]
            found = planner.next_waypoints(world.scene.position[:, 0], goal[:, 0], path) if planner else None
            path = found.path if found else None
            batch = ObservationBatch.of(
                world.scene, 0, limits, dt=CONTROL * DT, twist=np.column_stack([now.forward, now.turn, now.left]),
                **({"waypoint": found.point} if found else {}),
            )  # fmt: skip
            decisions = navigator.decide_batch(batch, [None] * E)
            assert decisions.failures == {}
            twist = decisions.twist
        world.step({0: Twists(*(twist[:, c].copy() for c in range(3)))})
        clearance = np.minimum(clearance, world.wall_clearance(0))
        away = np.hypot(*(world.scene.position[:, 0] - goal[:, 0]).T)
        arrival = np.where((away < 0.2) & np.isinf(arrival), (step + 1) * DT, arrival)
        if np.all(np.isfinite(arrival)):
            break
    return arrival, clearance


@pytest.mark.parametrize("kind", list(DRIVES))
@pytest.mark.parametrize("navigator", [Straight(), ORCANavigator()])
def test_a_robot_passes_the_door_of_an_l_shaped_room(navigator, kind):
    starts, goals = [(9.0, 2.0), (9.0, 1.0), (3.4, 9.5)], [(0.8, 9.0), (3.4, 9.4), (9.0, 3.0)]
    arrival, clearance = drive(navigator, kind, starts, goals)
    assert np.all(arrival < 40.0)
    assert np.all(clearance > 0.0)


def test_without_a_plan_it_stays_before_the_wall():
    ways = [(9.0, 1.0), (3.4, 9.5), (9.0, 3.4)], [(3.4, 9.4), (9.0, 3.0), (3.5, 9.5)]
    alone, _ = drive(ORCANavigator(), "differential", *ways, plan=False, limit=30.0)
    planned, _ = drive(ORCANavigator(), "differential", *ways)
    assert np.all(np.isinf(alone))
    assert np.all(planned < 20.0)


def test_it_plans_around_walls_and_steers_around_people():
    arrival, clearance = drive(
        ORCANavigator(), "differential", [(9.0, 2.0)], [(0.8, 9.0)], people=[(5.0, 2.5), (2.8, 7.5)]
    )
    assert arrival[0] < 50.0
    assert clearance[0] > 0.0


@pytest.mark.parametrize("navigator", [Straight(), ORCANavigator()])
def test_a_goal_in_sight_changes_no_bit(navigator):
    rng = stream(3, "sight")
    walls = Walls.of([[(-8.0, -4.0), (8.0, -4.0)], [(-8.0, 4.0), (8.0, 4.0)]])
    place, goal = rng.uniform(-3, 3, (20, 2)), rng.uniform(-3, 3, (20, 2))
    scene = Scene.of(place[:, None], heading=rng.uniform(-3, 3, (20, 1)), goal=goal[:, None], radius=0.3, walls=walls)
    next_waypoints = PathPlanner.of(walls, 0.3).next_waypoints(place, goal)
    np.testing.assert_array_equal(next_waypoints.point, goal)
    limits, twist = DriveLimits(1.0, 1.5, 1.0, 3.0), np.tile([0.5, 0.1, 0.0], (20, 1))
    plain = ObservationBatch.of(scene, 0, limits, dt=0.1, twist=twist)
    planned = ObservationBatch.of(scene, 0, limits, dt=0.1, twist=twist, waypoint=next_waypoints.point)
    twists = [navigator.decide_batch(batch, [None] * 20).twist for batch in (plain, planned)]
    np.testing.assert_array_equal(*twists)
    arrivals = [drive(navigator, "differential", place[:4], goal[:4], walls, plan) for plan in (False, True)]
    np.testing.assert_array_equal(*arrivals)


def test_paths_keep_their_distance_from_walls_and_end_at_the_goal():
    rng = stream(1, "paths")
    walls = Walls.of(L_ROOM)
    planner = PathPlanner.of(walls, 0.3, margin=0.15)
    lines = shapely.multilinestrings(shapely.linestrings(walls.segments().reshape(-1, 2, 2)))
    for _ in range(30):
        start, goal = rng.uniform([0.5, 5.5], [3.5, 9.5]), rng.uniform([0.5, 0.5], [9.5, 3.5])
        points = planner.waypoints(start, goal)
        np.testing.assert_array_equal(points[-1], goal)
        assert shapely.distance(shapely.LineString([start, *points]), lines) > 0.45 * (1 - 1e-5)


def test_a_robot_that_left_its_path_gets_another():
    planner = PathPlanner.of([[(2.0, -3.0), (2.0, 1.0)]], 0.3)
    goal = np.array([[4.0, 0.0]])
    first = planner.next_waypoints(np.array([[0.0, 0.0]]), goal)
    beyond = planner.next_waypoints(np.array([[4.0, 2.0]]), goal, copy.deepcopy(first.path))
    np.testing.assert_array_equal(beyond.point, goal)
    below = planner.next_waypoints(np.array([[0.0, -6.0]]), goal, first.path)
    assert below.point[0, 1] < 0.0


def test_a_robot_without_a_path_fails_alone():
    planner = PathPlanner.of([*L_ROOM, [(4.0, 0.0), (4.0, 4.0)]], 0.3)
    place, goal = np.array([[9.0, 2.0], [1.0, 1.0], [math.nan, 0.0]]), np.array([[0.8, 9.0], [0.8, 9.0], [1.0, 1.0]])
    next_waypoints = planner.next_waypoints(place, goal)
    assert sorted(next_waypoints.failures) == [0, 2]
    assert "cannot be reached from (9, 2) by a body of radius 0.4 m" in str(next_waypoints.failures[0])
    assert "not finite" in str(next_waypoints.failures[2])
    assert np.all(np.isnan(next_waypoints.point[[0, 2]]))
    np.testing.assert_array_equal(next_waypoints.point[1], planner.waypoints((1.0, 1.0), (0.8, 9.0))[0])
    again = planner.next_waypoints(place, goal, next_waypoints.path)
    np.testing.assert_array_equal(again.point, next_waypoints.point)
    with pytest.raises(InputError, match="PathPlanner: no path: Router: the goal"):
        planner.waypoints((9.0, 2.0), (0.8, 9.0))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"radius": 0.0}, "PathPlanner: radius = 0.0 m"),
        ({"margin": -0.1}, "PathPlanner: margin = -0.1 m"),
        ({"radius": 3.0}, "no space between the walls is wide enough"),
    ],
)
def test_wrong_values_are_explained(values, message):
    with pytest.raises(InputError, match=message):
        PathPlanner.of(L_ROOM, **({"radius": 0.3} | values))


def test_wrong_shapes_are_explained():
    planner = PathPlanner.of(L_ROOM, 0.3)
    with pytest.raises(InputError, match=r"shapes \[1, 2\] and \[2\]"):
        planner.waypoints([[1.0, 1.0]], (2.0, 2.0))
    with pytest.raises(InputError, match=r"equal and \[N, 2\]"):
        planner.next_waypoints(np.zeros((2, 2)), np.zeros((1, 2)))
