"""Every navigator keeps its contract; Straight and ORCA do what they are for."""

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
import pytest

from crowdbot import models, navigation
from crowdbot.core import InputError, Twist, Walls, builtin_classes, from_attributes
from crowdbot.navigation import Action, DriveLimits, Navigator, Observation, ORCANavigator, Straight, VisiblePeople

BUILTIN = builtin_classes(navigation, navigation.Navigator)
OTHERS = (
    navigation.ExternalNavigator,
    navigation.FollowerNavigator,
    navigation.MPPINavigator,
    navigation.PredictedOccupancyNavigator,
    navigation.ProcessNavigator,
    navigation.RealRobotNavigator,
    navigation.RecurrentPolicyNavigator,
    navigation.Ros2Navigator,
    navigation.RosbridgeNavigator,
    navigation.ScanMapNavigator,
    navigation.ScanPolicyNavigator,
    navigation.SinusoidNavigator,
)
"""Navigators that do not decide here, or have a memory; they have tests of their own."""
NAVIGATORS = {name: kind for name, kind in BUILTIN.items() if kind not in OTHERS}
LIMITS = DriveLimits(1.0, 1.5, 1.0, 3.0)


def meeting(people=(), **changes):
    """Return what a robot at the origin knows, looking and going along x; people are x, y, vx, vy."""
    rows = np.array(people, dtype=float).reshape(-1, 4)
    known = {"pose": (0.0, 0.0, 0.0), "goal": (9.0, 0.0), "radius": 0.3, "limits": LIMITS, "dt": 0.1}
    known["people"] = VisiblePeople(rows[:, :2], rows[:, 2:], np.full(len(rows), 0.25))
    return Observation(**(known | changes))


def test_the_room_shows_its_contracts():
    names = {"dynamic-window", "external", "mpc", "orca", "potential-field", "rds", "social-force", "straight"}
    names |= {
        "attention-policy",
        "follower",
        "mppi",
        "policy",
        "predicted-occupancy",
        "process",
        "real-robot",
        "recurrent-policy",
        "ros2",
        "rosbridge",
        "scan-map",
        "scan-policy",
        "sinusoid",
        "time-elastic-band",
    }
    assert set(BUILTIN) == names
    assert all(hasattr(navigation, name) for name in navigation.__all__)


@pytest.mark.parametrize("kind", NAVIGATORS.values(), ids=list(NAVIGATORS))
class TestEveryNavigator:
    def test_is_a_frozen_spec_that_text_makes(self, kind):
        navigator = from_attributes(kind, {"speed": "0.7"})
        assert navigator == kind(speed=0.7)
        with pytest.raises(dataclasses.FrozenInstanceError):
            navigator.speed = 1.0

    def test_goes_ahead_when_free(self, kind):
        twist = kind().act(meeting())
        assert isinstance(twist, Twist)
        assert twist.forward > 0.0
        assert abs(twist.turn) < 1e-9

    def test_keeps_its_own_speed_and_the_limits(self, kind):
        rushing = meeting(twist=Twist(0.4), goal=(3.0, 3.0))
        twist = kind(speed=0.4).act(rushing)
        assert 0.0 <= twist.forward <= 0.4
        assert abs(twist.turn) <= LIMITS.max_turn_rate
        slow = meeting(limits=DriveLimits(0.3, 0.2, 1.0, 3.0), goal=(0.0, 5.0))
        assert kind().act(slow).forward <= 0.3
        assert abs(kind().act(slow).turn) <= 0.2

    def test_is_a_pure_function(self, kind):
        seen = meeting([(2.0, 0.3, -1.0, 0.0), (1.0, -2.0, 0.0, 1.0)], twist=Twist(0.6, 0.1))
        assert kind().act(seen) == kind().act(seen)

    @pytest.mark.parametrize("speed", [0.0, -1.0, math.nan, math.inf])
    def test_explains_a_wrong_speed(self, kind, speed):
        with pytest.raises(InputError, match=f"{kind.__name__}: speed = {speed}"):
            kind(speed=speed)


SYMMETRIC = {name: kind for name, kind in NAVIGATORS.items() if kind is not navigation.AttentionPolicyNavigator}
"""A network trained by chance prefers a side; that of ``policy`` decides nothing in this meeting."""


@pytest.mark.parametrize("kind", SYMMETRIC.values(), ids=list(SYMMETRIC))
def test_a_navigator_mirrors_what_is_mirrored(kind):
    left = kind().act(meeting([(2.5, 0.3, -1.0, 0.0)], twist=Twist(0.8), goal=(9.0, 1.0)))
    right = kind().act(meeting([(2.5, -0.3, -1.0, 0.0)], twist=Twist(0.8), goal=(9.0, -1.0)))
    assert left.forward == pytest.approx(right.forward, abs=1e-9)
    assert left.turn == pytest.approx(-right.turn, abs=1e-9)


def test_straight_is_blind():
    assert Straight().act(meeting([(0.7, 0.0, -1.0, 0.0)])) == Straight().act(meeting())


@pytest.mark.parametrize(("side", "sign"), [(0.15, -1.0), (-0.15, 1.0)])
def test_orca_passes_on_the_free_side(side, sign):
    twist = ORCANavigator().act(meeting([(2.5, side, -1.0, 0.0)], twist=Twist(0.8)))
    assert math.copysign(1.0, twist.turn) == sign
    assert abs(twist.turn) > 0.05


def test_orca_brakes_for_someone_who_blocks_the_way():
    wall = [(1.0, y, 0.0, 0.0) for y in np.arange(-3.0, 3.1, 0.5)]
    assert ORCANavigator().act(meeting(wall, twist=Twist(0.6))).forward < 0.3


def test_orca_takes_all_or_half_of_the_avoidance():
    seen = meeting([(2.0, 0.1, -1.0, 0.0)], twist=Twist(0.9))
    alone = abs(ORCANavigator(share=1.0).velocity(seen)[1])
    half = abs(ORCANavigator(share=0.5).velocity(seen)[1])
    assert 0.0 < half < alone


def test_the_velocity_is_that_of_the_model():
    seen = meeting([(2.0, 0.1, -1.0, 0.0)], twist=Twist(0.9), walls=Walls.of([[(-5.0, -1.0), (9.0, -1.0)]]))
    wish = np.array([[1.0, 0.0], [-1.0, 0.0]])
    from crowdbot.core import Scene

    scene = Scene.of(
        [[0.0, 0.0], [2.0, 0.1]],
        [[0.9, 0.0], [-1.0, 0.0]],
        radius=[0.35, 0.25],
        preferred_velocity=wish,
        max_speed=1.0,
        external=[False, True],
        walls=seen.walls,
    )
    expected = models.ORCA(6.0, 15, 1.5, 1.0).velocity(scene, 0.3)[0, 0]
    np.testing.assert_array_equal(ORCANavigator().velocity(seen), expected)


def test_far_people_change_nothing():
    assert ORCANavigator().act(meeting([(8.0, 0.0, -1.0, 0.0)])) == ORCANavigator().act(meeting())


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"time_horizon": 0.0}, "time_horizon = 0.0 s must be finite and above 0"),
        ({"time_horizon_walls": -1.0}, "time_horizon_walls = -1.0"),
        ({"neighbor_distance": math.nan}, "neighbor_distance = nan"),
        ({"max_neighbors": 0}, "max_neighbors = 0"),
        ({"reaction": math.inf}, "reaction = inf"),
        ({"safety": -0.1}, "safety = -0.1 m must be finite and at least 0"),
        ({"share": 0.7}, "share = 0.7 must be 0.5 or 1"),
    ],
)
def test_orca_explains_wrong_values(values, message):
    with pytest.raises(InputError, match=message):
        ORCANavigator(**values)


@dataclass(frozen=True)
class Counting(Navigator):
    """Remembers how often it was asked."""

    def begin(self, observation):
        return 10

    def act(self, observation, memory):
        return Action(Twist(0.1 * memory)), memory + 1


@dataclass(frozen=True)
class Plain(Navigator):
    answer: object = Twist(0.25)

    def act(self, observation):
        return self.answer


def test_memory_is_an_argument_and_a_result():
    navigator = Counting()
    memory = navigator.begin(meeting())
    one, after = navigator.decide(meeting(), memory)
    again, _ = navigator.decide(meeting(), memory)
    two, last = navigator.decide(meeting(), after)
    assert (one.twist.forward, two.twist.forward, last) == (pytest.approx(1.0), pytest.approx(1.1), 12)
    assert again == one


def test_a_plain_act_is_enough_and_keeps_the_memory():
    action, memory = Plain().decide(meeting(), "kept")
    assert (action, memory) == (Action(Twist(0.25)), "kept")
    assert Plain().begin(meeting()) is None
    for kind in NAVIGATORS.values():
        assert kind().decide(meeting(), None) == (Action(kind().act(meeting())), None)


@pytest.mark.parametrize(
    ("navigator", "words"),
    [
        (Plain((0.1, 0.2)), "navigator Plain returned a tuple, it must return a Twist"),
        (Plain(None), "navigator Plain returned a NoneType, it must return a Twist"),
        (Plain(Action(Twist())), "navigator Plain returned a Action, it must return a Twist"),
    ],
)
def test_a_wrong_answer_is_rejected(navigator, words):
    with pytest.raises(InputError, match=words):
        navigator.decide(meeting(), None)


def test_joint_targets_must_be_numbers():
    @dataclass(frozen=True)
    class Waving(Navigator):
        def act(self, observation, memory):
            return Action(Twist(), {"arm": "up"}), memory

    with pytest.raises(InputError, match="Waving returned the target 'up' for joint 'arm'; it must be a finite number"):
        Waving().decide(meeting(), None)
