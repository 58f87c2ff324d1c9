"""Destinations estimated from the layout of a place."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import shapely
from goal_places import crowd, street, windows

from crowdbot.core import InputError, Walls, from_attributes
from crowdbot.models.goals import EnvironmentLayout
from crowdbot.models.goals.routes import Routes, mark_visible

ROOM = np.array([(0.0, 0.0), (0.0, 8.0), (10.0, 8.0), (10.0, 0.0)])  # clockwise: people are inside


def walk(start, velocity, rows=8):
    time = 0.4 * np.arange(1.0 - rows, 1.0)
    return windows((np.array(start) + time[:, None] * np.array(velocity))[None, :, None])


def test_the_exit_that_comes_nearer_is_the_likely_one():
    layout = EnvironmentLayout([(10.0, 0.0), (0.0, 10.0), (-10.0, 0.0)], straight=0.2)
    chance = layout.choices(walk((0.0, 0.0), (0.2, 1.2))).weight[0, 0]
    assert np.argmax(chance) == 2
    assert chance[2] > 0.5
    assert chance[3] < 0.05
    goal = layout.resolve(walk((0.0, 0.0), (0.2, 1.2)))[0, 0]
    assert 0.0 < goal[0] < 20.0 * 0.2  # pulled towards the exit, but not all the way
    likeliest = layout.choices(walk((0.0, 0.0), (0.2, 1.2))).likeliest(1)
    assert likeliest.position[0, 0, 0, 0] == pytest.approx(0.6 * 4.0, abs=0.2)


def test_who_walks_to_no_exit_goes_straight_on():
    layout = EnvironmentLayout([(10.0, 0.0)])
    past = walk((0.0, 0.0), (-1.3, 0.0))
    assert layout.choices(past).weight[0, 0, 0] > 0.95
    assert layout.resolve(past)[0, 0] == pytest.approx([-26.0, 0.0], abs=0.2)


def test_a_prior_counts():
    past = walk((0.0, 0.0), (1.3, 0.0))
    both = [(10.0, 3.0), (10.0, -3.0)]
    assert EnvironmentLayout(both).resolve(past)[0, 0, 1] == pytest.approx(0.0, abs=1e-9)
    assert EnvironmentLayout(both, prior=[9.0, 1.0], straight=0.1).resolve(past)[0, 0, 1] > 1.0


def test_an_exit_behind_a_wall_is_reached_by_the_corner():
    wall = [(5.0, -20.0), (5.0, 2.0)]
    layout = EnvironmentLayout([(10.0, -4.0)], walls=[wall])
    aim, way = layout.routes.next(np.array([(0.0, 0.0), (8.0, 0.0)]))
    assert aim[0, 0] == pytest.approx([5.0, 2.0], abs=0.7)
    assert way[0, 0] == pytest.approx(np.hypot(5.0, 2.5) + np.hypot(5.0, 6.5), abs=0.5)
    assert aim[1, 0].tolist() == [10.0, -4.0]
    behind = layout.choices(walk((0.0, 0.0), (1.2, 0.0)))
    assert behind.position[0, 0, 1, 1] > 0.0  # leftwards to the corner, though the exit lies to the right


def test_an_exit_without_a_way_is_out_of_the_question():
    layout = EnvironmentLayout([(5.0, 4.0), (20.0, 4.0)], walls=[ROOM])
    chance = layout.choices(walk((3.0, 4.0), (1.2, 0.0))).weight[0, 0]
    assert chance[2] == 0.0
    assert chance[:2].sum() == pytest.approx(1.0)


def test_sight_is_that_of_shapely():
    rng = np.random.default_rng(4)
    segments, place, target = rng.random((9, 4)), rng.random((20, 2)), rng.random((20, 15, 2))
    seen = np.zeros((20, 15), dtype=bool)
    mark_visible(place, target, segments, seen)
    walls = shapely.multilinestrings([s.reshape(2, 2) for s in segments])
    lines = shapely.linestrings([[(place[i], target[i, j]) for j in range(15)] for i in range(20)])
    assert np.array_equal(seen, ~shapely.intersects(lines, walls))


def test_ways_are_the_shortest_of_all_chains_of_corners():
    walls = Walls.of([[(2.0, -6.0), (2.0, 1.0)], [(4.0, -1.0), (4.0, 6.0)]])
    routes = Routes.of(np.array([[(8.0, 0.0), (8.0, 0.0)]]), walls)
    _, way = routes.next(np.array([[0.0, 0.0]]))
    stops = [np.array([0.0, 0.0]), *routes.corners, np.array([8.0, 0.0])]
    lines = [s.reshape(2, 2) for s in routes.segments]
    best = np.inf
    for a in stops[1:-1]:
        for b in stops[1:-1]:
            chain = [stops[0], a, b, stops[-1]]
            legs = [(p, q) for p, q in itertools.pairwise(chain) if not np.array_equal(p, q)]
            free = all(
                not shapely.LineString(leg).intersects(shapely.LineString(wall)) for leg in legs for wall in lines
            )
            best = min(best, sum(np.hypot(*(q - p)) for p, q in legs)) if free else best
    assert way[0, 0] == pytest.approx(best)


def test_openings_of_a_border_are_exits():
    doors = [[(0.0, 3.0), (0.0, 0.0)], [(0.0, 0.0), (10.0, 0.0)], [(10.0, 0.0), (10.0, 8.0)], [(10.0, 8.0), (0.0, 8.0)]]
    layout = EnvironmentLayout.of([*doors, [(0.0, 8.0), (0.0, 5.0)]], area=ROOM)
    assert len(layout.exits) == 1
    assert np.sort(layout.exits[0, :, 1]) == pytest.approx([3.3, 4.7], abs=0.15)
    assert layout.exits[0, :, 0] == pytest.approx([0.0, 0.0])
    open_ = EnvironmentLayout.of(area=shapely.box(0, 0, 10, 8), width=3.0)
    assert len(open_.exits) == 12
    assert np.hypot(*(open_.exits[:, 1] - open_.exits[:, 0]).T).max() < 3.3
    block = EnvironmentLayout.of([[(-1.0, -1.0), (11.0, -1.0), (11.0, 7.0), (-1.0, 7.0)]], area=ROOM)
    assert block.exits[..., 1].min() > 7.0  # the solid block leaves the upper end of the room
    corridor = EnvironmentLayout.of([[(0.0, 0.0), (9.0, 0.0)], [(9.0, 2.5), (0.0, 2.5)]])
    assert sorted(corridor.exits.mean(axis=1)[:, 0].round(1).tolist()) == [0.0, 9.0]


def test_a_recorded_place_has_its_openings_and_how_many_left_there():
    layout = EnvironmentLayout.learn(street(), straight=0.4)
    centre = layout.exits.mean(axis=1)
    busiest = centre[np.argsort(-np.asarray(layout.prior))[:2]]
    assert {("north" if y > 6.0 else "east") for _, y in busiest} == {"north", "east"}
    assert layout.straight == 0.4
    goal = layout.resolve(crowd())
    assert np.all(np.isfinite(goal))


def test_exits_come_from_text():
    layout = from_attributes(EnvironmentLayout, {"exits": "10 0, 0 10", "straight": "0.2"})
    assert layout.exits[:, 0].tolist() == [[10.0, 0.0], [0.0, 10.0]]
    assert layout.straight == 0.2


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: EnvironmentLayout([]), "the layout has no exit; give exits as points"),
        (lambda: EnvironmentLayout.of([ROOM], area=ROOM), "the layout has no exit"),
        (EnvironmentLayout.of, "there are neither walls nor an area"),
        (lambda: EnvironmentLayout.of(area=ROOM, width=0.0), "width = 0.0 m must be finite and above 0"),
        (lambda: EnvironmentLayout.of(area=ROOM[:2]), "one ring of at least three finite points"),
        (lambda: EnvironmentLayout([(1.0, 2.0, 3.0)]), r"exits have shape \[1, 3\]"),
        (lambda: EnvironmentLayout([(1.0, np.nan)]), "finite points"),
        (lambda: EnvironmentLayout([(1.0, 2.0)], prior=[1.0, 2.0]), r"prior has shape \[2\] for 1 exits"),
        (lambda: EnvironmentLayout([(1.0, 2.0)], prior=[0.0]), "not all 0"),
        (lambda: EnvironmentLayout([(1.0, 2.0)], straight=1.2), "straight = 1.2 must be at most 1"),
        (lambda: EnvironmentLayout([(1.0, 2.0)], certainty=-1.0), "certainty = -1.0"),
        (EnvironmentLayout.learn, "there is no recording to learn from"),
        (lambda: EnvironmentLayout([(1.0, 2.0)]).resolve(windows(np.zeros((1, 8, 1, 2)), units="px")), "is in px"),
    ],
)
def test_wrong_layouts(make, says):
    with pytest.raises(InputError, match=says) as told:
        make()
    assert "\n" not in str(told.value)
