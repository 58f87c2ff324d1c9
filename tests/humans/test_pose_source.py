"""Poses are interpolated, extrapolated and read from files as documented."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.humans import BodyPose, PoseSource, PoseTrack, read_pose_file

HAND = (0.3, -0.3, 1.2, 1.0, 0.0, 0.0, 0.0)


def line(*places: float, step: float = 1.0, **how: float) -> PoseTrack:
    times = [step * k for k in range(len(places))]
    return PoseTrack.of(times, [BodyPose(x, 0.0) for x in places], **how)


def test_positions_are_linear_and_rotations_spherical() -> None:
    quarter = (0.4, -0.3, 1.4, math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    track = PoseTrack.of([0, 2], [BodyPose(0, 0, 3.0, right_hand=HAND), BodyPose(1, 0, -3.0, right_hand=quarter)])
    pose = track.at(1.0)
    assert pose.x == 0.5
    assert pose.right_hand is not None
    assert pose.right_hand[:3] == pytest.approx((0.35, -0.3, 1.3))
    angle = 2.0 * math.atan2(pose.right_hand[6], pose.right_hand[3])
    assert angle == pytest.approx(math.pi / 4)
    assert math.cos(pose.heading) == pytest.approx(-1.0)


def test_a_stream_continues_for_the_stated_time_and_then_stands() -> None:
    track = line(0.0, 0.1, step=0.1, extrapolation=0.25)
    assert [round(track.at(t).x, 9) for t in (0.05, 0.2, 0.35, 5.0)] == [0.05, 0.2, 0.35, 0.35]
    assert [round(track.motion(t).vx, 9) for t in (0.05, 0.2, 0.34, 0.35, 5.0)] == [1.0, 1.0, 1.0, 0.0, 0.0]


def test_hands_move_with_a_person_who_is_extrapolated() -> None:
    poses = [BodyPose(x, 0, right_hand=(x + 0.3, -0.3, 1.2, 1, 0, 0, 0)) for x in (0.0, 0.1)]
    hand = PoseTrack.of([0, 0.1], poses, extrapolation=1.0).at(0.3).right_hand
    assert hand is not None
    assert hand[0] == pytest.approx(0.6)


def test_a_jump_is_a_teleport_without_velocity() -> None:
    track = line(0.0, 0.1, 100.0, 100.1, step=0.1, extrapolation=1.0)
    assert track.motion(0.15).vx == 0.0
    assert track.at(0.199).x == 0.1
    assert track.at(0.2).x == 100.0
    assert track.motion(0.25).vx == pytest.approx(1.0)
    late = line(0.0, 100.0, step=0.1, extrapolation=1.0)
    assert late.motion(0.15).vx == 0.0


@given(st.permutations(list(range(8))))
def test_the_order_of_arrival_does_not_matter(order: list[int]) -> None:
    track = PoseTrack.of([], [], start=BodyPose(-1.0, 0.0))
    for k in order:
        track = track.with_sample(0.1 * k, BodyPose(float(k * k) * 0.01, 0.0))
    assert track.time.tolist() == [0.1 * k for k in range(8)]
    assert track.at(-0.5).x == -1.0
    assert track.at(0.35).x == pytest.approx(0.125)


def test_old_samples_are_dropped_and_late_ones_left_out() -> None:
    track = PoseTrack.of([], [], start=BodyPose(0.0, 0.0))
    for k in range(1000):
        track = track.with_sample(0.1 * k, BodyPose(0.0, 0.0), since=0.1 * k - 1.0)
    assert len(track.time) < 20
    assert track.with_sample(1.0, BodyPose(9.0, 0.0), since=99.0) is track


def test_the_velocity_of_a_function_is_measured_and_limited() -> None:
    class Walk(PoseSource):
        def at(self, time: float) -> BodyPose:
            return BodyPose(2.0 * time if time < 1.0 else 50.0, 0.0)

    assert Walk().motion(0.5).vx == pytest.approx(2.0)
    assert Walk().motion(0.995).vx == 0.0


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"x": math.nan, "y": 0.0}, "x = nan must be a finite number"),
        ({"x": True, "y": 0.0}, "x = True"),
        ({"x": 10**400, "y": 0.0}, "must be a finite number"),
        ({"x": 0.0, "y": 0.0, "head": (0, 0, 1.7)}, "head must be 7 numbers"),
        ({"x": 0.0, "y": 0.0, "head": "abcdefg"}, "head must be 7 numbers"),
        ({"x": 0.0, "y": 0.0, "head": (0, 0, math.inf, 1, 0, 0, 0)}, "head has a value that is not a finite number"),
        ({"x": 0.0, "y": 0.0, "left_hand": (5, 0, 1, 1, 0, 0, 0)}, "left_hand at 5, 0, 1 m must be at most 3 m"),
        ({"x": 0.0, "y": 0.0, "left_hand": (0, 0, 1, 0, 0, 0, 0)}, "that is no rotation"),
        ({"x": 0.0, "y": 0.0, "skeleton": (0.0,) * 7}, "skeleton must be 115 numbers"),
    ],
)
def test_impossible_poses_are_refused(values: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        BodyPose(**values)  # type: ignore[arg-type]


def test_a_row_holds_the_whole_pose() -> None:
    pose = BodyPose(1, 2, 0.5, head=HAND, skeleton=(1.0, 2.0, 0.9) + (1.0, 0.0, 0.0, 0.0) * 28)
    assert BodyPose.of_row(pose.row()) == pose


def test_csv_and_json_lines_give_the_same_poses() -> None:
    hand = ",".join(f"right_hand_{name}" for name in ("x", "y", "z", "qw", "qx", "qy", "qz"))
    table = f"time,x,y,heading,{hand}\n1,0,0,0,,,,,,,\n2,1,0,0.5,0.3,-0.3,1.2,1,0,0,0\n"
    second = {"time": 2, "x": 1, "y": 0, "heading": 0.5, "right_hand": [0.3, -0.3, 1.2, 1, 0, 0, 0]}
    lines = '{"time": 1, "x": 0, "y": 0}\n\n' + json.dumps(second)
    one, two = read_pose_file(table.encode(), "a.csv", begin=1.0), read_pose_file(lines.encode(), "a.jsonl", begin=1.0)
    assert one.time.tolist() == two.time.tolist() == [0.0, 1.0]
    assert np.array_equal(one.rows, two.rows, equal_nan=True)
    assert one.at(1.0).right_hand == HAND


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csv", "", "a.csv:1: time, x, y is missing"),
        ("a.csv", "time,x,y\n", "a.csv has no samples"),
        ("a.csv", "time,x,y,speed\n0,0,0,1\n", "'speed' is unknown"),
        ("a.csv", "time,x,y,x\n0,0,0,1\n", "same name"),
        ("a.csv", "time,x,y,head_x\n0,0,0,1\n", "head needs the columns head_x"),
        ("a.csv", "time,x,y\n0,0\n", "a.csv:2: there are 2 cells, expected 3"),
        ("a.csv", "time,x,y\n0,0,far\n", "a.csv:2: y = 'far' must be a finite number"),
        ("a.csv", "time,x,y\n0,,0\n", "a.csv:2: x is missing"),
        ("a.csv", "time,x,y\n,0,0\n", "a.csv:2: time = None"),
        ("a.csv", "time,x,y\n1,0,0\n1,0,0\n", "a.csv:3: time 1 s must be later"),
        ("a.csv", "time,x,y\n1,1e9,0\n", "a.csv:2: x = "),
        ("a.jsonl", "{", "a.jsonl:1: this is not JSON"),
        ("a.jsonl", "[1]", "must be a JSON object"),
        ("a.jsonl", '{"time": 0, "x": "a", "y": 0}', "a.jsonl:1: x = 'a' must be a finite number"),
        ("a.jsonl", '{"time": NaN, "x": 0, "y": 0}', "a.jsonl:1: time = nan"),
        ("a.jsonl", '{"time": 0, "x": 0, "y": 0, "head": [1]}', "a.jsonl:1: head must be 7 numbers"),
    ],
)
def test_wrong_files_are_refused_with_the_line(name: str, text: str, message: str) -> None:
    with pytest.raises(InputError) as told:
        read_pose_file(text.encode(), name)
    assert message in str(told.value)


def test_parts_come_at_their_own_rates() -> None:
    """The head is sampled four times as often as the hand, in samples that lack the other."""
    times, poses = [], []
    for k in range(42):
        time = 0.025 * k
        head = (time, 0.0, 1.6, 1.0, 0.0, 0.0, 0.0)
        hand = (time + 0.3, -0.2, 1.0 + time, 1.0, 0.0, 0.0, 0.0)
        times.append(time)
        poses.append(BodyPose(time, 0.0, 0.0, head=head, right_hand=hand if k % 4 == 0 else None))
    track = PoseTrack.of(times, poses, part_timeout=0.15, extrapolation=0.5)
    alone = PoseTrack.of(times, poses)
    for time in (0.0, 0.01, 0.03, 0.06, 0.1, 0.33, 0.99):
        found = track.at(time)
        assert found.right_hand is not None
        assert found.right_hand[:3] == pytest.approx((time + 0.3, -0.2, 1.0 + time))
        assert found.head is not None
        assert found.head[:3] == pytest.approx((time, 0.0, 1.6))
        assert track.motion(time).vx == alone.motion(time).vx
    assert alone.at(0.03).right_hand is None
    late = track.at(1.1)
    assert late.right_hand is not None
    assert late.right_hand[:3] == pytest.approx((1.4, -0.2, 2.0))  # it moves with the person
    assert track.at(1.2).right_hand is None
    gap = PoseTrack.of([0.0, 0.5, 1.0], [poses[0], BodyPose(0.5, 0.0), poses[40]], part_timeout=0.2)
    assert gap.at(0.45).right_hand is not None  # the sample before has it
    assert gap.at(0.7).right_hand is None
