"""check_robot accepts robots that drive ahead and carry their sensors, and says what others do."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import pytest

from crowdbot.core import InputError, Pose, Twist
from crowdbot.world import DifferentialDrive, Drive, Robot, Twists, builtin_robots, check_robot, integrate_twist


@dataclass(frozen=True)
class Turned(Drive):
    """Drives ahead, backwards, sideways or not at all, whatever the command."""

    ahead: float
    left: float
    max_speed: float = 1.0

    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
        after = Twists.of(Twist(self.ahead, 0.0, left=self.left), len(pose.heading))
        return integrate_twist(pose, after, dt), after


@pytest.mark.parametrize("name", sorted(builtin_robots()))
def test_robots_of_the_package_pass(name: str) -> None:
    assert check_robot(Robot.load(name)) is None


@pytest.mark.parametrize(("ahead", "left"), [(0.5, 0.0), (0.1, 0.0), (0.5, 0.049), (0.5, -0.049)])
def test_a_robot_that_goes_ahead_passes(ahead: float, left: float) -> None:
    assert check_robot(dataclasses.replace(Robot.load("turtlebot2"), drive=Turned(ahead, left))) is None


@pytest.mark.parametrize(("ahead", "left"), [(0.0, 0.0), (-0.5, 0.0), (0.51, 0.0), (0.5, 0.06), (0.5, -0.06)])
def test_a_robot_that_does_not_go_ahead_is_told_where_it_is(ahead: float, left: float) -> None:
    with pytest.raises(InputError, match=rf"after 5 s forward at 0.5 m/s, the position is x = {5.0 * ahead:.3f}, y = "):
        check_robot(dataclasses.replace(Robot.load("turtlebot2"), drive=Turned(ahead, left)))


def test_a_late_robot_passes() -> None:
    late = dataclasses.replace(Robot.load("turtlebot2"), drive=DifferentialDrive(), latency=0.5)
    assert check_robot(late) is None


@pytest.mark.parametrize(
    ("x", "z", "is_on"), [(0.3, 0.0, True), (3.0, 0.0, False), (0.0, -0.5, False), (-3.0, 0.0, False)]
)
def test_sensors_sit_on_the_robot(x: float, z: float, is_on: bool) -> None:
    robot = next(Robot.load(name) for name in sorted(builtin_robots()) if Robot.load(name).mounts)
    mount = dataclasses.replace(robot.mounts[0], link=robot.model.root, x=x, y=0.0, z=z)
    moved = dataclasses.replace(robot, mounts=(mount,))
    if is_on:
        assert check_robot(moved) is None
    else:
        with pytest.raises(InputError, match=f"the sensor '{mount.name}' is not on the robot: x, y, z = "):
            check_robot(moved)
