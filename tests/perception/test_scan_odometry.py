"""Odometry from scans: paths in a hall with people, scans without returns, gaps, and what trackers gain."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import InputError, Pose, Scene
from crowdbot.evaluation import AnnotatedScan, score_positions
from crowdbot.perception import GlobalNearestNeighbor, LidarClusters, ScanOdometry, Tracker, Tracks
from crowdbot.sensors import BumperReading, Lidar2D

HALL = [[[-4.0, -3.0], [5.0, -3.0], [5.0, 4.0], [-4.0, 4.0]], [[1.0, 2.0], [2.0, 2.0], [2.0, 3.0]]]
LIDAR = Lidar2D(rays=720)


def drive(k):
    """Return the pose of a scanner on a circle of 1.2 m, relative to that of scan 0."""
    angle = 0.04 * k
    return Pose.of((1.2 * math.sin(angle), 1.2 * (1.0 - math.cos(angle))), angle)


def scan_at(k, pose, people=(), noise=0.0):
    scene = Scene.of([*people, [3.0, -1.5]], walls=HALL, radius=0.12).replace(time=0.1 * k)
    scan = LIDAR.read(scene, pose)
    error = noise * np.random.default_rng(k).normal(size=scan.ranges.shape)
    return replace(scan, ranges=scan.ranges + error, pose=Pose.of((0.0, 0.0), 0.0))


def test_a_round_among_walking_people_ends_near_its_begin():
    odometry, state = ScanOdometry(), None
    for k in range(158):
        people = [[3.0 - 0.05 * k, 0.5], [-3.0, -2.5 + 0.03 * k], [0.02 * k, -2.0]]
        pose, state = odometry.update(scan_at(k, drive(k), people, noise=0.01), state)
    truth = drive(157)
    assert np.hypot(*(pose.position[0] - truth.position[0])) < 0.05
    assert pose.heading[0] == pytest.approx(6.28, abs=0.01)


def test_errors_of_rounds_in_a_place_that_was_seen_do_not_add_up():
    odometry, state, errors = ScanOdometry(), None, []
    for k in range(4 * 157):
        people = [[3.0 - 0.05 * (k % 120), 0.5], [-3.0, -2.5 + 0.03 * (k % 150)], [0.02 * (k % 150), -2.0]]
        pose, state = odometry.update(scan_at(k, drive(k), people, noise=0.03), state)
        errors.append(np.hypot(*(pose.position[0] - drive(k).position[0])))
    assert errors[156::157] == pytest.approx(np.zeros(4), abs=0.01)  # key scan on key scan: 0.03 m after four rounds
    for k in range(4 * 157, 5 * 157):
        _, state = odometry.update(scan_at(k, drive(k)), state)
    x, y = state.points.T
    room, block = (x > -3.7) & (x < 4.7) & (y > -2.7) & (y < 3.7), (x > 0.7) & (x < 2.3) & (y > 1.7)
    column = np.hypot(x - 3.0, y + 1.5) < 0.3
    assert not np.any(room & ~block & ~column)  # people have left the map
    assert len(state.points) < 1000  # the map does not grow with the rounds


def test_a_scan_without_returns_continues_the_motion():
    odometry, state = ScanOdometry(), None
    for k in range(10):
        pose, state = odometry.update(scan_at(k, Pose.of((0.1 * k, 0.0), 0.0)), state)
    blind = scan_at(10, Pose.of((1.0, 0.0), 0.0))
    pose, state = odometry.update(replace(blind, ranges=np.full_like(blind.ranges, np.inf)), state)
    assert pose.position[0] == pytest.approx([1.0, 0.0], abs=0.01)
    pose, state = odometry.update(scan_at(11, Pose.of((1.1, 0.0), 0.0)), state)
    pose, state = odometry.update(scan_at(12, Pose.of((1.2, 0.0), 0.0)), state)
    assert pose.position[0] == pytest.approx([1.2, 0.0], abs=0.01)


def test_other_readings_and_fields_are_refused():
    scan = scan_at(0, Pose.of((0.0, 0.0), 0.0))
    with pytest.raises(InputError, match="the reading has 2 environments, it must be one planar scan"):
        ScanOdometry().update(replace(scan, pose=Pose.of(np.zeros((2, 2)), np.zeros(2))))
    pressed = np.zeros((1, 1), dtype=np.int64)
    with pytest.raises(InputError, match="the reading is BumperReading, it must be one planar scan"):
        ScanOdometry().update(BumperReading(0.0, scan.pose, pressed > 0, 0.0 * pressed, pressed))
    for field, value in (("search", 0.0), ("distance", 0.0), ("turn", -1.0), ("overlap", 1.5)):
        with pytest.raises(InputError, match=f"ScanOdometry: {field} = "):
            ScanOdometry(**{field: value})


@dataclass(frozen=True, kw_only=True)
class Diary(Tracker):
    """Reports the detections as they are, and collects them."""

    pages: list

    def begin(self):
        return 0

    def update(self, detections, time, state):
        self.pages.append(detections.position)
        return replace(Tracks.none(time), position=detections.position), state + 1


def test_trackers_see_the_world_and_scores_the_frame_of_the_scanner():
    pillar = np.array([3.0, -1.5])
    rows = []
    for k in (*range(30), *range(100, 110)):
        pose = drive(k)
        cosine, sine = math.cos(pose.heading[0]), math.sin(pose.heading[0])
        local = (pillar - pose.position[0]) @ np.array([[cosine, -sine], [sine, cosine]])
        rows.append(AnnotatedScan(scan_at(k, pose), local[None], sector=(math.pi, 20.0)))
    diary = Diary(pages=[])
    scores = score_positions(rows, {"find": LidarClusters()}, {"diary": diary}, odometry=ScanOdometry())
    assert scores["find, diary"].recall == 1.0
    assert scores["find, diary"] == scores["find"]
    for position in diary.pages[:30]:
        assert np.hypot(*(position - pillar).T).min() < 0.1
    assert np.hypot(*(diary.pages[30] - pillar).T).min() > 0.5  # after the gap, the origin is a new one


def test_people_beside_a_turning_scanner_are_tracked():
    rows = []
    for k in range(40):
        world = np.array([[4.0 - 0.1 * k, 0.5], [3.0, -1.5]])
        cosine, sine = math.cos(0.2 * k), math.sin(0.2 * k)
        local = world @ np.array([[cosine, -sine], [sine, cosine]])
        rows.append(AnnotatedScan(scan_at(k, Pose.of((0.0, 0.0), 0.2 * k), world[:1]), local))
    trackers = {"follow": GlobalNearestNeighbor()}
    plain = score_positions(rows, {"find": LidarClusters()}, trackers)["find, follow"]
    placed = score_positions(rows, {"find": LidarClusters()}, trackers, odometry=ScanOdometry())["find, follow"]
    assert placed.f1 > 0.95
    assert plain.f1 < 0.5


def test_the_command_matches_recorded_scans_only(tmp_path, capsys):
    (tmp_path / "walk.csv").write_text("".join(f"{k},{0.1 * k:.1f},{','.join(['2.0'] * 450)}\n" for k in range(3)))
    (tmp_path / "walk.wp").write_text("0,[[2.0, 0.0]]\n")
    assert main(["track", str(tmp_path / "walk.csv"), "--match-scans"]) == 0
    assert "no map, motion of the scanner from its scans" in capsys.readouterr().out
    assert main(["track", str(tmp_path / "walk.csv"), "--match-scans", "--statistics"]) == 2
    assert "--statistics do not depend on the motion of the scanner" in capsys.readouterr().err
    assert main(["track", "two-way", "--match-scans"]) == 2
    assert "--match-scans and --nobody are for recorded scans" in capsys.readouterr().err
