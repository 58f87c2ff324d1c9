"""Live fed by messages of ROS: people in any frame, odometry and transforms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.messages import Messages
from crowdbot.prediction import ConstantVelocity, Kalman, Live

MAKE = Messages()
BASE = "robot/base_link"


def nanoseconds(time: float) -> int:
    return round(time * 1e9)


def people(time: float, frame: str, **places: Sequence[float]) -> Any:
    """Return people_msgs/People; names are prefixed by ``p``."""
    persons = [
        MAKE.make(
            "people_msgs/msg/Person", name=name.removeprefix("p"), position=MAKE.point(x, y),
            velocity=MAKE.point(0.0, 0.0), reliability=0.8, tagnames=["heading", "radius"], tags=["0.0", "0.35"],
        )
        for name, (x, y) in places.items()
    ]  # fmt: skip
    return MAKE.make("people_msgs/msg/People", header=MAKE.header(nanoseconds(time), frame), people=persons)


def odometry(time: float, x: float, y: float, heading: float, frame: str = "odom") -> Any:
    return MAKE.odometry(nanoseconds(time), "robot", x, y, heading, [0.0, 0.0, 0.0], frame=frame)


def tracked(time: float, frame: str, package: str, *tracks: tuple[int, Sequence[float], np.ndarray]) -> Any:
    """Return TrackedPersons as a plain object with the attributes of rclpy messages."""
    rows = []
    for number, (x, y), covariance in tracks:
        whole = np.zeros((6, 6))
        whole[:3, :3] = covariance
        pose = SimpleNamespace(position=SimpleNamespace(x=x, y=y, z=0.0))
        rows.append(
            SimpleNamespace(track_id=number, pose=SimpleNamespace(pose=pose, covariance=whole.ravel().tolist()))
        )
    stamp = SimpleNamespace(sec=int(time), nanosec=nanoseconds(time % 1.0))
    header = SimpleNamespace(frame_id=frame, stamp=stamp)
    message = SimpleNamespace(header=header, tracks=rows)
    message.__msgtype__ = f"{package}/msg/TrackedPersons"
    return message


def transform(time: float, parent: str, child: str, x: float, y: float, heading: float) -> Any:
    row = SimpleNamespace(
        header=SimpleNamespace(frame_id=parent, stamp=SimpleNamespace(sec=int(time), nanosec=nanoseconds(time % 1.0))),
        child_frame_id=child,
        transform=SimpleNamespace(
            translation=SimpleNamespace(x=x, y=y, z=0.0),
            rotation=SimpleNamespace(x=0.0, y=0.0, z=math.sin(heading / 2.0), w=math.cos(heading / 2.0)),
        ),
    )
    message = SimpleNamespace(transforms=[row])
    message.__msgtype__ = "tf2_msgs/msg/TFMessage"
    return message


def test_people_in_a_fixed_frame_need_no_odometry() -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    for row in range(4):
        live.update_from(people(0.4 * row, "/map", p7=(0.5 * row, 0.0), panna=(3.0, 1.0)))
    assert live.ids.tolist() == [7, "anna"]
    forecast = live.predict(1)
    np.testing.assert_allclose(forecast.position[0, 0, 0], [[2.0, 0.0], [3.0, 1.0]], atol=1e-9)
    assert forecast.existence is not None
    assert forecast.existence.tolist() == [[0.8, 0.8]]
    assert live.past().radius is not None
    assert live.past().radius.tolist() == [[0.35, 0.35]]


def test_people_in_the_frame_of_a_robot_that_drives_and_turns_stand_still() -> None:
    live = Live(ConstantVelocity(), dt=0.2, robot=BASE)
    for row in range(11):
        time = 0.1 * row
        x, heading = 0.8 * time, 0.5 * time
        live.update_from(odometry(time, x, 0.0, heading))
        away = np.array([4.0 - x, 1.0])
        c, s = math.cos(heading), math.sin(heading)
        live.update_from(people(time, BASE, p1=(c * away[0] + s * away[1], c * away[1] - s * away[0])))
    past = live.past()
    slot = live.ids.tolist().index(1)
    np.testing.assert_allclose(past.position[0, :, slot], np.tile([4.0, 1.0], (6, 1)), atol=1e-9)
    assert past.robot[0].tolist() == [who == BASE for who in live.ids]
    np.testing.assert_allclose(past.position[0, :, 1 - slot, 0], 0.8 * 0.2 * np.arange(6), atol=1e-9)
    np.testing.assert_allclose(live.predict(1).position[0, 0, 0, 1 - slot], [0.96, 0.0], atol=1e-9)


def test_people_wait_for_odometry_of_their_time() -> None:
    live = Live(ConstantVelocity(), dt=0.1)
    live.update_from(odometry(0.0, 0.0, 0.0, 0.0))
    live.update_from(people(0.05, BASE, p1=(2.0, 0.0)))
    assert live.ids.tolist() == []
    live.update_from(odometry(0.1, 1.0, 0.0, 0.0))
    assert live.ids.tolist() == [1]
    np.testing.assert_allclose(live.past().position[0, -1, 0], [2.5, 0.0])


def test_people_of_a_laser_are_joined_by_static_transforms() -> None:
    live = Live(ConstantVelocity(), dt=0.1, frame="map")
    live.update_from(transform(0.0, "map", "odom", 10.0, 0.0, math.pi / 2.0), "/tf_static")
    live.update_from(transform(0.0, BASE, "laser", 0.3, 0.0, 0.0), "/tf_static")
    live.update_from(odometry(5.0, 1.0, 0.0, 0.0))
    live.update_from(people(5.0, "laser", p1=(2.0, 0.0)))
    np.testing.assert_allclose(live.past().position[0, -1, 0], [10.0, 3.3], atol=1e-9)


@pytest.mark.parametrize("package", ["pedsim_msgs", "spencer_tracking_msgs"])
def test_covariances_of_tracked_persons_turn_with_the_robot(package: str) -> None:
    live = Live(Kalman(), dt=0.1)
    live.update_from(odometry(1.0, 0.0, 0.0, math.pi / 2.0))
    spread = np.array([[0.09, 0.02, 0.0], [0.02, 0.01, 0.0], [0.0, 0.0, 1.0]])
    live.update_from(tracked(1.0, BASE, package, (3, (2.0, 0.0), spread), (4, (1.0, 1.0), np.zeros((3, 3)))))
    covariance = live.past().covariance
    assert covariance is not None
    np.testing.assert_allclose(covariance[0, 0, 0], [[0.01, -0.02], [-0.02, 0.09]], atol=1e-12)
    assert np.isnan(covariance[0, 0, 1]).all()  # zeros: the tracker does not say
    np.testing.assert_allclose(live.past().position[0, 0], [[0.0, 2.0], [-1.0, 1.0]], atol=1e-9)


def test_messages_of_rospy_are_read() -> None:
    message = people(2.5, "odom", p1=(1.0, 2.0))
    old = SimpleNamespace(
        _type="people_msgs/People", people=message.people,
        header=SimpleNamespace(frame_id="odom", stamp=SimpleNamespace(secs=2, nsecs=500_000_000)),
    )  # fmt: skip
    live = Live(ConstantVelocity(), dt=0.5)
    live.update_from(old)
    live.update([1], [[1.5, 2.0]], time=3.0)
    np.testing.assert_allclose(live.past().position[0, :, 0], [[1.0, 2.0], [1.5, 2.0]])


def test_a_frame_that_no_transform_joins_is_refused_by_name() -> None:
    live = Live(ConstantVelocity(), dt=0.1)
    with pytest.raises(
        InputError, match=r"no transform joins the frame camera_link with a fixed frame .*known are none"
    ):
        live.update_from(people(0.0, "camera_link", p1=(1.0, 0.0)))
    live.update_from(odometry(0.0, 0.0, 0.0, 0.0))
    live.update_from(people(0.0, BASE, p1=(1.0, 0.0)))
    with pytest.raises(
        InputError, match=rf"frame camera_link with the fixed frame odom; known are odom -> {BASE}; send odometry"
    ):
        live.update_from(people(0.1, "camera_link", p1=(1.0, 0.0)))
    assert live.ids.tolist() == [1]
    live.update_from(people(0.1, "odom", p1=(1.1, 0.0)))  # what was refused does not block the others
    np.testing.assert_allclose(live.past().position[0, -1, 0], [1.1, 0.0])
    with pytest.raises(InputError, match="no transform joins the frame other_robot with the fixed frame map"):
        Live(ConstantVelocity(), dt=0.1, frame="map", robot="other_robot").update_from(
            people(0.0, "map", p1=(1.0, 0.0))
        )


def test_people_before_or_between_transforms_are_refused() -> None:
    live = Live(ConstantVelocity(), dt=0.1)
    live.update_from(odometry(10.0, 0.0, 0.0, 0.0))
    with pytest.raises(
        InputError, match=r"no transform of robot/base_link to odom at 9.500 s, the stamp of the people"
    ):
        live.update_from(people(9.5, BASE, p1=(1.0, 0.0)))
    live.update_from(odometry(14.0, 0.0, 0.0, 0.0))
    with pytest.raises(InputError, match=r"at 12.000 s, the stamp of the people: transforms begin later or have a gap"):
        live.update_from(people(12.0, BASE, p1=(1.0, 0.0)))


def test_people_do_not_wait_for_ever() -> None:
    live = Live(ConstantVelocity(), dt=0.1)
    live.update_from(odometry(0.0, 0.0, 0.0, 0.0))
    for row in range(1, 21):
        live.update_from(people(0.1 * row, BASE, p1=(1.0, 0.0)))
    with pytest.raises(
        InputError, match=r"has come for people of 0.100 s, and 20 messages wait; the clocks of tracker"
    ):
        live.update_from(people(2.1, BASE, p1=(1.0, 0.0)))


def test_unknown_messages_and_frames_without_a_name_are_refused() -> None:
    live = Live(ConstantVelocity(), dt=0.1)
    with pytest.raises(InputError, match="a message of type geometry_msgs/msg/Twist has no people and no transforms"):
        live.update_from(MAKE.twist(0.5, 0.1, 0.0))
    with pytest.raises(InputError, match="a message of type builtins/msg/dict has no people"):
        live.update_from({"people": []})
    with pytest.raises(InputError, match=r"people_msgs/msg/People names no frame \(header.frame_id is empty\)"):
        live.update_from(people(0.0, "", p1=(1.0, 0.0)))
    with pytest.raises(InputError, match="odometry of frame_id '' and child_frame_id 'robot/base_link' must name both"):
        live.update_from(odometry(0.0, 0.0, 0.0, 0.0, frame=""))


def test_old_transforms_are_forgotten() -> None:
    live = Live(ConstantVelocity(), dt=0.1)
    for row in range(3000):
        live.update_from(odometry(0.02 * row, 0.01 * row, 0.0, 0.0))
    assert all(len(edge.stamps) < 600 for edge in live._messages._frames.odometry.values())
    live.update_from(people(0.02 * 2999, BASE, p1=(1.0, 0.0)))
    np.testing.assert_allclose(live.past().position[0, -1, 0], [30.99, 0.0])


def test_a_message_of_nobody_hides_the_people() -> None:
    live = Live(ConstantVelocity(), dt=0.4, coast=1.0)
    live.update_from(people(0.0, "map", p1=(0.0, 0.0)))
    live.update_from(people(0.4, "map", p1=(0.4, 0.0)))
    live.update_from(people(0.8, "map"))
    np.testing.assert_allclose(live.past().position[0, -1, 0], [0.8, 0.0])
    existence = live.predict(1).existence
    assert existence is not None
    np.testing.assert_allclose(existence, [[0.8 * 0.5**0.8]])
