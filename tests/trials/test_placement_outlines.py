"""Checks of starts and goals of robots with an outline: to people, to other robots and to walls."""

import pytest

from crowdbot.core import TrialError
from crowdbot.simulation import simulate
from crowdbot.trials import parse_trial

TRIAL = """<trial name="t" duration="0.2"><stage>{walls}</stage><crowd type="orca"/>{people}
<robot type="cuybot" x="0" y="0" heading="{heading}"><goal x="5" y="{goal}"/><navigator type="straight"/></robot>{more}
</trial>"""
SECOND = (
    '<robot name="other" type="{kind}" x="0" y="{y}"{more}><goal x="5" y="{y}"/><navigator type="straight"/></robot>'
)
WALL = '<wall points="-5,{y} 9,{y}"/>'
"""The cuybot is 0.573 m long and 0.532 m wide: its outline ends 0.266 m beside its centre, its disc 0.391 m."""


def problem_of(walls="", people="", heading=0.0, goal=0.0, more=""):
    try:
        parse_trial(TRIAL.format(walls=walls, people=people, heading=heading, goal=goal, more=more))
    except TrialError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(("y", "word"), [(0.47, ""), (0.46, "stands at 0,0.46 and overlaps a person or a robot")])
def test_a_person_may_stand_in_the_disc_of_a_robot_beside_its_outline(y, word):
    assert word in problem_of(people=f'<agent x="0" y="{y}" radius="0.2"/>')
    assert bool(word) == bool(problem_of(people=f'<agent x="0" y="{y}" radius="0.2"/>'))


def test_people_who_overlap_each_other_are_refused_as_before():
    people = '<agent x="3" y="0" radius="0.2"/><agent x="3" y="0.3" radius="0.2"/>'
    assert "stands at 3,0.3 and overlaps a person or a robot" in problem_of(people=people)


def test_two_robots_may_stand_side_by_side_within_their_discs():
    assert problem_of(more=SECOND.format(kind="cuybot", y=0.54, more="")) == ""
    overlap = problem_of(more=SECOND.format(kind="cuybot", y=0.5, more=""))
    assert "starts 0.50 m from robot 'robot', and their outlines overlap by 0.03 m" in overlap
    turned = problem_of(more=SECOND.format(kind="cuybot", y=0.54, more=' heading="0.785"'))
    assert "and their outlines overlap by 0.12 m" in turned


def test_a_robot_beside_a_disc_is_measured_by_its_outline_too():
    disc = (
        '<robot name="other" radius="0.3" x="0" y="{y}"><goal x="5" y="3"/><navigator type="straight"/>'
        '<drive type="differential-drive"/></robot>'
    )
    assert problem_of(more=disc.format(y=0.57)) == ""
    assert "their outlines overlap by 0.02 m" in problem_of(more=disc.format(y=0.55))


def test_a_robot_starts_beside_a_wall_nearer_than_its_radius():
    assert problem_of(walls=WALL.format(y=0.27)) == ""
    turned = problem_of(walls=WALL.format(y=0.3), heading=0.785)
    assert "starts 0.30 m from a wall, and its outline reaches 0.09 m into it; move or turn it" in turned


def test_a_goal_needs_room_for_the_outline_in_some_pose():
    assert problem_of(walls=WALL.format(y=2.0), goal=1.98) == ""  # 0.3 m before the goal is near enough
    near = TRIAL.replace('y="{goal}"/>', 'y="{goal}" tolerance="0.05"/>')
    with pytest.raises(TrialError, match=r"has its goal 0.20 m from a wall, and its outline needs 0.27 m in any pose"):
        parse_trial(near.format(walls=WALL.format(y=2.0), people="", heading=0, goal=1.8, more=""))
    parse_trial(near.format(walls=WALL.format(y=2.0), people="", heading=0, goal=1.77, more=""))


def test_a_start_within_the_disc_is_no_contact():
    trial = parse_trial(
        TRIAL.format(
            walls=WALL.format(y=-0.3), people='<agent x="0" y="0.5" radius="0.2"/>', heading=0, goal=0,
            more=SECOND.format(kind="cuybot", y=1.25, more=""),
        )
    )  # fmt: skip
    episode = simulate(trial, 0)
    assert episode.outcome == "timeout"
    assert episode.metrics["min_clearance"] == pytest.approx(0.034, abs=0.02)
    assert episode.metrics["min_wall_clearance"] == pytest.approx(0.034, abs=0.02)
