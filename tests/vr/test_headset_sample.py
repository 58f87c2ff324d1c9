"""Messages of headsets: axes, controllers and hands, and bytes that are no message."""

import numpy as np
import pytest
from headset_messages import message, pose
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import CrowdbotError, InputError
from crowdbot.vr import HeadsetSample
from crowdbot.web import StateFrame


def sample(**how):
    return HeadsetSample.of_frame(StateFrame.decode(message(1.0, **how)))


def turn_z(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def axes(part):
    w, x, y, z = part[3:]
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat([x, y, z, w]).as_matrix()


def test_the_axes_of_webxr_become_those_of_the_room():
    found = sample(head=(1.0, 2.0, 1.7), turn=turn_z(0.5))
    assert found.head[:3] == pytest.approx([1.0, 2.0, 1.7], abs=1e-6)
    assert axes(found.head) == pytest.approx(turn_z(0.5), abs=1e-6)
    raw = StateFrame("headset", 0.0, {"head": np.array([0.5, 1.7, -1.0, 0, 0, 0, 1], dtype="f4")})
    assert HeadsetSample.of_frame(raw).head[:3] == pytest.approx([1.0, -0.5, 1.7])  # ahead is -z, right is +x


def test_a_tracked_hand_gives_the_wrist_as_it_is():
    found = sample(left=(0.4, 0.2, 1.2), right=(0.4, -0.2, 1.2))
    assert found.left[:3] == pytest.approx([0.4, 0.2, 1.2], abs=1e-6)
    assert axes(found.right) == pytest.approx(np.eye(3), abs=1e-6)  # palm down, fingers ahead: axes of the person


@pytest.mark.parametrize(("side", "palm"), [("left", -1.0), ("right", 1.0)])
def test_a_controller_held_upright_is_a_hand_as_for_a_greeting(side, palm):
    """The rod of the grip points up (-z to the thumb), x to the right: thumbs up, the fingers ahead."""
    grip = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]).T  # columns: x right, y backward, z down
    from scipy.spatial.transform import Rotation

    q = Rotation.from_matrix(np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], dtype=float)).as_quat()
    assert grip.shape == (3, 3)
    data = np.concatenate([[0.2, 1.2, -0.5], q]).astype("f4")
    frame = StateFrame("headset", 0.0, {side: data, "flags": np.array([1], dtype="u1")})
    found = getattr(HeadsetSample.of_frame(frame), side)
    fingers, across, back = axes(found).T
    assert fingers == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)
    assert back == pytest.approx([0.0, -palm, 0.0], abs=1e-6)  # the back of the right hand looks to the right
    assert across @ np.array([0.0, 0.0, 1.0]) == pytest.approx(palm)  # thumb up: left of the right hand
    assert found[:3] == pytest.approx([0.5 - 0.08, -0.2, 1.2], abs=1e-6)  # the wrist is behind the palm


def test_a_guessed_position_and_a_hidden_page_are_no_tracking():
    assert sample(flags=1 | 2).head is None
    assert not sample(flags=0).visible
    assert sample(head=None).head is None


@pytest.mark.parametrize(
    ("arrays", "text"),
    [
        ({"head": np.zeros(6, dtype="f4")}, "7 finite numbers 'head'"),
        ({"head": np.full(7, np.nan, dtype="f4")}, "7 finite numbers 'head'"),
        ({"head": np.zeros(7, dtype="f4")}, "which is no pose"),
        ({"right": np.array([5e3, 0, 0, 0, 0, 0, 1], dtype="f4")}, "which is no pose"),
        ({"clock": np.zeros(3)}, "4 finite numbers 'clock'"),
        ({"pictures": np.zeros(3)}, "pairs of numbers"),
    ],
)
def test_wrong_messages_are_refused(arrays, text):
    with pytest.raises(InputError, match=text):
        HeadsetSample.of_frame(StateFrame("headset", 0.0, arrays))
    with pytest.raises(InputError, match="has the channel 'scene'"):
        HeadsetSample.of_frame(StateFrame("scene", 0.0, {}))


@given(st.integers(0, 300), st.integers(0, 255))
@settings(max_examples=200, deadline=None)
def test_changed_bytes_never_end_the_server(place, value):
    data = bytearray(message(1.0, left=(0.3, 0.2, 1.0), clock=np.arange(4.0)))
    data[place % len(data)] = value
    try:
        frame = HeadsetSample.of_frame(StateFrame.decode(bytes(data)))
    except CrowdbotError:
        return
    assert frame.head is None or np.all(np.isfinite(frame.head))


def test_samples_are_blended():
    a, b = sample(head=(0.0, 0.0, 1.6)), sample(head=(1.0, 0.0, 1.6), turn=turn_z(0.6), right=(1.3, 0, 1.0))
    half = a.blend(b, 0.5)
    assert half.head[:3] == pytest.approx([0.5, 0.0, 1.6], abs=1e-6)
    assert axes(half.head) == pytest.approx(turn_z(0.3), abs=1e-3)
    assert half.right is not None
    assert pose(np.zeros(3)).shape == (7,)


def test_the_gaze_is_in_the_frame_of_the_head_and_missing_while_the_eyes_are_closed():
    """The eyes look 0.3 rad to the left of a head that is turned by 0.5 rad."""
    ray = pose(np.array([0.0, 0.0, 1.6]), turn_z(0.8))
    found = sample(turn=turn_z(0.5), gaze=ray)
    assert found.gaze == pytest.approx([np.cos(0.3), np.sin(0.3), 0.0], abs=1e-6)
    assert sample(turn=turn_z(0.5)).gaze is None
    assert sample(turn=turn_z(0.5), gaze=ray, flags=1 | 2).gaze is None  # the head is not tracked
    closed = sample()
    assert found.blend(closed, 0.4).gaze is found.gaze  # eyes jump: the latest one counts
    assert found.blend(closed, 1.0).gaze is None
    with pytest.raises(InputError, match="7 finite numbers 'gaze'"):
        sample(gaze=np.zeros(3, dtype=np.float32))
