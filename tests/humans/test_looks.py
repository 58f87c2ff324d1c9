"""Pictures of people: sizes, variation by outfit, faces where the head is, and texture coordinates in range."""

import numpy as np
import pytest

from crowdbot.humans import body_uv, names, outfit, paint_body, person, shapes


@pytest.mark.parametrize("level", [0, 1, 2])
def test_corners_have_coordinates_in_the_picture(level):
    uv = body_uv(level)
    assert uv.shape == (*shapes().levels[level].faces.shape, 2)
    assert uv.min() >= 0.0
    assert uv.max() <= 1.0
    width = np.ptp(uv[..., 0], axis=1)
    assert np.quantile(width, 0.98) < 0.2  # only the crown of the head and hair are wide


@pytest.mark.parametrize("name", names()[::4])
def test_a_person_is_painted_the_same_way_each_time_and_differs_by_outfit(name):
    who = person(name)
    first, again = (paint_body(who, outfit(who, 3), 3, 256) for _ in range(2))
    np.testing.assert_array_equal(first, again)
    assert first.shape == (256, 256, 3)
    assert np.abs(first.astype(int) - paint_body(who, outfit(who, 4), 4, 256)).mean() > 1.0


def test_a_face_has_dark_brows_red_lips_and_white_eyes():
    who = person("woman-36")
    worn = outfit(who, 0)
    image = paint_body(who, worn, 0).astype(int)
    skin = 255.0 * np.array(worn.skin)
    head = image[:256]
    brow, mouth = (int(256 * (1.0 - (height - 1.40) / 0.345)) for height in (1.6125, 1.518))
    brows, lips = head[brow, 256 + 22], head[mouth, 258]
    assert brows.mean() < 0.8 * skin.mean()
    assert lips[0] - lips[1] > (skin[0] - skin[1]) + 15
    eyes = image[256:320, :64]
    assert eyes[32, 32].max() < 60  # pupil
    assert eyes[32, 6].min() > 150  # white


def test_smaller_pictures_are_means_of_larger_ones():
    who = person("man-44")
    large, small = (paint_body(who, outfit(who, 1), 1, size).astype(float) for size in (256, 128))
    mean = large.reshape(128, 2, 128, 2, 3).mean(axis=(1, 3))
    assert np.abs(mean - small).max() <= 1.0
