"""Files as they are published and saved: columns after z, folders with a scale, long rows, files of other kinds."""

from __future__ import annotations

import io
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import DataError
from crowdbot.data import load

STEPS = range(12)
JPSCORE = """#description: jpscore (0.8.4)
#framerate: 8.00
#geometry: geometry.xml
#ID: the agent ID
#X,Y,Z: the agents coordinates (in metres)

#ID\tFR\tX\tY\tZ\tA\tB\tANGLE\tCOLOR\t
"""
PETRACK = "# PeTrack project: a.pet\n# framerate: {}\n# {}\n"
Rows = Callable[[int, float, float], str]


@pytest.mark.parametrize(
    ("head", "row", "fps", "per_metre"),
    [
        (JPSCORE, lambda k, x, y: f"\n  1\t  {k}\t{x}\t{y}\t0.0\t0.2\t0.3\t0.0\t220\t", 8.0, 1.0),
        (
            "# description: my experiment\n#framerate: 8\n#X,Y,Z: the coordinates (in centimeters)\n#ID FR X Y Z A\n",
            lambda k, x, y: f"1 {k} {x} {y} 170 0.2\n", 8.0, 100.0,
        ),
        (
            PETRACK.format("25 fps", "id frame x/m y/m z/m mx/m my/m"),
            lambda k, x, y: f"1 {k} {x} {y} 1.7 0.1 0.2\n", 25.0, 1.0,
        ),
        (
            PETRACK.format("16.5", "id frame x/cm y/cm z/cm marker"),
            lambda k, x, y: f"1\t{k}\t{x}\t{y}\t170\t12\n", 16.5, 100.0,
        ),
        (
            PETRACK.format("25 fps", "id frame x [mm] y [mm] z [mm] gaze_x gaze_y gaze_z group"),
            lambda k, x, y: f"1, {k}, {x}, {y}, 1700, 0, 0, 1, 3\n", 25.0, 1000.0,
        ),
        ("#framerate: 10\n#ID FR X Y\n", lambda k, x, y: f"1 {k} {x} {y}\n", 10.0, 1.0),
    ],
    ids=["jpscore", "jpscore centimetres", "head direction", "marker", "gaze", "no height"],
)  # fmt: skip
def test_petrack_text_with_other_columns(head: str, row: Rows, fps: float, per_metre: float, tmp_path: Path) -> None:
    file = tmp_path / "a.txt"
    file.write_text(head + "".join(row(k, (0.1 * k + 1.0) * per_metre, 2.0 * per_metre) for k in STEPS))
    tracks = load(file)
    assert tracks.fps == fps
    np.testing.assert_allclose(tracks.position, [[0.1 * k + 1.0, 2.0] for k in STEPS])
    assert tracks.warnings == []


@pytest.mark.parametrize("names", ["id frame lat lon", "ID FR SPEED X Y", "id frame z x y"])
def test_petrack_text_whose_header_names_other_columns(names: str, tmp_path: Path) -> None:
    file = tmp_path / "a.txt"
    file.write_text(f"# framerate: 8\n# {names}\n" + "".join(f"1 {k} 1 2 3\n" for k in STEPS))
    with pytest.raises(DataError, match=r"its header names the columns .*--format csv --columns id=1 frame=2 x=NUMBER"):
        load(file)
    moved = load(file, format="csv", columns={"id": "1", "frame": "2", "x": "3", "y": "4"}, fps=8.0)
    assert moved.position[0].tolist() == [1.0, 2.0]


@pytest.mark.parametrize("count", [5, 400, 9000, 18_000])
@pytest.mark.parametrize("delimiter", [",", ", "])
def test_four_rows_of_any_length(count: int, delimiter: str, tmp_path: Path) -> None:
    """A row of a real file is longer than the first bytes that detect a format."""
    rows = np.arange(count)
    frame, id, x, y = 10 * (rows // 4), rows % 4 + 1, 2.0 + rows // 4 * 0.5 + rows % 4, 3.0 + rows % 4
    file = tmp_path / "pixel_pos.csv"
    file.write_text("\n".join(delimiter.join(f"{value:.5f}" for value in row) for row in (frame, id, y, x)))
    tracks = load(file)
    assert (len(tracks), tracks.units) == (count, "m")
    assert tracks.position[-1].tolist() == [x[-1], y[-1]]


@pytest.mark.parametrize("outside", [0.0, 0.02, -0.02])
def test_four_rows_of_fractions_of_the_picture_are_no_metres(outside: float, tmp_path: Path) -> None:
    rows = np.arange(120)
    x, y = np.linspace(outside, 1.0, 120), np.linspace(1.0 + outside, 0.0, 120)
    file = tmp_path / "pixel_pos.csv"
    file.write_text("\n".join(",".join(map(str, row.tolist())) for row in (10 * rows, 1 + 0 * rows, y, x)))
    tracks = load(file)
    assert tracks.units == "px"
    assert "fractions of the picture and no metres, give --homography" in tracks.warnings[0]
    metres = load(file, transform=20.0)
    assert (metres.units, metres.warnings) == ("m", [])
    np.testing.assert_allclose(metres.position[-1], [20.0, 0.0], atol=1e-9)


BOX = "-1.0 " * 10


@pytest.mark.parametrize(
    "row",
    [
        f"{{frame}} 1 Pedestrian {BOX}{{x}} -1.0 {{y}} -1.0\n",
        f"{{frame}}.0 1.0 Pedestrian {BOX}{{x}} -1.0 {{y}} -1.0\n",
        f"{{frame}} 1 Pedestrian {BOX}{{x}} 0.0 {{y}} 0.0\n",
        f"{{frame}}.0 1 Car {BOX}{{x}} -1 {{y}} -1\n",
        f"{{frame}} 1.00 Pedestrian {BOX}{{x}} -1.0 {{y}} -1.0 0.9\n",
    ],
)
def test_places_in_the_columns_of_kitti_without_boxes(row: str, tmp_path: Path) -> None:
    file = tmp_path / "zara.txt"
    file.write_text("".join(row.format(frame=k, x=2.0 + 0.5 * k, y=7.0) for k in STEPS))
    with pytest.raises(DataError, match="has no frame rate"):  # the rate of KITTI is not theirs
        load(file)
    tracks = load(file, fps=2.5)
    assert tracks.position[:2].tolist() == [[2.0, 7.0], [2.5, 7.0]]
    assert tracks.warnings == []


def test_an_id_of_kitti_that_is_no_whole_number(tmp_path: Path) -> None:
    file = tmp_path / "zara.txt"
    file.write_text(f"0 1.5 Pedestrian {BOX}1 -1 1 -1\n")
    with pytest.raises(DataError, match="line 1"):
        load(file, fps=2.5)


def person(path: Path, id: int, names: str = "frame,id,x,y,type") -> None:
    """Write a table of one person who walks."""
    rows = "".join(f"{k},{id},{0.05 * k + id},{id},ped\n" for k in STEPS)
    path.write_text(f"{names}\n{rows}", encoding="utf-8")


@pytest.mark.parametrize(
    ("beside", "content"),
    [
        ("ratio_pixel2meter.txt", "0.03872"),
        ("scale.txt", "# metres per pixel\n0.03872\n"),
        ("README.md", "frame,id,x,y\nThis folder has two people."),
        ("LICENSE.license", "Free"),
        ("", ""),
    ],
)
def test_a_folder_of_one_file_a_person_with_ids(beside: str, content: str, tmp_path: Path) -> None:
    folder = tmp_path / "run_01"
    folder.mkdir()
    for name, id in (("p1.csv", 4), ("p2.csv", 9), ("p10.csv", 5)):
        person(folder / name, id)
    if beside:
        (folder / beside).write_text(content)
    tracks = load(folder, fps=25.0)
    assert (tracks.ids.tolist(), len(tracks)) == ([4, 5, 9], 3 * len(STEPS))
    assert tracks.track(9).x[0] == 9.0
    assert ("not read, because it is no table: " + beside in tracks.note) == bool(beside)


def test_folders_that_are_several_recordings(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    folder.mkdir()
    person(folder / "a.csv", 1)
    person(folder / "b.csv", 1)
    with pytest.raises(DataError, match=r"b.csv has the id 1 in id, as .*a.csv has; .* give files that are recordings"):
        load(folder, fps=25.0)
    (folder / "b.csv").write_text("frame,id,x,y,type\n0,2,0,0,ped\n0,3,1,1,ped\n")
    with pytest.raises(DataError, match=r"b.csv has a column of ids, id, with 2 persons; .* give the files instead"):
        load(folder, fps=25.0)
    person(folder / "b.csv", 2, "frame,id,x_c,y_c,type")
    with pytest.raises(DataError, match="b.csv has the columns .*x_c.* move files of another kind out of the folder"):
        load(folder, fps=25.0)
    plain = tmp_path / "train"
    plain.mkdir()
    (plain / "zara.txt").write_text("".join(f"{10 * k}\t{id}\t{0.5 * k}\t{id}\n" for k in STEPS for id in (1, 2)))
    with pytest.raises(DataError, match=r"zara.txt, which has rows of several persons .* such as .*train/\*.txt"):
        load(plain)


def zipped(*names: str) -> bytes:
    """Return a zip archive of empty files."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for name in names:
            archive.writestr(name, "")
    return content.getvalue()


def saved(array: np.ndarray) -> bytes:
    """Return the bytes of an array file."""
    content = io.BytesIO()
    np.save(content, array)
    return content.getvalue()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (pickle.dumps({"x": [1.0]}, protocol=2), "is a pickle of Python, which is not read, .* run any code"),
        (pickle.dumps([0.5] * 100, protocol=5), "is a pickle of Python"),
        (saved(np.zeros((3, 4))), "is an array of NumPy, which does not say what its columns are"),
        (b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + bytes(100), "is a MATLAB file"),
        (zipped("[Content_Types].xml", "xl/workbook.xml"), "is an Excel workbook; save its sheet as CSV"),
        (zipped("content.xml"), "is an OpenDocument file"),
        (zipped("eth/a.txt", "eth/b.txt"), "is a zip archive of eth/a.txt, eth/b.txt; unpack it"),
        (b"\x89PNG\r\n\x1a\n" + bytes(50), "is a picture"),
        (bytes(4) + b"ftypisom" + bytes(50), "is a video; people in it are found by crowdbot track --video"),
        (b'<?xml version="1.0"?>\n<dataset name="x">\n<frame number="1"/></dataset>', "is XML of <dataset>"),
        (b"<viper>\n<config/>\n</viper>", "is XML of <viper>; recordings in XML are those of CVML"),
        (b'{"info": {}, "annotations": [{"bbox": [1, 2]}]}', "is JSON with info, annotations, bbox, but recordings"),
        (b"[[1, 2], [3, 4]]", "is JSON, but recordings"),
    ],
)
def test_files_of_other_kinds_say_what_they_are(content: bytes, words: str, tmp_path: Path) -> None:
    file = tmp_path / "tracks"
    file.write_bytes(content)
    with pytest.raises(DataError, match=words):
        load(file)


def tracker(row: str) -> str:
    """Rows of two people at frames 0 to 29, one 700 px and one 900 px from the left."""
    return "".join(
        row.format(f=k, id=id, x=x + 3 * k, y=200, r=x + 3 * k + 20, b=260, n=k / 30) + "\n"
        for k in range(30)
        for id, x in ((1, 700), (2, 900))
    )


@pytest.mark.parametrize(
    "row",
    [
        "{f},{id},{x},{y},20,60,0.9,0",
        "{f},{id},{x}.25,{y},20,60,0.{id}5,-1",
        "{f},{id},{x},{y},20,60,0.8",
        "{f}, {id}, {x}, {y}, {r}, {b}, 0.85, 0",
        "{f},{id},{x},{y},{r},{b},1",
        "{f},{id},{x},{y},{r},{b},0.5,2",
    ],
)
def test_boxes_of_trackers_are_no_millimetres(row: str, tmp_path: Path) -> None:
    """Eight columns with commas are those of the ATC shopping centre, too."""
    file = tmp_path / "bytetrack.txt"
    file.write_text(tracker(row))
    tracks = load(file, fps=30.0)
    assert (tracks.ids.tolist(), tracks.units, len(tracks)) == ([1, 2], "px", 60)
    assert tracks.track(1).position[2] == pytest.approx([716.0, 260.0], abs=0.3)
    assert ("right and bottom" in tracks.note) == ("{r}" in row)


@pytest.mark.parametrize("begin", [1_351_039_200.0, 1000.0, 5.5])
def test_days_of_the_atc_shopping_centre_are_millimetres(begin: float, tmp_path: Path) -> None:
    file = tmp_path / "atc.csv"
    file.write_text("".join(f"{begin + k / 25:.3f},9,{1000 + 40 * k},2000,1700,1000,0.1,0.2\n" for k in range(50)))
    assert (load(file).units, load(file).x[1]) == ("m", pytest.approx(1.04))


def kitti(boxes: str, place: str, score: str = "") -> str:
    rows = (
        f"{k} {id} Pedestrian 0 0 -1 {boxes.format(x=x + 3 * k, r=x + 3 * k + 40)} {place.format(x=0.1 * k)}{score}\n"
        for k in range(30)
        for id, x in ((1, 700), (2, 900))
    )
    return "".join(rows)


SIZES, ENDS = "{x} 100 40 160", "{x} 100 {r} 260"


@pytest.mark.parametrize(
    ("boxes", "place", "score"),
    [
        (SIZES, "-1 -1 -1 -1 -1 -1 -1", " 1.00"),
        (SIZES, "0 0 0 -1000 -1000 -1000 -10", ""),
        (ENDS, "-1 -1 -1 -1 -1 -1 -1", ""),
        (ENDS, "1.7 0.6 0.6 -1000 -1000 -1000 -10", " 0.5"),
        (ENDS, "0 0 0 0 0 0 0", ""),
    ],
)
def test_kitti_results_without_places_are_feet_of_boxes(boxes: str, place: str, score: str, tmp_path: Path) -> None:
    file = tmp_path / "0000.txt"
    file.write_text(kitti(boxes, place, score))
    tracks = load(file)
    assert (tracks.units, tracks.track(2).position[1].tolist()) == ("px", [923.0, 260.0])
    assert "the file has no places" in tracks.note
    assert ("width and height" in tracks.note) == (boxes == SIZES)


def test_kitti_rows_without_a_place_are_left_out(tmp_path: Path) -> None:
    file = tmp_path / "0000.txt"
    lost = "3 7 Pedestrian 0 0 -1 1 1 9 9 1.7 0.6 0.6 -1000 -1000 -1000 -10\n"
    file.write_text(kitti(ENDS, "1.7 0.6 0.6 {x} 1.6 5 0.1") + lost)
    tracks = load(file)
    assert (tracks.units, tracks.ids.tolist(), sorted(tracks.labels)) == ("m", [1, 2], [1, 2])
    assert tracks.track(1).position[10] == pytest.approx([5.0, -1.0])
    assert "1 rows without a place are left out" in tracks.note


def cvml(frames: list[str], root: str = "dataset", name: str = "objectlist") -> str:
    rows = "".join(f'<frame number="{k}"><{name}>{text}</{name}></frame>\n' for k, text in enumerate(frames))
    return f"<?xml version='1.0' encoding='ISO-8859-1'?>\n<{root} name='a'>\n{rows}</{root}>\n"


def walker(id: object, k: int, more: str = "") -> str:
    return f'<object id="{id}">{more}<box h="60" w="20" xc="{100 + 3 * k}" yc="70.5"/></object>'


CAVIAR = "<orientation>20</orientation><body><left xc='1' yc='2'/></body><appearance>visible</appearance>"


@pytest.mark.parametrize(
    ("root", "name", "more", "alone"),
    [
        ("dataset", "objectlist", "", False),
        ("result", "objectlist", "", False),
        ("dataset", "object_list", CAVIAR, False),
        ("dataset", "objectlist", "", True),
        ("dataset", "objectlist", '<confidence value="0.5"/>', False),
    ],
)
def test_cvml_boxes_have_their_feet_as_places(root: str, name: str, more: str, alone: bool, tmp_path: Path) -> None:
    frames = [walker(7, k, more) + ("" if alone else walker(0, -k)) for k in range(30)]
    frames[4] += '<object id="9"/>'
    file = tmp_path / "gt.xml"
    file.write_text(cvml(frames, root, name))
    with pytest.raises(DataError, match="has no frame rate"):
        load(file)
    tracks = load(file, fps=25.0)
    assert (tracks.ids.tolist(), tracks.units, tracks.dt) == ([7] if alone else [0, 7], "px", 0.04)
    assert tracks.track(7).position[5].tolist() == [115.0, 100.5]
    assert "1 objects without a box are left out" in tracks.note
    assert load(file, fps=25.0, transform=0.02).track(7).x[5] == pytest.approx(2.3)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('xc="103"', 'xc="left"', "gt.xml line 4: xc='left' of <box> is not a number"),
        (' h="60"', "", "line 3: h='' of <box> is not a number"),
        ('id="7"', 'id="ann"', "line 3: id='ann' of <object> is not a number"),
        ('id="7"', 'id="7.5"', "line 3"),
        ('number="2"', 'number=""', "line 5: number='' of <frame> is not a number"),
        ('number="2"', 'number="1"', "line"),
        ('xc="103"', 'xc="1e999"', "line 4"),
        ("</dataset>", "", "line .*: this is not well-formed XML: no element found"),
        ("<dataset", "<!DOCTYPE a [<!ENTITY b 'c'>]>\n<dataset", "gt.xml has a DOCTYPE"),
        ("<box", "<bax", "has no objects with a box in its 30 frames"),
    ],
)
def test_damaged_cvml_names_the_line(old: str, new: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / "gt.xml"
    text = cvml([walker(7, k) for k in range(30)])
    file.write_text(text.replace(old, new) if old == "<box" else text.replace(old, new, 1))
    with pytest.raises(DataError, match=words):
        load(file, fps=25.0)


def test_a_speed_of_pixels_names_the_scale(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("id,frame,x,y\n" + "".join(f"1,{k},{3 * k},{400 + k}\n" for k in range(60)))
    tracks = load(file, fps=24.0)
    assert "or give --scale or --homography if the places are pixels" in tracks.warnings[0]
    assert load(file, fps=24.0, transform=0.02).warnings == []


def test_grand_central_says_which_number_is_x(tmp_path: Path) -> None:
    """Its first numbers reach 1919, its second ones 1079; published homographies take the second for x."""
    for name in ("000001.txt", "000002.txt"):
        (tmp_path / name).write_text("".join(f"{1900 - k}\n{1000 + k}\n{20 * k}\n" for k in STEPS))
    for tracks in (load(tmp_path), load(tmp_path / "000001.txt")):
        assert tracks.position[0].tolist() == [1000.0, 1900.0]
        assert "x is the second number of a row" in tracks.note
