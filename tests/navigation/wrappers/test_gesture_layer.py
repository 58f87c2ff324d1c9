"""Gestures in observations, and the layer that obeys them: in decisions, runs, batches, replays and metrics."""

import dataclasses

import numpy as np
import pytest

from crowdbot.core import GESTURES, TrialError, Twist
from crowdbot.evaluation import episode_metrics
from crowdbot.navigation import (
    DriveLimits,
    GestureLayer,
    Navigator,
    Observation,
    ObservationBatch,
    ORCANavigator,
    SafetyLayer,
    Straight,
    VisiblePeople,
    check_navigator,
)
from crowdbot.navigation.process.messages import decode_observation, encode_observation
from crowdbot.recording import record, replay
from crowdbot.simulation import (
    Simulation,
    decode_state,
    encode_state,
    restore_state,
    simulate,
    simulate_seeds,
    state_of,
)
from crowdbot.trials import load_trial, parse_trial, trial_xml

NONE, WAIT, PROCEED = range(3)
OBEY = {"robot/gestures": "obey"}


@dataclasses.dataclass(frozen=True)
class Timid(Navigator):
    """Stands while anybody who walks is visible."""

    def act(self, observation):
        walks = np.hypot(*observation.people.velocity.T) > 0.1
        return Twist() if np.any(walks) else observation.towards_goal(1.0)


@dataclasses.dataclass(frozen=True)
class Halting(Navigator):
    """Stops for good where it sees a person."""

    def act(self, observation):
        return Twist() if len(observation.people) else observation.towards_goal(1.0)


def observation(gesture, place=(2.0, -2.0), velocity=(0.0, 1.0)):
    """Return what a robot at the origin knows that drives along x, with one person."""
    person = VisiblePeople(np.array([place]), np.array([velocity]), np.array([0.25]), gesture=np.array([gesture]))
    limits = DriveLimits(1.0, 1.5)
    return Observation(pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=limits, dt=0.1, people=person)


def act(navigator, seen):
    return GestureLayer().around(navigator).decide(seen, None)[0].twist


def test_the_codes_are_those_of_the_names():
    assert GESTURES == ("none", "wait", "proceed")


def test_the_robot_stands_while_it_is_told_to_wait_and_only_then():
    assert act(Straight(), observation(WAIT)) == Twist()
    for gesture in (NONE, PROCEED):
        assert act(Straight(), observation(gesture)) == Straight().act(observation(gesture))
    alone = dataclasses.replace(observation(NONE), people=VisiblePeople.none())
    assert act(Straight(), alone) == Straight().act(alone)


@pytest.mark.parametrize(
    ("place", "velocity", "stands"),
    [
        ((0.5, -2.0), (0.0, 1.0), False),  # the robot is in the way of the person, 0.5 m aside
        ((0.6, -2.0), (0.0, 1.0), True),
        ((0.5, -2.0), (0.0, -1.0), True),  # the person walks away from it
        ((0.5, -2.0), (0.0, 0.0), True),
    ],
)
def test_a_robot_in_the_way_of_who_tells_it_to_wait_clears_the_path(place, velocity, stands):
    assert (act(Straight(), observation(WAIT, place, velocity)) == Twist()) is stands


def test_who_tells_the_robot_to_proceed_counts_as_standing():
    assert Timid().act(observation(PROCEED)) == Twist()
    assert act(Timid(), observation(PROCEED)).forward == pytest.approx(1.0)
    assert act(Timid(), observation(NONE)) == Twist()


def test_the_layer_is_a_navigator_and_names_the_one_inside():
    navigator = GestureLayer().around(Straight())
    check_navigator(navigator)
    assert navigator.title("cart") == "navigator Straight with gestures of robot 'cart'"


def test_gestures_reach_a_navigator_in_another_process():
    seen = observation(WAIT)
    again = decode_observation(encode_observation(seen))
    np.testing.assert_array_equal(again.people.gesture, [WAIT])
    assert again.people.gesture.dtype == np.int64


def test_a_batch_decides_as_each_environment():
    trial = load_trial("intersection-gesture-wait", **OBEY)
    simulation = Simulation(trial, seeds=range(3))
    layer = GestureLayer().around(ORCANavigator())
    told = 0
    for _ in range(8):
        for _ in range(20):
            simulation.advance()
        robot = simulation.robots[0]
        batch = robot.observations(simulation.around, np.arange(3))
        assert isinstance(batch, ObservationBatch)
        decisions = layer.decide_batch(batch, [None] * 3)
        for k in range(3):
            alone = batch.environment(k)
            assert Twist(*decisions.twist[k].tolist()) == layer.decide(alone, None)[0].twist
            told += int(WAIT in alone.people.gesture)
    assert told > 0


@pytest.mark.parametrize(("people", "known"), [("seen", True), ("true", True), ("tracked", False)])
def test_gestures_are_known_of_people_whose_true_states_are(people, known):
    simulation = Simulation(load_trial("intersection-gesture-wait", **{"robot/people": people}))
    told, shown = [], []
    for _ in range(140):
        simulation.advance()
        seen = simulation.robots[0].observation(simulation.around, 0)
        told.append(WAIT in seen.people.gesture)
        shown.append(WAIT in simulation.world.scene.memory["gesture"])
    assert np.any(shown)
    assert bool(np.any(told)) is known
    if known:  # a scan can be a few steps old
        assert np.sum(np.array(told) != np.array(shown)) <= 6


@pytest.mark.parametrize("navigator", ["straight", "orca"])
def test_an_obedient_robot_lets_the_person_pass_and_another_does_not(navigator):
    obeys = simulate(load_trial("intersection-gesture-wait", navigator=navigator, **OBEY), 0)
    ignores = simulate(load_trial("intersection-gesture-wait", navigator=navigator), 0)
    assert obeys.outcome == "success"
    assert episode_metrics(obeys, ["gestures"])["gesture_compliance"] > 0.95
    assert episode_metrics(ignores, ["gestures"])["gesture_compliance"] < 0.05
    crossing = [int(np.argmax(episode.position[:, 1, 0] > 0.0)) for episode in (obeys, ignores)]
    assert obeys.position[crossing[0], 0, 1] > 0.5
    assert ignores.position[crossing[1], 0, 1] < 0.0


def test_a_robot_that_is_told_to_proceed_goes_first():
    plain = load_trial("intersection-gesture-proceed")
    for navigator, gestures in ((Straight(), "ignore"), (Timid(), "obey")):
        robot = dataclasses.replace(plain.robots[0], navigator=navigator, gestures=gestures)
        episode = simulate(dataclasses.replace(plain, robots=(robot,)), 0)
        assert episode.outcome == "success"
        assert episode_metrics(episode, ["gestures"])["gesture_compliance"] == pytest.approx(1.0)
        passed = int(np.argmax(episode.position[:, 1, 0] > 0.0))
        assert episode.position[passed, 0, 1] < -2.0


def test_a_robot_that_stands_although_it_may_proceed_is_counted():
    plain = load_trial("intersection-gesture-proceed", duration=20)
    halting = dataclasses.replace(plain.robots[0], navigator=Halting())
    episode = simulate(dataclasses.replace(plain, robots=(halting,)), 0)
    assert episode_metrics(episode, ["gestures"])["gesture_compliance"] < 0.1


@pytest.mark.parametrize("name", ["intersection-gesture-wait", "intersection-gesture-proceed"])
def test_runs_are_recorded_and_replayed_and_equal_in_batches_and_after_a_restore(name, tmp_path):
    trial = load_trial(name, **OBEY)
    record(trial, seed=1, out=tmp_path)
    assert replay(tmp_path / "episode.mcap").equal
    alone = simulate(trial, 1)
    assert [simulate_seeds(trial, [0, 1])[1].digest] == [alone.digest]
    first, second = Simulation(trial, 1), Simulation(trial, 1)
    for _ in range(90):
        first.advance()
    restore_state(second, decode_state(encode_state(state_of(first))))
    for _ in range(60):
        first.advance()
        second.advance()
    assert encode_state(state_of(first)) == encode_state(state_of(second))


def test_the_safety_layer_is_around_that_of_gestures():
    trial = load_trial("intersection-gesture-wait", **OBEY)
    robot = dataclasses.replace(trial.robots[0], navigator=Straight(), safety=SafetyLayer(approach=0.0))
    assert robot.controller.title() == "navigator Straight with gestures with safety layer"
    episode = simulate(dataclasses.replace(trial, robots=(robot,)), 0)
    assert episode_metrics(episode, ["gestures"])["gesture_compliance"] > 0.9


def test_the_attribute_is_read_written_and_refused_where_it_says_nothing():
    trial = load_trial("intersection-gesture-wait", **OBEY)
    text = trial_xml(trial)
    assert 'gestures="obey"' in text
    assert parse_trial(text) == trial
    assert 'gestures="' not in trial_xml(load_trial("intersection-gesture-wait")).split("<robot")[1]
    for old, new, sentence in (
        ('gestures="obey"', 'gestures="follow"', 'gestures="follow" must be ignore or obey'),
        ('gestures="obey"', 'gestures="obey" people="tracked"', 'has gestures="obey" but people="tracked"'),
        ('<navigator type="orca"/>', '<navigator type="external"/>', "which decides nothing; leave it out"),
    ):
        assert old in text
        with pytest.raises(TrialError) as caught:
            parse_trial(text.replace(old, new))
        assert sentence in str(caught.value)
        assert "<robot>" in str(caught.value)
