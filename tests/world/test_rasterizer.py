"""The rasteriser against plain geometry, and the same bytes without the compiler."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest

from crowdbot.core import InputError, Scene
from crowdbot.humans import People
from crowdbot.world import PeopleMotion, Renderer, SceneCamera
from crowdbot.world.rendering.rasterizer import DrawList, Rasterizer, pack_textures
from crowdbot.world.rendering.shade_kernels import soften
from crowdbot.world.rendering.software_visuals import illumination
from crowdbot.world.stage_appearance import Appearance

GREY = np.full((4, 4, 3), 128, dtype=np.uint8)
GROUND = np.array([0.5, 0.5, 0.5, 1.0])


def triangles(points, color=(1.0, 1.0, 1.0), texture=-1, closed=False):
    """Return the draw list of triangles ``[T, 3, 3]``."""
    points = np.asarray(points, dtype=np.float64)
    count = len(points)
    a, b = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    normal = np.cross(a, b)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return DrawList(
        points.reshape(-1, 3), np.repeat(normal, 3, axis=0), np.arange(3 * count).reshape(-1, 3),
        np.tile([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], (count, 1, 1)), np.zeros(count, dtype=np.int64),
        np.full(count, closed), np.arange(count), np.array([[*color, float(texture), 0.0, 0.0]]),
    )  # fmt: skip


def camera(width=40, height=30):
    return SceneCamera((0.0, 0.0, 1.0), (1.0, 0.0, 1.0), width, height, math.radians(60.0)).on(np.eye(4))


def by_rays(drawn, view):
    """Return depth and label of every pixel from its ray, every triangle and the floor, in plain NumPy."""
    right = np.cross(view.forward, view.up)
    depth, who = np.full((view.height, view.width), np.inf), np.full((view.height, view.width), -1)
    for row in range(view.height):
        for column in range(view.width):
            x = view.left + (column + 0.5) / view.width * (view.right - view.left)
            y = view.top - (row + 0.5) / view.height * (view.top - view.bottom)
            way = view.forward + x * right + y * view.up
            if way[2] < 0.0 and -view.place[2] / way[2] < view.far:
                depth[row, column], who[row, column] = -view.place[2] / way[2], -3
            for k, face in enumerate(drawn.faces):
                a, b, c = drawn.vertex[face]
                m = np.column_stack([b - a, c - a, -way])
                if abs(np.linalg.det(m)) < 1e-12:
                    continue
                u, v, t = np.linalg.solve(m, view.place - a)
                if u >= 0.0 and v >= 0.0 and u + v <= 1.0 and view.near < t < min(depth[row, column], view.far):
                    depth[row, column], who[row, column] = t, k
    return depth, who


@pytest.mark.parametrize("seed", range(4))
def test_depth_and_labels_are_those_of_rays(seed):
    """Random triangles, also behind and through the near plane, cover the pixels that rays hit."""
    rng = np.random.default_rng(seed)
    points = rng.uniform((-1.0, -2.0, -0.5), (5.0, 2.0, 2.5), (12, 3, 3))
    drawn, view = triangles(points), camera()
    depth, who = Rasterizer().labels(drawn, view, -3)
    expected, labels = by_rays(drawn, view)
    same = who == labels
    assert np.mean(same) > 0.998  # a ray through an edge may go either way
    both = same & np.isfinite(expected)
    assert both.sum() > 500
    np.testing.assert_allclose(depth[both], expected[both], rtol=1e-5)


def test_closed_surfaces_show_one_side():
    wall = [[(2.0, -1.0, 0.2), (2.0, 0.0, 1.8), (2.0, 1.0, 0.2)]]
    view = camera()
    turned = [[wall[0][0], wall[0][2], wall[0][1]]]
    seen = [np.any(Rasterizer().labels(triangles(item, closed=True), view, -3)[1] == 0) for item in (wall, turned)]
    assert sorted(seen) == [False, True]
    assert all(np.any(Rasterizer().labels(triangles(item), view, -3)[1] == 0) for item in (wall, turned))


def image(drawn, samples=1, shadows=False, look=Appearance(), textures=()):  # noqa: B008
    pool = pack_textures([GREY, GREY, *textures])
    return Rasterizer().image(drawn, camera(), illumination(look, ()), pool, GROUND, samples, shadows)


def test_antialiasing_gives_the_mean_of_samples():
    """The edge of a bright triangle before a dark sky has values between those of both, and the same area."""
    drawn = triangles([[(2.0, -0.7, 0.35), (2.0, 0.1, 1.9), (2.0, 0.75, 0.5)]], (0.9, 0.0, 0.0))
    reds = [image(drawn, samples)[..., 1].astype(float) for samples in (1, 4, 8)]
    levels = [len(np.unique(np.round(red[8:20], -1))) for red in reds]
    assert levels[1] > levels[0]
    assert reds[2].mean() == pytest.approx(reds[1].mean(), rel=0.02)


def test_shadows_darken_the_floor_where_the_sun_is_hidden():
    high = Appearance(sun_elevation=math.pi / 2)
    roof = triangles([[(2.0, -1.0, 0.9), (4.0, -1.0, 0.9), (3.0, 1.5, 0.9)]])
    lit, dark = (image(roof, 1, shadows, high).astype(int) for shadows in (False, True))
    darker = np.any(lit - dark > 20, axis=-1)
    assert 20 < darker.sum() < 400
    assert np.argwhere(darker)[:, 0].min() > 14  # below the horizon


def test_textures_are_seen_where_their_coordinates_say():
    half = np.zeros((8, 8, 3), dtype=np.uint8)
    half[:, 4:] = 255
    drawn = triangles([[(2.0, 1.0, 0.2), (2.0, -1.0, 0.2), (2.0, 1.0, 1.8)]], texture=2)
    seen = image(drawn, textures=[half])[..., 0].astype(int)
    who = Rasterizer().labels(drawn, camera(), -3)[1]
    left = seen[:, :18][who[:, :18] == 0]
    right = seen[:, 22:][who[:, 22:] == 0]
    assert left.mean() + 80 < right.mean()


@pytest.mark.parametrize("sky", ["clear", "cloudy", "overcast", "dusk"])
def test_skies_differ_and_are_brighter_than_nothing(sky):
    drawn = triangles([[(2.0, -0.1, 1.0), (2.0, 0.1, 1.0), (2.0, 0.0, 1.1)]])
    mine = image(drawn, look=Appearance(sky=sky))
    assert mine[:6].mean() > 40
    if sky != "clear":
        assert np.abs(mine.astype(int) - image(drawn)).mean() > 3


PROGRAM = """
import hashlib, sys
sys.path.insert(0, {folder!r})
import numpy as np
from test_rasterizer import GREY, GROUND, camera, triangles
from crowdbot.world.stage_appearance import Appearance
from crowdbot.world.rendering.software_visuals import illumination
from crowdbot.world.rendering.rasterizer import Rasterizer, pack_textures
from crowdbot.world.rendering import rasterizer
rasterizer.SHADOW_SIZES = 64, 64
points = np.random.default_rng(5).uniform((1.0, -1.0, 0.0), (4.0, 1.0, 2.0), (6, 3, 3))
pool = pack_textures([GREY, GREY, np.arange(192, dtype=np.uint8).reshape(8, 8, 3)])
drawn = triangles(points, (0.9, 0.7, 0.5), 2)
look = illumination(Appearance(sky="cloudy"), ())
seen = Rasterizer().image(drawn, camera(16, 12), look, pool, GROUND, 4, True)
print(hashlib.sha256(seen.tobytes()).hexdigest())
"""


@pytest.mark.program
def test_the_bytes_do_not_depend_on_the_compiler():
    """Compiled, and interpreted one operation after another by Python, the picture is the same."""
    program = PROGRAM.format(folder=os.path.dirname(__file__))
    found = []
    for plain in ("0", "1"):
        settings = {**os.environ, "NUMBA_DISABLE_JIT": plain}
        run = subprocess.run([sys.executable, "-c", program], env=settings, capture_output=True, text=True, check=True)
        found.append(run.stdout)
    assert found[0] == found[1]
    assert len(found[0].strip()) == 64


def test_what_is_not_allowed_is_said():
    with pytest.raises(InputError, match=r"SceneCamera: antialiasing = 3 must be one of 1, 2, 4, 8"):
        SceneCamera((0, 0, 1), (1, 0, 1), renderer="software", antialiasing=3)
    with pytest.raises(InputError, match=r"SceneCamera: antialiasing = 4 needs renderer = 'software'"):
        SceneCamera((0, 0, 1), (1, 0, 1), antialiasing=4)
    with pytest.raises(InputError, match=r"SceneCamera: renderer = 'vulkan' must be one of opengl, software"):
        SceneCamera((0, 0, 1), (1, 0, 1), renderer="vulkan")
    with pytest.raises(InputError, match='sun_elevation="0.0" must be at least 0.0872 rad'):
        Appearance(sun_elevation=0.0)


def test_many_samples_are_filtered_as_by_a_lens():
    drawn = triangles([[(3.0, -0.5, 0.6), (3.0, 0.4, 0.7), (3.0, 0.1, 1.5)]])
    view, light = camera(), illumination(Appearance(), ())
    pool = pack_textures([GREY, GREY])
    raster = Rasterizer()
    plain = raster.image(drawn, view, light, pool, GROUND, samples=2, shadows=False).astype(int)
    soft = soften(plain.astype(np.uint8)).astype(int)
    padded = np.pad(plain, ((1, 1), (1, 1), (0, 0)), mode="edge")
    rows = padded[:-2] + 2 * padded[1:-1] + padded[2:]
    expected = (rows[:, :-2] + 2 * rows[:, 1:-1] + rows[:, 2:] + 8) // 16
    np.testing.assert_array_equal(soft, expected)
    steps = [np.abs(np.diff(item.astype(int), axis=1)).max() for item in (plain, raster.image(
        drawn, view, light, pool, GROUND, samples=4, shadows=False))]  # fmt: skip
    assert steps[1] < 0.8 * steps[0]


def test_small_people_in_an_image_have_fewer_triangles():
    scene = Scene.of([[0.0, 0.0]])
    renderer = Renderer(scene, {}, None, PeopleMotion(scene, np.array([0]), People.of(["woman-36"])))

    def seen(away, detail):
        view = SceneCamera((away, 0.0, 1.0), (0.0, 0.0, 0.9), 320, 240, renderer="software", detail=detail)
        return renderer.images(view, rgb=False, segmentation=True).segmentation

    assert np.sum(seen(8.0, 0) == 0) > 300
    np.testing.assert_array_equal(seen(8.0, 0), seen(8.0, 2))
    assert np.any(seen(1.2, 0) != seen(1.2, 2))
