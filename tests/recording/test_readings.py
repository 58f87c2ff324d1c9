"""Readings in recordings: every class is a standard message that other tools read, and comes back as it was."""

from __future__ import annotations

import math
import types
import weakref
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from crowdbot import sensors
from crowdbot.core import EpisodeError, SpatialPose
from crowdbot.data import McapOpcode, McapReader
from crowdbot.messages import (
    CODECS,
    Codec,
    Messages,
    decode_reading,
    image_in,
    points_in,
)
from crowdbot.recording import READING_TABLES, export, read_episode, repair, replay, run, step_records
from crowdbot.simulation import Episode
from crowdbot.trials import parse_trial
from episode_copies import copy_episode
from reading_comparison import same

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
        for item, two in zip(read.readings[topic], readings, strict=True):
            same(item, two, topic)
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
    assert "robot/odom" not in frames
    moving = {row.child_frame_id: row.header.frame_id for row in found["/tf"].transforms}
    assert moving == {"robot/odom": "map", "robot/base_link": "robot/odom"}


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


@pytest.fixture
def decoded(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """Count the readings that are decoded, by class; nothing is kept from tests before."""
    count: Counter[str] = Counter()

    def counting(whole: Any, others: Any) -> Any:
        count[whole.kind] += 1
        return decode_reading(whole, others)

    step_records.read_reading.cache_clear()
    monkeypatch.setattr(step_records, "decode_reading", counting)
    return count


def test_a_reading_is_decoded_when_it_is_asked_for(recorded: tuple[Path, Episode], decoded: Counter[str]) -> None:
    path, episode = recorded
    read = read_episode(path)
    assert (len(read.readings["robot/depth"]), len(read.scans), read.people["id"].size) == (11, 21, 3)
    assert read.readings["robot/depth"].times == pytest.approx([item.time for item in episode.readings["robot/depth"]])
    assert not decoded
    depth = read.readings["robot/depth"]
    assert depth[3] is depth[3]
    same(depth[-1], episode.readings["robot/depth"][-1], "the last one")
    assert decoded == {"DepthImage": 2}
    assert [item.time for item in depth[1:8:3]] == [episode.readings["robot/depth"][k].time for k in (1, 4, 7)]
    assert sum(1 for _ in depth) == 11
    assert decoded.total() < 16
    with pytest.raises(IndexError):
        depth[11]


def test_decoded_readings_are_not_kept(recorded: tuple[Path, Episode], decoded: Counter[str]) -> None:
    clouds = read_episode(recorded[0]).readings["robot/cloud"]
    kept = [weakref.ref(cloud) for cloud in clouds]
    assert decoded == {"Cloud": 11}
    assert sum(item() is not None for item in kept) <= 8


@pytest.mark.parametrize(("table", "kinds"), [("people", set()), ("inertial", {"Inertial"}), ("points", {"Cloud"})])
def test_a_table_decodes_the_readings_that_it_needs(
    recorded: tuple[Path, Episode], decoded: Counter[str], tmp_path: Path, table: str, kinds: set[str]
) -> None:
    export(recorded[0], tmp_path / "table.parquet", table)
    assert set(decoded) - {"Touch"} == kinds  # touches are clouds, too


def test_images_and_clouds_have_the_types_of_the_file(recorded: tuple[Path, Episode]) -> None:
    read = read_episode(recorded[0]).readings
    depth: Any = read["robot/depth"][0]
    cloud: Any = read["robot/cloud"][0]
    assert (depth.depth.dtype, depth.hit.dtype) == (np.float32, np.int32)
    assert (cloud.ranges.dtype, cloud.hit.dtype) == (np.float32, np.int32)


def test_a_damaged_reading_is_named_when_it_is_asked_for(recorded: tuple[Path, Episode], tmp_path: Path) -> None:
    def cut(topic: str, data: bytes) -> bytes:
        return data[:-40] if topic == "/robot/depth/image" else data

    path = copy_episode(recorded[0], tmp_path / "cut.mcap", bytes_of=cut)
    read = read_episode(path)
    assert read.digest == recorded[1].digest
    same(read.readings["robot/cloud"][2], recorded[1].readings["robot/cloud"][2], "cloud")
    with pytest.raises(EpisodeError, match=r"cut.mcap is damaged: reading robot/depth at 0\.4 s: "):
        read.readings["robot/depth"][2]
    with pytest.raises(EpisodeError, match="reading robot/depth at 0 s"):
        export(path, tmp_path / "images.csv", "images")


@pytest.mark.parametrize("now", ["another episode", "nothing"])
def test_a_file_that_changes_after_it_was_opened_is_no_other_reading(
    recorded: tuple[Path, Episode], tmp_path: Path, now: str
) -> None:
    path = tmp_path / "episode.mcap"
    path.write_bytes(recorded[0].read_bytes())
    read = read_episode(path)
    path.unlink()
    if now == "nothing":
        with pytest.raises(EpisodeError, match=r"cannot read .*episode.mcap: No such file"):
            read.readings["robot/depth"][2]
        return
    run(parse_trial(TRIAL.replace('seed="4"', 'seed="5"')), out=path)
    with pytest.raises(EpisodeError, match="it has changed since it was opened"):
        read.readings["robot/depth"][2]


def test_a_part_of_an_index_is_completed_by_repair(recorded: tuple[Path, Episode], tmp_path: Path) -> None:
    whole, cut = recorded[0].read_bytes(), tmp_path / "cut.mcap"
    with recorded[0].open("rb") as stream:
        records = [(kind, place) for kind, place, _ in McapReader(stream).records()]
    last = max(k for k, (kind, _) in enumerate(records) if kind == McapOpcode.CHUNK)
    cut.write_bytes(whole[: records[last + 3][1]])
    count = {name: len(rows) for name, rows in read_episode(cut).readings.items()}
    assert count == {name: len(rows) for name, rows in recorded[1].readings.items()}
    repair(cut)
    read = read_episode(cut)
    with cut.open("rb") as stream:
        messages = sum(1 for _ in McapReader(stream).messages())
    assert read.complete
    assert {name: len(rows) for name, rows in read.readings.items()} == count
    with cut.open("rb") as stream:
        summary = make_reader(stream, validate_crcs=True).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == messages


@pytest.mark.parametrize("wrong", ["offset", "channel"])
def test_an_index_that_lies_gives_no_reading(recorded: tuple[Path, Episode], wrong: str) -> None:
    place = read_episode(recorded[0]).readings["robot/depth"].places[0]
    suffix, kind, at = place.parts[0]
    lie = at._replace(offset=at.offset + 1) if wrong == "offset" else at._replace(channel=at.channel + 1)
    with pytest.raises(EpisodeError, match=r"reading robot/depth at 0 s: McapError: the index of the chunk at byte"):
        step_records.read_reading(place._replace(parts=((suffix, kind, lie), *place.parts[1:])))
