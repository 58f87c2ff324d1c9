"""A calibration pose gives stature and arms; poses that are none are refused."""

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.humans import People, eye_offsets, rest_skeleton
from crowdbot.vr import HeadsetSample, measure_pose


def samples(body="man-30", stature=1.75, stretch=1.0, down=0.0, heading=0.3, noise=0.0, seed=0):
    """Return what a headset measures of a person whose arms are `stretch` times those of a body."""
    people = People.of([body], height=stature)
    bones = rest_skeleton(people)
    eyes = bones.head[bones.bone("head")] + eye_offsets(people)[0]
    arm = stretch * float(people.measures.arm[0].sum())
    c, s = np.cos(heading), np.sin(heading)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    ends = {}
    for side, sign in (("l", 1.0), ("r", -1.0)):
        way = np.array([0.0, sign * np.cos(down), -np.sin(down)])
        ends[side] = turn @ (bones.head[bones.bone(f"upperarm_{side}")] + arm * way)
    random = np.random.default_rng(seed)

    def pose(point):
        return np.concatenate([point + noise * random.standard_normal(3), [1.0, 0.0, 0.0, 0.0]])

    rows = [HeadsetSample(0.01 * k, pose(turn @ eyes), pose(ends["l"]), pose(ends["r"])) for k in range(40)]
    return rows, arm


@pytest.mark.parametrize("body", ["man-30", "woman-47", "girl-13"])
@pytest.mark.parametrize(("down", "word"), [(0.0, "T"), (0.8, "A")])
def test_stature_and_arms_are_those_of_the_person(body, down, word):
    stature = 1.4 if body.startswith("girl") else 1.72
    rows, arm = samples(body, stature, down=down, noise=0.003)
    pose = measure_pose(rows, body)
    assert pose.pose == word
    assert pose.stature == pytest.approx(stature, abs=0.005)
    assert pose.arm == pytest.approx(arm, abs=0.005)
    assert abs(pose.difference) < 0.012


def test_another_body_of_the_same_kind_is_taken_if_its_arms_fit_better():
    own = {name: float(People.of([name], height=1.75).measures.arm[0].sum()) for name in ("man-20", "man-79", "man-50")}
    longest, shortest = max(own, key=own.get), min(own, key=own.get)
    rows, arm = samples(shortest, 1.75, stretch=own[longest] / own[shortest])
    pose = measure_pose(rows, shortest)
    assert pose.body.startswith("man-")
    assert abs(pose.difference) <= own[longest] - own[shortest]
    if own[longest] - own[shortest] > 0.02:
        assert pose.body != shortest
    assert pose.arm == pytest.approx(arm, abs=0.003)


def test_poses_that_are_none_are_refused():
    rows, _ = samples()
    for wrong, text in (
        (rows[:20], "head and both hands must be tracked"),
        ([HeadsetSample(row.time, row.head, row.left, None) for row in rows], "head and both hands must be tracked"),
        (samples(noise=0.06)[0], "moves: hold the pose still"),
        (samples(down=1.45)[0], "neither a T nor an A pose"),
        (samples(down=-0.9)[0], "neither a T nor an A pose"),
        (samples(stature=1.0)[0], ""),
    ):
        if text:
            with pytest.raises(InputError, match=text):
                measure_pose(wrong, "man-30")
        else:
            assert measure_pose(wrong, "man-30").stature == pytest.approx(1.0, abs=0.005)
    low = [HeadsetSample(row.time, row.head - [0, 0, 1.5, 0, 0, 0, 0], row.left, row.right) for row in rows]
    with pytest.raises(InputError, match="set the floor of the headset first"):
        measure_pose(low, "man-30")
