"""Recordings: one MCAP file that other tools open, equal to the episode, and never half a file."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import signal
import subprocess
import sys
from collections import Counter
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Chunk
from rosbags.highlevel import AnyReader

import crowdbot
from crowdbot import data
from crowdbot.core import EpisodeError, InputError
from crowdbot.recording import RecordedEpisode, read_episode, record, run
from crowdbot.sensors import Reading, Sensor, SensorView
from crowdbot.simulation import Episode
from crowdbot.trials import Mount, load_trial, parse_trial
from trial_texts import GOOD, changed

TRIAL = parse_trial(GOOD)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Episode]:
    """Return a file and the episode it was written from."""
    folder = tmp_path_factory.mktemp("episode")
    return folder / "episode.mcap", run(TRIAL, out=folder)


def test_the_file_is_the_episode(recorded: tuple[Path, Episode]) -> None:
    path, episode = recorded
    read = read_episode(path)
    assert os.listdir(path.parent) == ["episode.mcap"]
    for name in ("times", "active", "ids", "radius", "commands"):
        assert np.array_equal(getattr(read, name), getattr(episode, name)), name
    people = slice(0, 4)
    for name in ("position", "velocity", "heading"):
        assert np.array_equal(getattr(read, name)[:, people], getattr(episode, name)[:, people]), name
        assert np.allclose(getattr(read, name), getattr(episode, name), rtol=0, atol=1e-12), name
    assert np.array_equal(read.position[:, 4], episode.position[:, 4])
    assert (read.robots, read.outcome, read.digest, read.seed) == ((4,), episode.outcome, episode.digest, 3)
    assert (read.steps, read.name, read.version) == (episode.steps, "small", crowdbot.__version__)
    assert parse_trial(read.xml) == TRIAL
    assert [ring.tolist() for ring in read.walls] == [ring.tolist() for ring in episode.walls]
    assert read.metrics == pytest.approx(dict(episode.metrics), nan_ok=True)
    assert len(read.scans) == len(episode.scans) == 41
    for scan, two in zip(read.scans, episode.scans, strict=True):
        assert scan.time == two.time
        assert scan.pose == two.pose
        assert np.array_equal(scan.ranges, two.ranges.astype(np.float32).astype(np.float64))
        assert np.array_equal(scan.hit, two.hit)
        assert np.allclose(scan.angles, two.angles, atol=1e-5)
    for item, two in ((read.tracks(), episode.tracks()), (read.tracks(0.1), data.load(path))):
        assert np.array_equal(item.x, two.x)
        assert np.array_equal(item.id, two.id)
        assert np.array_equal(item.frame, two.frame)


def expected(episode: Episode) -> dict[str, int]:
    count = len(episode.times)
    robot = ("/robot/odom", "/robot/ground_truth/odom", "/robot/cmd_vel", "/robot/scan", "/robot/scan/reading")
    topics = dict.fromkeys(("/clock", "/tf", "/people", *robot), count)
    topics |= {"/tf_static": 1, "/map": 1, "/robot/robot_description": 1}
    topics["/crowdbot/digest"] = count
    return topics | {"/crowd/markers": 9}


def test_rosbags_opens_the_file(recorded: tuple[Path, Episode]) -> None:
    path, episode = recorded
    count: Counter[str] = Counter()
    with AnyReader([path]) as reader:
        for connection, stamp, raw in reader.messages():
            count[connection.topic] += 1
            message: Any = reader.deserialize(raw, connection.msgtype)
            header = getattr(message, "header", None)
            assert header is None or header.stamp.sec * 10**9 + header.stamp.nanosec == stamp
            k = round(stamp / 1e8)
            if connection.topic == "/people":
                assert [int(person.name) for person in message.people] == np.flatnonzero(episode.active[k, :4]).tolist()
                assert [person.position.x for person in message.people] == episode.position[k, :4, 0].tolist()
            if connection.topic in ("/robot/odom", "/robot/ground_truth/odom"):  # equal without odometry
                frame = "robot/odom" if connection.topic == "/robot/odom" else "map"
                assert (message.header.frame_id, message.child_frame_id) == (frame, "robot/base_link")
                assert message.pose.pose.position.y == episode.position[k, 4, 1]
            if connection.topic == "/robot/scan":
                assert message.header.frame_id == "robot/scan"
                assert message.ranges.shape == (90,)
            if connection.topic == "/tf":
                frames = [(t.header.frame_id, t.child_frame_id) for t in message.transforms]
                assert frames == [("map", "robot/odom"), ("robot/odom", "robot/base_link")]
            if connection.topic == "/tf_static":
                (mount,) = message.transforms
                assert (mount.header.frame_id, mount.child_frame_id) == ("robot/base_link", "robot/scan")
                assert mount.transform.translation.x == 0.1
            if connection.topic == "/crowd/markers":
                assert Counter(marker.ns for marker in message.markers) == {
                    "clear": 1, "people": 4, "robots": 1, "goals": 1, "walls": 1,
                }  # fmt: skip
    assert dict(count) == expected(episode)


def test_the_index_of_a_chunk_has_the_position_and_the_sizes_of_the_chunk(recorded: tuple[Path, Episode]) -> None:
    path, _ = recorded
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert summary.chunk_indexes
    data = path.read_bytes()
    for index in summary.chunk_indexes:
        assert data[index.chunk_start_offset] == Opcode.CHUNK
        begin = index.chunk_start_offset + 9  # the opcode and the length of the record
        chunk = Chunk.read(ReadDataStream(BytesIO(data[begin : index.chunk_start_offset + index.chunk_length])))
        assert (len(chunk.data), chunk.uncompressed_size) == (index.compressed_size, index.uncompressed_size)


def test_the_mcap_reader_alone_opens_the_file(recorded: tuple[Path, Episode]) -> None:
    path, episode = recorded
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        assert reader.get_header().library == f"crowdbot {crowdbot.__version__}"
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        counts = {summary.channels[k].topic: n for k, n in summary.statistics.channel_message_counts.items()}
        assert counts == expected(episode)
        kinds = {c.topic: summary.schemas[c.schema_id] for c in summary.channels.values()}
        assert kinds["/people"].name == "people_msgs/msg/People"
        assert kinds["/people"].encoding == "ros2msg"
        assert b"MSG: people_msgs/Person\nstring name\ngeometry_msgs/Point position" in kinds["/people"].data
        stamps = [message.log_time for _, _, message in reader.iter_messages(topics=["/clock"])]
        assert stamps == [round(t * 1e9) for t in episode.times]
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
    assert set(metadata["crowdbot"]) == {
        "format", "trial", "trial_name", "seed", "version", "python", "numpy", "numba", "processor", "step_ns", "walls",
        "robots",
    }  # fmt: skip
    assert set(metadata["crowdbot.end"]) == {"digest", "outcome", "steps", "people", "metrics"}
    assert json.loads(metadata["crowdbot"]["robots"])[0]["name"] == "robot"
    assert json.loads(metadata["crowdbot.end"]["metrics"])["path_length"] == episode.metrics["path_length"]


def test_the_same_run_writes_the_same_file_over_an_old_one(recorded: tuple[Path, Episode], tmp_path: Path) -> None:
    target = tmp_path / "a" / "b" / "mine.mcap"
    target.parent.mkdir(parents=True)
    target.write_text("old")
    with pytest.raises(InputError, match=r"mine\.mcap already exists; use another path, or --force"):
        run(TRIAL, out=target)
    assert (target.read_text(), os.listdir(target.parent)) == ("old", ["mine.mcap"])
    run(TRIAL, out=target, force=True)
    assert target.read_bytes() == recorded[0].read_bytes()
    assert os.listdir(target.parent) == ["mine.mcap"]


def test_ctrl_c_leaves_a_whole_file(tmp_path: Path) -> None:
    def press(share: float) -> None:
        if 0.49 < share < 0.505:
            signal.raise_signal(signal.SIGINT)

    episode = run(TRIAL, out=tmp_path / "out", progress=press)
    assert episode.outcome == "interrupted"
    read = read_episode(tmp_path / "out" / "episode.mcap")
    assert (read.outcome, read.steps, read.digest) == ("interrupted", 42, episode.digest)
    assert np.array_equal(read.position[:, :4], episode.position[:, :4])
    assert len(data.load(tmp_path / "out" / "episode.mcap")) == int(episode.active.sum())


@pytest.mark.live
def test_ctrl_c_from_the_keyboard_leaves_a_whole_file(tmp_path: Path) -> None:
    code = (
        "import sys; from crowdbot.recording import run; from crowdbot.trials import parse_trial\n"
        "say = lambda share: print(share, flush=True)\n"
        "print(run(parse_trial(sys.stdin.read()), out=sys.argv[1], progress=say).outcome)"
    )
    text = changed('duration="4"', 'duration="4000"')
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(text)
    process.stdin.close()
    process.stdout.readline()
    process.send_signal(signal.SIGINT)
    said = process.stdout.read()
    process.stdout.close()
    assert process.wait() == 0
    assert said.split()[-1] == "interrupted"
    read = read_episode(tmp_path / "episode.mcap")
    assert read.outcome == "interrupted"
    assert len(read.times) == 1 + read.steps // 2
    assert os.listdir(tmp_path) == ["episode.mcap"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Thermometer(Sensor):
    """Measures something that has no message."""

    def measure(self, view: SensorView, state: None, rng: Any = None) -> tuple[Reading, None]:
        return Reading(view.time, view.pose), None


def test_a_run_that_fails_keeps_what_is_done(tmp_path: Path) -> None:
    def fail(share: float) -> None:
        if share > 0.6:
            raise RuntimeError("a bug")

    with pytest.raises(RuntimeError, match="a bug"):
        run(TRIAL, out=tmp_path / "a" / "b", progress=fail)
    assert os.listdir(tmp_path / "a" / "b") == ["episode.mcap"]
    read = read_episode(tmp_path / "a" / "b" / "episode.mcap")
    assert (read.complete, read.outcome) == (False, "interrupted")
    assert 0.6 * 4 - 0.6 < read.times[-1] <= 0.61 * 4


def test_nothing_is_left_behind_before_the_first_instant(tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "episode.mcap").write_text("old")
    warm = dataclasses.replace(TRIAL.robots[0], sensors=[Mount(name="warm", sensor=Thermometer())])
    for place in ("c", "kept"):
        with pytest.raises(
            EpisodeError, match=r"'robot/warm' returns a Reading, which has no ROS message; return one of Scan"
        ):
            run(dataclasses.replace(TRIAL, robots=[warm]), out=tmp_path / place, force=True)
    assert os.listdir(tmp_path) == ["kept"]
    assert os.listdir(tmp_path / "kept") == ["episode.mcap"]
    assert (tmp_path / "kept" / "episode.mcap").read_text() == "old"


def test_a_trial_that_has_no_xml_is_not_recorded(tmp_path: Path) -> None:
    @dataclasses.dataclass(frozen=True, kw_only=True)
    class Local(Thermometer):
        pass

    local = dataclasses.replace(TRIAL.robots[0], sensors=[Mount(name="warm", sensor=Local())])
    with pytest.raises(InputError, match="Local cannot be named in a trial file: move it to a module"):
        run(dataclasses.replace(TRIAL, robots=[local]), out=tmp_path / "c")
    assert os.listdir(tmp_path) == []


def test_a_place_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match=r"file is a file; give a folder for the episode"):
        run(TRIAL, out=tmp_path / "file")
    with pytest.raises(EpisodeError, match=r"cannot write .*episode.mcap: Not a directory; use another file"):
        run(TRIAL, out=tmp_path / "file" / "deeper")
    (tmp_path / "folder.mcap").mkdir()
    with pytest.raises(InputError, match=r"folder.mcap is a folder; give a file name"):
        run(TRIAL, out=tmp_path / "folder.mcap")


def test_files_that_are_no_episodes_are_refused_in_a_sentence(recorded: tuple[Path, Episode], tmp_path: Path) -> None:
    whole = recorded[0].read_bytes()

    def refused(content: bytes) -> str:
        path = tmp_path / "x.mcap"
        path.write_bytes(content)
        with pytest.raises(EpisodeError) as found:
            read_episode(path)
        assert "\n" not in str(found.value)
        return str(found.value).removeprefix(f"{path} ")

    assert refused(b"") == "is empty"
    assert refused(b"id,frame,x,y\n1,2,3,4\n").startswith("is not an MCAP file: it starts with b'id,frame'")
    assert refused(whole[:8]).startswith("is an MCAP file but not an episode of crowdbot")
    assert refused(whole[:3000]).startswith("has no recorded steps: the run was killed before the first one")
    assert refused(whole[:3000] + whole[-37:]).startswith("is damaged")
    hole = whole[: len(whole) // 2] + bytes(2000) + whole[len(whole) // 2 + 2000 :]
    assert refused(hole).startswith("is damaged")
    with pytest.raises(EpisodeError, match="there is no episode file"):
        read_episode(tmp_path / "none.mcap")
    with pytest.raises(EpisodeError, match=r"is a folder; give the episode.mcap in it"):
        read_episode(tmp_path)


def test_other_mcap_files_are_refused(tmp_path: Path) -> None:
    from mcap.writer import Writer

    path = tmp_path / "other.mcap"
    for metadata, sentence in (({}, "not an episode of crowdbot"), ({"seed": "1"}, "not an episode of crowdbot")):
        with path.open("wb") as stream:
            writer = Writer(stream)
            writer.start()
            if metadata:
                writer.add_metadata("crowdbot", metadata)
            writer.finish()
        with pytest.raises(EpisodeError, match=sentence):
            read_episode(path)
    keys = (
        {"format": "3"}
        | dict.fromkeys(RecordedEpisode.__dataclass_fields__, "")
        | dict.fromkeys(
            (
                "trial",
                "trial_name",
                "seed",
                "version",
                "digest",
                "outcome",
                "steps",
                "people",
                "metrics",
                "walls",
                "robots",
            ),
            "nonsense",
        )
    )
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        writer.add_metadata("crowdbot", keys)
        writer.finish()
    with pytest.raises(EpisodeError, match="has an invalid metadata record 'crowdbot'"):
        read_episode(path)


def test_damaged_bytes_never_show_a_stack_trace(recorded: tuple[Path, Episode], tmp_path: Path) -> None:
    whole = recorded[0].read_bytes()
    chance = np.random.default_rng(0)
    path = tmp_path / "x.mcap"
    wrong: list[str] = []
    for _ in range(60):
        content = bytearray(whole)
        for place in chance.integers(8, len(whole) - 8, 20):
            content[place] ^= 1 << int(chance.integers(8))
        path.write_bytes(bytes(content))
        try:
            read_episode(path)
        except EpisodeError as error:
            wrong.append(str(error))
    assert len(wrong) > 50
    assert all("damaged" in sentence or "does not hold" in sentence for sentence in wrong)


@pytest.mark.parametrize("name", ["four-blocks", "blind-corner", "circle-crossing"])
def test_the_map_is_occupied_where_a_solid_is_near_or_the_area_ends(name: str, tmp_path: Path) -> None:
    trial = load_trial(name, duration=0.1)
    record(trial, out=tmp_path)
    with AnyReader([tmp_path / "episode.mcap"]) as bag:
        links = [link for link in bag.connections if link.topic == "/map"]
        ((_, stamp, raw),) = bag.messages(links)
        grid = bag.deserialize(raw, links[0].msgtype)
    info, corner = grid.info, grid.info.origin.position
    cell = round(info.resolution, 6)  # the message has 32 bits
    x, y = corner.x + cell * (np.arange(info.width) + 0.5), corner.y + cell * (np.arange(info.height) + 0.5)
    away = trial.stage.clearance(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
    occupied = np.where(away <= cell * math.sqrt(0.5), 100, 0)
    assert (stamp, grid.header.frame_id) == (0, "map")
    assert np.array_equal(grid.data, occupied)
    assert bool(occupied.any()) == bool(trial.stage.rings)
