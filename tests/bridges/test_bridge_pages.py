"""The pages of the transports: their commands, typed one after the other, drive a robot."""

from __future__ import annotations

import os
import sys

import pytest
from bridge_runs import wait
from page_runs import HOW_TO, PAGES, begin, count_commands, drive, end, follow_page, simulation_words
from partner_runs import number_of_orders
from test_join import start_robot
from test_naoqi import FakeRobot

from crowdbot.bridges import TRANSPORTS
from crowdbot.recording import read_episode, replay

ROOT = HOW_TO.parents[1]


@pytest.fixture(autouse=True)
def local(monkeypatch, tmp_path):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))


def test_every_transport_has_a_page():
    assert PAGES.keys() | {"simulated"} == TRANSPORTS.keys(), "a simulated robot has no program of its own"
    titles = [(HOW_TO / f"{page}.md").read_text(encoding="utf-8").partition("\n")[0] for page in PAGES.values()]
    assert [title for title in titles if not title.startswith("# Your robot in a crowd in five minutes: ")] == []


@pytest.mark.live
def test_the_program_of_the_page_of_foxglove_says_what_to_start_first(tmp_path):
    follow_page("foxglove", tmp_path)
    program = begin([sys.executable, "drive.py", "1"], tmp_path, os.environ)
    errors = program.communicate(timeout=60)[1]
    assert (program.returncode, "Traceback" in errors) == (1, False)
    assert "no server at ws://127.0.0.1:1: start crowdbot run TRIAL --bridge foxglove:1 first" in errors


@pytest.mark.live
@pytest.mark.parametrize(
    "transport", ["rosbridge", "ros2", *(pytest.param(item, marks=pytest.mark.sweep) for item in ("foxglove", "tcp"))]
)
def test_the_commands_of_a_page_drive_a_robot(transport, tmp_path):
    assert drive(transport, tmp_path) > 10


@pytest.mark.live
def test_the_commands_of_the_page_drive_a_robot_at_a_server_of_others(tmp_path):
    assert drive("rosbridge-client", tmp_path) > 10


def test_the_commands_of_the_page_of_ros1_drive_a_robot(ros1, tmp_path):
    assert drive("ros1", tmp_path) > 10


@pytest.mark.sweep
def test_the_commands_of_the_page_of_naoqi_move_the_virtual_robot(tmp_path):
    simulation, program = follow_page("naoqi", tmp_path)
    with FakeRobot("idle") as robot:
        first = begin(simulation_words(simulation, f"naoqi:{robot.url}"), tmp_path, os.environ)
        wait(lambda: (tmp_path / "driven").exists() or first.poll() is not None, 120.0)
        places = {program[1]: str(ROOT / program[1]), program[2]: robot.url}
        words = [places.get(item, item) for item in program[1:]]
        second = begin([sys.executable, *words], tmp_path, os.environ)
        wait(lambda: number_of_orders(tmp_path / "driven") > 20 or second.poll() is not None, 120.0, look=0.5)
        assert robot.ask()["place"][0] > 0.0
        second.kill()
        second.communicate()
        end(first)
    assert count_commands(tmp_path / "driven" / "episode.mcap") > 10


@pytest.mark.sweep
def test_the_first_command_of_the_page_of_join_moves_the_robot_of_the_trial(domain, tmp_path):
    simulation, _ = follow_page("join", tmp_path)
    words = simulation_words(simulation, f"ros2:{domain}")
    robot = start_robot("ros2", str(domain))
    process = begin(words, tmp_path, os.environ)
    wait(lambda: number_of_orders(tmp_path / "joined") > 10 or process.poll() is not None, 120.0, 0.5)
    end(process)
    robot.communicate(timeout=60)
    path = tmp_path / "joined" / "episode.mcap"
    assert len(read_episode(path).orders) > 10
    assert replay(path).equal
