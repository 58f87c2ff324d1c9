"""Stages from files: areas as WKT and GeoJSON, maps of ROS."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity
from PIL import Image

from crowdbot.core import InputError, TrialError
from crowdbot.recording import replay, run
from crowdbot.trials import Stage, Wall, load_trial, parse_trial, trial_xml
from crowdbot.trials.files import stage_maps
from trial_texts import written

HOUSE = "POLYGON ((0 0, 10 0, 10 6, 0 6, 0 0), (4 2, 6 2, 6 4, 4 4, 4 2))"
TEXT = """<trial name="t" duration="2">
  <stage {stage}/>
  <crowd type="orca"/>
  <spawner count="3" zone="1,1 3,1 3,5 1,5" goal="7,1 9,1 9,5 7,5"/>
</trial>
"""
YAML = (
    "image: map.pgm\nresolution: 0.1\norigin: [-1.0, -0.5, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
)


def pgm(rows: list[str], kind: bytes = b"P5") -> bytes:
    """Return an image: # occupied, . free, ? unknown."""
    grey = {"#": 0, ".": 254, "?": 205}
    cells = [grey[mark] for row in rows for mark in row]
    body = bytes(cells) if kind == b"P5" else " ".join(map(str, cells)).encode()
    return kind + b"\n# made by hand\n%d %d\n255\n" % (len(rows[0]), len(rows)) + body


ROOM = ["?" * 30, *["?" + "#" * 28 + "?"] * 2, *["?##" + "." * 24 + "##?"] * 16, *["?" + "#" * 28 + "?"] * 2, "?" * 30]


def test_an_area_is_ground_with_holes() -> None:
    stage = Stage(area=HOUSE)
    assert stage.clearance([(1, 3), (5, 3), (11, 3), (3, 3)]).tolist() == [1.0, 0.0, 0.0, 1.0]
    assert len(stage.rings) == 2
    assert len(stage.as_walls()) == 8
    outer, hole = stage.rings
    assert np.sum(outer[:, 0] * np.roll(outer[:, 1], -1) - np.roll(outer[:, 0], -1) * outer[:, 1]) < 0.0
    assert np.sum(hole[:, 0] * np.roll(hole[:, 1], -1) - np.roll(hole[:, 0], -1) * hole[:, 1]) > 0.0


@pytest.mark.parametrize("name", ["area.wkt", "area.geojson"])
def test_an_area_may_lie_in_a_file(tmp_path: Path, name: str) -> None:
    rings = [[[0, 0], [10, 0], [10, 6], [0, 6], [0, 0]], [[4, 2], [6, 2], [6, 4], [4, 4], [4, 2]]]
    shape = {"type": "Polygon", "coordinates": rings}
    feature = {"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": shape}]}
    written(tmp_path, HOUSE if name.endswith("wkt") else json.dumps(feature), name)
    inside = load_trial(written(tmp_path, TEXT.format(stage=f'area="{name}"')))
    inline = parse_trial(TEXT.format(stage=f'area="{HOUSE}"'))
    assert run(inside).digest == run(inline).digest
    assert parse_trial(trial_xml(inside), folder=tmp_path) == inside
    assert f'area="{name}"' in trial_xml(inside)


@pytest.mark.parametrize(
    ("stage", "sentence"),
    [
        ('area="POLYGON ((0 0, 1 0"', 't.xml:2: <stage> area="POLYGON ((0 0, 1 0" is not WKT: '),
        ('area="POLYGON ((0 0, 4 4, 4 0, 0 4, 0 0))"', "the WKT has a polygon that is not simple: self-intersection"),
        ('area="POLYGON EMPTY"', "holds nothing, it must hold polygons"),
        ('area="GEOMETRYCOLLECTION (POINT (1 1))"', "holds Point, it must hold polygons"),
        ('area="POLYGON ((0 0, 1e9 0, 1e9 1e9, 0 0))"', "not finite, or more than 1e+08 m from the origin"),
        (
            'area="POLYGON ((395130 5714230, 395150 5714230, 395150 5714240, 395130 5714230))"',
            'the WKT has corners more than 1e+06 m from the origin of the trial; with offset="-395140,-5714235" its'
            " centre is the origin",
        ),
        (
            'area="POLYGON ((0 0, 9 0, 9 9, 0 0))" offset="2e6,0"',
            'more than 1e+06 m from the origin of the trial; with offset="-4,-4"',
        ),
        ('area="POLYGON ((0 0, 9 0, 9 9, 0 0))" offset="2e9,0"', "must lie within 1e+08 m of the origin"),
        ('area="POLYGON ((0 0, 9 0, 9 9, 0 0))" offset="1,2 3,4"', 'offset="1,2 3,4" must be one point x,y'),
        ('area="POLYGON ((9e6 0, 9e6 9, 9e6 9, 9e6 0))" offset="1"', "where a point x,y should be"),
        ('area="POLYGON ((0 0, 9 0, 9 9, 0 0))" rotation="7"', "rotation"),
        ('walkable="0,0 9,0 9,9" offset="1,0"', "offset acts on area and map only, and the stage has neither"),
        ('walkable="0,0 9,0 9,9" rotation="1"', "rotation acts on area and map only, and the stage has neither"),
        ('map="far.yaml"', 'far.yaml has corners more than 1e+06 m from the origin of the trial; with offset="'),
        ('area="none.wkt"', "there is no file 'none.wkt'"),
        ('area="../area.wkt"', "lies outside"),
        ('area="/etc/passwd"', "lies outside"),
        ('area="bad.bin"', "bad.bin is not text"),
        ('area="bad.txt"', "bad.txt is neither WKT nor GeoJSON of an area"),
        ('area="many.wkt"', "has 25001 corners, more than 20000"),
        ('area="POLYGON ((0 0, 9 0, 9 9, 0 0))" walkable="0,0 9,0 9,9"', "has both walkable and area"),
        ('area="POLYGON ((0 0, 2 0, 2 6, 0 6, 0 0))"', "spawn zone reaches outside the walkable area"),
        ('map="none.yaml"', "there is no file 'none.yaml'"),
        ('map="bad.txt"', "bad.txt is not a ROS map: it does not say image and resolution and origin"),
        ('map="noimage.yaml"', "there is no file 'gone.pgm'"),
        ('map="outside.yaml"', "lies outside"),
        ('map="notpgm.yaml"', "bad.bin is not an image that can be read: a map is a PGM, PNG, BMP or JPEG image"),
        ('map="short.yaml"', "short.pgm is cut off or damaged"),
        ('map="large.yaml"', "large.pgm has 5000 x 5000 cells; at most 16000000 are read"),
        ('map="huge.yaml"', "huge.pgm has too many cells; at most 16000000 are read"),
        ('map="nan.yaml"', "nan.yaml: resolution has nan, which is not finite"),
        ('map="word.yaml"', "word.yaml: resolution has 'fine', which is not a number"),
        ('map="zero.yaml"', "zero.yaml: resolution = 0 m must be above 0"),
        ('map="pair.yaml"', "pair.yaml: origin = [1, 2] must be a list of three numbers"),
        ('map="percent.yaml"', "percent.yaml: occupied_thresh = 65 must be from 0 to 1; 65 % is 0.65"),
        ('map="swapped.yaml"', "swapped.yaml: free_thresh = 0.8 must not be above occupied_thresh = 0.65"),
        ('map="mode.yaml"', "mode.yaml: mode = 'rwa' is unknown, did you mean 'raw'?; use trinary, scale, raw"),
        ('map="negate.yaml"', "negate.yaml: negate = 2 must be 0 or 1"),
        ('map="yaml.yaml"', "yaml.yaml:1: "),
    ],
)
def test_wrong_grounds_are_told(tmp_path: Path, stage: str, sentence: str) -> None:
    ring = [(np.cos(a), np.sin(a)) for a in np.linspace(0.0, 6.28, 25_000)]
    for name, data in {
        "bad.bin": b"\xff\x00\x12",
        "bad.txt": "hello",
        "many.wkt": f"POLYGON (({', '.join(f'{x} {y}' for x, y in [*ring, ring[0]])}))",
        "noimage.yaml": YAML.replace("map.pgm", "gone.pgm"),
        "outside.yaml": YAML.replace("map.pgm", "../../map.pgm"),
        "far.yaml": YAML.replace("[-1.0, -0.5", "[395130.0, 5714230.0"),
        "map.pgm": pgm(ROOM),
        "notpgm.yaml": YAML.replace("map.pgm", "bad.bin"),
        "short.yaml": YAML.replace("map.pgm", "short.pgm"),
        "short.pgm": b"P5 50 50 255\nabc",
        "huge.yaml": YAML.replace("map.pgm", "huge.pgm"),
        "huge.pgm": b"P5 99999 99999 255\nabc",
        "large.yaml": YAML.replace("map.pgm", "large.pgm"),
        "large.pgm": b"P5 5000 5000 255\nabc",
        "nan.yaml": YAML.replace("resolution: 0.1", "resolution: .nan"),
        "word.yaml": YAML.replace("resolution: 0.1", "resolution: fine"),
        "zero.yaml": YAML.replace("resolution: 0.1", "resolution: 0"),
        "pair.yaml": YAML.replace("[-1.0, -0.5, 0.0]", "[1, 2]"),
        "percent.yaml": YAML.replace("occupied_thresh: 0.65", "occupied_thresh: 65"),
        "swapped.yaml": YAML.replace("free_thresh: 0.196", "free_thresh: 0.8"),
        "mode.yaml": YAML + "mode: rwa\n",
        "negate.yaml": YAML.replace("negate: 0", "negate: 2"),
        "yaml.yaml": "image: [map.pgm",
    }.items():
        written(tmp_path, data, name)
    with pytest.raises(TrialError) as found:
        parse_trial(TEXT.format(stage=stage), place="t.xml", folder=tmp_path)
    assert sentence in str(found.value)


@pytest.mark.parametrize("kind", [b"P5", b"P2"])
def test_a_map_of_ros_is_a_stage(tmp_path: Path, kind: bytes) -> None:
    written(tmp_path, YAML, "map.yaml")
    written(tmp_path, pgm(ROOM, kind), "map.pgm")
    stage = Stage(map="map.yaml", folder=tmp_path)
    # 24 x 16 free cells of 0.1 m, three cells from the left and below of an origin at -1, -0.5
    left, low = -1.0 + 0.3, -0.5 + 0.3
    centre = (left + 1.2, low + 0.8)
    assert stage.clearance([centre])[0] == pytest.approx(0.8)
    assert stage.clearance([(left - 0.05, low + 0.8), (left + 0.2, low + 0.8)]) == pytest.approx([0.0, 0.2])
    assert stage.block_around(__import__("shapely").Point(left - 0.05, low + 0.8)) == "a solid of the map"
    loose = Stage(map="map.yaml", folder=tmp_path, unknown="free")
    assert loose.clearance([(-0.95, 1.0)])[0] == pytest.approx(0.05)
    assert stage.clearance([(-0.95, 1.0)])[0] == 0.0


def written_map(folder: Path, cells: np.ndarray, more: str = "", image: str = "map.png", kind: str = "L") -> Stage:
    """Write a map of pixels ``[H, W]`` or ``[H, W, C]`` and return its stage."""
    Image.fromarray(cells.astype(np.uint8), kind).save(folder / image)
    written(folder, YAML.replace("map.pgm", image) + more, "map.yaml")
    return Stage(map="map.yaml", folder=folder)


GREY = np.array([[{"#": 0, ".": 254, "?": 205}[mark] for mark in row] for row in ROOM])


@pytest.mark.parametrize(
    ("image", "kind", "cells"),
    [
        ("map.png", "L", GREY),
        ("map.bmp", "L", GREY),
        ("map.png", "RGB", np.repeat(GREY[..., None], 3, axis=2)),
        ("map.png", "RGBA", np.concatenate([np.repeat(GREY[..., None], 3, axis=2), np.full((*GREY.shape, 1), 255)], 2)),
        ("map.pgm", "L", GREY),
    ],
)
def test_a_map_is_an_image_of_any_kind(tmp_path: Path, image: str, kind: str, cells: np.ndarray) -> None:
    written_map(tmp_path, cells, image=image, kind=kind)
    written(tmp_path, pgm(ROOM), "plain.pgm")
    written(tmp_path, YAML.replace("map.pgm", "plain.pgm"), "plain.yaml")
    # an opaque grey of unknown cells is free in an image with opacity, as in nav2_map_server
    same, plain = (Stage(map=name, unknown="free", folder=tmp_path).rings for name in ("map.yaml", "plain.yaml"))
    for ring, other in zip(same, plain, strict=True):
        np.testing.assert_array_equal(ring, other)


def test_a_raw_map_holds_percent(tmp_path: Path) -> None:
    cells = np.zeros((20, 40))
    cells[8:12, 10:14], cells[8:12, 20:24], cells[8:12, 30:34] = 100, 30, 255  # a wall, cheap floor, unknown
    stage = written_map(tmp_path, cells, "mode: raw\n")
    assert [(round(float(ring[:, 0].min()), 3), round(float(ring[:, 0].max()), 3)) for ring in stage.rings] == [
        (0.0, 0.4),
        (2.0, 2.4),
    ]
    assert len(Stage(map="map.yaml", folder=tmp_path, unknown="free").rings) == 1


def test_a_map_in_the_mode_scale_is_unknown_only_where_it_is_transparent(tmp_path: Path) -> None:
    cells = np.full((20, 40, 2), 255)
    cells[8:12, 10:14, 0] = 0  # a wall
    cells[8:12, 20:24, 0] = 150  # between free and occupied: no wall
    cells[8:12, 30:34, 1] = 0  # transparent
    assert len(written_map(tmp_path, cells, "mode: scale\n", kind="LA").rings) == 2
    assert len(Stage(map="map.yaml", folder=tmp_path, unknown="free").rings) == 1
    assert len(written_map(tmp_path, cells[..., 0], "mode: trinary\n").rings) == 2  # 150 is unknown


def test_people_walk_on_a_map(tmp_path: Path) -> None:
    rows = ["#" * 100, *["#" + "." * 98 + "#"] * 28, *["#" + "." * 40 + "#" * 18 + "." * 40 + "#"] * 30, "#" * 100]
    written(tmp_path, YAML.replace("[-1.0, -0.5, 0.0]", "[0, 0, 0]"), "map.yaml")
    written(tmp_path, pgm(rows), "map.pgm")
    text = TEXT.format(stage='map="map.yaml"').replace('duration="2"', 'duration="12"')
    trial = load_trial(written(tmp_path, text.replace("<crowd", '<routing radius="0.3"/><crowd').replace(
        'count="3"', 'count="3" radius="0.25"')))  # fmt: skip
    episode = run(trial)
    where = episode.position[episode.active]
    assert trial.stage.clearance(where).min() > 0.2
    assert where[:, 0].max() > 6.5
    assert parse_trial(trial_xml(trial), folder=tmp_path) == trial


def test_slanted_walls_of_a_map_are_straight(tmp_path: Path) -> None:
    rows = ["".join("#" if abs(x - y) < 3 else "." for x in range(200)) for y in range(200)]
    written(tmp_path, YAML, "map.yaml")
    written(tmp_path, pgm(rows), "map.pgm")
    stage = Stage(map="map.yaml", folder=tmp_path)
    assert sum(len(ring) for ring in stage.rings) < 40


def test_a_turned_map_is_turned(tmp_path: Path) -> None:
    written(tmp_path, YAML.replace("[-1.0, -0.5, 0.0]", "[2, 1, 1.5707963267948966]"), "map.yaml")
    written(tmp_path, pgm(["##....", "......"]), "map.pgm")
    (ring,) = Stage(map="map.yaml", folder=tmp_path).rings
    assert ring.min(axis=0).tolist() == pytest.approx([1.8, 1.0])
    assert ring.max(axis=0).tolist() == pytest.approx([1.9, 1.2])


@pytest.mark.parametrize(
    ("limit", "most", "size", "sentence"),
    [
        ("MOST_CORNERS", 2000, 80, r"has \d+ corners, more than 2000; clean or shrink the map"),
        ("MOST_DETAIL", 4000, 80, r"has \d+ corners of cells, more than 4000; clean or shrink the map"),
        ("MOST_DETAIL", 120_000, 900, r"has \d+ runs of solid cells, more than 120000; clean or shrink the map"),
    ],
)
def test_a_map_of_noise_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, limit: str, most: int, size: int, sentence: str
) -> None:
    monkeypatch.setattr(stage_maps, limit, most)
    written(tmp_path, YAML, "map.yaml")
    noise = np.random.default_rng(0).integers(0, 2, (size, size), dtype=np.uint8) * 255
    written(tmp_path, f"P5 {size} {size} 255\n".encode() + noise.tobytes(), "map.pgm")
    with pytest.raises(InputError, match=sentence):
        Stage(map="map.yaml", folder=tmp_path)


def clearances(stage: Stage) -> list[float]:
    """Return the clearance at some places of a stage."""
    return [round(float(room), 6) for room in stage.clearance([(1, 3), (3, 3), (5, 3), (8, 1), (11, 3), (2, 5.5)])]


def house_at(x: float, y: float, turn: float) -> str:
    """Return the house turned about its corner and moved."""
    shape = shapely.affinity.rotate(shapely.from_wkt(HOUSE), turn, origin=(0.0, 0.0), use_radians=True)
    return str(shapely.to_wkt(shapely.affinity.translate(shape, x, y), rounding_precision=9))


@pytest.mark.parametrize("turn", [0.0, 0.5 * np.pi, 0.3, -2.0])
@pytest.mark.parametrize(("x", "y"), [(0.0, 0.0), (395_130.0, 5_714_230.0), (-1.9e7, 4.2e6)])
def test_an_area_is_moved_and_turned(tmp_path: Path, x: float, y: float, turn: float) -> None:
    text = house_at(x, y, turn)
    written(tmp_path, text, "far.wkt")
    shape = shapely.geometry.mapping(shapely.from_wkt(text))
    written(tmp_path, json.dumps(shape), "far.geojson")
    for area in ("far.wkt", "far.geojson", text):
        stage = Stage(area=area, offset=[(-x, -y)], rotation=-turn, folder=tmp_path)
        assert clearances(stage) == pytest.approx(clearances(Stage(area=HOUSE)), abs=1e-5)
        assert np.concatenate(stage.rings).max(axis=0) == pytest.approx([10.0, 6.0], abs=1e-5)


def test_a_map_is_moved_and_turned(tmp_path: Path) -> None:
    (tmp_path / "map.pgm").write_bytes(pgm(ROOM))
    written(tmp_path, YAML, "here.yaml")
    written(tmp_path, YAML.replace("[-1.0, -0.5", "[395129.0, 5714229.5"), "far.yaml")
    here, far = (
        Stage(map=name, folder=tmp_path, offset=offset)
        for name, offset in (("here.yaml", ()), ("far.yaml", "-395130,-5714230"))
    )
    assert np.concatenate(far.rings) == pytest.approx(np.concatenate(here.rings), abs=1e-6)
    turned = Stage(map="here.yaml", folder=tmp_path, rotation=0.5 * np.pi)
    x, y = np.concatenate(here.rings).T
    assert np.concatenate(turned.rings) == pytest.approx(np.column_stack([-y, x]), abs=1e-9)


def test_walls_of_the_trial_are_not_moved() -> None:
    stage = Stage(area=house_at(100.0, 0.0, 0.0), offset="-100,0", walls=[Wall([(1, 1), (1, 5)])])
    assert stage.clearance([(1.5, 3)]).tolist() == [0.5]


def test_a_trial_on_a_moved_stage_is_recorded_and_replayed(tmp_path: Path) -> None:
    written(tmp_path, house_at(395_130.0, 5_714_230.0, 0.25), "far.wkt")
    stage = 'area="far.wkt" offset="-395130,-5714230" rotation="-0.25"'
    trial = load_trial(written(tmp_path, TEXT.format(stage=stage)))
    assert stage in trial_xml(trial)
    assert parse_trial(trial_xml(trial), folder=tmp_path) == trial
    episode = run(trial, out=tmp_path / "away")
    file = tmp_path / "away" / "episode.mcap"
    (tmp_path / "far.wkt").unlink()
    done = replay(file)
    assert (done.equal, done.recorded) == (True, episode.digest)


@pytest.mark.parametrize(
    "wrong", ['offset="1"', 'offset="1,2 3,4"', 'offset="9e9,0"', 'rotation="7"', 'rotation="east"']
)
def test_a_wrong_placement_is_the_only_problem(wrong: str) -> None:
    text = TEXT.format(stage=f'area="{house_at(395_130.0, 5_714_230.0, 0.0)}" {wrong}')
    with pytest.raises(TrialError) as found:
        parse_trial(text, place="t.xml")
    assert len(found.value.problems) == 1
    assert wrong.partition("=")[0] in found.value.problems[0]
