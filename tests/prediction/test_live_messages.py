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


def odometry(
    time: float, x: float, y: float, heading: float, frame: str = "odom", spread: np.ndarray | None = None
) -> Any:
    """Return odometry, with the covariance ``[3, 3]`` of x, y and yaw."""
    message = MAKE.odometry(nanoseconds(time), "robot", x, y, heading, [0.0, 0.0, 0.0], frame=frame)
    if spread is not None:
        whole = np.diag([0.0, 0.0, 1e6, 1e6, 1e6, 0.0])  # what a planar robot does not know
        whole[np.ix_((0, 1, 5), (0, 1, 5))] = spread
        message.pose.covariance[:] = whole.ravel()
    return message


def detection(
    number: str, kind: str, x: float, y: float, score: float = 0.7, spread: float = 0.0, old: bool = False
) -> Any:
    """Return vision_msgs/Detection3D with the fields of ROS 2 Humble, or of Foxy."""
    whole = np.diag([spread, 2.0 * spread, 0.0, 0.0, 0.0, 0.0]).ravel()
    place = SimpleNamespace(x=x, y=y, z=0.9)
    pose = SimpleNamespace(pose=SimpleNamespace(position=place), covariance=whole)
    likely = {"id": kind, "score": score} if old else {"hypothesis": SimpleNamespace(class_id=kind, score=score)}
    less = {"id": "car", "score": 0.1} if old else {"hypothesis": SimpleNamespace(class_id="car", score=0.1)}
    return SimpleNamespace(
        results=[SimpleNamespace(pose=pose, **less), SimpleNamespace(pose=pose, **likely)] if kind else [],
        bbox=SimpleNamespace(center=SimpleNamespace(position=place), size=SimpleNamespace(x=0.6, y=0.6, z=1.8)),
        **({"is_tracking": bool(number), "tracking_id": number} if old else {"id": number}),
    )


def detections(time: float, frame: str, *rows: Any) -> Any:
    stamp = SimpleNamespace(sec=int(time), nanosec=nanoseconds(time % 1.0))
    message = SimpleNamespace(header=SimpleNamespace(frame_id=frame, stamp=stamp), detections=list(rows))
    message.__msgtype__ = "vision_msgs/msg/Detection3DArray"
    return message


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


@pytest.mark.parametrize("old", [False, True])
def test_detections_of_tracked_people_are_read(old: bool) -> None:
    live = Live(Kalman(), dt=0.4)
    for row in range(4):
        cars = [detection("4", "car", 9.0, 9.0, old=old), detection("", "traffic light", 8.0, 9.0, old=old)]
        person = detection("3", "Person", 0.5 * row, 0.0, spread=0.04, old=old)
        live.update_from(detections(0.4 * row, "map", person, detection("x", "", 3.0, 1.0, old=old), *cars))
    assert live.ids.tolist() == [3, "x"]
    past, forecast = live.past(), live.predict(1)
    assert past.covariance is not None
    np.testing.assert_allclose(past.covariance[0, -1, 0], np.diag([0.04, 0.08]))
    assert np.isnan(past.covariance[0, :, 1]).all()
    assert past.radius is None  # a box contains arms and bags
    np.testing.assert_allclose(past.position[0, -1], [[1.5, 0.0], [3.0, 1.0]])
    assert forecast.existence is not None
    np.testing.assert_allclose(forecast.existence, [[0.7, 1.0]])


def test_classes_of_people_have_other_names() -> None:
    live = Live(ConstantVelocity(), dt=0.4, person_classes=["0"])
    live.update_from(detections(0.0, "map", detection("1", "0", 1.0, 2.0), detection("2", "7", 3.0, 2.0)))
    assert live.ids.tolist() == [1]
    with pytest.raises(InputError, match=r"person_classes = 'person' must be a list, such as \['person'\]"):
        Live(ConstantVelocity(), dt=0.4, person_classes="person")


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (detection("", "person", 1.0, 2.0), "live: a detection of class 'person' has no id: people must be tracked"),
        (detection("1", "0", 1.0, 2.0), r"live: a detection has the class '0', .* Live\(..., person_classes=\['0'\]\)"),
    ],
)
def test_detections_that_are_no_tracked_people_are_refused(row: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Live(ConstantVelocity(), dt=0.4).update_from(detections(0.0, "map", row))


def test_the_covariance_of_odometry_grows_with_the_distance_from_the_robot() -> None:
    spread = np.array([[0.04, 0.01, 0.0], [0.01, 0.02, 0.0], [0.0, 0.0, 0.01]])
    found = {}
    for added in (True, False):
        live = Live(Kalman(), dt=0.1, robot=BASE, pose_covariance=added)
        for row in range(4):  # the robot looks along y; one person is 1 m ahead of it, one 10 m
            live.update_from(odometry(0.1 * row, 5.0, 3.0, math.pi / 2.0, spread=spread))
            live.update_from(people(0.1 * row, BASE, p1=(1.0, 0.0), p2=(10.0, 0.0)))
        found[added] = live.predict(1)
    with_pose, own = found[True].covariance, found[False].covariance
    assert with_pose is not None
    assert own is not None
    np.testing.assert_array_equal(found[True].position, found[False].position)
    names = live.ids.tolist()
    for who, lever in ((1, [0.0, 1.0]), (2, [0.0, 10.0]), (BASE, [0.0, 0.0])):
        motion = np.array([[1.0, 0.0, -lever[1]], [0.0, 1.0, lever[0]]])
        more = (with_pose - own)[0, 0, names.index(who)]
        np.testing.assert_allclose(more, motion @ spread @ motion.T, atol=1e-9)


def test_the_covariance_of_odometry_turns_into_the_fixed_frame_and_ends_behind_it() -> None:
    live = Live(Kalman(), dt=0.1, frame="map")
    live.update_from(transform(0.0, "map", "odom", 10.0, 0.0, math.pi / 2.0), "/tf_static")
    spread = np.diag([0.09, 0.01, 0.0])
    live.update_from(odometry(0.0, 0.0, 0.0, 0.0, spread=spread))
    live.update_from(odometry(0.2, 0.0, 0.0, 0.0, spread=3.0 * spread))
    live.update_from(transform(0.1, "odom", BASE, 0.0, 0.0, 0.0))  # the same motion, without a covariance
    live.update_from(people(0.1, BASE, p1=(2.0, 0.0)))
    live.update_from(people(0.1, "map", p2=(2.0, 0.0)))  # of a camera on a wall
    covariance = live.predict(1).covariance
    assert covariance is not None
    np.testing.assert_allclose((covariance[0, 0, 0] - covariance[0, 0, 1]), np.diag([0.02, 0.18]), atol=1e-9)


def test_a_covariance_of_odometry_that_is_unknown_or_impossible() -> None:
    unknown, wrong = np.diag([-1.0, 0.0, 0.0]), np.diag([0.1, -0.2, 0.1])
    live = Live(Kalman(), dt=0.1)
    live.update_from(odometry(0.0, 0.0, 0.0, 0.0, spread=unknown))
    live.update_from(people(0.0, BASE, p1=(2.0, 0.0)))
    assert live._history.rows().uncertainty is None
    live.update_from(odometry(0.1, 0.0, 0.0, 0.0, spread=wrong))
    with pytest.raises(
        InputError, match=r"live: the odometry on /odom has the covariance \[\[0.1, 0.0, 0.0\], .* zeros"
    ):
        live.update_from(people(0.1, BASE, p1=(2.0, 0.0)))
