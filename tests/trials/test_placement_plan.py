"""The plan places people of many seeds exactly as one seed after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.navigation import Straight
from crowdbot.trials import (
    Agent,
    Group,
    InitialPeople,
    Obstacle,
    PeopleBatch,
    PlacementPlan,
    RobotGoal,
    RobotSpec,
    Spawner,
    Stage,
    Wall,
    load_trial,
    place,
)
from crowdbot.world import DifferentialDrive

SQUARE = [(0, 0), (6, 0), (6, 6), (0, 6)]
GOAL = [(7, 0), (8, 0), (8, 6), (7, 6)]
STAGES = [
    Stage(),
    Stage(
        walkable=[(-1, -1), (9, -1), (9, 7), (-1, 7)],
        walls=[Wall([(0, 3), (4, 3)])],
        obstacles=[Obstacle([(4, 4), (4, 5), (5, 5), (5, 4)])],
    ),
    Stage(area="POLYGON ((-1 -1, 12 -1, 12 7, -1 7, -1 -1), (2 2, 3 2, 3 3, 2 2))"),
]
ROBOT = RobotSpec(x=3, y=1, radius=0.4, goal=RobotGoal(3, 1), drive=DifferentialDrive(), navigator=Straight())
ZONES = [SQUARE, [(0, 0), (6, 0), (6, 6), (5.5, 0.5)], [(1, 1), (5, 1), (5, 5), (3, 2)]]


def assert_equal_rows(found: PeopleBatch, expected: list[InitialPeople]) -> None:
    for e, people in enumerate(expected):
        one = found.environment(e)
        assert one.owners == people.owners
        for name in ("position", "goal", "radius", "speed", "heading", "group", "owner"):
            a, b = getattr(one, name), getattr(people, name)
            assert a.dtype == b.dtype
            assert a.tobytes() == b.tobytes(), name


def check_placement(plan: PlacementPlan, seeds: list[int]) -> None:
    known = [place(plan.stage, plan.spawners, plan.robots, seed, plan.agents, plan.recorded) for seed in seeds]
    found = plan.place(seeds)
    wrong = [e for e, (_, problems) in enumerate(known) if problems]
    if wrong:
        assert not isinstance(found, PeopleBatch)
        assert found == (wrong[0], known[wrong[0]][1])
    else:
        assert isinstance(found, PeopleBatch)
        assert_equal_rows(found, [people for people, _ in known])


@settings(max_examples=60, deadline=None)
@given(
    counts=st.lists(st.tuples(st.integers(0, 12), st.integers(0, 2)), min_size=1, max_size=3),
    stage=st.sampled_from(STAGES),
    seeds=st.lists(st.integers(-5, 2**66), min_size=1, max_size=4),
    radius=st.sampled_from(["0.25", "uniform(0.1, 0.35)", "normal(0.25, 0.02)"]),
    stands=st.booleans(),
    sizes=st.sampled_from([(), (), (Group(2, 0.5), Group(1))]),
)
def test_all_seeds_are_placed_as_one(
    counts: list[tuple[int, int]], stage: Stage, seeds: list[int], radius: str, stands: bool, sizes: Any
) -> None:
    spawners = [
        Spawner(
            count=count, zone=ZONES[zone], goal=() if stands and k else GOAL, radius=radius, stands=stands and k > 0,
            groups=sizes,
        )
        for k, (count, zone) in enumerate(counts)
    ]  # fmt: skip
    agents = [Agent(x=1.0, y=5.0, goal="7,5", radius=0.2)]
    check_placement(PlacementPlan.of(stage, spawners, [ROBOT], agents), seeds)


@pytest.mark.parametrize("name", ["circle-crossing", "crossing-flows", "four-blocks", "static-crowd", "joining-group"])
def test_built_in_trials_are_placed_as_one(name: str) -> None:
    trial = load_trial(name)
    plan = PlacementPlan.of(trial.stage, trial.spawners, trial.robots, trial.agents)
    seeds = [*range(20), -3, 2**62]
    assert plan._place_at_once(seeds)[1].all()
    check_placement(plan, seeds)


def test_points_near_a_limit_are_left_to_the_exact_placement() -> None:
    strip = [(0, 0), (6, 0), (6, 1e-10), (0, 1e-10)]
    plan = PlacementPlan.of(Stage(), [Spawner(count=2, zone=strip, goal=GOAL, radius=0.2)], [])
    assert not plan._place_at_once([0, 1])[1].any()
    check_placement(plan, [0, 1])


def test_too_many_people_are_told_for_the_first_seed() -> None:
    plan = PlacementPlan.of(Stage(), [Spawner(count=60, zone=SQUARE, goal=GOAL, radius=0.4)], [])
    found = plan.place([7, 8])
    assert not isinstance(found, PeopleBatch)
    assert found[0] == 0
    assert "of 60 people fit" in found[1][0][1]


def test_an_agent_in_a_robot_is_told() -> None:
    plan = PlacementPlan.of(Stage(), [], [ROBOT], [Agent(x=3.0, y=1.0, goal="7,5")])
    found = plan.place([7, 8])
    assert not isinstance(found, PeopleBatch)
    assert "overlaps a person or a robot" in found[1][0][1]


def test_many_people_are_placed_with_a_grid() -> None:
    wide = [(0, 0), (60, 0), (60, 60), (0, 60)]
    plan = PlacementPlan.of(Stage(), [Spawner(count=1001, zone=wide, goal=wide)], [])
    assert not plan._place_at_once([3])[1].any()
    assert np.array_equal(plan.place([3]).position[0], place(Stage(), plan.spawners, [], 3)[0].position)
