"""Recorded scans with annotated people in files of DROW, FROG and L-CAS: made ones, scores, and damaged files."""

import json
import math

import h5py
import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import DataError, Pose, Scene
from crowdbot.data import read_hdf5_arrays
from crowdbot.evaluation import AnnotatedScan, read_drow, read_frog, read_lcas, score_detections, score_positions
from crowdbot.perception import CloudClusters, GlobalNearestNeighbor, LidarClusters
from crowdbot.sensors import Lidar2D, Lidar3D

PLACES = [[2.0, 0.5], [3.0, -1.5], [1.5, 2.5]]


@pytest.fixture
def file(tmp_path):
    """Write three scans of a simulated S300, of which two are annotated."""
    lidar = Lidar2D(rays=450, field_of_view=math.radians(225.0), range_max=15.0)
    ranges = lidar.read(Scene.of(PLACES, radius=0.25), Pose.of((0.0, 0.0), 0.0)).ranges[0]
    row = ",".join(f"{item:.3f}" for item in np.where(np.isfinite(ranges), ranges, 29.96))
    (tmp_path / "walk.csv").write_text("".join(f"{k},{0.1 * k:.1f},{row}\n" for k in range(3)))
    polar = [[math.hypot(x, y), math.atan2(y, x)] for x, y in PLACES]
    (tmp_path / "walk.wp").write_text(f"0,{json.dumps(polar)}\n2,{json.dumps(polar[:2])}\n")
    return tmp_path / "walk.csv"


def test_annotated_scans_have_their_people_in_the_frame_of_the_scanner(file):
    rows = read_drow(file)
    assert [row.scan.time for row in rows] == [0.0, 0.1, 0.2]
    assert rows[1].people is None
    assert rows[0].people == pytest.approx(np.array(PLACES))
    assert np.isinf(rows[0].scan.ranges).any()
    assert rows[0].scan.angles[0] == pytest.approx(-math.radians(112.5))


def test_detections_are_scored(file):
    scores = score_detections(read_drow(file), LidarClusters())
    assert (scores.people, scores.detections) == (5, 6)
    assert scores.recall == 1.0
    assert scores.precision == pytest.approx(5 / 6)
    assert scores.error < 0.05


def test_the_command_compares_detectors(file, capsys):
    assert main(["track", str(file), "--detector", "lidar-clusters", "scan-network"]) == 0
    shown = capsys.readouterr().out
    assert "walk.csv, recorded scans" in shown
    assert "5 annotated people without identities; no map, no odometry" in shown
    assert "scan-network" in shown
    assert main(["track", str(file), "--json"]) == 0
    scores = json.loads(capsys.readouterr().out)["scores"]
    assert list(scores) == ["lidar-clusters", "lidar-clusters, global-nearest-neighbor"]
    assert scores["lidar-clusters"]["recall"] == 1.0


@pytest.mark.parametrize(
    ("suffix", "text", "message"),
    [
        (".csv", "0,0.1,1.0,x\n", "line 1 has no scan"),
        (".csv", "9,0.1,1.0,2.0\n", "has no scan with a line in walk.wp"),
        (".csv", "x,0.1,1.0,2.0\n", "line 1 has no scan: it must begin with the number"),
        (".wp", "0,[[1.0,\n", "must be the number of a scan and a list"),
        (".wp", "0,[[1.0, NaN]]\n", "a number that is not finite"),
        (".wp", "0," + "[" * 100_000, "must be the number of a scan"),
    ],
)
def test_damaged_files_are_one_sentence(file, suffix, text, message):
    file.with_suffix(suffix).write_text(text)
    with pytest.raises(DataError, match=message):
        read_drow(file)


def test_a_missing_file_is_named(file):
    file.with_suffix(".wp").unlink()
    with pytest.raises(DataError, match=r"walk.wp cannot be read"):
        read_drow(file)


def walk(k):
    """Return three people who walk, in scan k of 20 a second."""
    return [[2.0 + 0.05 * k, 0.5], [3.0, -1.5 + 0.04 * k], [4.0 - 0.05 * k, 2.0]]


def frog_arrays(count=12):
    lidar = Lidar2D(rays=720, field_of_view=math.pi * 719 / 720, range_max=10.0)
    pose = Pose.of((0.0, 0.0), -0.5 * math.pi / 720)
    scans = [lidar.read(Scene.of(walk(k), radius=0.25), pose).ranges[0] for k in range(count)]
    circles = [[x, y, 0.4, math.hypot(x, y), math.atan2(y, x), 0.1] for k in range(count) for x, y in walk(k)]
    return {
        "timestamps": 0.05 * np.arange(count),
        "scans": np.where(np.isfinite(scans), scans, 30.0).astype(np.float32),
        "circles": np.array(circles, dtype=np.float32),
        "circle_idx": 3 * np.arange(count, dtype=np.uint32),
        "circle_num": np.full(count, 3, dtype=np.uint32),
    }


def write_frog(file, **changed):
    with h5py.File(file, "w") as store:
        for name, values in (frog_arrays() | changed).items():
            if values is not None:
                store.create_dataset(name, data=values)
    return file


def test_scans_of_frog_have_their_people(tmp_path):
    rows = list(read_frog(write_frog(tmp_path / "walk.h5")))
    assert len(rows) == 12
    assert rows[5].people == pytest.approx(np.array(walk(5)), abs=1e-6)
    scores = score_detections(rows, LidarClusters())
    assert (scores.recall, scores.precision) == (1.0, 1.0)
    assert scores.error < 0.05


def test_trackers_are_scored_behind_each_detector(tmp_path, capsys):
    file = write_frog(tmp_path / "walk.h5")
    words = ["--tracker", "global-nearest-neighbor", "joint-probabilistic-data-association", "--json"]
    assert main(["track", str(file), *words]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["people"] == 36
    assert len(document["scores"]) == 3
    followed = document["scores"]["lidar-clusters, global-nearest-neighbor"]
    assert followed["recall"] > 0.7
    assert followed["error"] < 0.1


def test_a_tracker_begins_again_after_a_gap():
    rows = _timed([0.0, 0.1, 0.2, 0.3, 9.0, 9.1, 9.2, 9.3, 0.0])
    trackers = {"follow": GlobalNearestNeighbor()}
    whole = score_positions(rows, {"find": LidarClusters()}, trackers)["find, follow"]
    once = score_positions(rows[:4], {"find": LidarClusters()}, trackers)["find, follow"]
    first = score_positions(rows[:1], {"find": LidarClusters()}, trackers)["find, follow"]
    assert whole.detections == 2 * once.detections + first.detections


def test_identities_of_a_tracker_that_begins_again_are_new():
    ids = []
    rows = [row._replace(people=None) for row in _timed([0.0, 0.1, 0.2, 0.3, 9.0, 9.1, 9.2, 9.3])]
    trackers = {"follow": GlobalNearestNeighbor()}
    scores = score_positions(
        rows, {"find": LidarClusters()}, trackers, note=lambda label, tracks: ids.append((label, tracks.ids.tolist()))
    )
    assert [label for label, _ in ids] == ["find, follow"] * 8
    assert len(ids[3][1]) == 3
    assert not set(ids[3][1]) & set(ids[7][1])
    assert math.isnan(scores["find"].false_rate)
    with pytest.raises(DataError, match="no scan has annotated people"):
        score_positions(rows, {"find": LidarClusters()}, trackers)


def _timed(times):
    lidar, place = Lidar2D(rays=360), Pose.of((0.0, 0.0), 0.0)
    return [
        AnnotatedScan(lidar.read(Scene.of(PLACES, radius=0.25).replace(time=time), place), np.array(PLACES))
        for time in times
    ]


def test_positions_in_a_group_do_not_count():
    row = _timed([0.0])[0]._replace(people=np.array(PLACES[:1]))
    assert score_detections([row], LidarClusters()).precision == pytest.approx(1 / 3)
    box = np.array([[2.5, -2.0, 3.5, -1.0], [1.0, 0.0, 3.0, 1.0]])
    left_out = score_detections([row._replace(ignored=box)], LidarClusters())
    assert (left_out.detections, left_out.precision) == (2, 0.5)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"scans": None}, "lacks the arrays of numbers scans; it holds circle_idx"),
        ({"circles": np.array([b"x"])}, "lacks the arrays of numbers circles"),
        ({"circle_num": np.full(12, 4, dtype=np.uint32)}, "point outside the 36 circles"),
        ({"circle_idx": np.full(12, 2**63, dtype=np.uint64)}, "point outside the 36 circles"),
        ({"timestamps": np.zeros(11)}, "must have one value for each scan"),
        ({"timestamps": np.full(12, np.nan)}, "a time or a circle that is not finite"),
        ({"scans": np.zeros(12)}, "must be tables"),
    ],
)
def test_wrong_files_of_frog_are_one_sentence(tmp_path, changed, message):
    file = write_frog(tmp_path / "walk.h5", **changed)
    with pytest.raises(DataError, match=message):
        read_frog(file)


def test_a_damaged_and_a_huge_file_are_one_sentence(tmp_path):
    file = write_frog(tmp_path / "walk.h5")
    with pytest.raises(DataError, match=r"walk.h5 has 8640 values, more than the limit of 100"):
        read_hdf5_arrays(file, ["scans"], 100)
    file.write_bytes(file.read_bytes()[:700])
    with pytest.raises(DataError, match="cannot be read as HDF5"):
        read_frog(file)
    with pytest.raises(DataError, match="cannot be read as HDF5"):
        read_frog(tmp_path / "none.h5")


LABEL = "pedestrian 3.0 0.5 0.1 2.7 0.2 -0.8 3.3 0.8 0.9 0\ngroup 0.0 -4.0 0 -0.5 -4.5 -0.8 0.5 -3.5 0.9 1\n"


def write_lcas(folder, kind="binary"):
    """Write two scans of people of the height of a mast in a folder, of which the first is annotated."""
    scene = Scene.of([[3.0, 0.5], [0.0, -4.0]], radius=0.25)
    cloud = Lidar3D(columns=1800).read(scene, Pose.of((0.0, 0.0), 0.0).to_spatial(0.8))
    points = cloud.points()[0].reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    header = (
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
        f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(points)}\nDATA {kind}\n"
    )
    rows = np.column_stack([points, np.ones(len(points))]).astype("<f4")
    text = "".join(" ".join(f"{item:.4f}" for item in row) + "\n" for row in rows)
    data = rows.tobytes() if kind == "binary" else text.encode()
    folder.mkdir(exist_ok=True)
    for name in ("1464001237.670017000.pcd", "1464001237.770017000.pcd"):
        (folder / name).write_bytes(header.encode() + data)
    (folder / "1464001237.670017000.txt").write_text(LABEL)
    return folder


@pytest.mark.parametrize("kind", ["binary", "ascii"])
def test_scans_of_lcas_have_their_people(tmp_path, kind):
    rows = list(read_lcas(write_lcas(tmp_path, kind)))
    assert [row.people is None for row in rows] == [False, True]
    assert rows[0].people.tolist() == [[3.0, 0.5]]
    assert rows[1].scan.time - rows[0].scan.time == pytest.approx(0.1, abs=1e-6)
    assert len(list(read_lcas(tmp_path, annotated_only=True))) == 1
    scores = score_detections(rows, CloudClusters())
    assert (scores.recall, scores.precision) == (1.0, 1.0)


def test_a_folder_of_lcas_is_scored_with_clusters_of_points(tmp_path, capsys):
    assert main(["track", str(write_lcas(tmp_path / "scans")), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["scores"]["cloud-clusters"]["recall"] == 1.0
    assert main(["track", str(tmp_path / "scans"), "--detector", "lidar-clusters"]) == 2
    assert "PointCloud" in capsys.readouterr().err
    assert main(["track", str(tmp_path / "scans"), "--by", "distance"]) == 2
    assert "are for trials and episodes, not for recorded scans" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"POINTS", b"POINT", "is no PCD file: its header lacks POINTS"),
        (b"FIELDS x y z", b"FIELDS a y z", "must have the fields x, y and z; it has a, y, z"),
        (b"DATA binary", b"DATA binary_compressed", "compressed points are not read"),
        (b"DATA binary", b"DATA octal", "DATA octal must be ascii or binary"),
        (b"SIZE 4 4 4 4", b"SIZE 4 4 4 3", "SIZE, TYPE, COUNT and POINTS of its header cannot be read"),
        (b"COUNT 1 1 1 1", b"COUNT 1 1 1", "must have the same number of words"),
        (b"COUNT 1 1 1 1", b"COUNT 1 1 1 99999999", "at most 1000000 points are read"),
        (b"\nPOINTS ", b"\nPOINTS 9", "is truncated"),
        (b"\nPOINTS ", b"\nPOINTS 99999999", "at most 1000000 points are read"),
        (b"\nPOINTS ", b"\nPOINTS -", "at most 1000000 points are read"),
    ],
)
def test_wrong_point_clouds_are_one_sentence(tmp_path, old, new, message):
    file = write_lcas(tmp_path) / "1464001237.670017000.pcd"
    file.write_bytes(file.read_bytes().replace(old, new, 1))
    with pytest.raises(DataError, match=message):
        list(read_lcas(tmp_path))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("cyclist 1 2 3 4 5 6 7 8 9 0\n", "line 1 must be pedestrian or group"),
        ("pedestrian 1 2 3\n", "line 1 must be pedestrian or group"),
        ("pedestrian 1 2 x 4 5 6 7 8 9 0\n", "nine numbers and the visibility"),
        ("pedestrian 1 2 nan 4 5 6 7 8 9 0\n", "nine numbers and the visibility"),
        (LABEL * 501, "has more than 1000 lines"),
        (" " * 1_000_001, "annotations have at most 1 MB"),
    ],
)
def test_wrong_annotations_are_one_sentence(tmp_path, text, message):
    (write_lcas(tmp_path) / "1464001237.670017000.txt").write_text(text)
    with pytest.raises(DataError, match=message):
        list(read_lcas(tmp_path))


def test_folders_without_scans_or_times_are_one_sentence(tmp_path):
    with pytest.raises(DataError, match=r"has no scans: TIME.pcd files are expected"):
        read_lcas(tmp_path)
    write_lcas(tmp_path)
    (tmp_path / "0_first.pcd").write_bytes((tmp_path / "1464001237.670017000.pcd").read_bytes())
    with pytest.raises(DataError, match="the name must be the time of the scan"):
        list(read_lcas(tmp_path))
    with pytest.raises(DataError, match="no scan has annotated people"):
        score_positions([], {"": LidarClusters()}, {})
