"""Tracks out of recorded episodes: MCAP with people_msgs and odometry, written here message by message."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap_messages import McapRecording

from crowdbot.core import DataError
from crowdbot.data import load

WALLS = [[[0.0, 0.0], [4.0, 0.0]], [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]]


def write(path, steps=60, period=100_000_000, begin=5 * 10**9, finish=True):
    """Write two people who walk apart, one leaves at half time, and a robot with poses at the same stamps."""
    with McapRecording(path, finish) as recording:
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
    with McapRecording(tmp_path / "mixed.mcap") as recording:
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
    with McapRecording(tmp_path / "words.mcap") as recording:
        recording.people(0, {"ada": (0, 0), "7": (1, 1)})
        recording.people(10**9, {"7": (1, 1)})
    assert load(tmp_path / "words.mcap").id.tolist() == [1, 2, 2]


def test_a_recording_without_people_or_robots_in_it(tmp_path):
    with McapRecording(tmp_path / "alone.mcap") as recording:
        for k in range(3):
            recording.people(k * 10**8, {})
            recording.odometry(k * 10**8, k, 0)
    tracks = load(tmp_path / "alone.mcap")
    assert (tracks.ids.tolist(), tracks.robots) == ([1], frozenset({1}))
    with pytest.raises(DataError, match="contains only robots, no people to predict"):
        tracks.windows(1, 1)


def test_a_recording_that_stopped_in_the_middle(tmp_path):
    whole = write(tmp_path / "episode.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    for share in (0.01, 0.3, 0.6, 0.9, 0.999):
        cut.write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(DataError, match=r"cut\.mcap cannot be read as MCAP, it is truncated or damaged") as error:
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
        ("foreign", r"has no topic /people of people_msgs/msg/People, .*; it has /robot/odom"),
        ("once", "has 1 messages on /people, at least 2 are required"),
        ("back", "the stamp of message 6 on /people is not later than the previous one"),
        ("uneven", "the stamps on /people are not regular, some steps are far shorter than 100 ms"),
        ("twice", "frame 0, id 4 is a duplicate"),
        ("nan", "x is nan for frame 1, id 4"),
        ("walls", "the metadata 'walls' is not a JSON list of rings"),
        ("ring", "ring 1 of the metadata 'walls' is not a list of finite points"),
    ],
)
def test_recordings_of_something_else(tmp_path, what, message):
    path = tmp_path / "odd.mcap"
    with McapRecording(path) as recording:
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
