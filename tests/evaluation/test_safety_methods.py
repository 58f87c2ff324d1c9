"""Methods with a safety layer: their names, and the robot that they make."""

import pytest

from crowdbot.core import InputError
from crowdbot.evaluation import parse_methods, with_safety
from crowdbot.trials import load_trial

FRONTAL = load_trial("frontal")


def test_both_forms_of_each_method_stand_in_order():
    names = [item.name for item in with_safety(parse_methods("own, orca safety=0.2, mpc+safety"))]
    assert names == ["own", "own+safety", "orca", "orca+safety", "mpc+safety"][:2] + [
        "orca safety=0.2",
        "orca+safety safety=0.2",
        "mpc+safety",
    ]


@pytest.mark.parametrize("text", ["own+safety", "orca+safety", "straight+safety speed=0.5"])
def test_the_robot_gets_the_layer_and_loses_it_again(text):
    (method,) = parse_methods(text)
    guarded = method.put_into(FRONTAL)
    assert guarded.robots[0].safety is not None
    free, again = with_safety(parse_methods(text.replace("+safety", "")))
    assert free.put_into(guarded).robots[0].safety is None
    assert again.put_into(FRONTAL).robots[0].safety == guarded.robots[0].safety


def test_a_layer_of_the_trial_keeps_its_numbers():
    trial = load_trial("frontal", **{"robot/safety/slow": 0.2})
    assert parse_methods("straight")[0].put_into(trial).robots[0].safety.slow == 0.2
    assert parse_methods("straight+safety")[0].put_into(trial).robots[0].safety.slow == 0.2


def test_one_method_is_not_there_twice():
    with pytest.raises(InputError, match="is there twice"):
        parse_methods("orca+safety, orca+safety")
