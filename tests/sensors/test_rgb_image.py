"""Pictures: what a colour camera shows of a scene by rays and from a source, through its lens, with noise."""

import math

import numpy as np
import pytest

from crowdbot.core import InputError, Pose, Scene, SpatialPose, stream
from crowdbot.sensors import DepthCamera, Dropout, Gaussian, Offset, RGBCamera

ROOM = Scene.of([[3.0, 0.0], [4.0, 1.0]], radius=0.3, walls=[[(6.0, -9.0), (6.0, 9.0)]])
EYE = SpatialPose.of((0.0, 0.0, 1.2))
VIEW = {"width": 40, "height": 30, "field_of_view": math.radians(70.0)}


class Stripes:
    """Draws columns that count up, and remembers what it was asked."""

    def render(self, camera, pose):
        self.asked = camera, pose
        columns = np.broadcast_to(np.arange(camera.width)[None, None, :, None], (1, camera.height, camera.width, 3))
        return {"rgb": columns.astype(np.uint8), "hit": columns[..., 0].astype(np.int64)}


def test_rays_show_what_the_depth_camera_labels():
    labels = DepthCamera(**VIEW, range_min=0.0, range_max=50.0).read(ROOM, EYE).hit
    picture = RGBCamera(**VIEW, far=50.0, segmentation=True).read(ROOM, EYE)
    np.testing.assert_array_equal(picture.hit, labels)
    assert set(np.unique(picture.hit)) == {-3, -2, 0, 1} | ({-1} if -1 in labels else set())
    shown = {code: {tuple(pixel) for pixel in picture.rgb[picture.hit == code]} for code in (0, 1, -2)}
    assert not shown[0] & shown[1]
    assert not shown[0] & shown[-2]


def test_labels_come_only_when_asked_for_and_near_and_far_are_limits():
    assert RGBCamera(**VIEW).read(ROOM, EYE).hit is None
    near = RGBCamera(**VIEW, far=3.5, segmentation=True).read(ROOM, EYE).hit
    assert not np.isin([1, -2], near).any()
    assert (near == 0).any()


def test_a_source_is_shown_through_the_lens():
    source = Stripes()
    plain = RGBCamera(**VIEW, segmentation=True).read(ROOM, EYE, renderer=source)
    np.testing.assert_array_equal(plain.rgb[0, 3, :, 1], np.arange(40))
    assert source.asked[1] is EYE
    bent = RGBCamera(**VIEW, segmentation=True, distortion=(0.3, 0.0, 0.0, 0.0, 0.0)).read(ROOM, EYE, renderer=source)
    assert bent.rgb[0, 15, 36, 0] < 36
    assert np.all(np.abs(bent.hit[0].astype(int) - bent.rgb[0, ..., 0]) <= 1)
    level = RGBCamera(**VIEW).read(ROOM, Pose.of((1.0, 2.0), 0.5), renderer=source)
    assert source.asked[1].position.tolist() == [[1.0, 2.0, 0.4]]
    assert level.pose.heading[0] == 0.5


def test_noise_acts_on_the_values_and_stays_in_their_range():
    plain = RGBCamera(**VIEW).read(ROOM, EYE).rgb.astype(float)
    brighter = RGBCamera(**VIEW, noise=Offset(20.0)).read(ROOM, EYE, stream(0, "eye")).rgb
    np.testing.assert_array_equal(brighter, np.minimum(plain + 20.0, 255.0))
    grainy = RGBCamera(**VIEW, noise=Gaussian(4.0)).read(ROOM, EYE, stream(0, "eye")).rgb
    inside = (plain > 20.0) & (plain < 235.0)
    assert np.std((grainy - plain)[inside]) == pytest.approx(4.0, rel=0.05)
    lost = RGBCamera(**VIEW, noise=Dropout(1.0)).read(ROOM, EYE, stream(0, "eye")).rgb
    assert not lost.any()
    with pytest.raises(InputError, match="needs a random generator"):
        RGBCamera(noise=Gaussian(1.0), width=4, height=3).read(ROOM, EYE)


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"near": 2.0, "far": 1.0}, r"near = 2.0 m must be above 0 and below far = 1.0 m"),
        ({"width": 1 << 31}, r"width = 2147483648 must be a whole number of at least 1 and at most 16777216"),
        ({"width": 1 << 23}, r"8388608 x 240 pixels exceed the limit of 16777216 pixels"),
        ({"width": 0}, r"width = 0 must be a whole number of at least 1"),
        ({"field_of_view": 4.0}, r"field_of_view = 4.0 rad must be above 0 and below pi"),
        ({"distortion": (1.0, 2.0)}, r"distortion = \(1.0, 2.0\) must be five finite numbers"),
        ({"rate": 0.0}, r"rate = 0.0 Hz must be finite and at least 1e-06"),
    ],
)
def test_wrong_cameras_are_refused(fields, sentence):
    with pytest.raises(InputError, match=sentence):
        RGBCamera(**fields)
