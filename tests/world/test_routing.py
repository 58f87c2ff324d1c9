"""Router: what is in sight, shortest ways against slow twins, walking them, goals that cannot be reached."""

import heapq
import math

import numba
import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Scene, Walls
from crowdbot.world import Router
from crowdbot.world.crowd.routing import CORNER, STRAIGHT, corners, inside, room_for
from crowdbot.world.crowd.wall_cells import sees, wall_cells

ROOM = [(0.0, 0.0), (0.0, 12.0), (20.0, 12.0), (20.0, 0.0)]  # clockwise: people are inside
MAZE = [
    ROOM,
    [(5.0, 0.0), (5.0, 9.0)],
    [(10.0, 12.0), (10.0, 3.0)],
    [(15.0, 0.0), (15.0, 5.0)],
    [(15.0, 6.2), (15.0, 12.0)],
    [(7.0, 5.0), (8.0, 5.0), (8.0, 6.0), (7.0, 6.0)],
]
RADIUS = 0.3


def places(count, seed=0, walls=MAZE, radius=RADIUS, x=(0.0, 20.0), y=(0.0, 12.0)):
    """Return random places where a body has room."""
    rng = np.random.default_rng(seed)
    parts = room_for(Walls.of(walls), radius)
    found = []
    while len(found) < count:
        point = rng.uniform((x[0], y[0]), (x[1], y[1]))
        if any(part.contains(shapely.Point(point)) for part in parts):
            found.append(point)
    return np.array(found)


def in_sight(segments, p, q, reach):
    """Return what ``sees`` does, by shapely."""
    way = shapely.LineString([p, q])
    for x, y, u, v in segments:
        wall = shapely.LineString([(x, y), (u, v)])
        need = min(reach, wall.distance(shapely.Point(p)), wall.distance(shapely.Point(q)))
        if way.distance(wall) < need * (1.0 - 1e-6):
            return False
    return True


def shortest(node, segments, p, q, reach):
    """Return the length of the shortest way over some nodes, by shapely and Dijkstra with a heap."""
    points = [p, q, *node]
    best, done, heap = {0: 0.0}, set(), [(0.0, 0)]
    while heap:
        length, k = heapq.heappop(heap)
        if k == 1:
            return length
        if k in done:
            continue
        done.add(k)
        for n, point in enumerate(points):
            total = length + math.dist(points[k], point)
            if n not in done and total < best.get(n, math.inf) and in_sight(segments, points[k], point, reach):
                best[n] = total
                heapq.heappush(heap, (total, n))
    return math.inf


def walked(router, place, goal, step=0.1, most=2000, shove=None):
    """Return the ways of people who walk where the router says, ``[T, A, 2]``."""
    ways = router.follow(place[None], goal[None])
    track = [place]
    for t in range(most):
        away = ways.subgoal[0] - track[-1]
        far = np.hypot(*away.T)
        track.append(track[-1] + away * (np.minimum(1.0, step / np.maximum(far, 1e-12)))[:, None])
        if shove is not None:
            track[-1] = track[-1] + shove(t, track[-1])
        if np.all(np.hypot(*(track[-1] - goal).T) < 1e-9):
            break
        ways = router.follow(track[-1][None], goal[None], ways.way)
    return np.array(track)


def test_sight_is_what_shapely_says():
    rng = np.random.default_rng(1)
    walls = rng.uniform(0.0, 12.0, (30, 4))
    walls[:, 2:] = walls[:, :2] + rng.normal(0.0, 1.5, (30, 2))
    cells = wall_cells(walls, 0.3)
    answers = []
    for _ in range(300):
        p, q = rng.uniform(-3.0, 15.0, (2, 2))
        answers.append(sees(*cells, *p, *q, 1.0))
        assert answers[-1] == in_sight(walls, p, q, 0.3)
    assert 50 < sum(answers) < 250


def test_without_walls_everything_is_in_sight():
    cells = wall_cells(np.zeros((0, 4)), 0.3)
    assert sees(*cells, 0.0, 0.0, 1e6, -1e6, 1.0)
    assert Router.of([]).towards([[1.0, 2.0]], [[9.0, 9.0]]).tolist() == [[9.0, 9.0]]


def test_ways_bend_twice_about_a_right_angle_and_four_times_about_an_end():
    box = Walls.of([[(0, 0), (2, 0), (2, 2), (0, 2)]])
    assert len(corners(box, 0.5)) == 8
    assert len(corners(Walls.of([[(0, 0), (4, 0)]]), 0.5)) == 8
    assert len(corners(Walls.around([(0, 0), (4, 0), (4, 4), (0, 4)]), 0.5)) == 0
    joined = Walls.of([[(0, 0), (2, 0)], [(2, 0), (4, 0)]])  # a straight joint is no corner
    assert len(corners(joined, 0.5)) == 8


def test_no_corner_is_nearer_to_a_wall_than_the_radius():
    lines = shapely.MultiLineString(list(Walls.of(MAZE).segments().reshape(-1, 2, 2)))
    node = corners(Walls.of(MAZE), RADIUS)
    assert len(node) > 10
    assert min(lines.distance(shapely.Point(point)) for point in node) > RADIUS - 1e-8


def test_what_is_inside_of_rooms_houses_and_courtyards():
    house = shapely.Polygon([(0, 0), (9, 0), (9, 9), (0, 9)], [[(3, 3), (6, 3), (6, 6), (3, 6)]])
    free = inside(Walls.of([house]))
    held = [free.contains(shapely.Point(p)) for p in [(4, 4), (1, 1), (-1, 4)]]
    assert held == [True, False, True]
    room = inside(Walls.around(house))
    held = [room.contains(shapely.Point(p)) for p in [(4, 4), (1, 1), (-1, 4)]]
    assert held == [False, True, False]


def test_ways_are_as_short_as_the_slow_twin_finds():
    router, segments = Router.of(MAZE, RADIUS), Walls.of(MAZE).segments()
    start, goal = places(12, seed=2), places(12, seed=3)
    found = router.follow(start[None], goal[None])
    for k in range(12):
        expected = shortest(corners(router.walls, RADIUS), segments, start[k], goal[k], RADIUS)
        assert found.length[0, k] == pytest.approx(expected, rel=1e-9)
        assert found.length[0, k] >= math.dist(start[k], goal[k]) - 1e-9


def test_ways_are_hardly_longer_than_those_along_the_round_outline_of_free_space():
    router = Router.of(MAZE, RADIUS)
    (free,) = room_for(router.walls, RADIUS)
    vertices = shapely.get_coordinates(free)
    free = free.buffer(1e-6)
    shapely.prepare(free)
    start, goal = places(4, seed=4), places(4, seed=5)
    for p, q in zip(start, goal, strict=True):
        points = np.concatenate([[p, q], vertices])
        i, j = (part.ravel() for part in np.meshgrid(np.arange(len(points)), np.arange(len(points))))
        seen = shapely.covers(free, shapely.linestrings(np.stack([points[i], points[j]], axis=1)))
        length = np.where(seen, np.hypot(*(points[i] - points[j]).T), np.inf).reshape(len(points), -1)
        best = np.full(len(points), np.inf)
        best[0] = 0.0
        for _ in range(40):  # Bellman-Ford
            best = np.min(best[:, None] + length, axis=0)
        found = router.follow(p[None, None], q[None, None]).length[0, 0]
        assert best[1] * 0.99 <= found <= best[1] * 1.03


def test_who_walks_the_way_arrives_after_its_length_and_clear_of_walls():
    router = Router.of(MAZE, RADIUS)
    start, goal = places(40, seed=6), places(40, seed=7)
    planned = router.follow(start[None], goal[None]).length[0]
    track = walked(router, start, goal)
    assert np.all(np.hypot(*(track[-1] - goal).T) < 1e-9)
    length = np.sum(np.hypot(*np.moveaxis(np.diff(track, axis=0), -1, 0)), axis=0)
    assert np.all(length <= planned * 1.001 + 1e-9)
    lines = shapely.MultiLineString(list(router.walls.segments().reshape(-1, 2, 2)))
    assert shapely.distance(shapely.points(track), lines).min() > 0.5 * RADIUS - 1e-6


@settings(max_examples=4, deadline=None)
@given(st.integers(0, 10_000))
def test_whoever_is_pushed_about_still_arrives(seed):
    rng = np.random.default_rng(seed)
    router = Router.of(MAZE, RADIUS)
    cells = wall_cells(router.walls.segments(), 0.05)
    start, goal = places(10, seed=seed), places(10, seed=seed + 1)

    def shove(t, place):
        if t > 300:
            return np.zeros_like(place)
        push = rng.normal(0.0, 0.15, place.shape)
        free = [sees(*cells, *p, *(p + d), 1.0) for p, d in zip(place, push, strict=True)]
        return np.where(np.array(free)[:, None], push, 0.0)

    track = walked(router, start, goal, shove=shove)
    assert np.all(np.hypot(*(track[-1] - goal).T) < 1e-9)


def test_a_new_way_is_found_when_the_next_corner_is_out_of_sight():
    router = Router.of([[(0.0, -2.0), (0.0, 2.0)]], RADIUS)
    goal = np.array([[[5.0, 0.1]]])
    first = router.follow(np.array([[[-3.0, 0.1]]]), goal)
    assert first.subgoal[0, 0, 1] > 2.0
    kept = router.follow(np.array([[[-3.0, -0.5]]]), goal, first.way)
    assert kept.subgoal[0, 0, 1] > 2.0, "the way is kept although the other one is shorter now"
    lost = router.follow(np.array([[[1.0, -3.0]]]), goal, first.way)
    assert lost.subgoal.tolist() == goal.tolist()


def test_a_goal_that_moves_a_little_keeps_the_way_and_ends_it_elsewhere():
    router = Router.of(MAZE, RADIUS)
    start, goal = np.array([[[2.0, 2.0]]]), np.array([[[18.0, 2.0]]])
    first = router.follow(start, goal)
    second = router.follow(start, goal + 0.5, first.way)
    assert second.way[0, 0, CORNER] == first.way[0, 0, CORNER]
    assert second.length[0, 0] != first.length[0, 0]
    far = router.follow(start, np.array([[[2.0, 11.0]]]), second.way)
    assert far.way[0, 0, CORNER] == STRAIGHT


@pytest.mark.parametrize(("width", "open_"), [(0.58, False), (0.62, True)])
def test_ways_lead_through_gaps_as_wide_as_a_body_only(width, open_):
    wall = [[(0.0, -50.0), (0.0, -0.5 * width)], [(0.0, 0.5 * width), (0.0, 5.0)]]
    length = Router.of(wall, RADIUS).follow(np.array([[[-3.0, 1.0]]]), np.array([[[3.0, 1.0]]])).length[0, 0]
    assert (length < 7.0) == open_
    assert (length > 9.0) != open_


def test_nobody_who_touches_walls_is_lost():
    router = Router.of(MAZE, RADIUS)
    goal = np.array([18.0, 2.0])
    for place in [(4.95, 0.05), (5.05, 8.99), (5.0, 9.05), (0.0, 0.0), (7.5, 4.9), (8.02, 6.02), (14.99, 5.6)]:
        track = walked(router, np.array([place]), goal[None])
        assert math.dist(track[-1, 0], goal) < 1e-9


@pytest.mark.parametrize("goal", [(7.5, 5.5), (25.0, 5.0), (11.0, 30.0)])
def test_a_goal_in_or_behind_walls_is_an_error_or_the_nearest_place(goal):
    start = [[2.0, 2.0]]
    with pytest.raises(InputError, match=r"goal \(.*\) of agent 0 in environment 0 cannot be reached from \(2, 2\)"):
        Router.of(MAZE, RADIUS).towards(start, [goal])
    router = Router.of(MAZE, RADIUS, unreachable="nearest")
    (free,) = room_for(router.walls, RADIUS)
    ways = router.follow(np.array([start]), np.array([[goal]]))
    place = np.array(start)
    for _ in range(1000):
        away = ways.subgoal[0] - place
        place = place + away * min(1.0, 0.1 / max(math.hypot(*away[0]), 1e-12))
        ways = router.follow(place[None], np.array([[goal]]), ways.way)
    assert math.dist(place[0], goal) == pytest.approx(free.distance(shapely.Point(goal)), abs=1e-6)


def test_a_closed_room_cannot_be_left():
    walls = [ROOM, [(4, 4), (8, 4)], [(8, 4), (8, 8)], [(8, 8), (4, 8)], [(4, 8), (4, 4)]]
    with pytest.raises(InputError, match="cannot be reached"):
        Router.of(walls).towards([[6.0, 6.0]], [[1.0, 1.0]])
    stays = Router.of(walls, unreachable="nearest").towards([[6.0, 6.0]], [[1.0, 1.0]])
    assert 4.0 < stays[0, 0] < 8.0


def test_goals_led_lie_ahead_as_far_as_the_way_is_long():
    router = Router.of(MAZE, RADIUS)
    scene = Scene.of(places(20, seed=8), goal=places(20, seed=9), external=np.arange(20) == 4)
    ways = router.follow(scene.position, scene.goal)
    led = router.guide(scene)
    away = led.goal - scene.position
    others = np.arange(20) != 4
    assert np.array_equal(led.goal[:, 4], scene.goal[:, 4])
    np.testing.assert_allclose(np.hypot(away[..., 0], away[..., 1])[0, others], ways.length[0, others], rtol=1e-9)
    seen = ways.way[..., CORNER] == STRAIGHT
    assert np.any(seen)
    assert np.array_equal(led.goal[seen], scene.goal[seen])


@pytest.mark.parametrize("A", [40, 700])
def test_batches_numbers_and_threads_do_not_matter(A):
    router = Router.of(MAZE, RADIUS)
    start, goal = places(A, seed=10), places(A, seed=11)
    alone = router.follow(start[None], goal[None])
    twice = router.follow(np.stack([goal, start]), np.stack([start, goal]))
    assert twice.way[1].tobytes() == alone.way[0].tobytes()
    assert twice.subgoal[1].tobytes() == alone.subgoal[0].tobytes()
    order = np.random.default_rng(0).permutation(A)
    mixed = router.follow(start[None, order], goal[None, order])
    assert mixed.subgoal.tobytes() == alone.subgoal[:, order].tobytes()
    most = numba.get_num_threads()
    numba.set_num_threads(1)
    one = router.follow(start[None], goal[None])
    numba.set_num_threads(most)
    assert one.length.tobytes() == alone.length.tobytes()


def test_absent_agents_may_hold_anything():
    router = Router.of(MAZE, RADIUS)
    start, goal = places(3, seed=12)[None].copy(), places(3, seed=13)[None].copy()
    expected = router.follow(start, goal).subgoal[0, 0]
    start[0, 1], goal[0, 2] = np.nan, np.inf
    found = router.follow(start, goal, asking=np.array([[True, False, False]]))
    assert found.subgoal[0, 0].tolist() == expected.tolist()
    assert found.length[0, 1:].tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"radius": 0.0}, "radius 0.0 m must be finite and above 0"),
        ({"radius": math.nan}, "radius nan m"),
        ({"radius": 30.0}, "no space between the walls is wide enough for a body of radius 30.0 m"),
        ({"unreachable": "neares"}, "unreachable = 'neares' is unknown, did you mean 'nearest'"),
    ],
)
def test_a_wrong_router_is_explained(values, message):
    with pytest.raises(InputError, match=message):
        Router.of(MAZE, **values)


def test_a_place_that_is_no_number_is_explained():
    with pytest.raises(InputError, match="a position or goal is not finite"):
        Router.of(MAZE).towards([[math.nan, 0.0]], [[1.0, 1.0]])


def test_too_many_corners_are_explained():
    angle = np.linspace(0.0, 2.0 * np.pi, 3200)[:-1]
    with pytest.raises(InputError, match="the walls have 3199 corners, at most 3000 are allowed"):
        Router.of([100.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)])
