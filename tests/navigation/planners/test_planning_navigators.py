"""Social force, potential field, dynamic window and model-predictive control keep limits, clearances and symmetry."""

import dataclasses
import math

import numpy as np
import pytest
from open_ground import ANY_WAY, WHEELS, drive, observe

from crowdbot.core import InputError, Twist, Walls
from crowdbot.data import Forecast
from crowdbot.navigation import (
    DriveLimits,
    DynamicWindowNavigator,
    MPCNavigator,
    PotentialFieldNavigator,
    RDSNavigator,
    SocialForceNavigator,
    TimeElasticBandNavigator,
    TrackHistory,
    check_navigator,
)
from crowdbot.prediction import Predictor

KINDS = (
    SocialForceNavigator,
    PotentialFieldNavigator,
    DynamicWindowNavigator,
    MPCNavigator,
    TimeElasticBandNavigator,
    RDSNavigator,
)
pytestmark = pytest.mark.parametrize("kind", KINDS)


def test_keeps_the_contract(kind):
    check_navigator(kind())


@pytest.mark.parametrize("limits", [WHEELS, ANY_WAY], ids=["differential", "holonomic"])
def test_reaches_its_goal_alone_and_stays(kind, limits):
    path, _ = drive(kind(), limits, (3.0, 2.0), 9.0)
    assert math.dist(path[-1], (3.0, 2.0)) < 0.2
    assert math.dist(path[-1], path[-6]) < 0.05


@pytest.mark.parametrize("limits", [WHEELS, ANY_WAY], ids=["differential", "holonomic"])
def test_stops_for_a_person_in_front_of_a_wall(kind, limits):
    people = [(2.0, y, 0.0, 0.0) for y in (-0.4, 0.0, 0.4)]
    walls = [[(2.4, -1.0), (2.4, 1.0)], [(-1.0, -0.8), (2.4, -0.8)], [(-1.0, 0.8), (2.4, 0.8)]]
    path, gap = drive(kind(), limits, (5.0, 0.0), 8.0, people, walls)
    assert gap > 0.0
    assert np.abs(path[:, 1]).max() < 0.5
    assert path[-1, 0] < 1.45


@pytest.mark.parametrize("limits", [WHEELS, ANY_WAY], ids=["differential", "holonomic"])
def test_a_mirrored_scene_mirrors_the_twist(kind, limits):
    people = np.array([(2.5, 0.3, -1.0, 0.1), (1.5, -1.2, 0.2, 0.6)])
    flip = np.array([1.0, -1.0, 1.0, -1.0])
    wall = np.array([(-2.0, 1.4), (9.0, 1.2)])
    known = {"limits": limits}
    one = kind().act(observe(people, twist=Twist(0.8, 0.2), goal=(9.0, 1.0), walls=Walls.of([wall]), **known))
    mirror = Walls.of([wall * (1.0, -1.0)])
    other = kind().act(observe(people * flip, twist=Twist(0.8, -0.2), goal=(9.0, -1.0), walls=mirror, **known))
    assert tuple(one) == pytest.approx((other.forward, -other.turn, -other.left), abs=1e-9)


@pytest.mark.parametrize("limits", [DriveLimits(0.5, 0.4, 0.6, 0.8), DriveLimits(0.7, 9.0, holonomic=True)])
def test_limits_are_kept_and_values_finite_among_200_people(kind, limits):
    rng = np.random.default_rng(7)
    walls = Walls.of([[(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)]])
    for _ in range(6):
        people = np.column_stack([rng.uniform(-6.0, 6.0, (200, 2)), rng.normal(0.0, 1.0, (200, 2))])
        people[0, :2] = 0.0  # at the place of the robot
        seen = observe(people, limits=limits, goal=tuple(rng.uniform(-9.0, 9.0, 2).tolist()), walls=walls)
        twist = kind(speed=0.6).act(seen)
        assert all(map(math.isfinite, twist))
        assert math.hypot(twist.forward, twist.left) <= min(0.6, limits.max_speed) + 1e-9
        assert abs(twist.turn) <= limits.max_turn_rate + 1e-9
        assert limits.holonomic or (twist.left == 0.0 and twist.forward >= 0.0)
        assert kind(speed=0.6).act(seen) == twist


def test_at_the_goal_and_on_a_wall_the_values_are_finite(kind):
    for place in ((9.0, 0.0, 1.0), (0.0, 0.0, 0.0)):
        for limits in (WHEELS, ANY_WAY):
            twist = kind().act(observe(pose=place, walls=Walls.of([[(-1.0, 0.0), (1.0, 0.0)]]), limits=limits))
            assert all(map(math.isfinite, twist))


def test_wrong_values_are_explained(kind):
    for field in dataclasses.fields(kind):
        with pytest.raises(InputError, match=f"{kind.__name__}: {field.name} = nan"):
            kind(**{field.name: math.nan})


@dataclasses.dataclass(frozen=True)
class Standing(Predictor):
    """Expects everybody to stand still."""

    def predict(self, past, steps, samples, rng):
        position = np.repeat(past.position[:, None, -1:], steps, axis=2)
        return Forecast.of(position, past.present[:, -1], past.dt, "standing")


def test_mpc_alone_uses_the_predictor_of_the_trial(kind):
    tracks = TrackHistory.empty()
    for k in range(3):
        tracks = tracks.update(0.1 * k, [0], [[2.2 - 0.1 * k, 1.5 - 0.1 * k]])
    crossing = [(2.0, 1.3, -1.0, -1.0)]
    plain = kind().act(observe(crossing, twist=Twist(0.9), tracks=tracks))
    told = kind().act(observe(crossing, twist=Twist(0.9), tracks=tracks, predictor=Standing()))
    assert (plain == told) == (kind is not MPCNavigator)
