"""Kernels of plane geometry against slow and obvious twins."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from crowdbot.core.geometry import nearest_on_segment, ray_to_disc, ray_to_segment, time_to_contact, time_to_segment

number = st.floats(-8.0, 8.0).map(lambda value: round(value, 3))
radius = st.floats(0.05, 3.0).map(lambda value: round(value, 3))
angle = st.floats(-math.pi, math.pi)
quick = settings(max_examples=80, deadline=None)


def along(a, b, count=4001):
    return np.linspace(0.0, 1.0, count)[:, None] * (b - a) + a


@quick
@given(number, number, number, number, number, number)
def test_nearest_on_segment(x, y, ax, ay, bx, by):
    point, a, b = np.array([x, y]), np.array([ax, ay]), np.array([bx, by])
    nearest = np.array(nearest_on_segment(x, y, ax, ay, bx, by))
    sampled = np.linalg.norm(along(a, b) - point, axis=1).min()
    assert np.linalg.norm(nearest - point) == pytest.approx(sampled, abs=np.linalg.norm(b - a) / 4000)
    assert np.linalg.norm(nearest - a) + np.linalg.norm(nearest - b) == pytest.approx(np.linalg.norm(b - a), abs=1e-9)


@quick
@given(number, number, angle, number, number, radius)
def test_ray_to_disc(x, y, direction, cx, cy, size):
    ux, uy = math.cos(direction), math.sin(direction)
    distance = ray_to_disc(x, y, ux, uy, cx, cy, size)
    if math.hypot(cx - x, cy - y) <= size:
        assert distance == 0.0
        return
    roots = np.roots([1.0, 2.0 * ((x - cx) * ux + (y - cy) * uy), (x - cx) ** 2 + (y - cy) ** 2 - size**2])
    assume(abs(np.imag(roots[0])) == 0.0 or abs(np.imag(roots[0])) > 1e-6)
    ahead = [float(root.real) for root in roots if root.imag == 0.0 and root.real > 0.0]
    assert distance == pytest.approx(min(ahead, default=math.inf), abs=1e-5)


@quick
@given(number, number, angle, number, number, number, number)
def test_ray_to_segment(x, y, direction, ax, ay, bx, by):
    ux, uy = math.cos(direction), math.sin(direction)
    matrix = np.array([[ux, ax - bx], [uy, ay - by]])
    assume(abs(np.linalg.det(matrix)) > 1e-6)
    distance, place = np.linalg.solve(matrix, [ax - x, ay - y])
    assume(min(abs(place), abs(1.0 - place), abs(distance)) > 1e-6)
    expected = distance if distance > 0.0 and 0.0 < place < 1.0 else math.inf
    assert ray_to_segment(x, y, ux, uy, ax, ay, bx, by) == pytest.approx(expected, rel=1e-6)


def test_a_ray_that_starts_on_a_segment_hits_it_at_once():
    assert ray_to_segment(0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0) == 0.0


def test_a_ray_along_a_segment_misses_it():
    assert ray_to_segment(0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 2.0, 0.0) == math.inf


@quick
@given(number, number, number, number, radius)
def test_time_to_contact(x, y, vx, vy, reach):
    assume(abs(math.hypot(x, y) - reach) > 1e-3)
    time = time_to_contact(x, y, vx, vy, reach)
    times = np.linspace(0.0, 50.0, 50001)
    apart = np.hypot(x + vx * times, y + vy * times)
    assume(abs(apart.min() - reach) > 1e-2)  # a graze is decided by rounding
    assume(np.argmin(apart) < 50000 or x * vx + y * vy >= 0.0)  # still on its way after 50 s
    if math.hypot(x, y) < reach:
        assert time == 0.0
    elif apart.min() > reach:
        assert time == math.inf
    else:
        assert time == pytest.approx(times[np.argmax(apart < reach)], abs=1.1e-3)
        assert math.hypot(x + vx * time, y + vy * time) == pytest.approx(reach, abs=1e-6)


@quick
@given(number, number, number, number, radius, number, number, number, number)
def test_time_to_segment(x, y, vx, vy, size, ax, ay, bx, by):
    times = np.linspace(0.0, 40.0, 8001)
    centre = np.stack([x + vx * times, y + vy * times], axis=1)
    a, edge = np.array([ax, ay]), np.array([bx - ax, by - ay])
    place = np.clip((centre - a) @ edge / max(edge @ edge, 1e-30), 0.0, 1.0)
    apart = np.linalg.norm(centre - a - place[:, None] * edge, axis=1)
    assume(abs(apart.min() - size) > 5e-2)  # a graze is decided by rounding, or lies between two samples
    time = time_to_segment(x, y, vx, vy, size, ax, ay, bx, by)
    if apart.min() > size:
        assert time > 39.9
    else:
        assert time == pytest.approx(times[np.argmax(apart <= size)], abs=5.1e-3)


def test_a_disc_on_a_segment_has_arrived():
    assert time_to_segment(0.0, 0.1, 0.0, 0.0, 0.2, -1.0, 0.0, 1.0, 0.0) == 0.0
    assert time_to_segment(0.0, 1.0, 0.0, -1.0, 0.2, 0.0, 0.0, 0.0, 0.0) == pytest.approx(0.8)
