"""The elastic band and driving support: frames, shapes, and equal decisions in batches."""

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import InputError, Twist, Walls
from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
from crowdbot.navigation import DriveLimits, Observation, RDSNavigator, TimeElasticBandNavigator, VisiblePeople
from crowdbot.simulation import simulate, simulate_seeds
from crowdbot.trials import load_trial

WHEELS = DriveLimits(1.0, 1.5, 1.0, 3.0)
PEOPLE = np.array([(2.5, 0.3, -1.0, 0.1), (1.5, -1.2, 0.2, 0.6), (3.0, 2.0, -0.4, -0.8)])
WALL = np.array([(-2.0, 1.9), (9.0, 1.7)])


def seen(people=PEOPLE, turn=0.0, shift=(0.0, 0.0), limits=WHEELS, **changes):
    """Return a scene, turned about the origin and shifted."""
    cos, sin = math.cos(turn), math.sin(turn)
    rotation = np.array([[cos, -sin], [sin, cos]])
    rows = np.asarray(people, dtype=float).reshape(-1, 4)
    place, moving = rows[:, :2] @ rotation.T + shift, rows[:, 2:] @ rotation.T
    goal = rotation @ (9.0, 1.0) + shift
    known = {
        "pose": (float(shift[0]), float(shift[1]), turn),
        "goal": (float(goal[0]), float(goal[1])),
        "radius": 0.3,
        "limits": limits,
        "dt": 0.1,
        "twist": Twist(0.8, 0.1),
        "people": VisiblePeople(place, moving, np.full(len(rows), 0.25)),
        "walls": Walls.of([WALL @ rotation.T + shift]),
    }
    return Observation(**(known | changes))


@pytest.mark.parametrize("limits", [WHEELS, WHEELS._replace(holonomic=True)], ids=["differential", "holonomic"])
@pytest.mark.parametrize("kind", [RDSNavigator, TimeElasticBandNavigator])
def test_the_decision_does_not_depend_on_the_frame(kind, limits):
    here = kind().act(seen(limits=limits))
    for turn, shift in ((0.7, (0.0, 0.0)), (-2.1, (3.0, -7.0)), (3.0, (-20.0, 11.0))):
        there = kind().act(seen(turn=turn, shift=shift, limits=limits))
        assert tuple(there) == pytest.approx(tuple(here), abs=1e-3)


@pytest.mark.parametrize("kind", [RDSNavigator, TimeElasticBandNavigator])
def test_a_batch_decides_as_each_run_alone(kind):
    name = {RDSNavigator: "rds", TimeElasticBandNavigator: "time-elastic-band"}[kind]
    trial = parse_methods(name)[0].put_into(load_trial("crowdnav-circle-5", limit=6.0))
    together = simulate_seeds(trial, range(3))
    assert [item.digest for item in together] == [simulate(trial, seed).digest for seed in range(3)]


def test_a_long_robot_does_not_turn_its_rear_into_a_person():
    beside = [(-0.75, -0.62, 0.0, 0.0)]
    known = {"goal": (0.0, 5.0), "twist": Twist(), "walls": Walls.of()}
    disc = RDSNavigator(margin=0.0, width=0.6).act(seen(beside, **known))
    capsule = RDSNavigator(margin=0.0, width=0.6, rear=0.9).act(seen(beside, **known))
    assert disc.turn > 0.5
    assert 0.0 <= capsule.turn < 0.5 * disc.turn


def test_without_people_driving_support_changes_nothing():
    free = seen(np.zeros((0, 4)), walls=Walls.of())
    assert tuple(RDSNavigator().act(free)) == pytest.approx(tuple(free.towards_goal(1.0)), abs=1e-9)


def test_a_band_in_front_of_a_contact_stops_in_time():
    wall_of_people = [(1.2, 0.3 * k, 0.0, 0.0) for k in range(-12, 13)]
    ahead = seen(wall_of_people, walls=Walls.of(), goal=(9.0, 0.0))
    assert TimeElasticBandNavigator().act(ahead).forward < 0.8


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        (RDSNavigator, {"lead": 0.0}),
        (RDSNavigator, {"rear": -0.1}),
        (TimeElasticBandNavigator, {"horizon": math.nan}),
        (TimeElasticBandNavigator, {"iterations": 0}),
    ],
)
def test_wrong_numbers_are_explained(kind, values):
    with pytest.raises(InputError, match=f"{kind.__name__}: {next(iter(values))} = "):
        dataclasses.replace(kind(), **values)


def test_a_position_that_is_not_finite_is_a_counted_failure():
    broken = PEOPLE.copy()
    broken[0, 0] = math.nan
    for kind in (RDSNavigator, TimeElasticBandNavigator):
        twist = kind().act(seen(broken))
        assert all(isinstance(value, float) for value in twist)


def test_both_beat_straight_on_the_circle():
    plan = EvaluationPlan(
        [load_trial("crowdnav-circle-5")], parse_methods("straight, rds, time-elastic-band"), seeds=range(30)
    )
    straight, rds, band = (sum(cell.values("success")) for cell in evaluate(plan).cells)
    assert straight < rds < band
