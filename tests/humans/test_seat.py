"""Sitting: on a chair, and in the wheelchair that ships, riding along with it."""

import importlib.resources
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from walks import bone

from crowdbot.core import InputError
from crowdbot.humans import CHAIR, WHEELCHAIR, Gait, People, Seat, names
from crowdbot.humans.asset import shapes

ADULTS = [n for n in names() if n.startswith(("man-", "woman-", "mannequin"))]


def _urdf():
    file = importlib.resources.files("crowdbot").joinpath("assets", "robots", "wheelchair", "wheelchair.urdf")
    return ET.fromstring(file.read_text(encoding="utf-8")).find("link[@name='base_link']")


def _box(tag, near):
    """Middle, size and pitch of the box of the wheelchair whose middle is next to ``near``."""
    found = []
    for shape in _urdf().findall(tag):
        box, origin = shape.find("geometry/box"), shape.find("origin")
        if box is not None:
            middle = np.array([float(v) for v in origin.get("xyz").split()])
            size = np.array([float(v) for v in box.get("size").split()])
            found.append((middle, size, float(origin.get("rpy", "0 0 0").split()[1])))
    return min(found, key=lambda row: np.linalg.norm(row[0] - near))


def _seated(people, **given_):
    gait = Gait(People.of(people), seat=WHEELCHAIR)
    return gait, gait.start(np.zeros((len(people), 2)), np.zeros(len(people)), activity="sit", **given_)


def test_who_sits_in_the_wheelchair_has_the_feet_on_the_rests():
    gait, state = _seated(ADULTS)
    middle, size, pitch = _box("visual", (0.47, 0.1, 0.145))
    skin = gait.skin(state, 0)
    shoes = skin[:, shapes().levels[0].vertex_region == shapes().regions.index("shoes")]
    top = middle[2] + 0.5 * size[2] - np.tan(pitch) * (shoes[..., 0] - middle[0])
    assert np.abs((shoes[..., 2] - top).min(axis=1)).max() < 0.006
    ankle = gait.posture(state).position[:, [bone("foot_l"), bone("foot_r")]]
    assert (np.abs(np.abs(ankle[..., 1]) - middle[1]) < 0.5 * size[1]).all()
    assert (np.abs(ankle[..., 0] - middle[0]) < 0.5 * size[0]).all()


def test_who_sits_in_the_wheelchair_is_on_the_seat_and_before_its_back():
    gait, state = _seated(ADULTS)
    pad, size, _ = _box("visual", (-0.01, 0.0, 0.53))
    assert WHEELCHAIR.height == pytest.approx(pad[2] + 0.5 * size[2])
    skin = gait.skin(state, 0)
    shoes = shapes().levels[0].vertex_region == shapes().regions.index("shoes")
    plain = np.isin(shapes().levels[0].vertex_part, (0, 1, 2)) & ~shoes
    over = (np.abs(skin[..., 0] - pad[0]) < 0.5 * size[0] - 0.03) & (np.abs(skin[..., 1]) < 0.2) & plain
    lowest = np.where(over & (skin[..., 2] > 0.4), skin[..., 2], np.inf).min(axis=1) - WHEELCHAIR.height
    assert np.abs(lowest).max() < 0.04
    back, thick, pitch = _box("visual", (-0.25, 0.0, 0.79))
    trunk = (np.abs(skin[..., 1]) < 0.15) & (skin[..., 2] > 0.65) & (skin[..., 2] < 1.0)
    front = back[0] + 0.5 * thick[0] + np.tan(pitch) * (skin[..., 2] - back[2])
    gap = np.where(trunk, skin[..., 0] - front, np.inf).min(axis=1)
    assert gap.min() > -0.05
    assert gap.max() < 0.10


def test_hands_lie_on_the_arm_rests():
    gait, state = _seated(ADULTS)
    rest, size, _ = _box("visual", (-0.03, 0.265, 0.735))
    wrist = gait.posture(state).position[:, bone("hand_l")]
    top = rest[2] + 0.5 * size[2]
    assert (np.abs(wrist[:, 1] - rest[1]) < 0.5 * size[1]).all()
    assert (np.abs(wrist[:, 2] - top - 0.035) < 0.02).all()


@settings(max_examples=10, deadline=None)
@given(st.lists(st.tuples(st.floats(-0.5, 1.0), st.floats(-1.7, 1.7)), min_size=5, max_size=20))
def test_who_sits_rides_along_with_the_wheelchair(drives):
    gait, state = _seated(["man-20", "woman-36", "boy-08"])
    first, x, y, turn = gait.posture(state), 0.0, 0.0, 0.0
    for speed, rate in drives:
        turn += 0.1 * rate
        velocity = np.array([speed * np.cos(turn), speed * np.sin(turn)])
        x, y = x + 0.1 * velocity[0], y + 0.1 * velocity[1]
        state = gait.step(state, np.tile([x, y], (3, 1)), np.tile(velocity, (3, 1)), np.full(3, turn), 0.1)
        now = gait.posture(state)
        c, s = np.cos(turn), np.sin(turn)
        back = (now.position - [x, y, 0.0]) @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        still = [0, 1, 2, 3, *range(7, 10), *range(14, 17), *range(20, 28)]  # the head looks around
        np.testing.assert_allclose(back[:, still], first.position[:, still], atol=1e-6)


def test_people_sit_down_and_rise_without_a_jump():
    gait, _ = _seated(["man-20", "woman-36"])
    state = gait.start(np.zeros((2, 2)), np.zeros(2))
    before = gait.posture(state).position
    for activity in ("sit", "walk"):
        for _ in range(60):
            state = gait.step(state, state.position, np.zeros((2, 2)), np.zeros(2), 0.02, activity=activity)
            now = gait.posture(state).position
            assert np.abs(now - before).max() < 0.06
            before = now
    assert state.blend[:, 0].min() > 0.99


def test_feet_of_the_small_hang_and_chairs_can_differ():
    gait = Gait(People.of(["boy-08", "boy-08"]), seat=[WHEELCHAIR, CHAIR], ids=[3, 3])
    state = gait.start(np.zeros((2, 2)), np.zeros(2), activity="sit")
    foot, hip = (gait.posture(state).position[:, bone(name), 2] for name in ("foot_l", "thigh_l"))
    assert foot[0] > 0.25
    assert hip[0] - hip[1] == pytest.approx(WHEELCHAIR.height - CHAIR.height)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Seat(height=0.0), "height = 0.0 m must be from 0.2 to 1.2 m"),
        (lambda: Seat(recline=np.nan), "not finite"),
        (lambda: Gait(People.of(["man-20"]), seat=[CHAIR, CHAIR]), "2 seats are given for 1 people"),
    ],
)
def test_wrong_seats_are_named(call, message):
    with pytest.raises(InputError, match=message):
        call()
