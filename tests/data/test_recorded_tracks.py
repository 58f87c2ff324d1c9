"""Tracks out of recorded episodes: MCAP with people_msgs and odometry, written here message by message."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from crowdbot.core import DataError
from crowdbot.data import load

PERSON = """string name
geometry_msgs/Point position
geometry_msgs/Point velocity
float64 reliability
string[] tagnames
string[] tags
"""
PEOPLE = "std_msgs/Header header\npeople_msgs/Person[] people\n"
WALLS = [[[0.0, 0.0], [4.0, 0.0]], [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]]


def types():
    """Return a store that knows people_msgs."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(PERSON, "people_msgs/msg/Person"))
    store.register(get_types_from_msg(PEOPLE, "people_msgs/msg/People"))
    return store


class Recording:
    """Writes messages as a ROS 2 recorder does."""

    def __init__(self, path, finish=True):
        self.store, self.path, self.finish = types(), path, finish
        self.make = lambda kind, **fields: self.store.types[kind](**fields)

    def __enter__(self):
        self.file = self.path.open("wb")
        self.writer = Writer(self.file, compression=CompressionType.ZSTD)
        self.writer.start(profile="ros2", library="test")
        self.channels = {}
        return self

    def __exit__(self, *_):
        if self.finish:
            self.writer.finish()
        self.file.close()

    def write(self, topic, message, nanoseconds):
        kind = message.__msgtype__
        if topic not in self.channels:
            text = self.store.generate_msgdef(kind, ros_version=2)[0].encode()
            self.channels[topic] = self.writer.register_channel(
                topic, "cdr", self.writer.register_schema(kind, "ros2msg", text)
            )
        data = bytes(self.store.serialize_cdr(message, kind))
        self.writer.add_message(self.channels[topic], nanoseconds, data, nanoseconds)

    def header(self, nanoseconds):
        sec, nanosec = divmod(nanoseconds, 10**9)
        stamp = self.make("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id="map")

    def point(self, x, y):
        return self.make("geometry_msgs/msg/Point", x=float(x), y=float(y), z=0.0)

    def people(self, nanoseconds, persons):
        """Write {name: (x, y)}."""
        everyone = [
            self.make(
                "people_msgs/msg/Person",
                name=str(name),
                position=self.point(*place),
                velocity=self.point(0, 0),
                reliability=1.0,
                tagnames=[],
                tags=[],
            )
            for name, place in persons.items()
        ]
        message = self.make("people_msgs/msg/People", header=self.header(nanoseconds), people=everyone)
        self.write("/people", message, nanoseconds)

    def odometry(self, nanoseconds, x, y, topic="/robot/odom"):
        turn = self.make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
        pose = self.make("geometry_msgs/msg/Pose", position=self.point(x, y), orientation=turn)
        zero = self.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        message = self.make(
            "nav_msgs/msg/Odometry",
            header=self.header(nanoseconds),
            child_frame_id="robot/base_link",
            pose=self.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36)),
            twist=self.make(
                "geometry_msgs/msg/TwistWithCovariance",
                twist=self.make("geometry_msgs/msg/Twist", linear=zero, angular=zero),
                covariance=np.zeros(36),
            ),
        )
        self.write(topic, message, nanoseconds)

    def metadata(self, **values):
        self.writer.add_metadata("crowdbot", values)


def write(path, steps=60, period=100_000_000, begin=5 * 10**9, finish=True):
    """Write two people who walk apart, one leaves at half time, and a robot with poses at the same stamps."""
    with Recording(path, finish) as recording:
        for k in range(steps):
            now = begin + k * period
            persons = {3: (0.1 * k, 1.0), 12: (-0.1 * k, 2.0)}
            recording.people(now, persons if k < steps // 2 else {3: persons[3]})
            recording.odometry(now, 0.05 * k, 0.0)
        recording.metadata(walls=json.dumps(WALLS), seed="1")
    return path


def test_people_robots_and_walls(tmp_path):
    tracks = load(write(tmp_path / "episode.mcap"))
    assert (len(tracks), tracks.dt, tracks.frame_step, tracks.units) == (60 + 30 + 60, 0.1, 1, "m")
    assert (tracks.ids.tolist(), tracks.robots) == ([3, 12, 13], frozenset({13}))
    assert tracks.track(3).x.tolist() == [0.1 * k for k in range(60)]
    assert tracks.track(13).x.tolist() == [0.05 * k for k in range(60)]
    assert [ring.tolist() for ring in tracks.walls] == WALLS


def test_an_episode_becomes_windows_at_the_steps_of_the_field(tmp_path):
    tracks = load(write(tmp_path / "episode.mcap", steps=100)).resample(0.4)
    assert (tracks.dt, tracks.frame_step, tracks.robots) == (0.4, 4, frozenset({13}))
    past, future = tracks.windows(near=50.0)
    assert past.id[0].tolist() == [3, 12, 13]
    assert future.scored[0].tolist() == [True, False, False]
    assert past.robot[0].tolist() == [False, False, True]
    assert len(past.walls) == 2


def test_robots_at_their_own_rate_are_brought_to_the_stamps_of_people(tmp_path):
    with Recording(tmp_path / "mixed.mcap") as recording:
        recording.odometry(0, 9.0, 9.0, topic="/second/odom")
        for k in range(10):
            recording.people(k * 100_000_000, {"4": (k, 0)})
        for k in range(4):
            recording.odometry(50_000_000 + k * 150_000_000, k * 1.5, 0.0, topic="/first/odom")
    tracks = load(tmp_path / "mixed.mcap")
    assert tracks.robots == frozenset({5, 6})
    assert tracks.track(5).position.tolist() == [[9.0, 9.0]]
    assert tracks.track(6).frame.tolist() == [1, 2, 3, 4, 5]
    assert tracks.track(6).x == pytest.approx([0.5, 1.5, 2.5, 3.5, 4.5])


def test_names_that_are_words_are_numbered(tmp_path):
    with Recording(tmp_path / "words.mcap") as recording:
        recording.people(0, {"ada": (0, 0), "7": (1, 1)})
        recording.people(10**9, {"7": (1, 1)})
    assert load(tmp_path / "words.mcap").id.tolist() == [1, 2, 2]


def test_a_recording_without_people_or_robots_in_it(tmp_path):
    with Recording(tmp_path / "alone.mcap") as recording:
        for k in range(3):
            recording.people(k * 10**8, {})
            recording.odometry(k * 10**8, k, 0)
    tracks = load(tmp_path / "alone.mcap")
    assert (tracks.ids.tolist(), tracks.robots) == ([1], frozenset({1}))
    with pytest.raises(DataError, match="holds robots only, there is nobody to predict"):
        tracks.windows(1, 1)


def test_a_recording_that_stopped_in_the_middle(tmp_path):
    whole = write(tmp_path / "episode.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    for share in (0.01, 0.3, 0.6, 0.9, 0.999):
        cut.write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(DataError, match=r"cut\.mcap cannot be read as MCAP, it is cut short or damaged") as error:
            load(cut)
        assert "\n" not in str(error.value)
    write(cut, finish=False)
    with pytest.raises(DataError, match=r"cut\.mcap"):
        load(cut)


@given(spot=st.floats(0.0, 1.0), byte=st.integers(0, 255))
@settings(deadline=None, max_examples=25)
def test_a_damaged_recording_says_so(tmp_path_factory, spot, byte):
    path = tmp_path_factory.mktemp("damaged") / "damaged.mcap"
    whole = bytearray(write(path, steps=10).read_bytes())
    whole[int(spot * (len(whole) - 1))] = byte
    path.write_bytes(bytes(whole))
    try:
        found = load(path)
    except DataError as error:
        found = str(error)
    assert "damaged.mcap" in (found if isinstance(found, str) else found.name)


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ("foreign", r"has no topic /people of people_msgs/msg/People; it has /robot/odom"),
        ("once", "holds 1 messages on /people, at least 2 are needed"),
        ("back", "the stamp of message 6 on /people is not after the one before"),
        ("uneven", "the stamps on /people are not regular, some are far nearer than 100 ms"),
        ("twice", "frame 0, id 4 stands there a second time"),
        ("nan", "x is nan for frame 1, id 4"),
        ("walls", "the metadata 'walls' is not a JSON list of rings"),
        ("ring", "ring 1 of the metadata 'walls' is not a list of finite points"),
    ],
)
def test_recordings_of_something_else(tmp_path, what, message):
    path = tmp_path / "odd.mcap"
    with Recording(path) as recording:
        recording.odometry(0, 0, 0)
        if what != "foreign":
            recording.people(0, {"4": (0, 0), **({"04": (1, 1)} if what == "twice" else {})})
        if what not in ("foreign", "once"):
            for k in (1, 2, 3, 4):
                recording.people(k * 100_000_000, {"4": (np.nan if what == "nan" else k, 0)})
        if what == "uneven":
            recording.people(401_000_000, {"4": (0, 0)})
        if what == "back":
            recording.people(400_000_000, {"4": (0, 0)})
        if what in ("walls", "ring"):
            recording.metadata(walls="{]" if what == "walls" else "[[[0, 0], [1, 1]], [[0, NaN]]]")
    with pytest.raises(DataError, match=message):
        load(path)
