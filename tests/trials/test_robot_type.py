"""The type of a robot brings its body, drive and sensors, whatever the way it is named."""

import contextlib
import logging

import pytest

from crowdbot.cli import main
from crowdbot.evaluation import EvaluationPlan, parse_methods
from crowdbot.recording import record
from crowdbot.simulation import simulate
from crowdbot.trials import apply_values, describe_robot, load_trial, override_remarks, parse_trial, trial_xml

URDF = """<robot name="mybot"><link name="base_link"><inertial><mass value="20"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><cylinder radius="0.2" length="0.5"/></geometry></collision></link></robot>"""
ROBOT = """<robot name="mybot" urdf="mybot.urdf"><footprint radius="0.2"/>
<drive type="differential-drive" max-speed="1.9"/><sensor name="front" type="lidar-2d" rays="90" rate="10"/></robot>"""
XML = """<trial name="hall" duration="6"><stage/><crowd type="orca"/><agent x="3" y="0.2" goal="-6,0"/>
<robot type="mybot" x="-3" y="0"><goal x="6" y="0"/><navigator type="orca"/>{parts}</robot></trial>"""
OTHER = '<drive type="differential-drive" max-speed="0.7"/><sensor type="lidar2d"/>'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The working folder, with a robot of its own."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mybot").mkdir()
    (tmp_path / "mybot" / "robot.xml").write_text(ROBOT, encoding="utf-8")
    (tmp_path / "mybot" / "mybot.urdf").write_text(URDF, encoding="utf-8")
    return tmp_path


def test_every_way_to_name_a_robot_gives_the_same_run(folder):
    """A value, the plan of an evaluation and the file all give the robot of the folder."""
    values = {"duration": 6.0, "robot/navigator/type": "straight"}
    trial = load_trial("doorway", values)
    named = apply_values(trial, {"robot/type": "mybot"})
    (cell,) = EvaluationPlan([trial], parse_methods("straight"), ["mybot"], [3]).cells
    written = parse_trial(trial_xml(named), folder=folder)
    trials = [named, cell.variant, written, load_trial("doorway", values | {"robot/type": "mybot"})]
    assert {trial.robots[0].drive.max_speed for trial in trials} == {1.9}
    assert {mount.name for trial in trials for mount in trial.robots[0].sensors} == {"front"}
    assert {trial.robots[0].radius for trial in trials} == {0.2}
    assert len({simulate(trial, 3).digest for trial in trials}) == 1


def test_values_beside_a_new_type_override_it(folder):
    named = load_trial("doorway", {"robot/type": "mybot", "robot/radius": 0.25, "robot/latency": 0.1})
    assert (named.robots[0].radius, named.robots[0].latency) == (0.25, 0.1)
    assert describe_robot(named.robots[0]).endswith("the trial overrides radius (mybot: 0.2 m), latency (mybot: 0 s)")


def test_the_parts_of_the_replaced_robot_are_logged(folder, caplog):
    caplog.set_level(logging.INFO, logger="crowdbot")
    load_trial("doorway", {"robot/type": "mybot"})
    (line,) = [record.getMessage() for record in caplog.records if "becomes" in record.getMessage()]
    assert line.startswith("robot 'robot' becomes mybot, with its own drive and sensors instead of <drive type=")


@pytest.mark.parametrize(
    "words",
    [
        ["evaluate", "doorway", "--robots", "nosuch"],
        ["evaluate", "doorway", "--robots", "mybot,nosuch"],
        ["evaluate", "doorway", "--set", "robot/type=nosuch"],
        ["falsify", "doorway", "--robots", "nosuch"],
        ["run", "doorway", "--set", "robot/type=nosuch"],
    ],
)
def test_an_unknown_robot_is_an_error_without_remarks(folder, capsys, words):
    assert main(words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert 'type="nosuch" is not a robot' in line


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["evaluate", "two-way", "--robots", "nosuch"], 'type="nosuch" is not a robot'),
        (["evaluate", "two-way", "--navigators", "nosuch"], "unknown navigator 'nosuch'"),
        (["falsify", "two-way", "--robots", "nosuch"], 'type="nosuch" is not a robot'),
        (["run", "two-way", "--variant", "2"], "--variant 2: two-way has no variants"),
        (["render", "two-way", "--variant", "2"], "--variant 2: two-way has no variants"),
    ],
)
def test_an_error_after_a_robot_was_replaced_stands_alone(folder, capsys, words, error):
    assert main([*words, "--set", "robot/type=pepper"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert error in line


def test_a_trial_overrides_its_own_robot_and_says_what(folder):
    trial = parse_trial(XML.format(parts=OTHER), folder=folder)
    assert trial.robots[0].drive.max_speed == 0.7
    (remark,) = override_remarks(trial.robots)
    assert remark == (
        "robot 'robot' is mybot: differential-drive, at most 0.7 m/s, radius 0.2 m, sensors front (lidar2d), scan"
        " (lidar2d); the trial overrides drive (mybot: differential-drive, at most 1.9 m/s), sensor scan (added)"
    )
    assert not override_remarks(parse_trial(XML.format(parts=""), folder=folder).robots)


@pytest.mark.parametrize("way", [["--set", "robot/type=mybot"], ["--robots", "mybot"]])
def test_a_search_for_failures_takes_the_robot_of_both_options(folder, capsys, way):
    """Its failures run again from their own folder, without the working folder."""
    words = ["--runs", "4", "--search", "plain", "--failure", "min-clearance>9", "--set", "duration=2", "--keep", "1"]
    words += ["--over", "agent[1]/speed=uniform(0.8, 1.4)"]
    assert main(["falsify", "doorway", *way, *words, "--out", "out"]) == 0
    printed = capsys.readouterr().err
    assert "crowdbot: robot 'robot' is mybot: differential-drive, at most 1.9 m/s" in printed
    assert printed.count("becomes mybot") == 1
    with contextlib.chdir("out/found"):
        assert load_trial("1.xml").robots[0].drive.max_speed == 1.9
    (folder / "mybot" / "robot.xml").unlink()
    trial = load_trial("out/found/1.xml")
    assert [mount.name for mount in trial.robots[0].sensors] == ["front"]
    assert simulate(trial).steps > 0


def test_a_search_takes_one_robot(folder, capsys):
    assert main(["falsify", "doorway", "--robots", "mybot,pepper", "--runs", "2"]) == 2
    assert "--robots 'mybot,pepper' names 2 robots; give one" in capsys.readouterr().err


def test_a_recording_of_a_built_in_trial_names_its_robot_with_the_folder(folder):
    """It replays in another folder, from the files in the recording."""
    trial = load_trial("doorway", {"robot/type": "mybot", "duration": 1.0})
    done = record(trial, 1, folder / "elsewhere" / "episode.mcap")
    (folder / "mybot" / "robot.xml").unlink()
    assert main(["replay", str(done.path)]) == 0


def test_the_line_of_a_robot_says_that_its_shape_is_replaced(folder, capsys):
    text = URDF.replace('<cylinder radius="0.2" length="0.5"/>', '<mesh filename="body.stl"/>')
    (folder / "mybot" / "mybot.urdf").write_text(text, encoding="utf-8")
    assert main(["run", "doorway", "--set", "robot/type=mybot", "--set", "duration=0.2"]) == 0
    (line,) = [line for line in capsys.readouterr().err.splitlines() if " is mybot: " in line]
    wanted = "; meshes of a link are missing or broken and replaced by other shapes, see crowdbot check mybot"
    assert line.endswith(wanted)
    assert main(["check", "mybot"]) == 0
    assert "the mesh file body.stl is missing; for contacts, " in capsys.readouterr().out


def test_a_type_of_the_command_line_lies_in_the_working_folder(folder, capsys):
    """``--set robot/type`` and ``--robots`` name the same folder, wherever the trial file is."""
    assert main(["new", "navigator", "mine.py"]) == 0
    (folder / "halls").mkdir()
    text = XML.format(parts="").replace('type="mybot"', 'type="cuybot"')
    (folder / "halls" / "hall.xml").write_text(text, encoding="utf-8")
    values = ["--set", "robot/type=mybot", "--set", "robot/navigator/type=mine.py:Mine", "--set", "duration=0.2"]
    for words in (["run", "halls/hall.xml"], ["check", "halls/hall.xml"]):
        assert main([*words, *values]) == 0
        shown = capsys.readouterr()
        assert "at most 1.9 m/s, radius 0.2 m, sensors front (lidar2d)" in shown.out + shown.err
    assert main(["run", "halls/hall.xml", "--set", "robot/type=yourbot"]) == 2
    (folder / "mybot").rename(folder / "halls" / "mybot")  # not in the working folder: beside the trial
    assert main(["run", "halls/hall.xml", *values]) == 0


@pytest.mark.parametrize("value", ["stage/map=../hall.yaml", "robot/navigator/type=../mine.py:Mine"])
def test_a_type_of_the_working_folder_allows_no_other_value_outside_of_the_folder_of_the_trial(folder, capsys, value):
    assert main(["new", "navigator", "mine.py"]) == 0
    (folder / "halls").mkdir()
    (folder / "halls" / "hall.xml").write_text(XML.format(parts="").replace('"mybot"', '"cuybot"'), encoding="utf-8")
    (folder / "hall.yaml").write_text("image: hall.pgm\n", encoding="utf-8")
    words = ["run", "halls/hall.xml", "--set", "robot/type=mybot", "--set", value]
    capsys.readouterr()
    assert main(words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "lies outside" in line
    assert "--trust" in line
    if value.startswith("robot"):
        assert main([*words, "--set", "duration=0.2", "--trust"]) == 0


@pytest.mark.parametrize(("name", "hint"), [("mybto", ", did you mean 'mybot'?"), ("nothing-like-it", "")])
def test_check_names_the_robot_that_was_meant(folder, capsys, name, hint):
    assert main(["check", name]) == 2
    wanted = f"there is no trial, experiment, robot, file or folder {name!r}{hint}\n{name}: 1 error\n"
    assert capsys.readouterr().out == wanted


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("mybot/robot.xml", 'type="mybot/robot.xml" is a file of a robot folder; give the folder: mybot'),
        ("mybot/mybot.urdf", "make the folder with crowdbot new robot mybot/mybot.urdf, and give its name"),
    ],
)
def test_a_file_instead_of_a_robot_folder_is_refused_with_what_to_give(folder, capsys, name, words):
    (folder / "hall.xml").write_text(XML.format(parts="").replace('"mybot"', f'"{name}"'), encoding="utf-8")
    for command in (
        ["run", "frontal", "--set", f"robot/type={name}"],
        ["evaluate", "frontal", "--robots", name],
        ["falsify", "frontal", "--robots", name],
        ["check", "hall.xml"],
    ):
        assert main(command) in (1, 2), command
        text = capsys.readouterr()
        assert words in text.err + text.out, command
