"""Recorded scans in bags: labelled legs as people, scans without people, unknown ranges, and damaged messages."""

import json
import math

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import DataError, InputError, Pose, Scene
from crowdbot.data import load
from crowdbot.evaluation import read_scan_bag, score_detections
from crowdbot.perception import LidarClusters
from crowdbot.sensors import Lidar2D
from ros_bags import BagWriter

LIDAR = Lidar2D(rays=769, field_of_view=math.radians(270.0), range_max=11.0)
LEGS, SCAN = "/leg_cluster_positions", "/training_scan"
PILLAR = [1.0, 3.0]


def legs_of(k):
    """Return the legs of two people who walk in the sector, in scan k of 10 a second."""
    return [[2.0 + 0.1 * k, 0.2], [2.0 + 0.1 * k, -0.2], [4.0 - 0.05 * k, 0.5], [4.0 - 0.05 * k, 0.9]]


def write_bag(path, storage="ros1", labelled=True, topics=(SCAN,), lost=0, label=(), **changed):
    """Write ten scans of legs and of a pillar beside the sector; ``changed`` are fields of the scans."""
    with BagWriter(path, storage) as bag:
        for k in range(10):
            time, discs = 100.0 + 0.1 * k, [*legs_of(k), PILLAR]
            scan = LIDAR.read(Scene.of(discs, radius=0.07), Pose.of((0.0, 0.0), 0.0))
            ranges = scan.ranges[0].astype(np.float32)
            ranges[:lost] = 0.004
            fields = {
                "angle_min": float(scan.angles[0]), "angle_max": float(scan.angles[-1]),
                "angle_increment": float(scan.angles[1] - scan.angles[0]), "time_increment": 0.0, "scan_time": 0.1,
                "range_min": 0.03, "range_max": 11.0, "ranges": ranges, "intensities": np.zeros(0, dtype=np.float32),
            }  # fmt: skip
            for topic in topics:
                header = bag.header(time, "laser")
                bag.write(topic, time, bag.make("sensor_msgs/msg/LaserScan", header=header, **fields | changed))
            if labelled:
                points = [bag.vector("Point", *place) for place in (*legs_of(k), *label)]
                poses = [bag.make("geometry_msgs/msg/Pose", position=point, orientation=bag.turn()) for point in points]
                header = bag.header(0.0, "laser")
                bag.write(LEGS, time, bag.make("geometry_msgs/msg/PoseArray", header=header, poses=poses))
    return bag.file


@pytest.mark.parametrize(("name", "storage"), [("legs.bag", "ros1"), ("legs", "sqlite3"), ("legs", "mcap")])
def test_labelled_legs_are_people(tmp_path, name, storage):
    rows = read_scan_bag(write_bag(tmp_path / name, storage))
    assert [row.scan.time for row in rows] == pytest.approx([100.0 + 0.1 * k for k in range(10)])
    assert np.sort(rows[3].people, axis=0) == pytest.approx(np.array([[2.3, 0.0], [3.85, 0.7]]))
    scores = score_detections(rows, LidarClusters())
    assert (scores.recall, scores.people) == (1.0, 20)
    assert scores.error < 0.1


def test_positions_beside_the_labelled_sector_do_not_count(tmp_path):
    rows = read_scan_bag(write_bag(tmp_path / "legs.bag"))
    everywhere = score_detections([row._replace(sector=None) for row in rows], LidarClusters())
    inside = score_detections(rows, LidarClusters())
    assert (inside.precision, inside.false_rate) == (1.0, 0.0)
    assert everywhere.false_rate == pytest.approx(1.0)
    near = score_detections([row._replace(people=row.people[:1], sector=(1.0, 2.9)) for row in rows], LidarClusters())
    assert near.detections < inside.detections


def test_a_leg_without_a_second_one_is_a_person(tmp_path):
    people = read_scan_bag(write_bag(tmp_path / "legs.bag", label=[(4.5, -1.0)]))[0].people
    assert [4.5, -1.0] in people.tolist()
    assert len(people) == 3


def test_every_position_is_false_where_nobody_is(tmp_path, capsys):
    write_bag(tmp_path / "empty.bag", labelled=False, topics=("/left", "/right"), range_max=1.5)
    write_bag(tmp_path / "hall.bag", labelled=False, topics=("/left", "/right"))
    rows = read_scan_bag(tmp_path / "hall.bag", "/right", nobody=True)
    assert len(rows) == 10
    scores = score_detections(rows, LidarClusters())
    assert (scores.precision, scores.people, scores.false_rate) == (0.0, 0, 3.0)
    assert math.isnan(scores.recall)
    assert main(["track", str(tmp_path), "--nobody", "--sensor", "/left", "--json"]) == 0
    scores = json.loads(capsys.readouterr().out)["scores"]
    assert scores["lidar-clusters"]["false_rate"] == 1.5
    assert scores["lidar-clusters, global-nearest-neighbor"]["recall"] is None


def test_tracks_of_a_bag_without_labels_are_a_recording(tmp_path, capsys):
    file = write_bag(tmp_path / "own.bag", labelled=False)
    assert main(["track", str(file)]) == 2
    assert "for tracks without scores, --out DIR" in capsys.readouterr().err
    assert main(["track", str(file), "--out", str(tmp_path / "found")]) == 0
    tracker = "lidar-clusters, global-nearest-neighbor"
    shown = capsys.readouterr().out.splitlines()
    assert shown[0] == f"own.bag: 10 scans without labelled people, 3 tracks of {tracker}; no scores"
    assert shown[1:] == [str(tmp_path / "found" / name) for name in ("tracks.csv", "scores.json")]
    document = json.loads((tmp_path / "found/scores.json").read_text())
    assert document == {"source": "own.bag", "people": 0, "scores": {}, "tracks": {tracker: 3}}
    tracks = load(tmp_path / "found/tracks.csv")
    assert sorted(tracks.x[tracks.frame == tracks.frame.max()]) == pytest.approx([1.0, 2.9, 3.55], abs=0.1)
    labelled = write_bag(tmp_path / "legs.bag")
    assert main(["track", str(labelled), "--out", str(tmp_path / "scored"), "--duration", "0.5", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document == json.loads((tmp_path / "scored/scores.json").read_text())
    assert document["people"] == 10
    times = {line.split(",")[1] for line in (tmp_path / "scored/tracks.csv").read_text().splitlines()[1:]}
    assert max(times) == "100.400"
    assert main(["track", str(tmp_path), "--out", str(tmp_path / "both")]) == 2
    assert "has several bags, whose tracks would mix; give one bag" in capsys.readouterr().err


def test_ranges_beside_the_limits_are_unknown_or_no_returns(tmp_path):
    scan = read_scan_bag(write_bag(tmp_path / "legs.bag", lost=40))[0].scan
    assert np.isnan(scan.ranges[0, :40]).all()
    assert np.isposinf(scan.ranges[0, 40:80]).all()
    upside_down = read_scan_bag(write_bag(tmp_path / "turned.bag", angle_min=2.356, angle_increment=-0.006135))[0].scan
    assert (np.diff(upside_down.angles) > 0.0).all()
    plain = read_scan_bag(write_bag(tmp_path / "plain.bag", angle_min=-2.356, angle_increment=0.006135))[0].scan
    assert np.array_equal(upside_down.ranges, plain.ranges[:, ::-1])


def test_statistics_count_the_returns_of_labelled_people(tmp_path, capsys):
    write_bag(tmp_path / "legs.bag")
    assert main(["track", str(tmp_path / "legs.bag"), "--statistics", "--json"]) == 0
    bands = {band["near"]: band for band in json.loads(capsys.readouterr().out)["bands"]}
    assert bands[2.0]["people"] > 10
    assert bands[2.0]["apart"] == 1.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"labelled": False},
            "no labelled legs in /leg_cluster_positions; if nobody is in its scans, give --nobody",
        ),
        ({"label": [(math.nan, 0.0)]}, "/leg_cluster_positions, message 1 has a number that is not finite"),
        ({"topics": ()}, "has no messages of the type sensor_msgs/LaserScan"),
        ({"ranges": np.zeros(1, dtype=np.float32)}, "/training_scan, scan 1 has 1 ranges, 2 to 10000 are read"),
        ({"ranges": np.zeros(10_001, dtype=np.float32)}, "has 10001 ranges"),
        ({"angle_min": math.nan}, "must give at most a full turn"),
        ({"angle_increment": 0.0}, "must give at most a full turn"),
        ({"angle_increment": 1.0}, "must give at most a full turn"),
        ({"range_max": math.inf}, "must be finite, and the first the smaller one"),
        ({"range_min": 12.0}, "must be finite, and the first the smaller one"),
    ],
)
def test_wrong_bags_are_one_sentence(tmp_path, options, message):
    file = write_bag(tmp_path / "legs.bag", **options)
    with pytest.raises(DataError, match=message):
        read_scan_bag(file)


def test_other_files_topics_and_options_are_one_sentence(tmp_path, capsys):
    file = write_bag(tmp_path / "legs.bag")
    with pytest.raises(InputError, match="so there are people in its scans"):
        read_scan_bag(file, nobody=True)
    with pytest.raises(DataError, match="has no scans in /scan; it has /training_scan"):
        read_scan_bag(file, "/scan")
    (tmp_path / "text.bag").write_text("no bag")
    with pytest.raises(DataError, match="is no bag: it must be MCAP or SQLite of ROS 2, or a bag of ROS 1"):
        read_scan_bag(tmp_path / "text.bag")
    (tmp_path / "cut.bag").write_bytes(file.read_bytes()[:9000])
    with pytest.raises(DataError, match="it is truncated or damaged"):
        read_scan_bag(tmp_path / "cut.bag")
    assert main(["track", str(tmp_path / "walk.csv"), "--nobody"]) == 2
    assert "--nobody and --sensor are not for files of DROW and FROG" in capsys.readouterr().err


def test_scans_and_labels_are_one_each(tmp_path):
    with BagWriter(tmp_path / "legs.bag", "ros1") as bag:
        header = bag.header(0.0, "laser")
        fields = {"angle_min": -1.0, "angle_max": 1.0, "angle_increment": 0.5, "time_increment": 0.0, "scan_time": 0.1}
        bag.write(SCAN, 1.0, bag.make("sensor_msgs/msg/LaserScan", header=header, range_min=0.1, range_max=5.0,
            ranges=np.ones(5, dtype=np.float32), intensities=np.zeros(0, dtype=np.float32), **fields))  # fmt: skip
        for time in (1.0, 2.0):
            bag.write(LEGS, time, bag.make("geometry_msgs/msg/PoseArray", header=header, poses=[]))
    with pytest.raises(DataError, match="has 1 scans in /training_scan and 2 labels in /leg_cluster_positions"):
        read_scan_bag(bag.file)
