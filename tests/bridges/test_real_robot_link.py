"""RealRobotLink: a robot that drives itself, several robots, drivers, and the simulated base."""

from __future__ import annotations

import dataclasses
import math

import pytest
from bridge_runs import MemoryTransport

from crowdbot.bridges import RealRobotLink, SimulatedRobot, open_real_robot, steered_trial
from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.navigation import RealRobotNavigator
from crowdbot.recording import read_episode, replay
from crowdbot.simulation import Simulation, VelocityOrder
from crowdbot.trials import load_trial, parse_trial, trial_xml


def real_trial(navigator, **changes):
    trial = load_trial("frontal", duration=1.0)
    return dataclasses.replace(trial, robots=(dataclasses.replace(trial.robots[0], navigator=navigator, **changes),))


def test_a_robot_that_drives_itself_tells_its_velocity():
    navigator = RealRobotNavigator(bridge="naoqi:192.168.0.2", odometry="")
    trial = real_trial(navigator)
    assert trial.robots[0].mirror is None
    transport, simulation = MemoryTransport(), Simulation(trial, 0)
    simulation.begin()
    link = RealRobotLink(navigator, "robot", simulation, [transport])
    assert link.orders(simulation) == []
    transport.inbox.receive("/robot/cmd_vel", {"linear": {"x": 0.3}}, "naoqi")
    orders = link.orders(simulation)
    assert orders == [VelocityOrder(robot="robot", forward=0.3, source="naoqi")]
    assert link.hold(True, "the operator") == "robot 'robot' drives itself: stop it at itself"
    link.close()
    link.close()
    assert transport.stopped == 1


def test_two_robots_need_two_connections_and_drivers_must_decide():
    simulation = Simulation(real_trial(RealRobotNavigator()), 0)
    with pytest.raises(InputError, match="'a', 'b' have the same bridge 'simulated'"):
        open_real_robot(RealRobotNavigator(), ["a", "b"], simulation)
    for navigator, message in (
        (RealRobotNavigator(driver="folower"), "did you mean 'follower'"),
        (RealRobotNavigator(driver="rosbridge"), "'rosbridge' decides nothing"),
        (RealRobotNavigator(driver="straight", parameters="spped=1"), "spped"),
        (RealRobotNavigator(bridge="simulated:7", area="-1,-1,1,1"), "has no address"),
        (RealRobotNavigator(area="1,2"), "must be x0,y0,x1,y1"),
    ):
        with pytest.raises(InputError, match=message):
            open_real_robot(navigator, ["robot"], simulation)


def test_the_xml_has_the_navigator_and_no_pose_and_a_bridge_takes_its_place():
    trial = real_trial(RealRobotNavigator(driver="follower", parameters="distance=1.5"))
    text = trial_xml(trial)
    assert "<pose" not in text
    assert parse_trial(text).robots == trial.robots
    assert trial.robots[0].mirror.source == "external"
    assert steered_trial(trial).robots[0].mirror is None


def test_the_simulated_base_integrates_commands_and_stops_without_them():
    base = SimulatedRobot()
    base._twist, base._heard = (0.5, 0.0, math.pi / 2), 7.0
    for _ in range(100):
        base.pose = base._moved(0.01, 7.2)
    radius = 0.5 / (math.pi / 2)  # a quarter of a circle
    assert base.pose == pytest.approx((radius, radius, math.pi / 2), abs=1e-3)
    assert base._moved(1.0, 7.6) == base.pose


def test_the_command_run_waits_for_real_time_and_join_rehearses(tmp_path, capsys):
    file = tmp_path / "real.xml"
    file.write_text(trial_xml(real_trial(RealRobotNavigator(driver="straight", parameters="speed=0.4"))))
    assert main(["run", str(file), "--out", str(tmp_path / "a")]) == 0
    path = read_episode(tmp_path / "a" / "episode.mcap")
    moved = path.position[-1, path.robots[0]] - path.position[0, path.robots[0]]
    assert 0.05 < moved[0] < 0.4  # 0.2 m in 1 s of real time; nothing, had the run been faster than its robot
    assert replay(tmp_path / "a" / "episode.mcap").equal
    words = ["join", "frontal", "--area=-9,-9,9,9", "--bridge", "simulated", "--set", "duration=1"]
    assert main(words) == 0
    assert "poses of the robot, age median" in capsys.readouterr().err
