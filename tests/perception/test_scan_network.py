"""ScanNetwork: people of generated scans, hostile files of weights, and training that repeats."""

import math

import numpy as np
import pytest

from crowdbot.core import DataError, InputError, Pose, Scene, stream
from crowdbot.perception import ScanNetwork, train_scan_network
from crowdbot.perception.scan_network import SAMPLES, cut_windows, generate_scan
from crowdbot.sensors import Gaussian, Lidar2D, Scan


def reading_of(scan):
    shape = scan.ranges[None].shape
    return Scan(
        0.0, Pose.of((0.0, 0.0), 0.0), scan.ranges[None], scan.angles, np.full(shape, -1), np.ones(shape),
        np.full(shape, -1),
    )  # fmt: skip


def test_most_people_of_generated_scans_are_found_and_few_others():
    found = right = people = 0
    for seed in range(40):
        scan = generate_scan(stream(seed, "unseen"))
        beams = np.bincount(scan.person[scan.person >= 0], minlength=len(scan.centre))
        near = np.linalg.norm(scan.centre, axis=1) < 8.0
        wanted = scan.centre[(beams >= 6) & near]
        place = ScanNetwork().detect(reading_of(scan)).position
        people += len(wanted)
        away = np.linalg.norm(wanted[:, None] - place[None], axis=-1)
        right += int((away.min(axis=1, initial=9.0) < 0.4).sum())
        known = np.linalg.norm(scan.centre[:, None] - place[None], axis=-1)
        found += int((known.min(axis=0, initial=9.0) > 0.5).sum())
    assert right / people > 0.75
    assert found / 40 < 6.0


def test_a_map_hides_its_walls_and_the_scanner_may_turn():
    walls = [[(-5.0, 3.0), (5.0, 3.0)]]
    scene = Scene.of([[2.0, 0.0], [-3.0, 1.0]], radius=0.25, walls=walls)
    scan = Lidar2D(rays=720, noise=Gaussian(0.01)).read(scene, Pose.of((0.2, 0.1), 1.1), stream(1))
    found = ScanNetwork().detect(scan, scene.walls)
    away = np.linalg.norm(found.position[:, None] - [[2.0, 0.0], [-3.0, 1.0]], axis=-1)
    assert (away.min(axis=0) < 0.2).all()
    assert len(found) == 2
    assert found.coverage.visible([[2.0, 0.0], [0.0, 5.0]]).tolist() == [1.0, 0.0]


def test_cutouts_have_the_same_width_at_all_ranges():
    step = 2.0 * math.pi / 720
    windows = []
    for away in (2.0, 6.0):
        scene = Scene.of([[away + 0.25, 0.0]], radius=0.25)
        ranges = Lidar2D(rays=720, range_max=20.0).read(scene, Pose.of((0.0, 0.0), 0.0)).ranges[0]
        cut = np.empty((1, SAMPLES))
        cut_windows(np.where(np.isfinite(ranges), ranges, 1e3), np.array([360]), step, True, cut)
        windows.append((cut[0] < 0.9).sum() / SAMPLES * 1.66)
    assert windows == pytest.approx([0.5, 0.5], abs=0.12)


def test_labels_are_the_beams_on_people():
    scan = generate_scan(stream(3, "labels"))
    there = scan.person >= 0
    ends = scan.ranges[there, None] * np.stack([np.cos(scan.angles[there]), np.sin(scan.angles[there])], axis=-1)
    assert np.linalg.norm(ends - scan.centre[scan.person[there]], axis=1).max() < 0.5


def test_a_training_repeats_and_its_weights_are_used(tmp_path):
    fits = [train_scan_network(tmp_path / f"{k}.npz", scans=12, epochs=1, seed=5) for k in range(2)]
    one, other = (np.load(fit.file) for fit in fits)
    assert all(np.array_equal(one[name], other[name]) for name in one.files)
    assert 0.0 < fits[0].recall <= 1.0
    assert ScanNetwork(weights=str(fits[0].file)).detect(reading_of(generate_scan(stream(1)))).time == 0.0


def test_hostile_weights_are_rejected(tmp_path):
    text, wrong, pickled = (tmp_path / name for name in ("text.npz", "wrong.npz", "pickled.npz"))
    text.write_text("no weights")
    np.savez(wrong, layer0=np.zeros((7, 3)), layer1=np.zeros(3))
    np.savez(pickled, layer0=np.array([{"a": 1}], dtype=object), layer1=np.zeros(3))
    for file in (text, wrong, pickled, tmp_path / "none.npz"):
        with pytest.raises(DataError, match="no weights of ScanNetwork"):
            ScanNetwork(weights=str(file))


def test_wrong_values_are_rejected():
    with pytest.raises(InputError, match="threshold = 1.0 must be above 0 and below 1"):
        ScanNetwork(threshold=1.0)
    with pytest.raises(InputError, match="scans"):
        train_scan_network("x.npz", scans=2)
