"""People around robots: the gap that they keep, when they begin to evade, and who is left alone."""

import numpy as np
import pytest

from crowdbot.core import InputError, Scene
from crowdbot.models import ORCA, CollisionFreeSpeed, People, with_headway
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial

WARY = People(robot_caution=0.0)
SIZES = [0.25, 0.3]


def encounter(person, cart, goal, cart_velocity, **more):
    """Return a scene with a person who walks to a goal at 1.3 m/s and a robot that drives straight on."""
    given = {"velocity": [[1.3, 0.0], cart_velocity], "radius": SIZES, "external": [False, True]}
    given |= {"robot": [False, True], "goal": [goal, cart]}
    return Scene.of([person, cart], **(given | more))


def walk(model, scene, seconds=10.0, dt=0.1):
    """Return the positions ``[T, A, 2]`` of the first environment."""
    places = [scene.position[0]]
    for _ in range(round(seconds / dt)):
        scene = model.step(scene, dt)
        places.append(scene.position[0])
    return np.array(places)


def clearance(places):
    return np.hypot(*(places[:, 0] - places[:, 1]).T) - sum(SIZES)


@pytest.mark.parametrize("speed", [0.0, -0.7, -1.5])
@pytest.mark.parametrize("offset", [-0.2, 0.0, 0.3])
def test_people_evade_early_and_keep_a_gap(speed, offset):
    places = walk(WARY, encounter([-8.0, offset], [0.0, 0.0], [12.0, offset], [speed, 0.0]), 14.0)
    gap = clearance(places)
    aside = np.flatnonzero(np.abs(places[:, 0, 1] - offset) > 0.1)
    assert gap.min() > 0.6
    assert gap[aside[0]] > 1.5, "the first step aside comes long before the passage"
    assert places[-1, 0, 0] > 6.0, "the person walks on"


def test_without_a_gap_a_robot_is_one_more_person():
    plain, flagged = People(robot_gap=0.0), with_headway(ORCA)()
    scene = encounter([-2.0, 0.1], [0.0, 0.0], [9.0, 0.0], [-0.7, 0.0])
    for model in (plain, flagged):
        assert np.array_equal(model.velocity(scene, 0.1), model.velocity(scene.replace(robot=None), 0.1))


@pytest.mark.parametrize(
    "scene",
    [
        encounter([-30.0, 0.0], [0.0, 0.0], [12.0, 0.0], [-0.7, 0.0]),
        encounter([0.0, 0.0], [-3.0, 0.0], [12.0, 0.0], [-1.0, 0.0]),
        encounter([-4.0, 4.0], [0.0, 0.0], [12.0, 4.0], [0.0, 0.0]),
        encounter([-3.0, 0.0], [0.0, 0.0], [12.0, 0.0], [0.0, 0.0], visible=[True, False]),
        encounter([-3.0, 0.0], [0.0, 0.0], [12.0, 0.0], [0.0, 0.0], robot=[False, False]),
        encounter([-3.0, 0.0], [0.0, 0.0], [-3.0, 0.0], [0.0, 0.0]),
        encounter([-3.0, 0.0], [0.0, 0.0], [12.0, 0.0], [-0.5, 0.0], walls=[[(-1.0, -2.0), (-1.0, 2.0)]]),
    ],
    ids=["far", "drives-away", "beside", "unseen", "no-robot", "person-stands", "behind-a-wall"],
)
def test_people_whom_no_robot_concerns_do_not_change_a_bit(scene):
    expected = WARY.velocity(scene.replace(robot=None), 0.1)
    assert np.array_equal(WARY.velocity(scene, 0.1), expected)


def test_the_two_sides_are_mirrored():
    one, other = (walk(WARY, encounter([-6.0, y], [0.0, 0.0], [9.0, y], [-0.7, 0.0])) for y in (0.3, -0.3))
    assert np.allclose(one * [1.0, -1.0], other, atol=0.01), "the side of a tie is all that differs"
    head_on = walk(WARY, encounter([-6.0, 0.0], [0.0, 0.0], [9.0, 0.0], [-0.7, 0.0]))
    assert head_on[:, 0, 1].min() < -0.3, "equal sides: people keep to the right"


def test_people_wait_for_a_fast_robot_that_crosses_if_standing_is_cheap():
    scene = encounter([-3.9, 0.0], [0.0, -12.0], [9.0, 0.0], [0.0, 4.0])
    speeds, gaps = [], []
    for slowing in (0.1, 20.0):
        places = walk(People(robot_caution=0.0, robot_slowing=slowing), scene, 5.0)
        speeds.append(np.hypot(*np.diff(places[:, 0], axis=0).T).min() / 0.1)
        gaps.append(clearance(places).min())
    assert speeds[0] < speeds[1] - 0.1
    assert gaps[0] > gaps[1] + 0.2 > 0.5


def test_robots_behind_count_by_their_share():
    scene = encounter([0.0, 0.0], [-6.0, 0.1], [20.0, 0.0], [3.0, 0.0])
    unaware, aware = (walk(People(robot_gap=0.8, robot_behind=share), scene, 4.0) for share in (0.0, 1.0))
    assert np.array_equal(unaware[:10], walk(WARY, scene.replace(robot=None), 4.0)[:10])
    assert clearance(aware).min() > clearance(unaware).min() + 0.2


def test_nobody_evades_into_a_wall():
    walls = [[(-9.0, -0.7), (20.0, -0.7)], [(-9.0, 1.6), (20.0, 1.6)]]
    places = walk(WARY, encounter([-6.0, 0.0], [0.0, 0.0], [12.0, 0.0], [-0.5, 0.0], walls=walls), 12.0)
    assert places[:, 0, 1].max() < 1.6 - 0.2
    assert places[:, 0, 1].min() > -0.7 + 0.2
    assert clearance(places).min() > 0.2
    assert places[:, 0, 1].max() > 0.3, "the wide side"


def test_a_batch_equals_its_environments():
    rng = np.random.default_rng(3)
    place = rng.uniform(-5.0, 5.0, (4, 12, 2))
    robot = np.zeros((4, 12), dtype=bool)
    robot[0, 3] = robot[1, [0, 11]] = robot[3, 5] = True
    scene = Scene.of(place, rng.uniform(-1.0, 1.0, place.shape), goal=-place, external=robot, robot=robot)
    whole = WARY.velocity(scene, 0.1)
    for e in range(4):
        assert np.array_equal(whole[e : e + 1], WARY.velocity(scene.environment(e), 0.1))


def test_people_differ_in_caution_and_the_draw_is_reproducible():
    model = People(robot_gap=0.8, robot_horizon=4.0, robot_caution=0.3)
    drawn = [model.individual(2000, np.random.default_rng(seed)) for seed in (1, 1, 2)]
    gaps = [item.robot_gap for item in drawn]
    assert np.array_equal(gaps[0], gaps[1])
    assert not np.array_equal(gaps[0], gaps[2])
    assert np.median(gaps[0]) == pytest.approx(0.8, abs=0.03)
    assert np.log(gaps[0]).std() == pytest.approx(0.27, abs=0.02), "cut at two deviations"
    assert np.allclose(drawn[0].robot_horizon / gaps[0], 5.0), "one caution for both"
    assert np.all(drawn[0].robot_caution == 0.0), "drawn once"


def test_given_differences_are_kept():
    own = np.array([0.2, 0.4, 0.6])
    model = People(robot_gap=own, robot_caution=0.3).individual(3, np.random.default_rng(1))
    assert np.array_equal(model.robot_gap, own)
    alike = People(robot_gap=0.5, robot_caution=0.0)
    assert alike.individual(3, np.random.default_rng(1)) is alike
    assert CollisionFreeSpeed().individual(3, np.random.default_rng(1)) == CollisionFreeSpeed()


TRIAL = """<trial name="encounter" duration="12">
  <crowd type="people"{more}/>
  <agent x="-6" y="0.1" radius="0.25" speed="1.3" goal="9,0.1"/>
  <robot x="0" y="0" radius="0.3" heading="3.14159">
    <goal x="-9" y="0"/>
    <drive type="omnidirectional" max-speed="0.7"/>
    <navigator type="straight"/>
  </robot>
  <end collision="false" goal="false"/>
</trial>"""


def trial_of(folder, more, robot="<robot"):
    file = folder / "encounter.xml"
    file.write_text(TRIAL.format(more=more).replace("<robot x", f"{robot} x"), encoding="utf-8")
    return load_trial(file)


def gaps_of(trial):
    gaps = []
    for seed in range(6):
        place = simulate(trial, seed).position
        gaps.append(float(np.hypot(*(place[:, 0] - place[:, 1]).T).min()) - 0.55)
    return np.array(gaps)


def test_a_trial_draws_a_caution_for_each_person_and_seed(tmp_path):
    drawn, alike = (gaps_of(trial_of(tmp_path, f' robot-caution="{spread}"')) for spread in (0.4, 0))
    assert np.ptp(alike) < 1e-6
    assert np.ptp(drawn) > 0.1
    assert drawn.min() > 0.0


def test_a_robot_that_is_not_visible_is_not_avoided(tmp_path):
    place = simulate(trial_of(tmp_path, "", '<robot visible="false"'), 0).position
    assert np.hypot(*(place[:, 0] - place[:, 1]).T).min() < 0.6


@pytest.mark.parametrize(
    ("name", "value"), [("robot_gap", -0.1), ("robot_behind", 1.5), ("robot_horizon", 0.0), ("robot_caution", 3.0)]
)
def test_a_wrong_value_is_named(name, value):
    with pytest.raises(InputError, match=f"People: {name} = .* is not allowed"):
        People(**{name: value})
