"""People of ROS bags in the frames of robots and sensors: brought to a fixed frame, or rejected with the remedy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from crowdbot import cli
from crowdbot.core import DataError, InputError
from crowdbot.data import detect_format, load
from ros_bags import BagWriter

BEGIN = 1000.0
STANDING = {1: (6.0, 1.0), 2: (4.0, -2.0)}
"""People who stand still in the world."""


def seen(places, x, y, yaw, z=None):
    """Return places in the frame of a robot at a pose."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    rows = {name: (px - x, py - y) for name, (px, py) in places.items()}
    rest = () if z is None else (z,)
    return {name: (cos * dx + sin * dy, -sin * dx + cos * dy, *rest) for name, (dx, dy) in rows.items()}


def robot_pose(time):
    """A robot that drives on a bend at 1 m/s."""
    return 2.0 * math.sin(0.5 * time), 2.0 - 2.0 * math.cos(0.5 * time), 0.5 * time


def assert_standing(tracks, places=STANDING, within=0.01):
    for id, place in places.items():
        np.testing.assert_allclose(tracks.track(id).position, np.tile(place, (len(tracks.track(id)), 1)), atol=within)


@pytest.mark.parametrize("storage", ["mcap", "sqlite3", "ros1"])
def test_odometry_moves_people_of_the_base_to_its_frame(tmp_path, storage):
    """Poses at other times than the people are interpolated."""
    with BagWriter(tmp_path / "bag", storage) as bag:
        for k in range(-1, 62):
            bag.odometry(BEGIN + 0.05 * k + 0.013, *robot_pose(0.05 * k + 0.013))
            if k % 2 == 0 and k >= 0:
                bag.people(BEGIN + 0.05 * k, "base_link", seen(STANDING, *robot_pose(0.05 * k)))
    tracks = load(bag.file)
    assert detect_format(bag.file) == {"mcap": "episode", "sqlite3": "rosbag2", "ros1": "rosbag1"}[storage]
    assert_standing(tracks)
    assert "people are in the frame base_link, moved to odom by /odom" in tracks.note
    assert (tracks.dt, len(tracks.robots), len(tracks.ids)) == (0.1, 1, 3)
    if storage == "ros1":  # frames with the slash of tf 1 are the same
        assert load(bag.file, frame="/odom").x.tolist() == tracks.x.tolist()


def test_a_static_chain_of_a_tilted_sensor(tmp_path):
    """A laser upside down under the base, turned by 30 degrees: map -> odom -> base_link -> laser."""
    with BagWriter(tmp_path / "bag") as bag:
        bag.transform(0.0, "base_link", "mast", x=0.2, z=0.5, yaw=math.pi / 6, topic="/tf_static")
        bag.transform(0.0, "mast", "laser", roll=math.pi, topic="/tf_static")
        for k in range(40):
            time, (x, y, yaw) = BEGIN + 0.1 * k, robot_pose(0.1 * k)
            bag.transform(time, "map", "odom", x=1.0, y=-0.5)
            bag.transform(time, "odom", "base_link", x - 1.0, y + 0.5, yaw=yaw)
            places = {name: (px - 0.2, py) for name, (px, py) in seen(STANDING, x, y, yaw).items()}
            mast = seen(places, 0.0, 0.0, math.pi / 6)
            bag.people(time, "laser", {name: (px, -py, 0.3) for name, (px, py) in mast.items()})
    tracks = load(bag.file)
    assert_standing(tracks, within=1e-9)
    assert "people are in the frame laser, moved to map by /tf_static and /tf" in tracks.note


def test_people_in_the_map_are_not_moved_and_the_robot_is_brought_there(tmp_path):
    with BagWriter(tmp_path / "bag") as bag:
        for k in range(30):
            bag.transform(BEGIN + 0.1 * k, "map", "odom", x=10.0, yaw=math.pi / 2)
            bag.odometry(BEGIN + 0.1 * k, 0.1 * k, 0.0)
            bag.people(BEGIN + 0.1 * k, "map", STANDING)
    tracks = load(bag.file)
    assert_standing(tracks, within=0.0)
    robot = tracks.track(next(iter(tracks.robots)))
    np.testing.assert_allclose(robot.position[[0, -1]], [[10.0, 0.0], [10.0, 2.9]], atol=1e-9)
    assert tracks.note == ""
    odometric = load(bag.file, frame="odom")
    np.testing.assert_allclose(odometric.track(1).position[0], [1.0, 4.0], atol=1e-9)
    np.testing.assert_allclose(odometric.track(3).position[-1], [2.9, 0.0], atol=1e-9)


def test_odometry_in_another_frame_without_a_transform_is_told(tmp_path):
    with BagWriter(tmp_path / "bag") as bag:
        for k in range(5):
            bag.odometry(BEGIN + 0.1 * k, 0.1 * k, 0.0)
            bag.people(BEGIN + 0.1 * k, "map", STANDING)
    assert "/odom is in the frame odom, people in map: both are taken as the same" in load(bag.file).note


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        ("base_link", r"the frame 'base_link', and no transform joins it with a fixed frame \(transforms: odom ->"
         r" base_footprint\)\. Record /tf and /tf_static, or odometry whose child_frame_id is 'base_link'"),
        ("camera", r"the frame 'camera', .* if the frame does not move, give --frame camera"),
    ],
)  # fmt: skip
def test_a_frame_without_a_transform_is_rejected(tmp_path, frame, message):
    with BagWriter(tmp_path / "bag") as bag:
        for k in range(5):
            bag.odometry(BEGIN + 0.1 * k, 0.1 * k, 0.0, child="base_footprint")
            bag.people(BEGIN + 0.1 * k, frame, STANDING)
    with pytest.raises(DataError, match=message):
        load(bag.file)
    tracks = load(bag.file, frame=frame)
    assert_standing(tracks, within=0.0)
    assert f"positions are relative to {frame}, which perhaps moves" in tracks.note
    with pytest.raises(DataError, match=f"'{frame}', and no transform joins it with 'map'"):
        load(bag.file, frame="map")


def test_wheels_below_a_base_do_not_make_it_a_fixed_frame(tmp_path):
    with BagWriter(tmp_path / "bag") as bag:
        bag.transform(0.0, "base_link", "laser", x=0.2, topic="/tf_static")
        for k in range(5):
            bag.transform(BEGIN + 0.1 * k, "base_link", "wheel", y=0.3, roll=0.1 * k)
            bag.people(BEGIN + 0.1 * k, "laser", STANDING)
    with pytest.raises(DataError, match="'laser', and no transform joins it with a fixed frame"):
        load(bag.file)
    np.testing.assert_allclose(load(bag.file, frame="base_link").track(1).x, 6.2)


def test_stamps_outside_the_odometry_are_left_out(tmp_path):
    with BagWriter(tmp_path / "bag") as bag:
        for k in range(30):
            if 10 <= k < 20:
                bag.odometry(BEGIN + 0.1 * k, *robot_pose(0.1 * k))
            bag.people(BEGIN + 0.1 * k, "base_link", seen(STANDING, *robot_pose(0.1 * k)))
    tracks = load(bag.file)
    assert_standing(tracks, within=1e-9)
    assert tracks.track(1).frame.tolist() == list(range(10, 20))
    assert "40 of 60 positions are left out, at times without a transform" in tracks.note


def test_odometry_of_another_time_is_rejected_and_gaps_are_not_bridged(tmp_path):
    with BagWriter(tmp_path / "late") as bag:
        for k in range(5):
            bag.people(BEGIN + 0.1 * k, "base_link", STANDING)
            bag.odometry(BEGIN + 100 + 0.1 * k, 0.0, 0.0)
    with pytest.raises(DataError, match="the transforms to odom are of other times; record /odom at the same time"):
        load(bag.file)
    with BagWriter(tmp_path / "gap") as bag:
        for k in range(60):
            bag.people(BEGIN + 0.1 * k, "base_link", STANDING)
            if not 10 < k < 40:
                bag.odometry(BEGIN + 0.1 * k, 0.0, 0.0)
    assert len(load(bag.file).track(1)) == 60 - 29


def test_messages_in_several_frames_and_without_one(tmp_path):
    with BagWriter(tmp_path / "two") as bag:
        for k in range(20):
            x, y, yaw = robot_pose(0.1 * k)
            bag.odometry(BEGIN + 0.1 * k, x, y, yaw)
            bag.people(BEGIN + 0.1 * k, *(("odom", STANDING) if k % 2 else ("base_link", seen(STANDING, x, y, yaw))))
    assert_standing(load(bag.file), within=1e-9)
    with BagWriter(tmp_path / "none") as bag:
        for k in range(20):
            bag.people(BEGIN + 0.1 * k, "", STANDING)
    assert "the messages name no frame" in load(bag.file).note


def test_the_topic_of_people_is_chosen(tmp_path, capsys):
    with BagWriter(tmp_path / "bag", "sqlite3") as bag:
        for k in range(60):
            bag.tracked(BEGIN + 0.1 * k, "map", {5: (0.13 * k, 0.0)}, "/tracker")
            bag.people(BEGIN + 0.1 * k, "map", {"ada": (0.1 * k, 2.0)}, "/leg_detector")
            bag.odometry(BEGIN + 0.1 * k, 0.0, 0.0)
    with pytest.raises(DataError, match="several topics of people, /leg_detector, /tracker; choose one with --topic"):
        load(bag.file)
    assert load(bag.file, topic="/tracker").track(5).x[1] == pytest.approx(0.13)
    with pytest.raises(DataError, match="it has no topic /traker, did you mean '/tracker'"):
        load(bag.file, topic="/traker")
    with pytest.raises(DataError, match="its topic /odom is nav_msgs/msg/Odometry; types of people are people_msgs"):
        load(bag.file, topic="/odom")
    (tmp_path / "t.csv").write_text("id,time,x,y\n1,0,0,0\n1,1,1,0\n")
    with pytest.raises(InputError, match="a topic or a frame is given, but the format csv has none"):
        load(tmp_path / "t.csv", topic="/people")
    assert cli.main(["predict", "--data", str(bag.file), "--topic", "/tracker", "--frame", "map", "--step", "0.2"]) == 0
    assert "60 rows of 1 person and 1 robots, 5.8 s with a step of 0.2 s" in capsys.readouterr().err


def test_tracked_people_in_detections_of_vision_msgs(tmp_path):
    with BagWriter(tmp_path / "bag") as bag:
        for k in range(20):
            rows = [("7", "person", 0.1 * k, 2.0), ("8", "car", 0.3 * k, 0.0)]
            bag.detections(BEGIN + 0.1 * k, "map", rows)
    tracks = load(bag.file)
    assert tracks.ids.tolist() == [7]
    assert tracks.track(7).x[-1] == pytest.approx(1.9)
    with BagWriter(tmp_path / "untracked") as bag:
        bag.detections(BEGIN, "map", [("", "person", 0.0, 2.0)])
    with pytest.raises(InputError, match="a detection of class 'person' has no id: people must be tracked"):
        load(bag.file)


@pytest.mark.parametrize(
    "kind",
    ["pedsim_msgs/msg/AgentStates", "hunav_msgs/msg/Agents", "people_msgs/msg/PositionMeasurementArray"],
)
@pytest.mark.parametrize("storage", ["mcap", "ros1"])
def test_messages_of_simulators_and_detectors(tmp_path, kind, storage):
    """Fields as in the published definitions."""
    with BagWriter(tmp_path / "bag", storage) as bag:
        for k in range(30):
            bag.agents(BEGIN + 0.1 * k, "map", {1: (0.13 * k, 1.0), 2: (4.0, 0.13 * k)}, kind)
    tracks = load(bag.file)
    assert (len(tracks), tracks.dt, tracks.ids.tolist()) == (60, 0.1, [1, 2])
    np.testing.assert_allclose(tracks.track(1).x, 0.13 * np.arange(30))


@pytest.mark.parametrize(("drift", "lost"), [(0.01, ()), (-0.01, ()), (0.03, ()), (0.01, (50, 51)), (0.002, (7,))])
def test_stamps_that_drift_leave_no_gaps(tmp_path, drift, lost):
    """Each period is a little longer or shorter than at the beginning; lost messages stay gaps."""
    time = 0.0
    with BagWriter(tmp_path / "bag") as bag:
        for k in range(300):
            if k not in lost:
                bag.people(BEGIN + time, "map", {1: (0.13 * k, 1.0)})
            time += 0.1 * (1.0 + drift * (k >= 150))
    tracks = load(bag.file)
    assert tracks.frame.tolist() == [k for k in range(300) if k not in lost]
    assert tracks.dt == pytest.approx(time / 300, rel=2e-3)
    assert "off a regular step" in tracks.note or abs(drift) < 0.003


@pytest.mark.parametrize("burst", [0.001, 0.01, 0.02])
def test_messages_in_bursts_are_refused(tmp_path, burst):
    with BagWriter(tmp_path / "bag") as bag:
        for k in range(30):
            bag.people(
                BEGIN + 0.1 * (k - k % 2) + burst * (k % 2) + 0.1 * (k > 20) * (k % 2), "map", {1: (0.1 * k, 1.0)}
            )
    with pytest.raises(DataError, match="the stamps on /people are not regular, some steps are far shorter than"):
        load(bag.file)
