"""Calibration of rooms: exact without noise, as good as theory says with it, and errors that say what is wrong."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.vr import RigidTransform, RoomLimits, SharedRooms, fit_rigid

TURNS = st.floats(-3.1, 3.1)
SHIFTS = st.floats(-50.0, 50.0)
CORNERS = np.array([[0.0, 0.0, 0.9], [4.0, 0.0, 1.1], [4.0, 5.0, 0.9], [0.0, 5.0, 1.3], [2.0, 2.0, 0.5]])


@given(TURNS, SHIFTS, SHIFTS, st.booleans(), st.integers(0, 1000))
@settings(max_examples=50, deadline=None)
def test_points_without_noise_give_the_transform(turn, x, y, level, seed):
    points = np.random.default_rng(seed).uniform(-3.0, 3.0, (6, 3))
    true = RigidTransform.at(x, y, turn, 0.3)
    fit = fit_rigid(points, true.apply(points), level)
    assert fit.transform.rotation == pytest.approx(true.rotation, abs=1e-8)
    assert fit.transform.translation == pytest.approx(true.translation, abs=1e-7)
    assert fit.rms < 1e-7
    assert np.linalg.det(fit.transform.rotation) == pytest.approx(1.0)


def test_any_rotation_in_space_is_found_without_mirroring():
    random = np.random.default_rng(5)
    q, r = np.linalg.qr(random.standard_normal((3, 3)))
    rotation = q * np.sign(np.diag(r)) * np.sign(np.linalg.det(q * np.sign(np.diag(r))))
    points = random.standard_normal((5, 3))
    fit = fit_rigid(points, points @ rotation.T + [1.0, 2.0, 3.0], level=False)
    assert fit.transform.rotation == pytest.approx(rotation, abs=1e-9)
    flat = fit_rigid(CORNERS[:3], CORNERS[:3] @ rotation.T, level=False)  # three points: a plane
    assert flat.transform.rotation == pytest.approx(rotation, abs=1e-9)


@pytest.mark.parametrize(("level", "freedom"), [(True, 4), (False, 6)])
def test_errors_and_residuals_are_those_of_theory(level, freedom):
    """Noise of 5 mm, 2000 calibrations of 5 points: residual, heading and centroid scatter as they must."""
    random, noise, count = np.random.default_rng(1), 0.005, 2000
    true = RigidTransform.at(1.0, -2.0, 0.7)
    fits = [
        fit_rigid(CORNERS, true.apply(CORNERS) + noise * random.standard_normal(CORNERS.shape), level)
        for _ in range(count)
    ]
    square = np.mean([np.sum(fit.residual**2) for fit in fits])
    assert square == pytest.approx(noise**2 * (3 * len(CORNERS) - freedom), rel=0.05)
    assert np.sqrt(np.mean([fit.noise**2 for fit in fits])) == pytest.approx(noise, rel=0.03)
    centre = CORNERS.mean(axis=0)
    places = np.array([fit.transform.apply(centre) for fit in fits]) - true.apply(centre)
    assert places.std(axis=0) == pytest.approx(noise / np.sqrt(len(CORNERS)), rel=0.06)
    if level:
        arms = np.sum((CORNERS[:, :2] - centre[:2]) ** 2)
        headings = np.array([fit.transform.heading for fit in fits]) - true.heading
        assert headings.std() == pytest.approx(noise / np.sqrt(arms), rel=0.06)
        assert abs(headings.mean()) < 3 * noise / np.sqrt(arms * count)


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ([[0, 0, 0], [1, 0, 0]], "2 pairs of points are given; it needs at least 3"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], "the points are on one line"),
        ([[0, 0, 0], [0, 0, 1], [0, 0, 2]], "the points are on one line"),
        ([[0, 0], [1, 0], [2, 1]], r"both must be \[N, 3\]"),
        ([[0, 0, 0], [1, 0, 0], [np.nan, 1, 0]], "a coordinate is not a finite number"),
    ],
)
def test_points_that_define_no_transform_are_refused(source, message):
    with pytest.raises(InputError, match=message):
        fit_rigid(np.array(source, dtype=float), np.array(source, dtype=float))


def test_transforms_are_a_group():
    a, b = RigidTransform.at(1.0, 2.0, 0.5), RigidTransform.at(-3.0, 0.5, 2.0, 0.2)
    point = np.array([0.3, -0.7, 1.1])
    assert a.after(b).apply(point) == pytest.approx(a.apply(b.apply(point)))
    assert a.inverse().after(a).apply(point) == pytest.approx(point)


def test_rooms_keep_points_and_say_their_residual():
    rooms = SharedRooms()
    true = RigidTransform.at(3.0, 1.0, -0.4)
    for k, point in enumerate(CORNERS):
        shift = [0.0, 0.0, 0.01 if k == 2 else 0.0]
        rooms.add_pair("robot", point.tolist(), (true.apply(point) + shift).tolist())
    fit = rooms.calibrate("robot")
    state = rooms.room("robot").state()
    assert state["rms"] == fit.rms > 0.0
    assert int(np.argmax(state["residual"])) == 2
    assert state["heading"] == pytest.approx(-0.4)
    rooms.room("robot").limits = RoomLimits(((0, 0), (4, 0), (4, 5), (0, 5)))
    x, y = true.apply([1.0, 2.5, 0.0])[:2]
    assert rooms.margin("robot", x, y) == pytest.approx(1.0)
    assert rooms.margin("person", x, y) is None
    rooms.clear("robot")
    assert rooms.room("robot").place.heading == pytest.approx(-0.4)
    for call, message in (
        (lambda: rooms.calibrate("robot"), "0|shapes"),
        (lambda: rooms.room("kitchen"), "room = 'kitchen': expected person or robot"),
        (lambda: rooms.add_pair("person", [1, 2], [1, 2, 3]), "must be 3 numbers"),
    ):
        with pytest.raises(InputError, match=message):
            call()


@given(st.floats(-2.0, 6.0), st.floats(-2.0, 6.0))
@settings(max_examples=100, deadline=None)
def test_the_margin_of_a_room_with_a_niche(x, y):
    """An L of 4 m x 4 m without its upper right quarter, against distances to its rectangles."""
    limits = RoomLimits(((0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)))
    inside = (0 < x < 4 and 0 < y < 2) or (0 < x < 2 and 0 < y < 4)
    margin = limits.margin(x, y)
    if abs(margin) > 1e-9:
        assert (margin > 0) == inside
    if inside and x < 0.8 and y < 0.8:
        assert margin == pytest.approx(min(x, y))


@pytest.mark.parametrize("corners", [((0, 0), (1, 0)), ((0, 0), (1, 0), (1,)), ((0, 0), (1, 0), (1, float("nan")))])
def test_limits_that_are_no_polygon_are_refused(corners):
    with pytest.raises(InputError, match="limits of a room"):
        RoomLimits(corners)
