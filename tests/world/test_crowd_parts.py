"""Limits and small rules of journeys, routers, flows, replayed people, servos and first twists."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Pose, Scene, Twist, stream
from crowdbot.models import ORCA
from crowdbot.world import (
    DifferentialDrive,
    Direction,
    JourneyAssignment,
    Omnidirectional,
    PeopleSource,
    PlanarWorld,
    Point,
    ReplayedPeople,
    ReplayedTrack,
    Router,
    Twists,
    VelocityServo,
    WaypointSequence,
    Zone,
)

PATHS = tuple(WaypointSequence((Point(x, 5.0),)) for x in (0.0, 9.0))
DOOR = Zone(((0.0, 0.0), (1.0, 0.0), (1.0, 4.0), (0.0, 4.0)))
some = settings(max_examples=40, deadline=None)


@pytest.mark.parametrize("which", [-1, 0, 1, [0, 1], [-1, 1], [[0, -1, 1]]])
def test_journeys_are_named_by_their_number_or_minus_one(which: object) -> None:
    assert JourneyAssignment(PATHS, which).which is which  # type: ignore[arg-type]


@pytest.mark.parametrize("which", [2, -2, [0, 2], [-2, 0], [1, 0, 2], 0.5, [0.0, 1.0]])
def test_one_wrong_number_of_a_journey_is_refused(which: object) -> None:
    with pytest.raises(InputError, match="must be from 0 to 1, or -1 for no journey"):
        JourneyAssignment(PATHS, which)  # type: ignore[arg-type]


@pytest.mark.parametrize("heading", [math.nan, math.inf])
def test_a_heading_must_be_finite(heading: float) -> None:
    with pytest.raises(InputError, match="Direction"):
        Direction(heading)


@pytest.mark.parametrize("radius", [0.0, -0.3, math.inf, math.nan])
def test_the_radius_of_a_router_must_be_finite_and_above_0(radius: float) -> None:
    with pytest.raises(InputError, match=f"Router: radius {radius} m must be finite and above 0"):
        Router.of([[(0.0, 0.0), (1.0, 0.0)]], radius)


def test_a_guide_puts_goals_ahead_at_the_distance_of_the_way() -> None:
    router = Router.of([[(2.0, -1.0), (2.0, 1.0)]], 0.3)
    scene = Scene.of([[0.0, 0.0], [0.0, 5.0]], goal=[[4.0, 0.0], [4.0, 5.0]])
    goal = router.guide(scene).goal[0]
    assert goal[1].tolist() == [4.0, 5.0]  # the way is free
    detour = 2.0 * math.hypot(2.0, 1.3)  # a bit less than around the corner at the distance of the body
    assert np.linalg.norm(goal[0]) == pytest.approx(detour, rel=0.05)
    assert abs(math.atan2(goal[0, 1], goal[0, 0])) == pytest.approx(math.atan2(1.3, 2.0), abs=0.1)
    nobody = router.guide(scene, np.array([[False, False]]))
    np.testing.assert_array_equal(nobody.goal, scene.goal)


@dataclass(frozen=True)
class Always:
    """A distribution of one number."""

    value: float

    def draw(self, rng: np.random.Generator, count: int) -> np.ndarray:
        return np.full(count, self.value)


def run(world: PlanarWorld, steps: int) -> None:
    for _ in range(steps):
        world.step({})


@pytest.mark.parametrize("word", ["speed", "radius"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.inf, math.nan])
def test_a_source_that_draws_an_impossible_person_is_named(word: str, value: float) -> None:
    source = PeopleSource(DOOR, PATHS[0], rate=10.0, timing="regular", **{word: Always(value)})
    world = PlanarWorld(Scene.of(np.zeros((3, 2)), active=False), ORCA(), {}, 0.1, sources=[source])
    with pytest.raises(InputError, match=f"the sampled {word} {value} must be finite and above 0"):
        run(world, 3)


@pytest.mark.parametrize("seed", [7, 7 + 2**40, 2**63 - 2])
def test_a_new_seed_of_a_running_flow_is_that_of_every_environment(seed: int) -> None:
    source = PeopleSource(DOOR, PATHS[0], rate=20.0)

    def arrivals(seed: int, environments: int, before: int = 0) -> np.ndarray:
        scene = Scene.of(np.zeros((environments, 4, 2)), active=False)
        world = PlanarWorld(scene, ORCA(), {}, 0.1, sources=[source], seed=before)
        world.reconfigure(world.scene, [source], seed)
        run(world, 3)
        return np.where(world.scene.active[..., None], world.scene.position, 0.0)

    together = arrivals(seed, 3)
    assert np.any(together[0] != together[1])
    for e in range(3):
        np.testing.assert_array_equal(together[e], arrivals((seed + e) % 2**63, 1, e)[0])


@some
@given(seed=st.integers(0, 999), time=st.floats(-1.0, 6.0))
def test_replayed_people_are_between_their_rows(seed: int, time: float) -> None:
    rng = stream(seed, "tracks")
    tracks = []
    for agent in range(3):
        rows = np.sort(rng.choice(np.arange(0.0, 5.0, 0.25), int(rng.integers(1, 8)), replace=False))
        tracks.append(ReplayedTrack(agent, rows, rng.normal(size=(len(rows), 2))))
    replayed = ReplayedPeople(tracks)
    (place,), (pace,) = replayed._rows.at(np.array([time]))
    for k, track in enumerate(tracks):
        expected = [np.interp(time, track.time, track.position[:, axis]) for axis in (0, 1)]
        np.testing.assert_allclose(place[k], expected, atol=1e-6)
        inside = track.time[0] <= time < track.time[-1]
        before = np.searchsorted(track.time, time, side="right") - 1
        step = np.diff(track.position, axis=0)[before] / np.diff(track.time)[before] if inside else np.zeros(2)
        if np.min(np.abs(track.time - time)) > 1e-6:
            np.testing.assert_allclose(pace[k], step, atol=1e-9)


@some
@given(
    forward=st.floats(-3.0, 3.0), left=st.floats(-3.0, 3.0), turn=st.floats(-4.0, 4.0), sideways=st.booleans(),
    dt=st.sampled_from([0.01, 0.1, 1.0]),
)  # fmt: skip
def test_a_servo_keeps_its_limits_and_ends_at_the_limited_twist(
    forward: float, left: float, turn: float, sideways: bool, dt: float
) -> None:
    servo = VelocityServo(
        max_speed=1.2, max_turn_rate=1.5, max_acceleration=2.0, max_turn_acceleration=3.0, time_constant=0.2,
        sideways=sideways,
    )  # fmt: skip
    pose, twist, command = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), Twist(forward, turn, left=left)
    for _ in range(math.ceil(20.0 / dt)):
        before = twist
        pose, twist = servo.step(pose, twist, command, dt)
        assert math.hypot(twist.forward[0], twist.left[0]) <= 1.2 + 1e-9
        assert abs(twist.turn[0]) <= 1.5 + 1e-9
        change = math.hypot(twist.forward[0] - before.forward[0], twist.left[0] - before.left[0])
        assert change <= 2.0 * dt + 1e-9
        assert abs(twist.turn[0] - before.turn[0]) <= 3.0 * dt + 1e-9
        if change < 1e-12 and abs(twist.turn[0] - before.turn[0]) < 1e-12:
            break
    wanted = np.array([forward, left if sideways else 0.0])
    wanted *= min(1.0, 1.2 / max(np.linalg.norm(wanted), 1e-12))
    assert (twist.forward[0], twist.left[0]) == pytest.approx(tuple(wanted), abs=1e-3)
    assert twist.turn[0] == pytest.approx(max(-1.5, min(1.5, turn)), abs=1e-6)


@some
@given(heading=st.floats(-math.pi, math.pi), x=st.floats(-0.9, 0.9), y=st.floats(-0.9, 0.9))
def test_a_robot_goes_on_with_the_velocity_it_begins_with(heading: float, x: float, y: float) -> None:
    scene = Scene.of(np.zeros((2, 1, 2)), np.array([[[x, y]], [[-y, x]]]), heading=heading, external=True)
    world = PlanarWorld(scene, ORCA(), {0: Omnidirectional(max_speed=2.0)}, 0.1)
    twist = world.twists[0]
    np.testing.assert_allclose(twist.velocity(np.full(2, heading)), [[x, y], [-y, x]], atol=1e-12)
    assert twist.turn.tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"robot_margin": -0.1}, "robot_margin -0.1 m must be finite and at least 0"),
        ({"robot_margin": math.inf}, "robot_margin inf m"),
        ({"heading_jitter": -0.1}, "heading_jitter -0.1 rad must be from 0 to pi"),
        ({"heading_jitter": 3.2}, "heading_jitter 3.2 rad"),
        ({"substeps": 0}, "substeps = 0 must be a whole number from 1 to 10000"),
        ({"substeps": True}, "substeps = True"),
        ({"substeps": 10_001}, "substeps = 10001"),
        ({"substeps": 2.0}, "substeps = 2.0"),
    ],
)
def test_impossible_worlds_are_refused(values: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        PlanarWorld(Scene.of([[0.0, 0.0]]), ORCA(), {}, 0.1, **values)  # type: ignore[arg-type]


def test_drives_belong_to_robots_of_the_scene() -> None:
    scene = Scene.of([[0.0, 0.0], [3.0, 0.0]], external=[True, False])
    for agent, message in ((2, "agents 0 to 1"), (-1, "agents 0 to 1"), (1, "agent 1 has a drive but is not external")):
        with pytest.raises(InputError, match=message):
            PlanarWorld(scene, ORCA(), {agent: DifferentialDrive()}, 0.1)
    world = PlanarWorld(scene, ORCA(), {0: DifferentialDrive()}, 0.1)
    with pytest.raises(InputError, match="agent 1 has a command but is not a robot; robots are"):
        world.step({0: Twist(), 1: Twist()})
