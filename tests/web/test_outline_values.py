"""Values, events and drawings of a robot that is not a disc are those of its outline."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from crowdbot.recording import read_episode, record
from crowdbot.simulation import Simulation
from crowdbot.trials import parse_trial
from crowdbot.web.scene import episode_events, episode_series
from crowdbot.web.simulator.live_values import live_values
from crowdbot.world import Robot

TEXT = """<trial name="passing" duration="0.4" world="planar">
  <stage><wall points="-5,{wall} 5,{wall}"/></stage><crowd type="orca"/>
  <agent name="p" x="{x}" y="{y}" radius="0.25" goal="{x},{y}" speed="0.5"/>
  <robot name="robot" type="cuybot" x="0" y="0"><goal x="0" y="0"/><navigator type="straight"/></robot>
</trial>
"""


@pytest.fixture(scope="module")
def robot() -> Robot:
    shape = Robot.load("cuybot")
    assert shape.outline is not None
    assert shape.half_width < 0.9 * shape.radius
    return shape


def test_live_values_measure_to_the_outline(robot: Robot) -> None:
    front = float(robot.outline[:, 0].max())
    values = live_values(Simulation(parse_trial(TEXT.format(wall=-1.0, x=2.0, y=0.0))))
    assert values["wall"] == pytest.approx(1.0 - robot.half_width, abs=1e-3)
    assert values["clearance"] == pytest.approx(2.0 - front - 0.25, abs=1e-3)


def test_a_person_beside_a_narrow_robot_is_as_near_as_the_outline(robot: Robot, tmp_path: Path) -> None:
    y = robot.radius + 0.02 + 0.25  # the person stands 0.02 m from the disc around the robot
    gap = robot.radius - robot.half_width + 0.02
    record(parse_trial(TEXT.format(wall=-3.0, x=0.0, y=y)), 0, tmp_path / "e.mcap")
    episode = read_episode(tmp_path / "e.mcap")
    assert episode_series(episode)["clearance"][0] == pytest.approx(gap, abs=1e-3)
    passes = [event for event in episode_events(episode) if event.kind == "near miss"]
    assert [event.about for event in passes] == [f"the robot passes person 0 at {gap:.2f} m"]


def test_a_drawing_shows_the_outline(robot: Robot) -> None:
    drawing = Simulation(parse_trial(TEXT.format(wall=-3.0, x=2.0, y=0.0)))._repr_svg_()
    assert drawing.count("<circle") == 1
    longest = max(re.findall(r'<path d="([^"]*)"', drawing), key=len)
    assert longest.count(",") == len(robot.outline) + 1


def test_a_robot_that_is_passed_has_its_name(robot: Robot, tmp_path: Path) -> None:
    y = robot.half_width + robot.radius + 0.1
    two = TEXT.format(wall=-3.0, x=-4.0, y=0.0).replace('<goal x="0" y="0"/>', '<goal x="4" y="0"/>')
    second = (
        f'<robot name="second" type="cuybot" x="0" y="{y}"><goal x="4" y="{y}"/><navigator type="straight"/></robot>'
    )
    two = two.replace("</trial>", f"{second}</trial>")
    record(parse_trial(two), 0, tmp_path / "e.mcap")
    passes = [event.about for event in episode_events(read_episode(tmp_path / "e.mcap")) if event.kind == "near miss"]
    assert [about.split(" at ")[0] for about in passes] == ["robot 1 passes robot 2", "robot 2 passes robot 1"]
