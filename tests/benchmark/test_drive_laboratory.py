"""The drive laboratory: traces, manoeuvres, figures, and the bars of the robots that ship."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

import crowdbot
from crowdbot.benchmark import (
    DRIVE_BARS,
    DriveFigures,
    DriveTrace,
    Manoeuvre,
    compare_traces,
    manoeuvres,
    measure_drives,
    speed_grid,
    trace_physics,
    trace_planar,
)
from crowdbot.benchmark.drives.traces import TraceStore, drive_runs
from crowdbot.cli import main
from crowdbot.core import InputError, Scene, Twist
from crowdbot.models import ORCA
from crowdbot.world import AckermannDrive, Omnidirectional, PlanarWorld, Robot, builtin_robots
from samples import sample

STEP = 0.01
ROBOTS = Path(crowdbot.__file__).parent / "assets" / "robots"


def test_a_planar_trace_is_the_planar_world():
    """With latency, the trace equals what PlanarWorld does in an empty hall."""
    robot = Robot.load("turtlebot2")
    commands = [Twist(0.5, 1.0)] * 50 + [Twist()] * 50
    trace = trace_planar(robot, commands, STEP)
    scene = Scene.of([[0.0, 0.0]], heading=[0.0], external=[True], radius=[robot.radius])
    world = PlanarWorld(scene, ORCA(), {0: robot.drive}, dt=STEP, latency={0: robot.latency})
    for k, command in enumerate(commands):
        for _ in range(2):
            world.step({0: command})
        np.testing.assert_allclose(trace.position[k], world.scene.position[0, 0], atol=1e-12)
    assert trace.heading[-1] == pytest.approx(0.0 + np.sum(trace.twist[:, 2]) * 0.02, abs=0.02)


def test_headings_of_traces_do_not_jump():
    trace = trace_physics(Robot.load("differential"), [Twist(0.0, 1.5)] * 300, STEP)
    assert trace.heading[-1] > 2.0 * math.pi
    assert np.abs(np.diff(trace.heading)).max() < 0.05


def test_figures_of_made_up_motions():
    robot = Robot.load("differential")  # 1 m/s, 1.5 rad/s, 1 m/s2, 3 rad/s2
    first = Manoeuvre("grid", (Twist(1.0, 0.0),) * 150 + (Twist(),) * 100, 150)
    plane = trace_planar(robot, first.commands, STEP)
    fast = plane._replace(twist=plane.twist * 1.1)
    found = compare_traces(robot.drive, first, fast, plane)
    assert found.overshoot == pytest.approx(0.1)
    assert found.steady_error == pytest.approx(0.1)
    assert found.acceleration == pytest.approx(1.1)
    away = plane._replace(position=plane.position + [0.0, 0.25], heading=plane.heading + 0.5, tilt=plane.tilt + 0.6)
    found = compare_traces(robot.drive, first, away, plane)
    assert found.path_error == pytest.approx(0.25 / 3.0, rel=0.05)
    assert found.heading_error == pytest.approx(0.5)
    assert found.fallen
    assert found.stop_distance == pytest.approx(0.495)
    assert compare_traces(robot.drive, first, plane, plane) == dataclasses.replace(
        DriveFigures(), acceleration=pytest.approx(1.0), stop_distance=pytest.approx(0.495)
    )


def test_the_grid_holds_what_a_drive_can_do():
    grid = speed_grid(Omnidirectional(max_speed=0.5))
    assert any(twist.left for twist in grid)
    assert all(twist.forward != 0.0 for twist in speed_grid(AckermannDrive()))
    names = [manoeuvre.name for manoeuvre in manoeuvres(Robot.load("pepper"))]
    assert names.count("grid") == 26
    assert names[-5:] == ["straight", "ramp", "sine", "weave", "slip"]


@pytest.mark.parametrize("step", sample([0.005, 0.01], 1))
@pytest.mark.parametrize("name", builtin_robots())
def test_shipped_robots_are_within_the_bars(name, step):
    """At full speed, full turn rate and both; the command measures the whole grid at 2, 5 and 10 ms."""
    report = measure_drives([name], steps=[step], quick=True)
    for row in report.rows:
        assert row.failures == ()
        assert {bar: getattr(row.grid, bar) <= most for bar, most in DRIVE_BARS.items()} == dict.fromkeys(
            DRIVE_BARS, True
        )
        assert row.others["straight"].heading_change < 0.01
        assert row.grid.stop_error < 0.02


def test_qolo_keeps_its_wheels_on_the_floor():
    """Asked for 1.5 m/s and 2.06 rad/s, it spun out; its drive now limits the turn rate at this speed."""
    robot = Robot.load("qolo")
    trace = trace_physics(robot, [Twist(1.5, 2.06)] * 150, 0.005)
    assert trace.twist[-1, 0] == pytest.approx(1.5, rel=0.01)
    assert trace.twist[-1, 2] == pytest.approx(1.0 / 1.5, rel=0.01)
    assert trace.tilt.max() < 0.01


def test_the_command_prints_a_table_or_json(capsys, tmp_path):
    assert main(["bench", "drives", "--robot", "differential", "--quick", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["rows"][0]["robot"] == "differential"
    assert document["rows"][0]["failures"] == []
    assert document["bars"] == dict(DRIVE_BARS)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["bench", "drives", "environments"], "is measured alone"),
        (["bench", "--robot", "qolo"], "--robot, --makers and --keep belong to crowdbot bench drives"),
        (["bench", "drives", "--quick", "--robot", "qolo", "--makers", "no.urdf"], "there is no URDF file no.urdf"),
        (["bench", "drives", "--robot", "turtlebot9"], "there is no robot 'turtlebot9'"),
    ],
)
def test_wrong_options_are_told(words, says, capsys):
    assert main(words) != 0
    assert says in capsys.readouterr().err


def test_a_step_must_divide_a_sample():
    robot = Robot.load("differential")
    for step in (0.003, 0.0, 0.05, -0.01):
        with pytest.raises(InputError, match=r"0.02 s must be a whole number of steps"):
            trace_planar(robot, [Twist()], step)
        with pytest.raises(InputError, match=r"0.02 s must be a whole number of steps"):
            trace_physics(robot, [Twist()], step)
    assert isinstance(trace_planar(robot, [Twist()], 0.02), DriveTrace)


def test_a_measurement_continues_from_its_files(tmp_path):
    """Motions that are kept are not measured again; those of other commands are, and broken files."""
    robot = Robot.load("differential")
    chosen, calls = manoeuvres(robot, quick=True)[:1], []

    def measure(*asked):
        calls.append(asked[2])
        return drive_runs(*asked)

    store = TraceStore(tmp_path)
    first = store.runs(robot, 0.02, chosen, measure)
    again = store.runs(robot, 0.02, chosen, measure)
    assert len(calls) == 1
    assert all(np.array_equal(a, b) for a, b in zip(first[0][1], again[0][1], strict=True))
    store.runs(robot, 0.02, manoeuvres(robot, quick=True)[2:3], measure)
    assert len(calls) == 2
    for file in tmp_path.iterdir():
        file.write_bytes(file.read_bytes()[:100])
    store.runs(robot, 0.02, chosen, measure)
    assert len(calls) == 3
