"""Colour cameras of the robots that ship: a trial has them only when it asks, for they are drawn."""

import re
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.navigation import Straight
from crowdbot.recording import run
from crowdbot.sensors import RGBCamera
from crowdbot.trials import RobotGoal, RobotSpec, parse_trial

CAMERAS = {
    "cuybot": ["camera"],
    "pepper": ["camera_top", "camera_bottom"],
    "qolo": ["color_front"],
    "turtlebot2": ["kinect_rgb"],
}


def made(name: str, **more: object) -> RobotSpec:
    """Return a robot of a type."""
    return RobotSpec(type=name, x=0, y=0, goal=RobotGoal(5, 0), navigator=Straight(), sensor_rates="nearest", **more)


def cameras(robot: RobotSpec) -> list[str]:
    """Return the names of its colour cameras."""
    return [mount.name for mount in robot.sensors if isinstance(mount.sensor, RGBCamera)]


@pytest.mark.parametrize("name", CAMERAS)
def test_cameras_of_a_type_come_when_they_are_asked_for(name: str) -> None:
    plain, asked = made(name), made(name, cameras=True)
    assert cameras(plain) == []
    assert cameras(asked) == CAMERAS[name]
    assert [mount for mount in asked.sensors if mount.name not in CAMERAS[name]] == list(plain.sensors)


def test_who_asks_for_cameras_that_are_not_there_is_told() -> None:
    for name, more in (("wheelchair", {}), ("pepper", {"default_sensors": False})):
        with pytest.raises(InputError, match=re.escape('has cameras="true" but no such cameras: it needs a type with')):
            made(name, cameras=True, **more)


TRIAL = """<trial name="look" duration="0.2" step="0.1" seed="1" {world}>
  <agent x="2" y="0.3" goal="-3,0"/>
  <agent x="3" y="-0.5" goal="-3,0"/>
  <robot type="cuybot" sensor-rates="nearest" {cameras} x="0" y="0">
    <goal x="5" y="0"/>
    <navigator type="straight"/>
  </robot>
  <crowd type="orca"/>
  <recording period="0.1"/>
</trial>"""


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("world", ["", 'world="physics"'])
def test_a_trial_that_asks_has_pictures_and_one_that_does_not_draws_nothing(
    world: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked = run(parse_trial(TRIAL.format(world=world, cameras='cameras="true"')))
    pictures = asked.readings["robot/camera"]
    assert len(pictures) == 3
    assert {picture.rgb.shape for picture in pictures} == {(1, 240, 480, 3)}  # type: ignore[attr-defined]
    assert all(np.ptp(picture.rgb) > 100 for picture in pictures)  # type: ignore[attr-defined]

    def refuse(*args: object, **more: object) -> None:
        raise AssertionError("nothing is to be drawn")

    monkeypatch.setattr("crowdbot.world.rendering.renderer.Renderer.render", refuse)
    plain = run(parse_trial(TRIAL.format(world=world, cameras="")))
    assert "robot/camera" not in plain.readings
    assert set(asked.readings) - set(plain.readings) == {"robot/camera"}
    np.testing.assert_array_equal(plain.position, asked.position)
