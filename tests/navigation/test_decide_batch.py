"""Decisions in many environments at once equal those one by one, and a failure belongs to its environment."""

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot import models, navigation
from crowdbot.core import InputError, Pose, Scene, Twist, Walls, builtin_classes, stream
from crowdbot.navigation import (
    Action,
    AgentsInView,
    DriveLimits,
    Navigator,
    Observation,
    ObservationBatch,
    ORCANavigator,
    Straight,
)
from crowdbot.navigation.goal_motion import exact_distance
from crowdbot.sensors import Odometry, Scan

LIMITS = DriveLimits(1.0, 1.5, 1.0, 3.0)
OTHERS = (
    "external",
    "follower",
    "mppi",
    "predicted-occupancy",
    "process",
    "real-robot",
    "recurrent-policy",
    "ros2",
    "rosbridge",
    "scan-map",
    "scan-policy",
    "sinusoid",
)
"""Navigators that do not decide here, or have a memory; they have tests of their own."""
NAVIGATORS = {name: kind for name, kind in builtin_classes(navigation, Navigator).items() if name not in OTHERS}
ROOM = Walls.of([[(-6.0, -4.0), (6.0, -4.0)], [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0)], [(-6.0, 5.0), (6.0, 5.0)]])


def batch_of(seed, count=8, people=12, limits=LIMITS, walls=ROOM, **changes):
    rng = stream(seed, "batch")
    shape = (count, people)
    fields = {
        "pose": np.column_stack([rng.normal(0, 2, (count, 2)), rng.uniform(-7, 7, count)]),
        "goal": rng.uniform(-6, 6, (count, 2)),
        "radius": rng.uniform(0.2, 0.5, count),
        "limits": limits,
        "dt": 0.1,
        "twist": rng.uniform([0, -1, 0], [1, 1, 0.1], (count, 3)),
        "people": AgentsInView(
            rng.uniform(-5, 5, (*shape, 2)),
            rng.normal(0, 1, (*shape, 2)),
            rng.uniform(0.2, 0.3, shape),
            rng.random(shape) < 0.7,
            rng.permutation(200 * count).reshape(count, 200)[:, :people],
        ),
        "walls": walls,
        "time": rng.uniform(0, 9, count),
    }
    return ObservationBatch(**(fields | changes))


def same(navigator, batch):
    together = navigator.decide_batch(batch, [None] * len(batch))
    alone = Navigator.decide_batch(navigator, batch, [None] * len(batch))
    assert {k: str(error) for k, error in together.failures.items()} == {
        k: str(error) for k, error in alone.failures.items()
    }
    np.testing.assert_array_equal(together.twist, alone.twist)
    return together


@settings(max_examples=25, deadline=None)
@given(
    st.integers(0, 10_000),
    st.sampled_from(sorted(NAVIGATORS)),
    st.integers(0, 14),
    st.sampled_from([LIMITS, DriveLimits(0.7, 0.9), DriveLimits(1.2, 2.0, 0.6, 2.0, holonomic=True)]),
)
def test_the_batch_has_the_bits_of_single_decisions(seed, name, people, limits):
    batch = batch_of(seed, people=people, limits=limits)
    waypoints = batch.goal + np.where(np.arange(8)[:, None] % 2, 0.0, stream(seed).normal(0, 1, (8, 2)))
    navigator = NAVIGATORS[name](speed=0.9)
    same(navigator, batch)
    assert same(navigator, dataclasses.replace(batch, waypoint=waypoints)).failures == {}


@pytest.mark.parametrize("share", [0.5, 1.0])
@pytest.mark.parametrize("most", [1, 3, 200])
def test_orca_keeps_the_bits_of_its_model_in_dense_crowds(share, most):
    navigator = ORCANavigator(share=share, max_neighbors=most, neighbor_distance=3.0)
    batch = batch_of(3, count=4, people=130)
    tied = batch.people.position.copy()
    tied[:, 1] = tied[:, 0]
    people = dataclasses.replace(batch.people, position=tied)
    assert same(navigator, dataclasses.replace(batch, people=people)).failures == {}


def test_the_distance_has_the_bits_of_math_dist():
    rng = stream(5, "distance")
    for scale in (1e-9, 1e-3, 1.0, 1e4):
        for ax, ay, bx, by in (scale * rng.normal(0, 1, (2000, 4))).tolist():
            assert exact_distance(ax, ay, bx, by) == math.dist((ax, ay), (bx, by))
    assert exact_distance(1.0, 2.0, 1.0, 2.0) == 0.0


def test_an_environment_is_an_ordinary_observation():
    scene = Scene.of(
        np.arange(24.0).reshape(3, 4, 2), np.ones((3, 4, 2)), goal=np.ones((3, 4, 2)), active=[True, True, False, True]
    )
    twist = np.arange(9.0).reshape(3, 3)
    seen = np.ones((3, 4), dtype=bool)
    seen[2, 1] = False
    batch = ObservationBatch.of(
        scene,
        0,
        LIMITS,
        dt=0.2,
        twist=twist,
        seen=seen,
        environments=np.array([0, 2]),
        ids=10 + np.tile(range(4), (3, 1)),
    )
    for k, e in enumerate((0, 2)):
        single = Observation.of(
            scene, 0, LIMITS, dt=0.2, twist=Twist(*twist[e]), seen=seen[e], environment=e, ids=10 + np.arange(4)
        )
        one = batch.environment(k)
        assert (one.pose, one.goal, one.waypoint, one.radius, one.twist, one.time, one.dt) == (
            single.pose, single.goal, single.waypoint, single.radius, single.twist, single.time, single.dt,
        )  # fmt: skip
        for name in ("position", "velocity", "radius", "ids", "existence", "gesture"):
            np.testing.assert_array_equal(getattr(one.people, name), getattr(single.people, name))
    assert batch.environment(1).people.ids.tolist() == [13]
    with pytest.raises(TypeError, match="has no field 'colour'"):
        ObservationBatch.of(scene, 0, LIMITS, dt=0.2, twist=twist, colour=1)
    with pytest.raises(InputError, match=r"waypoint has shape \[2, 2\], it must be \[3, 2\]"):
        ObservationBatch.of(scene, 0, LIMITS, dt=0.2, twist=twist, waypoint=np.zeros((2, 2)))


def readings(count):
    pose = Pose(np.zeros((count, 2)), np.arange(float(count)))
    rows = np.arange(count)[:, None] * np.ones(3)
    zero = rows.astype(int)
    scan = Scan(0.5, pose, rows, np.zeros(count), zero, rows, zero)
    return {"lidar": scan, "wheels": Odometry(0.5, pose, pose, rows, rows, zero)}


def test_readings_by_name_and_where_they_have_arrived():
    batch = batch_of(0, count=3, readings=readings(3), arrived={"lidar": np.array([True, False, True])})
    last = batch.environment(2)
    assert last.scan.ranges.tolist() == [[2.0, 2.0, 2.0]]
    assert last.scan.angles.shape == (3,)
    assert last.readings["lidar"] is last.scan
    assert last.odometry.estimate.heading.tolist() == [2.0]
    assert batch.environment(1).scan is None
    assert list(batch.environment(1).readings) == ["wheels"]
    wrong = batch_of(0, count=3, readings=readings(2))
    with pytest.raises(InputError, match="a Scan has 2 rows, it must have 3"):
        wrong.environment(0)


@dataclass(frozen=True)
class Picky(Navigator):
    """Fails in the environment at 2 s, counts decisions elsewhere."""

    def begin(self, observation):
        if observation.time == 1.0:
            raise RuntimeError("cannot begin")
        return 0

    def act(self, observation, memory):
        if observation.time == 2.0:
            return 1 / 0
        return Action(Twist(0.1 * memory)), memory + 1


def test_one_failure_does_not_stop_the_others():
    batch = batch_of(1, count=4, time=np.arange(4.0))
    memories, failures = Picky().first_memories(batch, robot="r1")
    assert (memories, list(failures), str(failures[1])) == ([0, None, 0, 0], [1], "cannot begin")
    decisions = Picky().decide_batch(batch, [3, 3, 3, 3], "r1")
    assert list(decisions.failures) == [2]
    assert isinstance(decisions.failures[2], ZeroDivisionError)
    assert decisions.memories == [4, 4, 3, 4]
    np.testing.assert_allclose(decisions.twist[:, 0], [0.3, 0.3, 0.0, 0.3])
    assert not decisions.seconds.any()


@pytest.mark.parametrize("navigator", [Straight(), ORCANavigator(), Picky()])
def test_a_timer_measures_each_decision(navigator):
    ticks = iter(range(100))
    seconds = navigator.decide_batch(batch_of(1, count=4), [0] * 4, timer=lambda: float(next(ticks))).seconds
    assert np.all(seconds > 0.0)
    assert seconds.sum() in (1.0, 4.0)


@pytest.mark.parametrize("navigator", [Straight(), ORCANavigator()])
@pytest.mark.parametrize(
    ("name", "value"), [("pose", math.nan), ("goal", math.inf), ("twist", math.nan), ("radius", 0)]
)
def test_a_wrong_value_fails_in_its_environment_alone(navigator, name, value):
    batch = batch_of(2)
    getattr(batch, name)[3] = value
    decisions = same(navigator, batch)
    assert list(decisions.failures) == [3]
    assert f"observation: {name}" in str(decisions.failures[3])
    assert np.all(decisions.twist[3] == 0.0)


def test_only_orca_depends_on_people_with_wrong_values():
    batch = batch_of(2)
    batch.people.seen[3, 5] = True
    batch.people.position[3, 5] = math.nan
    assert same(Straight(), batch).failures == {}
    assert list(same(ORCANavigator(), batch).failures) == [3]
    batch.people.seen[3, 5] = False
    assert same(ORCANavigator(), batch).failures == {}


def test_values_that_the_model_rejects_fail_everywhere():
    assert list(same(ORCANavigator(time_horizon=1e-4), batch_of(1, count=2)).failures) == [0, 1]
    assert list(same(Straight(), batch_of(1, count=2, dt=-1.0)).failures) == [0, 1]
    assert list(same(ORCANavigator(), batch_of(1, count=2, limits=DriveLimits(1.0, 0.0))).failures) == [0, 1]


def test_a_subclass_with_its_own_rule_is_asked():
    @dataclass(frozen=True)
    class Lazy(ORCANavigator):
        def act(self, observation):
            return Twist(0.125)

    @dataclass(frozen=True)
    class Sideways(ORCANavigator):
        def velocity(self, observation):
            return (0.0, 0.5)

    batch = batch_of(4)
    assert np.all(Lazy().decide_batch(batch, [None] * 8).twist[:, 0] == 0.125)
    same(Sideways(), batch)
    assert np.any(
        Sideways().decide_batch(batch, [None] * 8).twist != ORCANavigator().decide_batch(batch, [None] * 8).twist
    )


def test_a_wrong_shape_is_explained():
    with pytest.raises(InputError, match=r"observations: twist has shape \[8, 2\], it must be \[8, 3\]"):
        batch_of(0, twist=np.ones((8, 2)))
    with pytest.raises(InputError, match="2 tracks in 8 environments"):
        batch_of(0, tracks=[None, None])


def test_arrays_of_other_types_and_orders_are_converted():
    batch = batch_of(6)
    turned = dataclasses.replace(batch, pose=np.asfortranarray(batch.pose), goal=np.round(batch.goal).astype(int))
    assert turned.pose.flags.c_contiguous
    assert same(ORCANavigator(), turned).failures == {}


def test_the_model_is_that_of_the_navigator():
    assert ORCANavigator.paper is models.ORCA.paper
