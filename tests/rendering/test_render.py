"""Images and films of trials, by every kind of camera, and what is said when that is impossible."""

from __future__ import annotations

import json
import weakref
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from crowdbot.cli import main
from crowdbot.core import InputError, MissingExtra
from crowdbot.recording import run
from crowdbot.rendering import (
    ImageWriter,
    RenderedImage,
    RenderRequest,
    camera_names,
    color_segmentation,
    render_images,
)
from crowdbot.trials import load_trial, overview, parse_trial
from crowdbot.world.rendering import gl_context
from samples import sample
from space_trials import LEAN, ROOM, room


def test_cameras_have_names() -> None:
    assert camera_names(parse_trial(ROOM)) == ("door", "head", "overview", "pepper/depth", "pepper/eyes")
    assert camera_names(load_trial("frontal")) == ("overview",)


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("world", ["planar", "physics"])
def test_every_camera_sees_the_room(world: str) -> None:
    trial = parse_trial(room(world))
    for name in ("door", "head", "pepper/eyes"):
        (shot,) = render_images(trial, name, RenderRequest(0.2), depth=True, segmentation=True)
        assert shot.time == pytest.approx(0.2)
        assert shot.rgb.shape[:2] == ((24, 32) if "/" in name else (48, 64))
        assert shot.depth is not None
        assert shot.segmentation is not None
        assert {-3, -2} <= set(np.unique(shot.segmentation))
        near = shot.depth[shot.segmentation >= 0]
        assert len(near)
        assert near.max() < 12.0
        assert shot.rgb.std() > 5.0


@pytest.mark.parametrize("name", sample(["frontal", "intersection", "blind-corner", "bottleneck", "random-goals"], 2))
def test_the_overview_has_the_whole_stage_in_view_and_the_feet_of_people(name: str) -> None:
    stage = load_trial(name).stage
    camera = overview(stage, np.zeros((0, 2)))
    points = np.concatenate(stage.rings)
    ahead = np.array([0.0, np.cos(camera.pitch), -np.sin(camera.pitch)])
    above = np.array([0.0, np.sin(camera.pitch), np.cos(camera.pitch)])
    eye = np.array([camera.x, camera.y, camera.z])
    for height in (0.0, stage.wall_height):
        away = np.column_stack([points, np.full(len(points), height)]) - eye
        edge = np.tan(0.5 * camera.field_of_view) * (away @ ahead)
        assert np.all(np.abs(away[:, 0]) < edge)
        assert np.all(np.abs(away @ above) < edge * camera.height / camera.width)
    x, y = np.random.default_rng(3).uniform(points.min(axis=0), points.max(axis=0), (2000, 2)).T
    floor = np.column_stack([x, y])[stage.clearance(np.column_stack([x, y])) > 0.3]
    toward = (eye[:2] - floor) * stage.wall_height / eye[2]
    seen = [
        not any(crosses(a, a + b, wall) for wall in stage.as_walls().segments())
        for a, b in zip(floor, toward, strict=True)
    ]
    assert np.mean(seen) > 0.85
    assert np.degrees(camera.pitch) >= 60.0 - 1e-9


@pytest.mark.usefixtures("drawing")
def test_the_depth_camera_of_pepper_does_not_see_its_own_eye() -> None:
    inside = '<goal x="9" y="0"/><navigator type="straight"/>'
    robot = f'<robot name="pepper" type="pepper" x="0" y="0" sensor-rates="nearest">{inside}</robot>'
    stage = '<stage walkable="-2,-4 10,-4 10,4 -2,4"/><crowd type="orca"/>'
    trial = parse_trial(f'<trial name="t" duration="1">{stage}{robot}</trial>')
    (shot,) = render_images(trial, "pepper/depth", RenderRequest(0.0), segmentation=True)
    assert shot.segmentation is not None
    assert set(np.unique(shot.segmentation)) <= {-3, -2, -1}


def crosses(a: np.ndarray, b: np.ndarray, wall: np.ndarray) -> bool:
    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    c, d = wall[:2], wall[2:]
    return side(a, b, c) * side(a, b, d) < 0.0 and side(c, d, a) * side(c, d, b) < 0.0


@pytest.mark.usefixtures("drawing")
def test_an_open_place_is_seen_from_near_by() -> None:
    camera = overview(load_trial("circle-crossing").stage, np.array([[-5.0, 0.0], [5.0, 4.0]]))
    assert (round(np.degrees(camera.pitch)), round(np.degrees(camera.field_of_view))) == (60, 60)
    assert camera.x == 0.0


@pytest.mark.usefixtures("drawing")
def test_a_film_is_even_and_the_same_each_time() -> None:
    trial = parse_trial(room(text=LEAN))
    films = [list(render_images(trial, "door", RenderRequest(0.2, 0.6, 12.5))) for _ in range(2)]
    assert [round(shot.time, 2) for shot in films[0]] == [0.2, 0.28, 0.36, 0.44, 0.52, 0.6]
    assert all(np.array_equal(a.rgb, b.rgb) for a, b in zip(*films, strict=True))
    assert not np.array_equal(films[0][0].rgb, films[0][-1].rgb)
    assert len(list(render_images(trial, "door", RenderRequest(0.0, 0.4)))) == 11


@pytest.mark.usefixtures("drawing")
def test_a_camera_does_not_change_the_run() -> None:
    trial = parse_trial(room(text=LEAN))
    before = run(trial).digest
    list(render_images(trial, "door", RenderRequest(0.5)))
    assert run(trial).digest == before


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("ending", sample([".png", ".jpg", ".webp"], 1))
def test_an_image_is_written(ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "deep" / f"door{ending}"
    (tmp_path / "room.xml").write_text(LEAN)
    words = ["render", str(tmp_path / "room.xml"), "--at", "0.2", "--out", str(path), "--depth", "--segmentation"]
    assert main([*words, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["camera"], told["images"], told["rate"], told["world"]) == ("door", 1, None, "planar")
    names = [path, path.with_name("door-depth.png"), path.with_name("door-segmentation.png")]
    assert told["files"] == [str(name) for name in names]
    (shot,) = render_images(parse_trial(LEAN), "door", RenderRequest(0.2), depth=True, segmentation=True)
    assert np.asarray(Image.open(path)).shape == (48, 64, 3)
    metres = np.asarray(Image.open(names[1])) / 1000.0
    seen = np.isfinite(shot.depth)
    np.testing.assert_allclose(metres[seen], shot.depth[seen], atol=6e-4)
    labels = Image.open(names[2])
    assert labels.mode == "P"
    who = np.asarray(labels)
    assert np.array_equal(who == 2, shot.segmentation == -3)
    assert np.array_equal(np.asarray(labels.convert("RGB")), color_segmentation(shot.segmentation))
    assert sorted(path.parent.iterdir()) == sorted(names)


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("ending", [".gif", ".webp", ".mp4", ""])
def test_a_film_is_written(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"film{ending}"
    (tmp_path / "room.xml").write_text(LEAN)
    words = ["render", str(tmp_path / "room.xml"), "--to", "0.4", "--fps", "12.5", "--out", str(path), "--depth"]
    assert main(words) == 0
    if ending == "":
        assert len(list(path.glob("rgb-*.png"))) == len(list(path.glob("depth-*.png"))) == 6
    elif ending == ".mp4":
        import av

        with av.open(str(path)) as film:
            images = [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]
            assert film.streams.video[0].average_rate == 12.5
        first = next(render_images(parse_trial(LEAN), "door"))
        assert len(images) == 6
        assert np.abs(images[0].astype(int) - first.rgb).mean() < 6.0
    else:
        with Image.open(path) as film:
            assert film.n_frames == 6
            assert film.size == (64, 48)
    assert not list(tmp_path.rglob("*.part"))


def moving(count: int) -> Iterator[RenderedImage]:
    """A bright square that wanders over a dark ground, and rests from image 3 to 5."""
    for k in range(count):
        image = np.full((40, 61, 3), (20, 40, 60), dtype=np.uint8)
        at = 3 * min(k, 3) if k < 6 else 3 * (k - 2) % 40
        image[5 + at // 2 : 15 + at // 2, at : at + 11] = (220, 180, 90)
        yield RenderedImage(k / 30.0, image)


@pytest.mark.parametrize("ending", [".gif", ".webp"])
def test_films_show_what_was_seen_as_long_as_it_was_seen(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"film{ending}"
    _, count = ImageWriter(path, film=True, rate=30.0).write(moving(31))
    assert count == 31
    wanted = [shot.rgb for shot in moving(31)]
    time, times = 0.0, []
    with Image.open(path) as film:
        assert film.info["loop"] == 0
        assert film.n_frames == 31 - 2, "what rests is one image"
        for number in range(film.n_frames):
            film.seek(number)
            seen = np.asarray(film.convert("RGB")).astype(int)
            times.append(time)
            assert np.abs(seen - wanted[round(time * 30.0)]).mean() < (1e-9 if ending == ".gif" else 4.0), number
            time += film.info["duration"] / 1000.0
    assert time == pytest.approx(31 / 30.0, abs=0.006), "times are rounded, but do not add up"
    assert times[4] - times[3] == pytest.approx(0.1, abs=0.011)
    assert path.stat().st_size < 31 * 2500


@pytest.mark.parametrize("ending", [".gif", ".webp", ".mp4"])
def test_a_film_is_written_image_by_image(ending: str, tmp_path: Path) -> None:
    alive: weakref.WeakSet[RenderedImage] = weakref.WeakSet()
    sizes = []

    def watched() -> Iterator[RenderedImage]:
        for shot in moving(200):
            alive.add(shot)
            assert len(alive) <= 3
            sizes.append(sum(part.stat().st_size for part in tmp_path.glob(".*.part")))
            yield RenderedImage(shot.time, shot.rgb)

    ImageWriter(tmp_path / f"film{ending}", film=True).write(watched())
    if ending != ".mp4":
        assert sizes[-1] > sizes[0] == 0
    assert [path.name for path in tmp_path.iterdir()] == [f"film{ending}"]


@pytest.mark.parametrize("ending", [".gif", ".webp", ".mp4"])
def test_a_film_that_fails_leaves_nothing(ending: str, tmp_path: Path) -> None:
    def broken() -> Iterator[RenderedImage]:
        yield from moving(3)
        raise InputError("the run is over")

    with pytest.raises(InputError, match="the run is over"):
        ImageWriter(tmp_path / f"film{ending}", film=True).write(broken())
    assert not list(tmp_path.iterdir())


WRONG = {
    "camera": (["--camera", "dor"], r"room has no camera 'dor', did you mean 'door'\?; it has door, overview"),
    "late": (["--at", "7"], r"there is no image at 7 s: room lasts from 0 to 1 s"),
    "backwards": (
        ["--from", "0.6", "--to", "0.2"],
        r"the end of the video \(0.2 s\) must be after its start \(0.6 s\)",
    ),
    "rate": (
        ["--to", "0.4", "--fps", "30"],
        r"the rate 30 Hz gives a period of 0.0333333 s, which is shorter than the time step 0.04 s; the highest",
    ),
    "negative rate": (["--to", "0.4", "--fps", "-5"], r"the rate -5 Hz must be finite and above 0"),
    "no world": (["--world", "physic"], r"--world physic must be planar or physics, did you mean 'physics'\?"),
    "both": (["--at", "0.4", "--to", "0.6"], r"--at is for an image and --to for a video"),
    "fps of an image": (["--at", "0.4", "--fps", "5"], r"--fps requires a video"),
    "ending": (
        ["--out", "a.tiff"],
        r"a.tiff must end in .png, .jpg, .webp for an image, or in .mp4, .gif, .webp for a video with --to T",
    ),
    "world": (
        ["--world", "physics", "--set", "world=planar"],
        r"--world physics and --set world=planar conflict",
    ),
}


@pytest.mark.parametrize("mistake", WRONG)
def test_a_mistake_is_said_in_a_sentence(mistake: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import re

    (tmp_path / "room.xml").write_text(LEAN)
    words, sentence = WRONG[mistake]
    out = [] if "--out" in words else ["--out", str(tmp_path / "out" / "a.webp")]
    assert main(["render", str(tmp_path / "room.xml"), *words, *out]) == 2
    said = capsys.readouterr().err
    assert re.search(sentence, said), said
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


def test_without_a_way_to_draw_nothing_is_written(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("MUJOCO_GL", "disabled")
    gl_context.backend.cache_clear()
    plain = LEAN.replace("<camera ", '<camera renderer="opengl" ', 1)
    try:
        with pytest.raises(InputError, match="MUJOCO_GL = 'disabled' must be one of egl, osmesa"):
            list(render_images(parse_trial(plain)))
        assert len(list(render_images(parse_trial(LEAN)))) == 1  # the rasteriser needs no graphics library
    finally:
        gl_context.backend.cache_clear()


def test_without_extras(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(MissingExtra, match=r"a video as .mp4 needs the extra \[sim\]"):
        ImageWriter(tmp_path / "a.mp4", film=True)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtra, match=r"an image of a trial needs the extra \[sim\]: pip install"):
        list(render_images(load_trial("frontal")))


def test_cameras_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["render", "frontal", "--list", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["cameras"] == ["overview"]
