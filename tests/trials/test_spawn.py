"""Spawners: people stand in their zone, clear of walls, robots and each other; distributions."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, stream
from crowdbot.navigation import Straight
from crowdbot.trials import GAP, Distribution, Obstacle, RobotGoal, RobotSpec, Spawner, Stage, Wall, place
from crowdbot.world import DifferentialDrive

SQUARE = [(0, 0), (6, 0), (6, 6), (0, 6)]


def spawner(count: int, zone: object = SQUARE, **changes: object) -> Spawner:
    return Spawner(count=count, zone=zone, goal=[(7, 0), (8, 0), (8, 6), (7, 6)], **changes)  # type: ignore[arg-type]


def robot(x: float, y: float, radius: float) -> RobotSpec:
    return RobotSpec(x=x, y=y, radius=radius, goal=RobotGoal(x, y), drive=DifferentialDrive(), navigator=Straight())


STAGE = Stage(
    walkable=[(-1, -1), (9, -1), (9, 7), (-1, 7)],
    walls=[Wall([(0, 3), (4, 3)])],
    obstacles=[Obstacle([(4, 4), (4, 5), (5, 5), (5, 4)])],
)


@settings(max_examples=30, deadline=None)
@given(
    counts=st.lists(st.integers(0, 12), min_size=1, max_size=3),
    low=st.floats(0.1, 0.3),
    seed=st.integers(-5, 2**40),
    at=st.tuples(st.floats(0.5, 5.5), st.floats(0.5, 2.0)),
)
def test_nobody_overlaps_anything(counts: list[int], low: float, seed: int, at: tuple[float, float]) -> None:
    robots = [robot(*at, radius=0.4)]
    spawners = [spawner(count, radius=f"uniform({low!r}, 0.35)") for count in counts]
    people, problems = place(STAGE, spawners, robots, seed)
    assert not problems
    assert np.bincount(people.spawner, minlength=len(counts)).tolist() == counts
    discs = np.concatenate([people.position, [at]])
    radius = np.concatenate([people.radius, [0.4]])
    away = np.hypot(*np.moveaxis(discs[:, None] - discs[None], -1, 0))
    np.fill_diagonal(away, math.inf)
    assert np.all(away >= radius[:, None] + radius[None] + GAP - 1e-12)
    zone, solid = shapely.Polygon(SQUARE), shapely.union_all([shapely.Polygon(o.points) for o in STAGE.obstacles])
    wall = shapely.LineString(STAGE.walls[0].points)
    for point, r in zip(shapely.points(people.position), people.radius, strict=True):
        assert zone.covers(point)
        assert point.distance(solid) >= r
        assert point.distance(wall) >= r
    goals = shapely.points(people.goal)
    assert all(
        shapely.Polygon(s.goal).covers(g) for s, g in zip([spawners[k] for k in people.spawner], goals, strict=True)
    )
    assert np.all((people.radius >= low) & (people.radius <= 0.35))
    assert np.all((people.speed >= 0.56) & (people.speed <= 2.12))


def test_places_depend_on_the_seed_only_and_on_earlier_spawners() -> None:
    two = [spawner(5, radius=0.2), spawner(5, zone=[(0, 0), (3, 0), (3, 2)], radius=0.2)]
    first, again, other = (place(Stage(), two, [], seed)[0] for seed in (1, 1, 2))
    assert np.array_equal(first.position, again.position)
    assert np.array_equal(first.goal, again.goal)
    assert not np.array_equal(first.position, other.position)
    alone = place(Stage(), two[:1], [], 1)[0]
    assert np.array_equal(alone.position, first.position[:5])
    assert np.array_equal(alone.speed, first.speed[:5])
    assert np.array_equal(
        place(Stage(), [spawner(5), *two], [], 1)[0].radius[:5], place(Stage(), [spawner(5)], [], 1)[0].radius
    )


def test_what_does_not_fit_is_counted() -> None:
    people, problems = place(Stage(), [spawner(1000, radius=0.3)], [], 0)
    assert 50 < len(people) < 140
    assert problems[0][1].startswith(
        f"only {len(people)} of 1000 people fit into the spawn zone of 36.00 m2 beside walls"
    )
    none, problems = place(Stage(), [spawner(2, zone=[(0, 0), (1, 0), (1, 1)])], [robot(0.5, 0.5, 2.0)], 0)
    assert len(none) == 0
    assert problems[0][1].startswith("spawn zone of 0.50 m2 leaves no room for a single body beside walls, robots and")


def test_a_thousand_people_are_placed_quickly_and_evenly() -> None:
    zone = [(0, 0), (40, 0), (40, 30), (0, 30)]
    people, problems = place(Stage(), [spawner(1000, zone=zone)], [], 4)
    assert not problems
    counts = np.histogram2d(*people.position.T, bins=[4, 3], range=[[0, 40], [0, 30]])[0]
    assert counts.min() > 50
    assert counts.max() < 120


def test_a_thin_zone_across_its_box_is_filled() -> None:
    people, problems = place(Stage(), [spawner(5, zone=[(0, 0), (20, 20), (20.05, 20)], radius=0.2)], [], 0)
    assert not problems
    assert len(people) == 5


@pytest.mark.parametrize(
    ("text", "extent", "mean", "sd"),
    [
        ("1.3", (1.3, 1.3), 1.3, 0.0),
        ("uniform(0.2, 0.3)", (0.2, 0.3), 0.25, 0.1 / math.sqrt(12)),
        ("normal(1.34, 0.26)", (0.56, 2.12), 1.34, 0.26 * math.sqrt(0.9733)),
        ("normal(0, 1, 0, 9)", (0.0, 9.0), math.sqrt(2 / math.pi), math.sqrt(1 - 2 / math.pi)),
    ],
)
def test_draws_follow_their_distribution(text: str, extent: tuple[float, float], mean: float, sd: float) -> None:
    distribution = Distribution.parse(text)
    drawn = distribution.draw(stream(0, text), 40_000)
    assert distribution.extent == extent
    assert Distribution.parse(str(distribution)) == distribution
    assert drawn.min() >= extent[0]
    assert drawn.max() <= extent[1]
    assert abs(drawn.mean() - mean) < 4.0 * sd / 200.0 + 1e-12
    assert abs(drawn.std() - sd) < 0.02 * sd + 1e-12


def test_each_draw_takes_one_number() -> None:
    for text in ("2", "uniform(0, 1)", "normal(0, 1)"):
        one, many = stream(1, "a"), stream(1, "a")
        Distribution.parse(text).draw(one, 7)
        many.random(7)
        assert one.random() == many.random()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("triangle(1, 2)", "'triangle' is not a distribution"),
        ("normal(1)", "normal takes 2 or 4 numbers, not 1"),
        ("normal(1, -1)", "standard deviation -1, it must be above 0"),
        ("uniform(2, 1)", "low end 2 not below its high end 1"),
        ("uniform(1, nan)", "is not finite"),
        ("fast", "is not a number, uniform"),
        ("uniform(1, 2", "is not a number, uniform"),
        ("normal(1, 1, 5, 5)", "low end 5 not below"),
    ],
)
def test_a_wrong_distribution_is_explained(text: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence.replace("(", r"\(")):
        Distribution.parse(text)
