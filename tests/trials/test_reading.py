"""Trial files: what is read, every kind of mistake with its sentence, and XML -> Trial -> XML."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, TrialError
from crowdbot.models import ORCA
from crowdbot.navigation import Straight
from crowdbot.recording import run
from crowdbot.sensors import Gaussian, Lidar2D
from crowdbot.trials import (
    Camera,
    Cube,
    Distribution,
    End,
    Light,
    Mount,
    Obstacle,
    Planner,
    RecordingSpec,
    RobotGoal,
    RobotSpec,
    Spawner,
    Stage,
    Table,
    Trial,
    Wall,
    builtin_trials,
    check_trial,
    load_trial,
    parse_trial,
    trial_xml,
)
from crowdbot.world import DifferentialDrive
from trial_texts import GOOD, SHY, changed, written


def test_a_good_file_is_the_tree() -> None:
    trial = parse_trial(GOOD)
    assert (trial.name, trial.duration, trial.step, trial.seed, trial.people) == ("small", 4.0, 0.05, 3, 4)
    assert trial.stage.obstacles[0].points == ((0.0, 1.5), (1.0, 1.5), (1.0, 2.5), (0.0, 2.5))
    assert trial.crowd == ORCA(time_horizon=2.0)
    assert trial.spawners[1].speed == Distribution("uniform", (1.0, 1.4))
    robot = trial.robots[0]
    assert (robot.position, robot.goal.position, robot.visible) == ((-2.0, -2.4), (3.0, -2.4), True)
    assert robot.drive == DifferentialDrive(max_speed=1.0)
    assert robot.navigator == Straight()
    assert robot.sensors[0].sensor == Lidar2D(rays=90, noise=Gaussian(0.01))
    assert (robot.sensors[0].name, robot.sensors[0].x) == ("scan", 0.1)
    assert trial.end == End(goal=True, collision=False)
    assert trial.recording == RecordingSpec(period=0.1)


def test_reading_what_was_written_gives_the_same_trial() -> None:
    for trial in (parse_trial(GOOD), *(load_trial(name) for name in builtin_trials())):
        text = trial_xml(trial)
        assert parse_trial(text) == trial
        assert trial_xml(parse_trial(text)) == text


numbers = st.floats(-50.0, 50.0, allow_nan=False)
words = st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc")), max_size=12)


@st.composite
def trials(draw: st.DrawFn) -> Trial:
    """Make trials that are possible."""
    corner = draw(st.tuples(numbers, numbers))
    zone = [corner, (corner[0] + 3.0, corner[1]), (corner[0], corner[1] + 3.0)]
    low = draw(st.floats(0.1, 1.0))
    distribution = draw(
        st.sampled_from([f"uniform({low!r}, 2.5)", f"normal(1.5, {low / 4!r})", repr(low), "normal(1, 0.5, 0.3, 2)"])
    )
    robot = RobotSpec(
        name=draw(st.from_regex(r"\A[A-Za-z][A-Za-z0-9_]{0,6}\Z")),
        x=draw(numbers),
        y=draw(numbers),
        visible=draw(st.booleans()),
        deadline=draw(st.none() | st.floats(0.001, 1.0)),
        tracks=draw(st.none() | st.floats(0.1, 9.0)),
        ghost=(ghost := draw(st.booleans())),
        planner=draw(st.none() | st.builds(Planner, st.floats(0.0, 1.0))),
        goal=RobotGoal(draw(numbers), draw(numbers), draw(st.floats(0.1, 2.0))),
        drive=DifferentialDrive(max_speed=draw(st.floats(0.1, 3.0))),
        navigator=Straight(),
        sensors=[Mount(sensor=Lidar2D(rays=draw(st.integers(1, 99)), noise=(Gaussian(low),)), heading=draw(numbers))],
    )
    typed = RobotSpec(
        name=draw(st.from_regex(r"\A[A-Za-z][A-Za-z0-9_]{0,6}\Z")),
        type=draw(st.sampled_from(["pepper", "turtlebot2", "qolo"])),
        sensor_rates="nearest",
        default_sensors=(equipped := draw(st.booleans())),
        cameras=equipped and draw(st.booleans()),
        x=draw(numbers),
        y=draw(numbers),
        goal=RobotGoal(draw(numbers), draw(numbers)),
        latency=draw(st.none() | st.floats(0.0, 1.0)),
        radius=draw(st.none() | st.floats(0.1, 1.0)),
        drive=draw(st.none() | st.just(DifferentialDrive(max_speed=low))),
        navigator=Straight(),
        sensors=[Mount(name="mine", sensor=Lidar2D(), z=draw(st.none() | numbers), pitch=low, link="base_link")],
    )
    return Trial(
        name=draw(st.from_regex(r"\A[a-z&<\"' ]{0,8}x\Z").map(lambda text: text.strip())),
        about=draw(words),
        duration=draw(st.floats(0.1, 100.0)),
        seed=draw(st.integers(-(2**53), 2**53)),
        crowd=ORCA(time_horizon=draw(st.floats(0.1, 9.0))),
        stage=Stage(
            walkable=draw(st.sampled_from([(), [(-99, -99), (99, -99), (99, 99), (-99, 99)]])),
            walls=[Wall([(corner[0], 60.0 + 1e-9), (0.1, 77)])],
            obstacles=[Obstacle([(60, 60), (60 + low, 60), (60, 61)])],
            props=draw(st.sampled_from([(), (Table(x=70, y=-70, length=1.0 + low), Cube(x=80, y=-70, fixed=True))])),
            lights=[Light(x=corner[0], y=0.0, brightness=low)],
        ),
        cameras=[
            Camera(name="look", x=corner[0], heading=corner[1], field_of_view=low, width=draw(st.integers(16, 99)))
        ],
        world="planar" if ghost else draw(st.sampled_from(["planar", "physics"])),
        bodies=draw(st.sampled_from([None, "discs", "limbs", "skins"])),
        spawners=[
            Spawner(
                count=draw(st.integers(0, 3)),
                zone=zone,
                goal=zone,
                speed=distribution,
                body=draw(st.sampled_from(["", "child man-20", "mannequin"])),
                activity=draw(st.sampled_from(["", "talk", "walk  phone"])),
            )
        ],
        robots=draw(st.sampled_from([[], [robot], [typed]])),
        end=End(draw(st.booleans()), draw(st.booleans())),
    )


@settings(max_examples=40, deadline=None)
@given(trials())
def test_any_trial_survives_the_way_through_xml(trial: Trial) -> None:
    text = trial_xml(trial)
    assert parse_trial(text) == trial
    assert trial_xml(parse_trial(text)) == text


MISTAKES = {
    "misspelt attribute of a sensor": (
        'rays="90"',
        'rais="90"',
        r":14: <sensor> has no attribute 'rais', did you mean 'rays'\?; it takes .*heading",
    ),
    "radius that can be negative": (
        'radius="0.25"',
        'radius="normal(0.2, 0.1)"',
        r"must be above 0 m and at most 5 m, and it ranges from -0.1 to 0.5",
    ),
    "nan point": ("-5,-2 -3,-2", "nan,-2 -3,-2", r":8: <spawner> zone=.* has the point 'nan,-2', which is not finite"),
    "wrong choice": (
        'name="west"',
        'name="west" arrival="leaves"',
        r'arrival="leaves" must be leave or stay, did you mean .leave.\?',
    ),
    "noise": ("gaussian(0.01)", "gausian(0.01)", r":14: <sensor> .*unknown noise 'gausian'.*did you mean 'gaussian'"),
    "zone in an obstacle": (
        "-5,-2 -3,-2 -3,1 -5,1",
        "0.2,1.7 0.8,1.7 0.8,2.3",
        r":8: <spawner> spawn zone lies inside obstacle 1 of the stage; it is not accessible",
    ),
    "zone in a wall": (
        "-5,-2 -3,-2 -3,1 -5,1",
        "-5,2.85 5,2.85 5,2.95 -5,2.95",
        r":8: <spawner> spawn zone of 1.00 m2 leaves no room for a single body beside walls",
    ),
    "robot near a wall": (
        'y="-2.4" radius',
        'y="-2.8" radius',
        r":10: <robot> starts 0.20 m from a wall",
    ),
    "goal out of reach": ('<goal x="3" y="-2.4"', '<goal x="30" y="0"', r":10: <robot> has its goal at 30,0 outside"),
    "name of a robot": ('robot name="robot"', 'robot name="my robot"', r':10: <robot> name="my robot" must match'),
    "holonomic": (
        'x="-2" y',
        'x="-2" holonomic="true" y',
        r':10: <robot> has holonomic="true" but its drive cannot move sideways; take <drive type="omnidirectional"/>',
    ),
    "deadline": ('x="-2" y', 'x="-2" deadline="0" y', r':10: <robot> deadline="0" must be above 0 s'),
    "wrong root": ("<trial ", "<simulation ", r"mismatched tag"),
    "no XML": ("<stage ", "<stage <", r":3: this is not well-formed XML: not well-formed"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_named_with_its_line(mistake: str, tmp_path: Path) -> None:
    old, new, sentence = MISTAKES[mistake]
    path = written(tmp_path / "in", changed(old, new))
    with pytest.raises(TrialError) as found:
        run(load_trial(path), out=tmp_path / "out")
    assert re.search(sentence, str(found.value)), str(found.value)
    assert all(problem.startswith(f"{path}:") for problem in found.value.problems)
    assert len(found.value.problems) == 1
    assert not (tmp_path / "out").exists()


def test_all_mistakes_are_said_at_once_in_the_order_of_the_lines() -> None:
    text = GOOD
    for old, new in (
        ('duration="4"', 'duration="-4"'),
        ('type="orca"', 'type="orka"'),
        ('radius="0.25"', 'radius="-0.25"'),
        ('rays="90"', 'rais="90" rate="7x"'),
        ("<end ", "<finish/><end "),
    ):
        assert old in text
        text = text.replace(old, new)
    with pytest.raises(TrialError) as found:
        parse_trial(text, place="t.xml")
    lines = [int(re.match(r"t\.xml:(\d+): ", problem)[1]) for problem in found.value.problems]  # type: ignore[index]
    assert lines == sorted(lines)
    assert lines == [2, 7, 9, 14, 14, 16], found.value.problems


HIDDEN = """<trial name="bad">
  <stage area="no.wkt" map="no.yaml" wall-height="-1"/>
  <crowd type="orca" time-horizon="-1" nosuch="1"/>
  <agent x="1" y="1" body="womn man" speed="-1"/>
  <spawner count="-1" zone="0,0 1,0 1,1" goal="0,0 1,0 1,1"/>
  <recorded data="none.txt" mode="reactiv"/>
  <robot type="peper" x="2" y="2" radius="-1">
    <goal x="3" y="2"/>
    <sensor type="lidar2d" rays="-4" range-max="-1" rate="x"/>
  </robot>
</trial>
"""


def test_no_wrong_value_hides_another_in_its_element(tmp_path: Path) -> None:
    with pytest.raises(TrialError) as found:
        parse_trial(HIDDEN, place="t.xml", folder=tmp_path)
    said = str(found.value)
    for line, part in (
        (1, "needs the attribute 'duration'"),
        (2, 'wall-height="-1" must be at least 0.001 m and at most 100 m'),
        (3, "no attribute 'nosuch'"),
        (3, "time_horizon = -1.0"),
        (4, 'speed="-1" must be'),
        (5, 'count="-1" must be at least 0'),
        (6, "did you mean 'reactive'?"),
        (7, 'radius="-1"'),
        (7, "needs the element <navigator>"),
        (9, "rate: 'x' is not a number"),
    ):
        assert re.search(rf"^t\.xml:{line}: <\w+> .*{re.escape(part)}", said, re.MULTILINE), (line, part, said)
    assert len(found.value.problems) == 10, said


def test_two_robots_must_not_overlap_nor_share_a_name() -> None:
    text = GOOD.replace("<end ", GOOD[GOOD.index("<robot") : GOOD.index("<end")] + "<end ")
    with pytest.raises(TrialError, match="name 'robot' is already used by another robot"):
        parse_trial(text)
    with pytest.raises(TrialError, match=r"starts 0.00 m from robot 'other'"):
        parse_trial(text.replace('robot name="robot"', 'robot name="other"', 1))


def test_a_trial_made_in_python_is_checked_too() -> None:
    zone = [(0, 0), (1, 0), (1, 1)]
    with pytest.raises(InputError, match=r'Spawner: radius="-0.2" must be above 0 m'):
        Spawner(count=1, zone=zone, goal=zone, radius=-0.2)
    with pytest.raises(InputError, match="Spawner: zone=.* must be at least 3 different points"):
        Spawner(count=1, zone=[(0, 0), (1, 1)], goal=zone)
    with pytest.raises(InputError, match="drive is a Straight, it must be a Drive"):
        RobotSpec(x=0, y=0, goal=RobotGoal(1, 1), drive=Straight(), navigator=Straight())  # type: ignore[arg-type]
    trial = Trial(name="full", duration=1, crowd=ORCA(), spawners=[Spawner(name="s", count=99, zone=zone, goal=zone)])
    with pytest.raises(TrialError, match=r"trial 'full': spawner 's' only \d+ of 99 people fit"):
        check_trial(trial)
    with pytest.raises(TrialError, match="fit"):
        run(trial)


def test_what_xml_cannot_hold_is_refused() -> None:
    with pytest.raises(InputError, match="holds a character that XML cannot hold"):
        Trial(name="bell\x07", duration=1, crowd=ORCA())
    import numpy as np

    trial = Trial(name="each", duration=1, crowd=ORCA(time_horizon=np.array([1.0, 2.0])))
    with pytest.raises(InputError, match=r"time-horizon = .* cannot be written as an attribute"):
        trial_xml(trial)


def test_code_comes_from_the_folder_of_the_trial_only(tmp_path: Path) -> None:
    (tmp_path / "shy.py").write_text(SHY)
    inside = written(tmp_path, changed('type="straight"', 'type="shy.py:Shy" space="0.7"'))
    trial = load_trial(inside)
    assert trial.robots[0].navigator.space == 0.7  # type: ignore[attr-defined]
    assert 'type="shy.py:Shy" space="0.7"' in trial_xml(trial)
    outside = written(tmp_path / "deep", changed('type="straight"', 'type="../shy.py:Shy"'))
    with pytest.raises(TrialError, match=r":13: <navigator> the file '../shy.py' lies outside .*--trust"):
        load_trial(outside)
    trusted = load_trial(outside, trust=True)
    assert 'type="../shy.py:Shy"' in trial_xml(trusted)
    with pytest.raises(TrialError, match=r"the module 'os' is not loaded from here; pass --trust"):
        parse_trial(changed('type="straight"', 'type="os:Shy"'))


def test_a_trial_is_found_by_name_or_says_what_there_is(tmp_path: Path) -> None:
    assert load_trial("crossing-flows").name == "crossing-flows"
    assert dataclasses.replace(load_trial("frontal"), seed=5).seed == 5
    with pytest.raises(TrialError, match=r"there is no trial 'crossing-flow', did you mean 'crossing-flows'\?"):
        load_trial("crossing-flow")
    with pytest.raises(TrialError, match=r"there is no trial file .*missing\.xml$"):
        load_trial(tmp_path / "missing.xml")
    with pytest.raises(TrialError, match="is not a file"):
        load_trial(tmp_path)
    with pytest.raises(TrialError, match=r"empty\.xml is empty; a trial is an XML file"):
        load_trial(written(tmp_path, "", "empty.xml"))
    with pytest.raises(TrialError, match=r":1: the root element is <world>, it must be <trial>"):
        load_trial(written(tmp_path, "<world/>", "world.xml"))
