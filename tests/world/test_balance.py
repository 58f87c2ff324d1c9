"""People who are pushed: bracing, recovery steps, falls, and pushes that pass on."""

from __future__ import annotations

import math

import numpy as np
import pytest

from crowdbot.core import InputError, Scene, Twist
from crowdbot.humans import LIMBS, LYING, FallPose, Gait, People, fall_postures
from crowdbot.metrics import fall_hic15, fall_metrics
from crowdbot.models import ORCA
from crowdbot.simulation import simulate
from crowdbot.trials import parse_trial
from crowdbot.world import Balance, Omnidirectional, PhysicsWorld, Robot, balance_ability, maximum_lean, read_urdf
from crowdbot.world.physics.balance.fall import FallMotion, impact_speeds

WAYS = {"forward": 0.0, "backward": math.pi, "left": 0.5 * math.pi, "right": -0.5 * math.pi}
STEP, FALLING, LYING_DOWN, RISING = 0.005, 2, 3, 4
NAMES = [limb.name for limb in LIMBS]


def ram(mass: float = 100.0, height: float = 1.15) -> Robot:
    text = (
        f"<robot name='ram'><link name='base'><inertial><origin xyz='0 0 {height}'/><mass value='{mass}'/>"
        "<inertia ixx='5' iyy='5' izz='5' ixy='0' ixz='0' iyz='0'/></inertial>"
        f"<collision><origin xyz='0.3 0 {height}'/><geometry><box size='0.1 0.6 0.1'/></geometry></collision></link>"
        "</robot>"
    )
    drive = Omnidirectional(max_speed=5.0, max_turn_rate=1.0, max_acceleration=100.0, max_turn_acceleration=10.0)
    return Robot("ram", read_urdf(text), drive, base="planar")


def struck(
    name: str, heading: float, speed: float, *, row: int = 1, balance: bool = True, get_up: float | None = 5.0
) -> PhysicsWorld:
    """Return the world 1.6 s after the start of a beam that strikes standing people and withdraws."""
    place = [[0.0, 0.0], *([0.9 + 0.45 * k, 0.0] for k in range(row))]
    scene = Scene.of(
        place, goal=place, heading=[0.0] + [heading] * row, external=[True] + [False] * row,
        radius=[0.3] + [0.2] * row, max_speed=[speed] + [0.0] * row, preferred_speed=[speed] + [0.0] * row,
    )  # fmt: skip
    people = People.of([name] * row)
    world = PhysicsWorld(scene, ORCA(), {0: ram()}, 0.02, people=people, balance=balance, get_up=get_up)
    for _ in range(80):
        world.step({0: Twist(-1.0 if world.contact_events else speed)})
    return world


def outcome(name: str, way: float, lean: float = 0.0, speed: float = 0.0) -> tuple[int, bool]:
    """Return recovery steps and whether the person falls."""
    balance, heading = Balance(People.of([name]), np.zeros(1, dtype=np.int64), 1), np.zeros(1)
    toward = np.array([math.cos(way), math.sin(way)])
    balance.shift[0], balance.speed[0] = balance.center[0] * math.sin(lean) * toward, speed * toward
    for _ in range(1000):
        balance.advance(np.zeros(1, dtype=np.int64), heading, STEP)
    return int(balance.steps[0]), bool(balance.phase[0] == FALLING)


@pytest.mark.parametrize("name", ["man-24", "man-50", "woman-72"])
@pytest.mark.parametrize(("word", "column"), [("forward", 0), ("backward", 1), ("left", 2), ("right", 2)])
def test_people_recover_with_one_step_up_to_the_published_lean(name: str, word: str, column: int) -> None:
    years = People.of([name]).persons[0].years
    most = float(maximum_lean([years])[0, column])
    assert outcome(name, WAYS[word], most - math.radians(2.0)) == (1, False)
    assert outcome(name, WAYS[word], most + math.radians(2.0))[0] != 1


@pytest.mark.parametrize(("word", "degrees"), [("forward", 8.0), ("backward", 4.5), ("left", 8.0)])
def test_feet_in_place_hold_the_lean_of_clinical_tests(word: str, degrees: float) -> None:
    assert outcome("man-24", WAYS[word], math.radians(degrees - 2.0)) == (0, False)
    assert outcome("man-24", WAYS[word], math.radians(degrees + 2.0))[0] == 1


def test_harder_pushes_need_more_steps_until_people_fall() -> None:
    found = [outcome("man-36", 0.0, speed=speed) for speed in (0.1, 0.8, 1.5, 2.6)]
    assert found[0] == (0, False)
    assert found[1] == (1, False)
    assert found[3][1]
    assert [one[1] for one in found] == sorted(one[1] for one in found)


def test_the_old_fall_where_the_young_recover() -> None:
    assert not outcome("woman-24", math.pi, speed=1.1)[1]
    assert outcome("woman-72", math.pi, speed=1.1)[1]


def test_a_push_on_the_feet_acts_against_the_push_and_one_at_the_waist_along() -> None:
    balance = Balance(People.of(["man-36"]), np.zeros(1, dtype=np.int64), 1)
    balance.push(0, np.array([0.4, 0.0]), 0.0, ("robot", 3))
    assert balance.speed[0].tolist() == [-0.4, 0.0]
    balance.push(0, np.array([0.4, 0.0]), 1.4, ("robot", 3))
    assert balance.speed[0].tolist() == [0.0, 0.0]
    assert balance.pusher[0].tolist() == [0, 3]


def test_a_push_that_is_passed_on_counts_for_the_body_that_pushed_first() -> None:
    balance = Balance(People.of(["man-36", "man-24"]), np.arange(2), 2)
    balance.push(0, np.array([0.4, 0.0]), 1.2, ("robot", 7))
    balance.push(1, np.array([0.3, 0.0]), 1.2, ("person", 0))
    balance.push(0, np.array([-0.1, 0.0]), 1.2, ("person", 1))
    assert balance.pusher.tolist() == [[0, 7], [0, 7]]


def test_abilities_of_shorter_people_are_in_proportion() -> None:
    tall, small = (balance_ability(People.of(["man-24"], height=height)) for height in (1.9, 1.6))
    assert (tall.base / small.base).round(6).tolist() == [[1.1875] * 3]
    assert small.rate[0] > tall.rate[0]


@pytest.mark.parametrize("word", list(WAYS))
def test_lying_people_are_on_the_floor_and_not_in_it(word: str) -> None:
    people = People.of(["man-36", "woman-72"])
    gait = Gait(people)
    upright = gait.posture(gait.start([[0.0, 0.0], [3.0, 1.0]], [0.4, -2.0]))
    poses = {k: FallPose(WAYS[word], LYING, 0.4, True, True) for k in range(2)}
    limbs = people.limbs(fall_postures(upright, people, np.array([0.4, -2.0]), poses))
    low = np.minimum(limbs.start[..., 2], limbs.end[..., 2]) - limbs.radius
    assert np.abs(low.min(axis=1)).max() < 1e-9
    assert np.maximum(limbs.start[..., 2], limbs.end[..., 2]).max() < 0.55
    assert low[:, NAMES.index("head")].max() < 0.1


@pytest.mark.parametrize("degrees", [30, -40, 50, 70, -120, 140, 165])
def test_an_oblique_fall_ends_on_the_front_the_side_or_the_back(degrees: float) -> None:
    people = People.of(["woman-72"])
    gait = Gait(people)
    upright = gait.posture(gait.start([[0.0, 0.0]], [0.0]))
    pose = FallPose(math.radians(degrees), LYING, 0.4, False, True)
    posture = fall_postures(upright, people, np.zeros(1), {0: pose})
    limbs = people.limbs(posture)
    low = np.minimum(limbs.start[..., 2], limbs.end[..., 2]) - limbs.radius
    assert low[0, [NAMES.index(name) for name in ("pelvis", "chest")]].max() < 0.05  # not held up by a hand
    head, pelvis = posture.position[0, 5, :2], posture.position[0, 0, :2]
    away = head - pelvis
    assert math.degrees(math.atan2(away[1], away[0])) == pytest.approx(degrees, abs=12)  # in the direction of the fall


def test_people_get_up_on_bent_legs() -> None:
    people = People.of(["man-36"])
    gait = Gait(people)
    upright = gait.posture(gait.start([[0.0, 0.0]], [0.0]))
    heights = []
    for rising in (False, True):
        pose = FallPose(0.0, math.radians(50.0), 0.0, False, True, rising)
        posture = fall_postures(upright, people, np.zeros(1), {0: pose})
        knee, hip = posture.position[0, 21], posture.position[0, 20]
        heights.append(float(knee[0] - hip[0]))
        limbs = people.limbs(posture)
        assert abs((np.minimum(limbs.start[..., 2], limbs.end[..., 2]) - limbs.radius).min()) < 1e-9
    assert heights[1] > heights[0] + 0.2  # the knees come forward under the body


def test_no_region_hits_the_floor_faster_than_in_free_fall() -> None:
    people = People.of(["woman-72"])
    gait = Gait(people)
    upright = gait.posture(gait.start([[0.0, 0.0]], [0.0]))
    for way in WAYS.values():
        speeds, _ = impact_speeds(upright, people, 0.0, way, True, FallMotion(0.44, 4.0, 3.0))
        height = float(people.height[0])
        assert 0.5 < max(speeds.values()) <= math.hypot(4.0 * height * math.sin(0.44), math.sqrt(2 * 9.81 * height))


def test_a_struck_person_falls_lies_and_gets_up() -> None:
    world = struck("woman-72", 0.0, 3.0, get_up=0.5)
    (fall,) = world.falls
    assert (fall.person, fall.direction, fall.cause, fall.causer) == (1, "forward", "robot", 0)
    assert 0.3 < fall.end - fall.begin < 1.2
    phases, heads = [], []
    for _ in range(300):
        world.step({0: Twist(0.0)})
        phases.append(int(world.falling.balance.phase[1]))
        heads.append(float(world.people.ends[0, NAMES.index("head"), 2]))
    assert [phase for k, phase in enumerate(phases) if k == 0 or phase != phases[k - 1]][-3:] == [LYING_DOWN, RISING, 0]
    assert min(heads) < 0.4
    assert heads[-1] > 1.3


def test_nobody_falls_without_balance() -> None:
    world = struck("woman-72", 0.0, 3.0, balance=False)
    assert world.falls == ()
    assert float(world.people.ends[0, NAMES.index("head"), 2]) > 1.3


def test_a_push_goes_through_a_row_of_people() -> None:
    world = struck("man-36", 0.0, 3.0, row=3)
    moved = world.scene.position[0, 1:, 0] - (0.9 + 0.45 * np.arange(3))
    assert np.all(moved > 0.05)
    pairs = {(contact_event.first.kind, contact_event.second.kind) for contact_event in world.contact_events}
    assert ("person", "person") in pairs


def test_a_copy_of_a_falling_world_continues_alike() -> None:
    world = struck("woman-72", 0.0, 3.0)
    other = world.copy()
    for _ in range(10):
        world.step({0: Twist(0.0)})
        other.step({0: Twist(0.0)})
    assert np.array_equal(world.scene.position, other.scene.position)
    assert np.array_equal(world.people.ends, other.people.ends)
    assert world.falls == other.falls


def test_people_walk_around_someone_on_the_floor() -> None:
    world = struck("woman-72", 0.0, 3.0, get_up=None)
    walls = world.falling.add_obstacles(world.scene).walls
    assert len(walls) == len(world.scene.walls) + 4
    assert world.falling.add_obstacles(world.scene).external[0, 1]
    assert not world.scene.external[0, 1]


def test_hic_of_falls_is_that_of_a_half_sine() -> None:
    speed, g, rate = 3.0, 9.81, 690.0
    times = np.linspace(0.0, math.pi / rate, 2001)
    pulse = speed * rate / g * np.sin(rate * times)
    velocity = np.concatenate([[0.0], np.cumsum(0.5 * (pulse[1:] + pulse[:-1]) * np.diff(times))])
    best = max(
        (times[j] - times[i]) * ((velocity[j] - velocity[i]) / (times[j] - times[i])) ** 2.5
        for i in range(0, 1000, 10)
        for j in [2000 - i]
    )
    assert fall_hic15(speed) == pytest.approx(best, rel=2e-3)
    assert fall_metrics([], [])["fall_severity"] == 0.0


TRIAL = """<trial name="shove" duration="4" world="{world}" balance="true" step="0.05" seed="1"><stage/>
<crowd type="orca"/><agent x="1.2" y="0" heading="3.14159" body="woman-72"/>
<robot name="robot" type="wheelchair" x="0" y="0" visible="false" default-sensors="false"><goal x="9" y="0"/>
<navigator type="straight"/></robot><end collision="false" goal="false"/></trial>"""


def test_falls_are_part_of_an_episode_and_of_the_metrics_of_its_robot() -> None:
    episode = simulate(parse_trial(TRIAL.format(world="physics")), 0)
    assert episode.metrics["falls"] == len(episode.falls)
    assert episode.metrics["robot_caused_falls"] == sum(fall.cause == "robot" for fall in episode.falls)
    assert episode.metrics["max_severity"] >= episode.metrics["fall_severity"]
    assert simulate(parse_trial(TRIAL.format(world="physics")), 0).digest == episode.digest


def test_balance_needs_the_physics_world() -> None:
    with pytest.raises(InputError, match='balance="true" needs the bodies of world="physics"'):
        parse_trial(TRIAL.format(world="planar"))
