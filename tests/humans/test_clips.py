"""Clips: motion capture on all bodies, against the gait that it was made of, and hostile files."""

import json

import numpy as np
import pytest
from bvh_texts import DT, SPEED, walking_bvh

from crowdbot.core import InputError
from crowdbot.humans import Clip, Gait, People, clip_of, names, read_bvh, read_clip, shapes, write_clip


@pytest.fixture(scope="module")
def walking():
    """Return the clip of a walk."""
    return clip_of(read_bvh(walking_bvh(), "walk.bvh"), "walk.clip")


def directions(posture, row=0):
    """Return the unit vectors along thighs, shanks and arms ``[8, 3]``."""
    ends = (("thigh", "calf"), ("calf", "foot"), ("upperarm", "lowerarm"), ("lowerarm", "hand"))
    found = []
    for first, last in ends:
        for side in "lr":
            a, b = (posture.position[row, shapes().bone(f"{name}_{side}")] for name in (first, last))
            found.append((b - a) / np.linalg.norm(b - a))
    return np.array(found)


def test_a_walk_is_one_cycle_in_step_with_the_way(walking):
    assert walking.cyclic
    assert walking.rate == pytest.approx(60.0, rel=1e-3)
    assert 0.9 < len(walking.lift) / walking.rate < 1.4  # a cycle at 1.3 m/s takes about 1.1 s
    assert walking.lift.max() < 0.01


def test_the_clip_of_a_gait_gives_the_postures_of_the_gait(walking):
    """The same body, walking in another direction with the clip of its own gait, has limbs in the same directions."""
    people = People.of(["man-32"])
    played = Gait(People(people.persons, people.variation, people.height, (walking,)), seed=1)
    gait = Gait(people, seed=1)
    way = SPEED * np.array([[0.0, 1.0]])
    with_clip = played.start(np.zeros((1, 2)), [np.pi / 2], way, "walk.clip")
    plain = gait.start(np.zeros((1, 2)), [np.pi / 2], way)
    angles = []
    for k in range(150):
        with_clip = played.step(with_clip, way * DT * (k + 1), way, [np.pi / 2], DT)
        plain = gait.step(plain, way * DT * (k + 1), way, [np.pi / 2], DT)
        if k > 60:
            a, b = directions(played.posture(with_clip)), directions(gait.posture(plain))
            angles.append(np.degrees(np.arccos(np.clip(np.sum(a * b, axis=1), -1.0, 1.0))))
    assert np.mean(angles) < 6.0
    assert np.max(angles) < 30.0


@pytest.mark.parametrize("name", names()[::9])
def test_all_bodies_play_a_clip_with_a_foot_on_the_floor(walking, name):
    people = People.of([name])
    gait = Gait(People(people.persons, people.variation, people.height, (walking,)))
    state = gait.start([[0.0, 0.0]], [0.0], [[1.2, 0.0]], "walk.clip")
    for k in range(40):
        state = gait.step(state, [[0.024 * (k + 1), 0.0]], [[1.2, 0.0]], [0.0], 0.02)
        low = gait.skin(state, 0)[..., 2].min()
        assert -0.02 < low < 0.03


def test_a_clip_survives_its_file(walking):
    again = read_clip(write_clip(walking), "walk.clip")
    np.testing.assert_allclose(again.rotations, walking.rotations, atol=1e-6)
    assert (again.cyclic, again.bones, again.rate) == (walking.cyclic, walking.bones, walking.rate)


def test_who_stands_is_played_in_time():
    still = clip_of(read_bvh(walking_bvh(speed=0.0, frames=30), "stand.bvh"), "stand.clip")
    assert not still.cyclic
    assert len(still.lift) == 30


def one(**changes):
    """Return the text of a clip with changed values."""
    values = {"format": "crowdbot-clip-1", "rate": 30, "cyclic": False, "bones": ["head"],
              "rotations": [[[1, 0, 0, 0]], [[1, 0, 0, 0]]], "lift": [0, 0]}  # fmt: skip
    return json.dumps(values | changes)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", r"x.clip is not JSON"),
        ("[1]", r"x.clip is no clip: its format must be 'crowdbot-clip-1'; crowdbot new clip FILE.bvh writes one"),
        (one(more=1), r"x.clip has the keys .*more"),
        (one(rate="fast"), r"x.clip: rate, rotations and lift must be numbers"),
        (one(rate=0), r"x.clip: rate = 0.0 Hz must be from 1 to 1000"),
        (one(bones=["tail"]), r"x.clip has unknown bone 'tail'; bones are pelvis"),
        (one(rotations=[[[1, 0, 0, 0]]]), r"rotations have shape \[1, 1, 4\]; they must be \[T, 1, 4\] for 2 frames"),
        (one(rotations=[[[0, 0, 0, 0]]] * 2), r"a quaternion has a length of 0; it must be 1"),
        (one(lift=[0, -1]), r"a lift is not from 0 to 2 leg lengths"),
        (one(cyclic=1), r"cyclic must be true or false"),
        ("[" * 100_000, r"x.clip is not JSON"),
    ],
)
def test_a_wrong_clip_is_refused_in_a_sentence(text, message):
    with pytest.raises(InputError, match=message):
        read_clip(text, "x.clip")


GOOD = walking_bvh(frames=12).splitlines()


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["nothing"], r"x.bvh is no BVH file: it must have HIERARCHY in its first line, and a line MOTION"),
        (GOOD[:3] + ["\tOFFSET 0 nan 0"] + GOOD[4:], r"x.bvh:4: there are 3 numbers, expected 3 finite ones"),
        (GOOD[:3] + ["\tOFFSET 0 0"] + GOOD[4:], r"x.bvh:4: there are 2 numbers, expected 3"),
        (GOOD[:4] + ["\tCHANNELS 2 Xposition Wposition"] + GOOD[5:], r"x.bvh:5: channels must be a number and as many"),
        (GOOD[:5] + ["\tWHAT"] + GOOD[5:], r"x.bvh:6: 'WHAT' is not expected here"),
        (GOOD[:-1], r"x.bvh has 11 frames, expected 12"),
        (
            [line.replace("Frames: 12", "Frames: 1e5") for line in GOOD],
            r"100000 frames of 0.016667 s must be 2 to 20000",
        ),
        ([line.replace("LeftForeArm", "Wing") for line in GOOD], r"x.bvh has no joint for lowerarm_l"),
        (["HIERARCHY", *["JOINT a", "{"] * 500, "MOTION"], r"x.bvh:802: there are more than 400 joints"),
    ],
)
def test_a_wrong_bvh_file_is_refused_in_a_sentence(lines, message):
    with pytest.raises(InputError, match=message):
        clip_of(read_bvh("\n".join(lines), "x.bvh"), "x.bvh")


def test_a_clip_needs_two_frames():
    with pytest.raises(InputError, match=r"for 1 frames, from 2 to 3000"):
        Clip("x", 30.0, False, ("head",), np.tile((1.0, 0, 0, 0), (1, 1, 1)), np.zeros(1))
