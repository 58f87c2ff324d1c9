"""The safety layer: separation after ISO 13855, fields, stop and restart, in runs, batches, replays and branches."""

import math

import numpy as np
import pytest

from crowdbot.core import InputError, Twist, Walls
from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods, with_safety
from crowdbot.navigation import (
    DriveLimits,
    Observation,
    SafetyLayer,
    SafetyState,
    Straight,
    VisiblePeople,
    check_navigator,
)
from crowdbot.recording import branch, record, replay
from crowdbot.simulation import simulate, simulate_seeds
from crowdbot.trials import RobotGoal, RobotSpec, load_trial, parse_trial, trial_xml
from crowdbot.world import DifferentialDrive

LAYER = SafetyLayer(approach=1.6, response=0.1, intrusion=0.1, deceleration=1.0, restart=1.0)
GUARDED = parse_methods("straight+safety")[0]


def seen(gap, angle=0.0, time=0.0, **changes):
    """Return what a robot knows with a person at a clearance and an angle."""
    away = gap + 0.3 + 0.25
    place = np.array([[away * math.cos(angle), away * math.sin(angle)]])
    known = {"pose": (0.0, 0.0, 0.0), "goal": (9.0, 0.0), "radius": 0.3, "limits": DriveLimits(1.0, 1.5), "dt": 0.1}
    known |= {"people": VisiblePeople(place, np.zeros((1, 2)), np.full(1, 0.25)), "time": time}
    return Observation(**(known | changes))


@pytest.mark.parametrize("speed", [0.0, 0.2, 0.7, 1.5])
def test_separation_is_that_of_the_standard(speed):
    stop = 0.1 + speed / 1.0
    assert LAYER.separation(speed) == pytest.approx(1.6 * stop + speed * 0.1 + speed**2 / 2.0 + 0.1)
    assert LAYER.speed_at(LAYER.separation(speed)) == pytest.approx(speed, abs=1e-12)
    assert LAYER.speed_at(LAYER.separation(0.0) - 0.01) < 0.0


@pytest.mark.parametrize("gap", [0.3, 0.6, 1.0, 1.7, 3.0, 9.0])
@pytest.mark.parametrize("angle", [0.0, 1.2, math.pi])
def test_the_speed_keeps_the_separation_in_every_direction(gap, angle):
    twist, state = LAYER.limit(seen(gap, angle), Twist(1.0, 0.4), SafetyState(None))
    assert state.stopped == (gap < LAYER.separation(0.0))
    assert 0.0 <= twist.forward <= 1.0
    if not state.stopped:
        assert LAYER.separation(twist.forward) <= gap + 1e-9
        assert twist.turn == pytest.approx(0.4 * twist.forward)
    if gap == 9.0:
        assert twist == Twist(1.0, 0.4)


def test_the_fields_count_only_what_is_ahead():
    layer = SafetyLayer(approach=0.0, warning=0.5, slow=0.3)
    length = layer.stopping_length(1.0)
    ahead = seen(length - 0.01)
    assert layer.limit(ahead, Twist(1.0), SafetyState(None))[0] == Twist()
    assert layer.limit(seen(length + 0.2), Twist(1.0), SafetyState(None))[0].forward == pytest.approx(0.3)
    assert layer.limit(seen(length + 0.6), Twist(1.0), SafetyState(None))[0].forward == 1.0
    for angle in (math.pi / 2.0, math.pi):
        assert layer.limit(seen(0.2, angle), Twist(1.0), SafetyState(None))[0].forward == 1.0
    sideways = seen(0.2, math.pi / 2.0)
    assert layer.limit(sideways, Twist(0.0, 0.0, 1.0), SafetyState(None))[0] == Twist()


def test_walls_are_in_the_fields_of_a_robot_without_scanner():
    wall = Walls.of([[(0.5, -3.0), (0.5, 3.0)]])
    free = seen(9.0, walls=wall)
    assert LAYER.limit(free, Twist(1.0), SafetyState(None))[1].stopped


def test_after_a_stop_the_robot_waits_until_the_field_was_clear():
    state = SafetyState(None)
    times = []
    for k in range(30):
        gap = 0.2 if 3 <= k < 6 else 9.0
        twist, state = LAYER.limit(seen(gap, time=0.1 * k), Twist(1.0), state)
        times += [k] if twist.forward == 0.0 else []
    assert times == list(range(3, 15))


def test_a_wrapped_navigator_keeps_the_contract():
    check_navigator(LAYER.around(Straight()))


@pytest.mark.parametrize("name", ["response", "slow", "deceleration", "restart"])
def test_a_wrong_number_is_explained(name):
    with pytest.raises(InputError, match=f'SafetyLayer: {name}="-1.0" must be'):
        SafetyLayer(**{name: -1.0})


def test_a_trial_has_the_layer_and_keeps_it_in_xml():
    trial = GUARDED.put_into(load_trial("frontal"))
    assert trial.robots[0].safety == SafetyLayer()
    assert parse_trial(trial_xml(trial)) == trial
    assert load_trial("frontal", **{"robot/safety/slow": 0.2}).robots[0].safety == SafetyLayer(slow=0.2)


def test_an_external_robot_has_no_layer():
    from crowdbot.navigation import ExternalNavigator

    with pytest.raises(InputError, match="has <safety> in addition"):
        RobotSpec(
            x=0.0, y=0.0, goal=RobotGoal(1.0, 0.0), drive=DifferentialDrive(), navigator=ExternalNavigator(),
            safety=SafetyLayer(),
        )  # fmt: skip


@pytest.mark.parametrize("name", ["orca", "mpc"])
def test_runs_are_equal_in_batches_and_alone(name):
    trial = parse_methods(f"{name}+safety")[0].put_into(load_trial("circle-crossing", duration=4.0))
    together = simulate_seeds(trial, range(3))
    assert [item.digest for item in together] == [simulate(trial, seed).digest for seed in range(3)]


def test_a_recording_replays_and_branches(tmp_path):
    trial = GUARDED.put_into(load_trial("frontal", duration=8.0))
    first = record(trial, out=tmp_path / "first")
    assert "no_keyframes" not in str(first)
    assert replay(tmp_path / "first" / "episode.mcap").equal
    assert branch(tmp_path / "first" / "episode.mcap", at=6.0).digest == first.digest


def test_the_layer_prevents_contacts_at_speed_and_costs_time():
    trial = load_trial("circle-crossing", duration=40.0)
    plan = EvaluationPlan([trial], with_safety(parse_methods("straight")), seeds=range(6))
    free, guarded = evaluate(plan).cells
    assert (free.method, guarded.method) == ("straight", "straight+safety")
    assert guarded.protocol["safety"]
    assert not free.protocol["safety"]
    assert free.values("robot_caused_contacts").sum() > guarded.values("robot_caused_contacts").sum()
