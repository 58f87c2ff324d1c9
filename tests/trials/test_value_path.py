"""Value paths: one language for ``--set``, sweeps, branches and Python."""

from __future__ import annotations

import pytest

from crowdbot.core import Element, InputError, TrialError
from crowdbot.models import ORCA, Boids
from crowdbot.navigation import Straight
from crowdbot.trials import Trial, apply_values, load_trial, parse_trial
from crowdbot.trials.value_path import set_value, set_values

TEXT = """<trial name="paths" duration="5">
  <crowd type="orca" time-horizon="3" max-neighbors="4"/>
  <spawner name="left" count="1" zone="-6,-6 -4,-6 -4,-4" goal="4,4 6,4 6,6"/>
  <spawner count="2" zone="-6,4 -4,4 -4,6" goal="4,-4 6,-4 6,-6"/>
  <robot x="0" y="0" control-period="0.2"><goal x="9" y="0"/><drive type="differential-drive" max-speed="1"/>
    <navigator type="orca" speed="0.7"/></robot>
  <robot name="second" x="0" y="3"><goal x="9" y="3"/><drive type="velocity-servo"/><navigator type="straight"/></robot>
</trial>"""


@pytest.fixture(scope="module")
def trial() -> Trial:
    return parse_trial(TEXT)


def value(path: str, root: Element) -> str:
    """Return the attribute at ``tag number attribute``."""
    tag, number, word = path.split()
    return [child for child in root.children if child.tag == tag][int(number)].attributes[word]


def tree() -> Element:
    robots = [Element("robot", {"x": "0"}), Element("robot", {"name": "tim", "x": "1"})]
    spawners = [Element("spawner", {"count": "1"}), Element("spawner", {"count": "2", "name": "1"})]
    return Element("trial", {}, [Element("crowd", {"type": "orca", "time-horizon": "2"}), *robots, *spawners])


@pytest.mark.parametrize(
    ("path", "where"),
    [
        ("robot[robot]/x", "robot 0 x"),  # the name that is a default
        ("robot[tim]/x", "robot 1 x"),
        ("robot[1]/x", "robot 0 x"),  # numbers begin at 1
        ("robot[2]/x", "robot 1 x"),
        ("robot[2].x", "robot 1 x"),
        ("/robot[tim]/x/", "robot 1 x"),
        ("spawner[1]/count", "spawner 1 count"),  # a name comes before a number
        ("spawner[2]/count", "spawner 1 count"),
        ("crowd/time_horizon", "crowd 0 time-horizon"),
        ("crowd.time-horizon", "crowd 0 time-horizon"),
        ("robot[tim]/default_sensors", "robot 1 default-sensors"),
    ],
)
def test_a_path_leads_to_one_attribute(path: str, where: str) -> None:
    root = tree()
    set_value(root, Trial, path, "7")
    assert value(where, root) == "7"


@pytest.mark.parametrize(
    ("path", "sentence"),
    [
        ("robot/x", "is not clear: <trial> has 2 <robot>; choose one: robot[robot], robot[tim]"),
        ("spawner/count", "choose one: spawner[1], spawner[1]"),
        ("robot[tom]/x", "does not exist: no <robot> has the name 'tom', did you mean 'tim'?"),
        ("robot[0]/x", "does not exist: there are 2 <robot>, numbered from 1"),
        ("robot[3]/x", "does not exist: there are 2 <robot>, numbered from 1"),
        ("source[1]/rate", "does not exist: there are 0 <source>, numbered from 1"),
        ("source/rate", "does not exist: there are 0 <source>"),
        ("robt[1]/x", "does not exist: <trial> has no element 'robt[1]', did you mean 'robot'?"),
        ("robot[tim]/hight", "names no attribute: <robot> has no 'hight', did you mean 'height'?"),
        ("durations", "names no attribute: <trial> has no 'durations', did you mean 'duration'?"),
        ("robot[tim]/qqq", "names no attribute: <robot> has no 'qqq'; it takes name, type, "),
        ("qqq/x", "does not exist: <trial> has no element 'qqq'; it has "),
        ("robot[tim]/", "is not a path; write elements and an attribute"),
        ("", "is not a path; write elements and an attribute, such as robot[NAME]/goal/x"),
        ("robot[tim]//x", "does not exist: <robot> has no element ''"),
        ("robot[[tim]]/x", "does not exist: <trial> has no element 'robot[[tim]]'"),
    ],
)
def test_a_path_that_leads_nowhere_says_what_there_is(path: str, sentence: str) -> None:
    with pytest.raises(InputError) as found:
        set_value(tree(), Trial, path, "7")
    assert sentence in str(found.value)
    assert "did you mean" not in sentence or str(found.value) == sentence


def test_names_may_hold_dots_and_slashes() -> None:
    root = tree()
    root.children[1].attributes["name"] = "a.b"
    root.children[2].attributes["name"] = "c/d"
    set_values(root, Trial, {"robot[a.b].x": "3", "robot[c/d]/x": "4"})
    assert (value("robot 0 x", root), value("robot 1 x", root)) == ("3", "4")


def test_a_new_type_drops_the_old_parameters_and_comes_first(trial: Trial) -> None:
    assert apply_values(trial, {"crowd/type": "boids"}).crowd == Boids()
    for order in (("crowd/goal-gain", "crowd/type"), ("crowd/type", "crowd/goal-gain")):
        both = {"crowd/type": "boids", "crowd/goal-gain": 5.25}
        changed = apply_values(trial, {path: both[path] for path in order})
        assert changed.crowd == Boids(goal_gain=5.25)
    same = apply_values(trial, {"crowd/type": "orca", "crowd/max-neighbors": 6})
    assert same.crowd == ORCA(time_horizon=3, max_neighbors=6)  # the same type keeps its parameters


def test_dots_and_slashes_mix(trial: Trial) -> None:
    assert apply_values(trial, {"robot[1]/goal.x": 2.5}).robots[0].goal.x == 2.5


def test_a_robot_is_set_by_the_name_that_is_its_default(trial: Trial) -> None:
    changed = apply_values(trial, {"robot[robot]/navigator/speed": 0.4, "robot[1].control_period": 0.1})
    assert changed.robots[0].navigator.speed == 0.4  # type: ignore[attr-defined]
    assert changed.robots[0].control_period == 0.1
    assert changed.robots[1] == trial.robots[1]
    straight = apply_values(trial, {"robot[robot]/navigator/type": "straight"})
    assert straight.robots[0].navigator == Straight()


def test_an_element_that_is_missing_is_made() -> None:
    root = tree()
    set_values(root, Trial, {"robot[tim]/navigator/speed": "0.5", "robot[tim]/navigator/type": "straight"})
    navigator = next(child for child in root.children[2].children if child.tag == "navigator")
    assert navigator.attributes == {"type": "straight", "speed": "0.5"}


def test_a_message_names_the_path_and_the_value_is_checked(trial: Trial) -> None:
    with pytest.raises(TrialError, match=r'paths: "crowd/robot/x" does not exist: <crowd> has no element'):
        apply_values(trial, {"crowd/robot/x": 1})
    with pytest.raises(TrialError, match=r'<trial> duration="-1" must be above 0 s'):
        apply_values(trial, {"duration": -1})
    with pytest.raises(TrialError, match="has no attribute 'time-horizon'"):
        apply_values(trial, {"crowd/type": "boids", "crowd/time-horizon": 3})
    assert load_trial("crossing-flows", **{"crowd/type": "boids"}).crowd == Boids()
