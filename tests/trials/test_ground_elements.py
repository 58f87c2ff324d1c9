"""Elements of the stage for uneven ground and doors: reading, writing, checks."""

from __future__ import annotations

import pytest

from crowdbot.core import InputError, TrialError
from crowdbot.trials import (
    Door,
    Platform,
    Ramp,
    Stage,
    Stairs,
    Threshold,
    check_trial,
    parse_trial,
    trial_remarks,
    trial_xml,
)

TEXT = """<trial name="t" duration="5" world="{world}">
  <stage walkable="-2,-3 12,-3 12,3 -2,3">
    <threshold x="1" y="0" width="6" height="{sill}"/>
    <ramp x="4" y="0" length="2" width="{width}" height="0.16"/>
    <platform x="6" y="0" length="2" width="{width}" height="0.16"/>
    <stairs x="7.29" y="0" heading="3.141592653589793" steps="2" tread="0.29" rise="0.08" width="{width}"/>
    <door name="hall" points="9,-3 9,3" opening="schedule" times="1 3"/>
  </stage>
  <routing/>
  <crowd type="orca"/>
  <agent x="0" y="1" goal="8,1"/>
  <robot name="bot" type="{robot}" x="0" y="0"><goal x="{goal}" y="0"/>{planner}<navigator type="straight"/></robot>
</trial>
"""


def _text(**values: object) -> bytes:
    usual = {"world": "physics", "width": 2, "robot": "cuybot", "goal": 8, "planner": "", "sill": 0.01}
    return TEXT.format(**{**usual, **values}).encode()


def test_a_trial_with_ground_and_doors_is_written_as_it_is_read() -> None:
    trial = parse_trial(_text())
    assert [type(item) for item in trial.stage.ground] == [Threshold, Ramp, Platform, Stairs]
    assert parse_trial(trial_xml(trial).encode()) == trial
    assert trial.stage.physical().doors[0].switches == (1.0, 3.0)


def test_the_planar_world_refuses_uneven_ground_in_a_sentence() -> None:
    with pytest.raises(TrialError) as caught:
        parse_trial(_text(world="planar"))
    (problem,) = caught.value.problems
    assert "which only the physics world has" in problem


def test_the_planar_world_takes_doors() -> None:
    text = _text(world="planar").decode().splitlines()
    rest = [
        line for line in text if not any(f"<{word} " in line for word in ("threshold", "ramp", "platform", "stairs"))
    ]
    assert parse_trial("\n".join(rest).encode()).stage.doors[0].name == "hall"


def test_a_robot_is_told_what_it_cannot_pass() -> None:
    assert not any("straight way" in remark for remark in trial_remarks(parse_trial(_text(goal=3))))
    (told,) = [
        remark for remark in trial_remarks(parse_trial(_text(goal=3, sill=0.02, robot="turtlebot2"))) if "way" in remark
    ]
    assert "passes steps up to 1.2 cm and slopes up to 12 %" in told
    (told,) = [remark for remark in trial_remarks(parse_trial(_text(goal=3, robot="pepper"))) if "way" in remark]
    assert "its base is pulled along the floor" in told


def test_a_planner_drives_around_stairs_or_says_that_it_cannot() -> None:
    trial = parse_trial(_text(goal=8.3, planner='<planner margin="0.05"/>'))
    (robot,) = trial.robots
    planner = robot.stage_planner(trial.stage)
    assert planner is not None
    points = planner.waypoints((0.0, 0.0), (8.3, 0.0))
    assert len(points) > 1  # around the stairs at x = 7 to 7.6
    assert abs(points[:, 1]).max() > 1.0
    with pytest.raises(TrialError, match="no path to its goal"):
        parse_trial(_text(width=6, goal=8.3, planner='<planner margin="0.05"/>'))


def test_people_take_stairs_but_no_cliffs() -> None:
    low = Stage(ground=(Platform(x=0, y=0, length=2, width=2, height=0.16),), walkable=[(-5, -5), (5, -5), (5, 5)])
    high = Stage(ground=(Platform(x=0, y=0, length=2, width=2, height=0.5),), walkable=[(-5, -5), (5, -5), (5, 5)])
    assert len(low.walking_walls()) == len(low.as_walls())
    assert len(high.walking_walls()) > len(high.as_walls())


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ({"points": [(0, 0)]}, "points"),
        ({"opening": "schedule"}, "needs times"),
        ({"times": "3"}, "times need opening"),
        ({"opening": "schedule", "times": "3 2"}, "must increase"),
        ({"opening": "push", "kind": "sliding"}, "hinged"),
        ({"angle": 0.0}, "angle must not be 0"),
    ],
)
def test_wrong_doors_are_refused(words: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        Door(**({"name": "d", "points": [(0, 0), (1, 0)]} | words))  # type: ignore[arg-type]


def test_names_of_doors_differ() -> None:
    doors = '<door name="hall" points="9,-3 9,3"/><door name="hall" points="8,-3 8,3"/>'
    text = _text().replace(b'<door name="hall" points="9,-3 9,3" opening="schedule" times="1 3"/>', doors.encode())
    with pytest.raises(TrialError, match="already used"):
        parse_trial(text)


def test_a_bevel_makes_slopes_at_both_edges() -> None:
    plain, slanted = Threshold(x=0, y=0, depth=0.1), Threshold(x=0, y=0, depth=0.1, bevel=0.03)
    assert (len(plain.parts()), len(slanted.parts())) == (1, 3)
    stage = Stage(ground=(slanted,))
    ground = stage.physical().ground
    assert ground is not None
    assert ground.height([[-0.05, 0], [-0.035, 0], [0, 0], [0.035, 0], [0.06, 0]]).tolist() == pytest.approx(
        [0.0, 0.01, 0.02, 0.01, 0.0], abs=1e-9
    )


def test_a_trial_made_in_python_is_checked_too() -> None:
    trial = parse_trial(_text())
    check_trial(trial)
    assert trial.stage.physical().ground is not None
