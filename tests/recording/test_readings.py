"""Readings in recordings: every class is a standard message that other tools read, and comes back as it was."""

from __future__ import annotations

import dataclasses
import math
import types
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from crowdbot import sensors
from crowdbot.core import EpisodeError, Pose, Scene, SpatialPose
from crowdbot.messages import (
    CODECS,
    KIND,
    REST,
    Codec,
    MeasuredReading,
    Messages,
    codec_of,
    decode_reading,
    encode_reading,
    image_in,
    picture_codec,
    points_in,
    unencoded_fields,
)
from crowdbot.recording import READING_TABLES, read_episode, replay, run
from crowdbot.sensors import Gaussian, Lens, Reading, Sensor
from crowdbot.simulation import Episode
from crowdbot.trials import parse_trial

SENSORS: dict[str, Sensor] = {
    "Scan": sensors.Lidar2D(rays=31, noise=Gaussian(0.01)),
    "PointCloud": sensors.Lidar3D(columns=24, noise=Gaussian(0.01)),
    "RangeReading": sensors.Ultrasound(),
    "DepthImage": sensors.DepthCamera(width=12, height=9),
    "ImuReading": sensors.IMU(rate=100.0, acceleration_noise=0.01, turn_offset=0.1),
    "Odometry": sensors.WheelOdometry(slip=0.01, ticks_per_turn=500),
    "RgbImage": sensors.RGBCamera(width=12, height=9, segmentation=True),
    "BumperReading": sensors.Bumper(radius=0.9),
    "TrackedPeople": sensors.GroundTruthPeople(),
}
"""One that gives each class of readings; a new class needs a row here and in ``CODECS``."""
SCENE = Scene.of([[1.0, 0.2], [2.5, -0.7], [-9.0, 3.0]], [[0.3, 0.1], [0.0, -1.0], [0.0, 0.0]], radius=0.3,
                 walls=[[(4.0, -9.0), (4.0, 9.0)]])  # fmt: skip
KINDS = [getattr(sensors, name) for name in sensors.__all__]
READINGS = [cls for cls in KINDS if isinstance(cls, type) and issubclass(cls, Reading) and cls is not Reading]

TRIAL = """<trial name="eyes" duration="2" step="0.05" seed="4">
  <stage walkable="-6,-3 6,-3 6,3 -6,3"/>
  <crowd type="orca"/>
  <spawner name="east" count="3" zone="-1,-2 3,-2 3,1 -1,1" goal="4,-2 5,-2 5,1 4,1"/>
  <robot name="robot" x="-3" y="-2.4" radius="0.3">
    <goal x="3" y="-2.4"/>
    <drive type="differential-drive" max-speed="1"/>
    <navigator type="straight"/>
    <sensor name="scan" x="0.1" type="lidar2d" rays="90" noise="gaussian(0.01)"/>
    <sensor name="cloud" type="lidar3d" columns="60" rate="5"/>
    <sensor name="us" x="0.2" heading="0.5" type="ultrasound"/>
    <sensor name="ir" type="infrared"/>
    <sensor name="depth" type="depth-camera" width="16" height="12" rate="5"/>
    <sensor name="imu" type="imu" rate="20"/>
    <sensor name="wheels" type="wheel-odometry"/>
    <sensor name="bumper" type="bumper"/>
    <sensor name="people" type="ground-truth-people"/>
  </robot>
  <end collision="false"/>
</trial>
"""
TYPES = {
    "/robot/scan": "sensor_msgs/msg/LaserScan",
    "/robot/cloud": "sensor_msgs/msg/PointCloud2",
    "/robot/us": "sensor_msgs/msg/Range",
    "/robot/ir": "sensor_msgs/msg/Range",
    "/robot/depth/image": "sensor_msgs/msg/Image",
    "/robot/depth/labels": "sensor_msgs/msg/Image",
    "/robot/depth/camera_info": "sensor_msgs/msg/CameraInfo",
    "/robot/imu": "sensor_msgs/msg/Imu",
    "/robot/wheels": "nav_msgs/msg/Odometry",
    "/robot/bumper": "sensor_msgs/msg/PointCloud2",
    "/robot/people": "people_msgs/msg/People",
}


def same(one: Any, two: Any, what: str) -> None:
    """Compare what was read with what was measured, at the 32 bits that most standard types have."""
    if dataclasses.is_dataclass(one):
        assert type(one) is type(two), what
        for field in dataclasses.fields(one):
            same(getattr(one, field.name), getattr(two, field.name), f"{what}.{field.name}")
        return
    a, b = np.asarray(one), np.asarray(two)
    assert a.shape == b.shape, what
    if b.dtype.kind == "f":
        assert np.allclose(a, b.astype(np.float32), rtol=3e-7, atol=1e-6, equal_nan=True), what
        assert np.array_equal(np.isposinf(a), np.isposinf(b)), what
        assert np.array_equal(np.isneginf(a), np.isneginf(b)), what
    else:
        assert a.dtype.kind == b.dtype.kind, what
        assert np.array_equal(a, b), what


def back(reading: Reading, sensor: Any) -> Reading:
    """Return a reading after it was messages, as bytes."""
    make = Messages()
    found = {}
    for ending, message in encode_reading(make, MeasuredReading(reading, sensor, "robot", "robot/eye")):
        found[ending] = make.decode_message(make.encode_message(message), message.__msgtype__)
    whole = found.pop(REST)
    assert whole.__msgtype__ == KIND
    return decode_reading(whole, found)


def test_recordings_keep_the_names_of_kinds_and_fields() -> None:
    """Names in files do not change with those in Python: older recordings open, older versions read newer ones."""
    kinds, names = {}, set()
    for name, sensor in SENSORS.items():
        reading = sensor.read(SCENE, Pose.of((0.1, 0.0), 0.3), np.random.default_rng(0))
        whole = dict(encode_reading(Messages(), MeasuredReading(reading, sensor, "robot", "robot/eye")))[REST]
        kinds[name] = whole.kind
        names |= {field.name for field in whole.fields}
    assert kinds == {
        "Scan": "Scan", "PointCloud": "Cloud", "RangeReading": "Echo", "DepthImage": "DepthImage",
        "ImuReading": "Inertial", "Odometry": "Odometry", "RgbImage": "Picture", "BumperReading": "Touch",
        "TrackedPeople": "Tracked",
    }  # fmt: skip
    assert "facing" in names
    assert "cos_incidence" not in names


def test_no_class_of_readings_is_forgotten() -> None:
    assert unencoded_fields() == []
    assert {cls.__name__ for cls in READINGS} <= set(SENSORS)
    assert {cls.__name__ for cls in CODECS} >= set(SENSORS)


@pytest.mark.parametrize("kind", READINGS, ids=lambda cls: cls.__name__)
@pytest.mark.parametrize("place", ["in the plane", "in space"])
def test_every_class_of_readings_comes_back(kind: type[Reading], place: str) -> None:
    sensor = SENSORS[kind.__name__]
    pose: Any = Pose.of((0.1, 0.0), 0.3)
    state = sensor.begin()
    for number in range(2):
        if place == "in space":
            pose = Pose.of((0.1 + 0.2 * number, 0.0), 0.3).to_spatial(0.7, 0.02, 0.1)
        view = sensors.SensorView(SCENE.replace(time=0.05 * number), pose)
        reading, state = sensor.measure(view, state, np.random.default_rng(number))
        assert type(reading) is kind
        read = back(reading, sensor)
        assert type(read) is kind
        assert read.time == reading.time
        assert (read.pose.position == reading.pose.position).all()
        same(read, reading, kind.__name__)
        same(back(read, sensor), read, "a second time")
    with np.errstate(invalid="ignore"):
        assert any(np.any(np.asarray(getattr(reading, f.name)) != 0) for f in dataclasses.fields(reading)[2:])


def test_a_sensor_of_ones_own_may_give_these_readings(tmp_path: Path) -> None:
    @dataclasses.dataclass(frozen=True)
    class Warm(sensors.RangeReading):
        pass

    own = types.SimpleNamespace(rate=5.0)
    reading = Warm(1.0, Pose.of((0.0, 0.0), 0.0), np.array([1.5]), np.array([3]), np.array([-1]), np.ones((1, 3)))
    assert codec_of(Warm) is CODECS[sensors.RangeReading]
    read = back(reading, own)
    assert type(read) is sensors.RangeReading
    assert read.ranges.tolist() == [1.5]
    with pytest.raises(
        EpisodeError, match=r"returns a Reading, which has no ROS message; return one of Scan, PointCloud"
    ):
        codec_of(Reading, "robot/eye")


@dataclasses.dataclass(frozen=True)
class Colours(Reading):
    """What a colour camera gives."""

    rgb: Any
    lens: Lens
    hit: Any


def test_pictures_are_images_with_their_lens(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CODECS, Colours, picture_codec)
    rgb = np.random.default_rng(0).integers(0, 256, (1, 6, 8, 3), dtype=np.uint8)
    lens = Lens.of(8, 6, 1.0, (0.1, 0.0, 0.0, 0.0, 0.01))
    picture = Colours(0.5, Pose.of((0.0, 0.0), 0.0).to_spatial(1.0), rgb, lens, np.full((1, 6, 8), -1))
    make = Messages()
    messages = dict(encode_reading(make, MeasuredReading(picture, None, "robot", "robot/eye")))
    assert (messages["/image"].encoding, messages["/image"].step) == ("rgb8", 24)
    assert messages["/image"].header.frame_id == "robot/eye_optical"
    assert bytes(messages["/image"].data) == rgb.tobytes()
    read = back(picture, None)
    same(read, picture, "picture")
    assert read.lens == lens  # type: ignore[attr-defined]
    bare = dataclasses.replace(picture, hit=None)
    assert "/labels" not in dict(encode_reading(make, MeasuredReading(bare, None, "robot", "robot/eye")))
    assert back(bare, None).hit is None  # type: ignore[attr-defined]
    ((parent, child, turn),) = picture_codec.frames("robot", "robot/eye")
    assert (parent, child) == ("robot/eye", "robot/eye_optical")
    assert np.allclose(turn.matrix[0], [[0, 0, 1], [-1, 0, 0], [0, -1, 0]])


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Episode]:
    folder = tmp_path_factory.mktemp("eyes")
    return folder / "episode.mcap", run(parse_trial(TRIAL), out=folder)


def test_an_episode_keeps_every_reading(recorded: tuple[Path, Episode]) -> None:
    path, episode = recorded
    read = read_episode(path)
    assert set(read.readings) == set(episode.readings)
    for topic, readings in episode.readings.items():
        assert len(read.readings[topic]) == len(readings)
        for one, two in zip(read.readings[topic], readings, strict=True):
            same(one, two, topic)
    assert replay(path).equal


def test_other_tools_read_each_sensor(recorded: tuple[Path, Episode]) -> None:
    path, episode = recorded
    count: Counter[str] = Counter()
    stamps: dict[str, list[int]] = {}
    with AnyReader([path]) as bag:
        kinds = {connection.topic: connection.msgtype for connection in bag.connections}
        for connection, stamp, raw in bag.messages():
            message: Any = bag.deserialize(raw, connection.msgtype)
            count[connection.topic] += 1
            stamps.setdefault(connection.topic, []).append(stamp)
            if connection.topic in TYPES:
                assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == stamp
                assert message.header.frame_id.startswith("robot/")
    assert {topic: kinds[topic] for topic in TYPES} == TYPES
    for topic in TYPES:
        name = topic.split("/")[2]
        times = [round(reading.time * 1e9) for reading in episode.readings[f"robot/{name}"]]
        assert stamps[topic] == times, topic
    with path.open("rb") as stream:
        summary = make_reader(stream, validate_crcs=True).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    alone = {summary.channels[k].topic: n for k, n in summary.statistics.channel_message_counts.items()}
    assert alone == dict(count)
    assert (alone["/robot/imu"], alone["/robot/cloud"], alone["/robot/us"]) == (41, 11, 21)


def test_a_viewer_finds_points_pixels_and_frames(recorded: tuple[Path, Episode]) -> None:
    path, episode = recorded
    found: dict[str, Any] = {}
    with AnyReader([path]) as bag:
        for connection, _, raw in bag.messages():
            if connection.topic not in found:
                found[connection.topic] = bag.deserialize(raw, connection.msgtype)
    cloud = episode.readings["robot/cloud"][0]
    rows = points_in(found["/robot/cloud"])
    assert [field.name for field in found["/robot/cloud"].fields][:4] == ["x", "y", "z", "intensity"]
    assert not found["/robot/cloud"].is_dense
    assert np.allclose(np.stack([rows["x"], rows["y"], rows["z"]], -1), cloud.points()[0], atol=1e-5, equal_nan=True)
    assert set(rows["label"].ravel().tolist()) & {0, 1, 2}
    assert image_in(found["/robot/depth/image"]).shape == (12, 16)
    assert found["/robot/us"].radiation_type == 0
    assert found["/robot/ir"].radiation_type == 1
    assert math.isclose(found["/robot/ir"].field_of_view, math.radians(1.0), rel_tol=1e-6)
    assert found["/robot/imu"].orientation_covariance[0] == -1.0
    assert found["/robot/wheels"].header.frame_id == "robot/odom"
    frames = {row.child_frame_id: row for row in found["/tf_static"].transforms}
    assert frames["robot/us"].transform.rotation.z == pytest.approx(math.sin(0.25))
    assert frames["robot/depth_optical"].header.frame_id == "robot/depth"
    assert frames["robot/odom"].header.frame_id == "map"


def test_mounts_in_space_are_fixed_frames() -> None:
    from crowdbot.messages import mount_pose

    mount = types.SimpleNamespace(x=0.1, y=0.0, z=1.2, roll=0.0, pitch=0.4, heading=0.5)
    robot = types.SimpleNamespace(sensor_pose=lambda one: (one.x, one.y, one.z, one.roll, one.pitch, one.heading))
    (row,) = Messages().fixed(0, [("robot/base_link", "robot/eye", mount_pose(robot, mount))]).transforms
    turn = row.transform.rotation
    assert row.transform.translation.z == 1.2
    again = SpatialPose(np.zeros((1, 3)), np.array([[turn.w, turn.x, turn.y, turn.z]]))
    assert np.allclose(again.matrix, SpatialPose.of((0.0, 0.0, 0.0), 0.0, 0.4, 0.5).matrix)
    plain = mount_pose(types.SimpleNamespace(), mount)
    assert plain.position.tolist() == [[0.1, 0.0, 0.0]]


def test_arrays_that_pretend_to_be_huge_are_refused() -> None:
    from crowdbot.messages import unpack_arrays

    huge = types.SimpleNamespace(name="x", dtype="<f8", shape=[1 << 20, 1 << 20], data=bytes(8))
    with pytest.raises(ValueError, match="x has an invalid type <f8 or shape"):
        unpack_arrays([huge])
    code = types.SimpleNamespace(name="x", dtype="|O", shape=[1], data=bytes(8))
    with pytest.raises(ValueError, match="has an invalid type"):
        unpack_arrays([code])
    assert isinstance(CODECS[sensors.Scan], Codec)


def test_tables_of_what_sensors_measured(recorded: tuple[Path, Episode], tmp_path: Path) -> None:
    import pandas as pd

    from crowdbot.recording import export

    path, episode = recorded
    clouds = episode.readings["robot/cloud"]
    count = {name: export(path, tmp_path / f"{name}.parquet", name) for name in READING_TABLES}
    assert count["points"] == sum(int(np.isfinite(cloud.ranges).sum()) for cloud in clouds)  # type: ignore[attr-defined]
    assert (count["ranges"], count["inertial"], count["images"], count["odometry"]) == (42, 41, 11, 21)
    points = pd.read_parquet(tmp_path / "points.parquet")
    ends = clouds[0].points(in_world=True)[0]  # type: ignore[attr-defined]
    first = points[points["time"] == 0.0]
    assert np.allclose(first[["point_x", "point_y", "point_z"]], ends[np.isfinite(ends[..., 0])], atol=1e-5)
    assert set(first["sensor"]) == {"robot/cloud"}
    ranges = pd.read_parquet(tmp_path / "ranges.parquet")
    assert set(ranges["sensor"]) == {"robot/us", "robot/ir"}
    tracked = pd.read_parquet(tmp_path / "tracked.parquet")
    told = episode.readings["robot/people"][0]
    assert tracked[tracked["time"] == 0.0]["id"].tolist() == told.ids()  # type: ignore[attr-defined]
    rows = export(path, tmp_path / "bumpers.csv", "bumpers")
    assert len(pd.read_csv(tmp_path / "bumpers.csv")) == rows
