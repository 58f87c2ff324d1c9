"""Lenses pixel by pixel, and limbs around the ring of a bumper point by point, against slow twins."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, stream
from crowdbot.sensors.bumper import _limbs
from crowdbot.sensors.lens import MOST_PIXELS, Lens, distort_image, pixel_directions
from crowdbot.sensors.range_finders import teardrop

some = settings(max_examples=25, deadline=None)
seeds = st.integers(0, 10_000)


@pytest.mark.parametrize(("width", "height", "view"), [(4, 3, 1.0), (5, 5, 2.0), (640, 480, 0.3), (1, 1, 3.0)])
def test_the_view_ends_at_the_outer_sides_of_the_pixels(width: int, height: int, view: float) -> None:
    lens = Lens.of(width, height, view)
    assert (lens.cx, lens.cy) == (0.5 * (width - 1), 0.5 * (height - 1))
    assert lens.fx == lens.fy
    right = (width - 0.5 - lens.cx) / lens.fx
    assert 2.0 * math.atan(right) == pytest.approx(view)
    if width < 10:
        directions = pixel_directions(lens)
        np.testing.assert_allclose(np.linalg.norm(directions, axis=-1), 1.0)
        np.testing.assert_allclose(-directions[0, :, 1] / directions[0, :, 0], (np.arange(width) - lens.cx) / lens.fx)
        np.testing.assert_allclose(-directions[:, 0, 2] / directions[:, 0, 0], (np.arange(height) - lens.cy) / lens.fy)


@pytest.mark.parametrize("view", [0.0, math.pi, -1.0, math.nan])
def test_a_view_is_between_nothing_and_half_a_turn(view: float) -> None:
    with pytest.raises(InputError, match="must be above 0 and below pi"):
        Lens.of(4, 3, view)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"width": 0}, "width = 0"), ({"height": MOST_PIXELS + 1}, "height"), ({"width": 2.5}, "width = 2.5"),
        ({"width": MOST_PIXELS, "height": 2}, "exceed the limit"), ({"fx": 0.0}, "fx = 0.0"), ({"fy": -1.0}, "fy"),
        ({"distortion": (0.0,) * 4}, "must be five finite numbers"),
        ({"distortion": (0.0, 0.0, math.inf, 0.0, 0.0)}, "must be five finite numbers"),
        ({"cx": math.nan}, "must be five finite numbers"),
    ],
)  # fmt: skip
def test_impossible_lenses_are_refused(changes: dict[str, object], message: str) -> None:
    given_ = {"width": 4, "height": 3, "fx": 3.0, "fy": 3.0, "cx": 1.5, "cy": 1.0, "distortion": (0.0,) * 5}
    with pytest.raises(InputError, match=message):
        Lens(**(given_ | changes))  # type: ignore[arg-type]


@settings(max_examples=10, deadline=None)
@given(seed=seeds)
def test_a_distorted_image_is_looked_up_pixel_by_pixel(seed: int) -> None:
    rng = stream(seed, "image")
    k1, k2, p1, p2, k3 = rng.normal(0.0, 0.1, 5) * [1.0, 0.3, 0.1, 0.1, 0.1]
    lens = Lens(6, 5, 5.0, 4.0, 2.3 + rng.normal(0.0, 0.3), 2.1 + rng.normal(0.0, 0.3), (k1, k2, p1, p2, k3))
    colour, depth = rng.normal(size=(2, 5, 6, 3)), rng.normal(size=(2, 5, 6))
    found, far = distort_image(colour, lens, fill=-7.0), distort_image(depth, lens, fill=-7.0)
    right, down = lens.rays()
    for row in range(5):
        for column in range(6):
            x, y = right[row, column] * lens.fx + lens.cx, down[row, column] * lens.fy + lens.cy
            assume(min(abs(x % 1.0 - 0.5), abs(y % 1.0 - 0.5)) > 1e-6)
            if not (-0.5 <= x <= 5.5 and -0.5 <= y <= 4.5):
                assert np.all(found[:, row, column] == -7.0)
                assert np.all(far[:, row, column] == -7.0)
                continue
            x, y = min(max(x, 0.0), 5.0), min(max(y, 0.0), 4.0)
            columns = np.maximum(0.0, 1.0 - np.abs(np.arange(6) - x))
            rows = np.maximum(0.0, 1.0 - np.abs(np.arange(5) - y))
            mixed = np.einsum("r,c,ercn->en", rows, columns, colour)
            np.testing.assert_allclose(found[:, row, column], mixed, atol=1e-9)
            np.testing.assert_array_equal(far[:, row, column], depth[:, round(y), round(x)])


def test_whole_colours_are_rounded() -> None:
    lens = Lens(3, 1, 1.0, 1.0, 1.0, 0.0, (0.2, 0.0, 0.0, 0.0, 0.0))
    image = np.array([[[[0], [100], [200]]]], dtype=np.uint8)
    found = distort_image(image, lens)
    u = lens.rays()[0][0, 2]
    assert found.dtype == np.uint8
    assert found[0, 0, :, 0].tolist() == [round(100 - 100 * u), 100, round(100 + 100 * u)]


@some
@given(seed=seeds)
def test_the_part_of_a_limb_nearest_to_a_ring(seed: int) -> None:
    rng = stream(seed, "limb")
    start, end = rng.normal(0.0, 0.6, (1, 3)), rng.normal(0.0, 0.6, (1, 3))
    if rng.random() < 0.2:
        end[0, 2] = start[0, 2]  # lying
    elif rng.random() < 0.2:
        end[0, :2] = start[0, :2]  # upright
    radius, place = rng.uniform(0.1, 0.8, 1), rng.normal(0.0, 0.3, 2)
    low = rng.normal(0.0, 0.3)
    high = low + rng.uniform(0.0, 0.5)
    points, size = _limbs(start, end, radius, place, low, high)
    line = start + np.linspace(0.0, 1.0, 4001)[:, None] * (end - start) - np.append(place, 0.0)
    over = np.maximum(np.maximum(low - line[:, 2], line[:, 2] - high), 0.0)
    gap2 = np.sum(line[:, :2] ** 2, axis=1) + over**2
    found = points[0] @ points[0] + (radius[0] ** 2 - size[0] ** 2 if np.isfinite(size[0]) else np.nan)
    if np.isnan(size[0]):
        assert over[np.argmin(gap2)] >= radius[0] - 1e-3
    else:
        assert found == pytest.approx(gap2.min(), abs=1e-3)
        assert size[0] == pytest.approx(math.sqrt(max(0.0, radius[0] ** 2 - over[np.argmin(gap2)] ** 2)), abs=0.05)


@some
@given(share=st.floats(0.76, 0.999), radius=st.floats(0.1, 2.0), length=st.floats(0.5, 8.0))
def test_the_surface_of_the_zone_of_ultrasound(share: float, radius: float, length: float) -> None:
    along = share * length
    side = radius * 16.0 / (3.0 * math.sqrt(3.0)) * share * math.sqrt(share * (1.0 - share))
    found = teardrop(np.array([math.atan2(side, along), -math.atan2(side, along)]), radius, length)
    np.testing.assert_allclose(found, math.hypot(along, side), rtol=1e-6)
    assert teardrop(np.array([0.0]), radius, length)[0] == pytest.approx(length)
    widest = math.atan(0.5 * radius * 16.0 / (3.0 * math.sqrt(3.0)) / length)
    inside, outside = teardrop(np.array([widest * 0.999, widest * 1.001]), radius, length)
    assert inside > 0.5 * length
    assert outside == 0.0
