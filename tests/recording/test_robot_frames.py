"""Frames, joints, odometry and descriptions of robots in recordings, read by rosbags and mcap alone."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from crowdbot import data
from crowdbot.core import Pose, SpatialPose
from crowdbot.recording import branch, export, open_run, read_episode, replay, run
from crowdbot.recording.robot_messages import LinkFrames, relative
from crowdbot.sensors import spatial_pose
from crowdbot.simulation import Episode, JointOrder
from crowdbot.trials import Trial, parse_trial
from crowdbot.world import quaternion, read_urdf

TRIAL = """<trial name="frames" duration="1.5" step="0.02" seed="4" world="{world}" bodies="{bodies}">
  <stage walkable="-6,-3 6,-3 6,3 -6,3"/>
  <crowd type="orca"/>
  <spawner name="east" count="1" zone="3,-2 4,-2 4,1 3,1" goal="4,-2 5,-2 5,1 4,1"/>
  <robot name="one" type="{first}" x="-3" y="-1.4" heading="0.4">
    <goal x="3" y="1.4"/>
    <navigator type="straight"/>
    {sensor}
  </robot>
  <robot name="two" x="-3" y="1.4" radius="0.3">
    <goal x="3" y="1.4"/>
    <drive type="differential-drive" max-speed="1"/>
    <navigator type="straight"/>
    <sensor name="eye" type="lidar2d" rays="8" x="0.1" z="0.4" heading="0.5"/>
  </robot>
  <end collision="false"/>
</trial>
"""
WRONG = '<sensor name="odometry" type="wheel-odometry" rate="50" left-scale="1.03" track-scale="0.95"/>'
KINDS = {
    "plane": ("planar", "turtlebot2", WRONG),
    "physics": ("physics", "turtlebot2", ""),
    "limbs": ("physics", "pepper", ""),
}
FOOT = """<robot name="cart"><link name="base_footprint"/>
  <link name="base_link"><inertial><mass value="9"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><origin xyz="0 0 0.2"/><geometry><box size="0.4 0.3 0.2"/></geometry></collision></link>
  <link name="laser"/><link name="mast"/><link name="odom"/>
  <joint name="foot" type="fixed"><parent link="base_footprint"/><child link="base_link"/>
  <origin xyz="0 0 0.1"/></joint>
  <joint name="lift" type="prismatic"><parent link="base_link"/><child link="mast"/><axis xyz="0 0 1"/>
  <limit lower="0" upper="1" effort="1" velocity="1"/></joint>
  <joint name="eye" type="fixed"><parent link="mast"/><child link="laser"/><origin xyz="0.1 0 0"/></joint>
  <joint name="tag" type="fixed"><parent link="base_link"/><child link="odom"/></joint></robot>"""
CART = """<robot name="cart" urdf="cart.urdf" base="planar"><drive type="omnidirectional"/>
  <posture joint="lift" position="0.5"/>
  <sensor name="laser" type="lidar-2d" link="laser" rays="8"/>
  <sensor name="mast" type="lidar-2d" link="mast" z="0.1" rays="8"/>
  <sensor name="wheels" type="wheel-odometry" holonomic="true"/></robot>"""


@dataclasses.dataclass
class Recorded:
    """Messages of a file by topic, with their times [ns], and the tree of frames of its first instant."""

    path: Path
    episode: Episode
    trial: Trial
    messages: dict[str, list[tuple[int, Any]]]

    @property
    def parents(self) -> dict[str, set[str]]:
        """Parents of each frame."""
        result: dict[str, set[str]] = {}
        for topic in ("/tf", "/tf_static"):
            for _, message in self.messages[topic]:
                for row in message.transforms:
                    result.setdefault(row.child_frame_id, set()).add(row.header.frame_id)
        return result

    def pose(self, frame: str, stamp: int) -> SpatialPose:
        """Return the pose of a frame in the map at an instant, as a listener of transforms does."""
        rows: dict[str, Any] = {}
        for topic in ("/tf_static", "/tf"):
            for now, message in self.messages[topic]:
                if now <= stamp:
                    rows |= {row.child_frame_id: row for row in message.transforms}
        pose = SpatialPose.of((0.0, 0.0, 0.0))
        chain = []
        while frame != "map":
            chain.append(rows[frame])
            frame = rows[frame].header.frame_id
        for row in reversed(chain):
            shift, turn = row.transform.translation, row.transform.rotation
            place = pose.position + pose.matrix @ np.array([shift.x, shift.y, shift.z])
            whole = (
                pose.matrix[0] @ SpatialPose(np.zeros((1, 3)), np.array([[turn.w, turn.x, turn.y, turn.z]])).matrix[0]
            )
            pose = SpatialPose(place, np.asarray(quaternion(whole))[None])
        return pose


def messages_of(path: Path) -> dict[str, list[tuple[int, Any]]]:
    result: dict[str, list[tuple[int, Any]]] = {}
    with AnyReader([path]) as bag:
        for connection, stamp, raw in bag.messages():
            result.setdefault(connection.topic, []).append((stamp, bag.deserialize(raw, connection.msgtype)))
    return result


def record(trial: Trial, folder: Path) -> Recorded:
    episode = run(trial, out=folder)
    return Recorded(folder / "episode.mcap", episode, trial, messages_of(folder / "episode.mcap"))


@pytest.fixture(scope="module", params=KINDS)
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    world, first, sensor = KINDS[request.param]
    bodies = "limbs" if request.param == "limbs" else ""
    text = TRIAL.format(world=world, first=first, sensor=sensor, bodies=bodies)
    return record(parse_trial(text.replace(' bodies=""', "")), tmp_path_factory.mktemp("frames"))


def test_the_frames_are_one_tree_with_every_link_and_every_sensor(recorded: Recorded) -> None:
    parents = recorded.parents
    assert all(len(names) == 1 for names in parents.values()), parents
    for frame in parents:
        chain = [frame]
        while chain[-1] != "map":
            (above,) = parents[chain[-1]]
            assert above not in chain, chain
            chain.append(above)
    for robot in recorded.trial.robots:
        assert parents[f"{robot.name}/odom"] == {"map"}
        assert parents[f"{robot.name}/base_link"] == {f"{robot.name}/odom"}
        assert {f"{robot.name}/{link}" for link in robot.body.model.links} <= set(parents)
        assert {f"{robot.name}/{mount.name}" for mount in robot.sensors} <= set(parents)
    for topic, rows in recorded.messages.items():
        for _, message in rows:
            frame = getattr(getattr(message, "header", None), "frame_id", "")
            assert frame in {"", "map", *parents}, topic
            assert getattr(message, "child_frame_id", "map") in {"map", *parents}, topic


def test_what_is_latched_is_written_once_and_first(recorded: Recorded) -> None:
    latched = {"/map", "/tf_static", "/one/robot_description", "/two/robot_description"}
    with recorded.path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        channels = {channel.topic: channel for channel in summary.channels.values()}
        counts = {summary.channels[k].topic: n for k, n in summary.statistics.channel_message_counts.items()}
        order = [channel.topic for _, channel, _ in reader.iter_messages(log_time_order=False)][:8]
    assert {topic: counts[topic] for topic in latched} == dict.fromkeys(latched, 1)
    assert set(order[1:5]) == latched
    assert order[0] == "/clock"
    for topic, channel in channels.items():
        assert ("durability: 1" in channel.metadata["offered_qos_profiles"]) == (topic in latched)
    assert {recorded.messages[topic][0][0] for topic in latched} == {0}


def test_the_description_is_the_urdf_of_the_robot(recorded: Recorded) -> None:
    for robot in recorded.trial.robots:
        text = recorded.messages[f"/{robot.name}/robot_description"][0][1].data
        assert all(f'<link name="{link}"' in text for link in robot.body.model.links)
    puck = read_urdf(recorded.messages["/two/robot_description"][0][1].data)
    assert puck.mass == pytest.approx(40.0)


def test_transforms_place_every_sensor_where_it_measured(recorded: Recorded) -> None:
    """At recorded instants; a planar reading is compared in the plane."""
    for topic, readings in recorded.episode.readings.items():
        reading = [reading for reading in readings if round(reading.time * 1e9) % 100_000_000 == 0][-1]
        found, true = recorded.pose(topic, round(reading.time * 1e9)), spatial_pose(reading.pose)
        assert found.position[0, :2] == pytest.approx(true.position[0, :2], abs=1e-6), topic
        if not isinstance(reading.pose, Pose):
            assert found.position[0, 2] == pytest.approx(true.position[0, 2], abs=1e-6), topic
            assert found.matrix == pytest.approx(true.matrix, abs=1e-6), topic
        else:
            assert math.cos(found.heading[0] - true.heading[0]) == pytest.approx(1.0), topic


def test_map_to_odom_is_the_error_of_the_odometry(recorded: Recorded) -> None:
    readings = {round(item.time * 1e9): item for item in recorded.episode.readings["one/odometry"]}
    compared = 0
    for stamp, message in recorded.messages["/one/odom"]:
        assert (message.header.frame_id, message.child_frame_id) == ("one/odom", "one/base_link")
        if stamp in readings:
            place, estimate = message.pose.pose.position, readings[stamp].estimate  # type: ignore[attr-defined]
            assert [place.x, place.y] == pytest.approx(estimate.position[0].tolist(), abs=1e-9)
            spin = message.twist.twist
            assert [spin.linear.x, spin.angular.z] == readings[stamp].twist[0, :2].tolist()  # type: ignore[attr-defined]
            compared += 1
    assert compared == 16
    found, true = recorded.episode, recorded.messages["/one/ground_truth/odom"]
    k = found.robots[0]
    assert [row.header.frame_id for _, row in true] == ["map"] * 16
    assert [row.pose.pose.position.x for _, row in true] == found.position[:, k, 0].tolist()
    last = {row.child_frame_id: row.transform.translation for row in recorded.messages["/tf"][-1][1].transforms}
    drift = math.hypot(last["one/odom"].x, last["one/odom"].y)
    assert (drift > 1e-5) == (recorded.trial.robots[0].type == "turtlebot2")
    assert (last["two/odom"].x, last["two/odom"].y) == (0.0, 0.0)
    one, two = (recorded.messages[f"/two{end}"][-1][1].pose.pose for end in ("/odom", "/ground_truth/odom"))
    assert (one.position, one.orientation) == (two.position, two.orientation)


def test_joint_states_are_those_of_the_joints_that_move(recorded: Recorded) -> None:
    robot = recorded.trial.robots[0]
    joints = {joint.name for joint in robot.body.model.joints.values() if joint.size == 1}
    stamps = [stamp for stamp, _ in recorded.messages["/one/joint_states"]]
    assert stamps == [100_000_000 * k for k in range(16)]
    last = recorded.messages["/one/joint_states"][-1][1]
    assert len(last.name) == len(last.position) == len(last.velocity)
    assert set(last.name) <= joints
    assert "/two/joint_states" not in recorded.messages
    if robot.type == "turtlebot2":
        angle = dict(zip(last.name, last.position.tolist(), strict=True))
        assert set(angle) == joints
        first = recorded.messages["/one/joint_states"][0][1]
        begin = dict(zip(first.name, first.position.tolist(), strict=True))
        path = np.hypot(*np.diff(recorded.episode.position[:, recorded.episode.robots[0]], axis=0).T).sum()
        ways = [(angle[name] - begin[name]) * 0.035 for name in ("wheel_left_joint", "wheel_right_joint")]
        assert np.mean(ways) == pytest.approx(0.0 if recorded.trial.world == "planar" else path, rel=0.05)


def test_a_recording_is_read_with_the_true_poses(recorded: Recorded) -> None:
    read, episode = read_episode(recorded.path), recorded.episode
    assert np.allclose(read.position, episode.position, rtol=0, atol=1e-12)
    assert np.allclose(read.heading, episode.heading, rtol=0, atol=1e-12)
    one, two = read.tracks(0.1), data.load(recorded.path)
    assert np.array_equal(one.x, two.x)
    assert np.array_equal(one.id, two.id)
    assert len(two.robots) == 2
    assert replay(recorded.path).equal


def test_joints_and_transforms_are_tables(recorded: Recorded, tmp_path: Path) -> None:
    import pandas as pd

    count = export(recorded.path, tmp_path / "joints.csv", "joints")
    table = pd.read_csv(tmp_path / "joints.csv")
    last = recorded.messages["/one/joint_states"][-1][1]
    rows = table[np.isclose(table["time"], 1.5)]
    assert (len(table), rows["joint"].tolist()) == (count, last.name)
    assert rows["position"].tolist() == pytest.approx(last.position.tolist())
    assert export(recorded.path, tmp_path / "frames.parquet", "transforms") > 0
    frames = pd.read_parquet(tmp_path / "frames.parquet")
    counted = Counter(frames["child"])
    assert counted["two/eye"] == 1
    assert counted["one/odom"] == len(recorded.messages["/tf"])
    row = frames[frames["child"] == "two/eye"].iloc[0]
    assert (row["parent"], row["x"], row["z"]) == ("two/base_link", 0.1, 0.4)
    assert row["qw"] == pytest.approx(math.cos(0.25))


def test_a_branch_has_the_frames_at_its_start(tmp_path: Path) -> None:
    world, first, sensor = KINDS["plane"]
    late = sensor.replace('rate="50"', 'rate="4"')
    text = TRIAL.format(world=world, first=first, sensor=late, bodies="").replace(' bodies=""', "")
    whole = record(parse_trial(text), tmp_path / "whole")
    branch(whole.path, at=0.6, out=tmp_path / "part")
    part = messages_of(tmp_path / "part" / "episode.mcap")
    stamp = 600_000_000
    for topic in ("/one/odom", "/one/ground_truth/odom", "/two/odom"):
        before, after = (dict(rows[topic])[stamp] for rows in (whole.messages, part))
        for item, two in ((before.pose.pose, after.pose.pose), (before.twist.twist, after.twist.twist)):
            assert repr(item) == repr(two), topic
    before, after = (dict(rows["/tf"])[stamp].transforms for rows in (whole.messages, part))
    rows = [{row.child_frame_id: repr(row.transform) for row in found} for found in (before, after)]
    assert {name for name in rows[0] if rows[0][name] != rows[1][name]} <= {
        "one/wheel_left",
        "one/wheel_right",
    }
    assert rows[0]["one/odom"] != rows[0]["two/odom"]
    assert [now for now, _ in part["/tf_static"]] == [stamp]
    assert (
        part["/tf_static"][0][1].transforms[0].child_frame_id
        == whole.messages["/tf_static"][0][1].transforms[0].child_frame_id
    )


def test_an_order_moves_a_joint_and_the_sensors_on_it(tmp_path: Path) -> None:
    world, _, _ = KINDS["plane"]
    text = TRIAL.format(world=world, first="pepper", sensor="", bodies="limbs")
    order = JointOrder(robot="one", joint="HeadYaw", position=0.7)
    with open_run(parse_trial(text), out=tmp_path) as running:
        for k in range(30):
            if k == 12:
                running.step([order])
            else:
                running.step()
    found = messages_of(tmp_path / "episode.mcap")
    angles = [
        dict(zip(row.name, row.position.tolist(), strict=True))["HeadYaw"] for _, row in found["/one/joint_states"]
    ]
    assert (angles[0], angles[-1]) == (0.0, 0.7)


def test_names_of_links_and_sensors_do_not_collide(tmp_path: Path) -> None:
    (tmp_path / "cart").mkdir()
    (tmp_path / "cart" / "cart.urdf").write_text(FOOT)
    (tmp_path / "cart" / "robot.xml").write_text(CART)
    text = TRIAL.format(world="planar", first="cart", sensor="", bodies="").replace(' bodies=""', "")
    trial = parse_trial(text, folder=tmp_path)
    frames = LinkFrames(trial.robots[0])
    assert frames.base == "one/base_footprint"
    assert frames.names == {
        "base_footprint": "one/base_footprint", "base_link": "one/base_link", "laser": "one/laser",
        "mast": "one/mast_link", "odom": "one/odom_link",
    }  # fmt: skip
    cart = record(trial, tmp_path / "out")
    parents = {frame: next(iter(names)) for frame, names in cart.parents.items() if frame.startswith("one")}
    assert all(len(names) == 1 for names in cart.parents.values())
    assert parents == {
        "one/odom": "map", "one/base_footprint": "one/odom", "one/base_link": "one/base_footprint",
        "one/laser": "one/mast_link", "one/mast_link": "one/base_link", "one/odom_link": "one/base_link",
        "one/mast": "one/mast_link", "one/wheels": "one/base_footprint",
    }  # fmt: skip
    assert cart.messages["/one/odom"][0][1].child_frame_id == "one/base_footprint"
    assert cart.pose("one/laser", 0).position[0, 2] == pytest.approx(0.6)
    assert cart.pose("one/mast", 0).position[0, 2] == pytest.approx(0.7)


def test_a_pose_is_expressed_in_another_frame() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        frame, inside = (Pose.of(rng.uniform(-5, 5, 2), rng.uniform(-4, 4)) for _ in range(2))
        found = relative(frame, frame.offset(*inside.position[0].tolist(), float(inside.heading[0])))
        assert found.position == pytest.approx(inside.position)
        assert found.heading == pytest.approx(inside.heading)


def test_odometry_has_the_covariance_of_its_errors_and_a_branch_continues_it(tmp_path: Path) -> None:
    trial = parse_trial("""<trial name="slip" duration="2"><crowd type="orca"/><robot name="bot" x="0" y="0">
      <drive type="differential-drive"/><goal x="9" y="3"/><navigator type="straight"/>
      <sensor name="wheels" type="wheel-odometry" rate="20" slip="0.05" noise="gaussian(0.1)"/></robot></trial>""")
    recorded = record(trial, tmp_path)
    ends = {topic: rows[-1][1] for topic, rows in recorded.messages.items()}
    sent, whole = ends["/bot/odom"], ends["/bot/wheels"]
    covariance = whole.pose.covariance.reshape(6, 6)
    assert covariance[0, 0] > 1e-4
    assert covariance[5, 5] > 1e-3
    assert covariance[1, 5] > 1e-3  # it has turned to the left before it drove on
    assert [covariance[k, k] for k in (2, 3, 4)] == [1e-9] * 3
    assert whole.twist.covariance.reshape(6, 6)[0, 0] > 0.01
    assert sent.pose.covariance.tolist() == whole.pose.covariance.tolist()
    assert sent.twist.covariance.tolist() == whole.twist.covariance.tolist()
    truth = ends["/bot/ground_truth/odom"]
    assert truth.pose.covariance.tolist() == truth.twist.covariance.tolist() == (1e-9 * np.eye(6)).ravel().tolist()
    branch(recorded.path, 1.0, out=tmp_path / "rest")
    rest = messages_of(tmp_path / "rest" / "episode.mcap")
    assert rest["/bot/odom"][-1][1].pose.covariance.tolist() == sent.pose.covariance.tolist()
