"""A robot whose outline fits a door, but not its disc, goes through it with every navigator that follows a path."""

import numpy as np
import pytest

from crowdbot.navigation import PathPlanner
from crowdbot.simulation import simulate
from crowdbot.trials import parse_trial

URDF = """<robot name="mir"><link name="base_link">
<inertial><origin xyz="0 0 0.2"/><mass value="70"/><inertia ixx="2" iyy="5" izz="6" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 0.2"/><geometry><box size="0.89 0.58 0.35"/></geometry></collision></link></robot>"""
ROBOT = """<robot name="mir" urdf="mir.urdf" base="planar">
<drive type="differential-drive" max-speed="1" max-turn-rate="1.5" max-acceleration="1" max-turn-acceleration="3"/>
</robot>"""
TRIAL = """<trial name="door" duration="60"><stage walkable="-5,-4 5,-4 5,4 -5,4">
<wall points="0,-4 0,-0.475"/><wall points="0,0.475 0,4"/></stage><crowd type="orca"/>
<robot type="mir" x="-3.5" y="2" heading="0"><goal x="3.5" y="-1.5" tolerance="0.3"/><navigator type="{navigator}"/>
<planner/></robot></trial>"""
NAVIGATORS = [
    "orca-navigator", "dynamic-window-navigator", "mpc-navigator", "social-force-navigator",
    "potential-field-navigator", "time-elastic-band-navigator", "rds-navigator\" margin=\"0.1", "policy-navigator",
]  # fmt: skip


@pytest.fixture(scope="module")
def mir(tmp_path_factory):
    folder = tmp_path_factory.mktemp("robots") / "mir"
    folder.mkdir()
    (folder / "mir.urdf").write_text(URDF, encoding="utf-8")
    (folder / "robot.xml").write_text(ROBOT, encoding="utf-8")
    return folder


@pytest.mark.parametrize("navigator", NAVIGATORS)
def test_a_mir100_passes_a_door_of_95_cm(mir, navigator, monkeypatch):
    monkeypatch.chdir(mir.parent)
    trial = parse_trial(TRIAL.format(navigator=navigator))
    assert 2.0 * trial.robots[0].radius > 1.0
    metrics = simulate(trial, 0).metrics
    assert metrics["success"] == 1.0
    assert 0.0 < metrics["min_wall_clearance"] < 0.2


def test_paths_of_a_disc_and_of_an_outline(mir, monkeypatch):
    """The disc has no path; the outline passes the door, and where the disc has a path, it takes that."""
    monkeypatch.chdir(mir.parent)
    door = parse_trial(TRIAL.format(navigator="straight")).stage.as_walls()
    planner = PathPlanner.of(door, 0.54, 0.1, half_width=0.29)
    path = planner.waypoints((-3.0, 2.0), (3.0, 2.0))
    gap = np.hypot(path[:-1, 0], np.abs(path[:-1, 1]) - 0.475)
    assert 0.39 - 1e-6 <= gap.min() < 0.5
    wall = [[(0.0, -4.0), (0.0, 0.0)]]
    wide, outline = PathPlanner.of(wall, 0.54), PathPlanner.of(wall, 0.54, half_width=0.29)
    np.testing.assert_array_equal(
        wide.waypoints((-3.0, -1.0), (3.0, -1.0)), outline.waypoints((-3.0, -1.0), (3.0, -1.0))
    )
    starts, goals = np.array([[-3.0, 2.0], [-3.0, 1.0]]), np.array([[3.0, -2.0], [-4.0, 1.0]])
    both = planner.next_waypoints(starts, goals)
    assert not both.failures
    again = planner.next_waypoints(starts, goals, both.path)
    np.testing.assert_array_equal(both.point, again.point)
