"""LearnedScene: features by their definition, corrections in the frames of people, training and weights."""

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import DataError, InputError, Pose, Scene
from crowdbot.perception import LearnedScene, LearnedState, TrackedScene, Tracks, train_learned_scene
from crowdbot.perception.scan_prediction.learned_scene import (
    FEATURES,
    FREE,
    EarlierTracks,
    person_frames,
    track_features,
)
from crowdbot.sensors import Lidar2D

LIDAR = Lidar2D(rays=360, range_max=12.0)
AHEAD = np.array([0.25, 0.5, 1.5, 3.0, 5.0])


def scan_at(time, places, walls=()):
    scene = Scene.of(places, radius=0.25, walls=list(walls)).replace(time=time)
    return LIDAR.read(scene, Pose.of((0.2 * time, 0.0), 0.3 * time))


def tracks_of(position, velocity, time=1.0):
    count = len(position)
    return Tracks(
        time, np.arange(count), np.array(position, dtype=float), np.array(velocity, dtype=float),
        np.tile(0.01 * np.eye(4), (count, 1, 1)), np.ones(count), np.ones(count, dtype=bool),
    )  # fmt: skip


def walk(time):
    return [[2.0 + 0.3 * time, -1.0 + 1.2 * time], [4.0 - time, 1.0]]


def scans_of(count=14):
    return [scan_at(0.1 * k, walk(0.1 * k)) for k in range(count)]


def weights_of(folder, last):
    """Write weights of two layers whose outputs are constant."""
    np.savez(
        folder / "own.npz", layer0=np.zeros((FEATURES, 4)), layer1=np.zeros(4), layer2=np.zeros((4, 8)),
        layer3=np.array(last, dtype=float),
    )  # fmt: skip
    return str(folder / "own.npz")


def test_frames_look_along_velocities():
    turn = person_frames(np.array([[0.0, 2.0], [0.0, 0.0]]))
    assert turn[0] @ [0.0, 2.0] == pytest.approx([2.0, 0.0])
    assert turn[1] == pytest.approx(np.eye(2))


def test_features_do_not_depend_on_the_place_and_the_direction_of_the_scene():
    place, velocity = np.array([[2.0, 1.0], [3.0, -1.0]]), np.array([[0.8, 0.3], [-1.0, 0.1]])
    found = []
    for turn, shift in ((0.0, [0.0, 0.0]), (1.1, [5.0, -2.0])):
        rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        pose = Pose.of(tuple(shift), turn)
        scan = LIDAR.read(Scene.of(place @ rotation.T + shift, radius=0.25).replace(time=1.0), pose)
        tracks = tracks_of(place @ rotation.T + shift, velocity @ rotation.T)
        earlier = [EarlierTracks(0.5, tracks.ids, 0.5 * tracks.velocity)]
        found.append(track_features(tracks, earlier, [scan]))
    assert found[0].shape == (2, FEATURES)
    assert found[1] == pytest.approx(found[0], abs=1e-6)
    assert found[0][0, 4:7] == pytest.approx([-0.5 * math.hypot(0.8, 0.3), 0.0, 1.0])
    assert found[0][0, 7:10] == pytest.approx([0.0, 0.0, 0.0])


def test_surfaces_are_measured_in_their_sector():
    scan = scan_at(0.0, [[2.0, 0.0]], [[(3.5, -3.0), (3.5, 3.0)]])
    features = track_features(tracks_of([[2.0, 0.0]], [[1.0, 0.0]], 0.0), [], [scan])[0, -8:]
    distance = 1.0 / features - 0.3
    assert distance.min() == pytest.approx(1.5, abs=0.1)
    assert distance[[3, 4]].min() == distance.min()
    assert (distance <= FREE + 1e-9).all()


def test_corrections_are_turned_interpolated_and_shared(tmp_path):
    file = weights_of(tmp_path, [0.5, 0.0, 1.0, 0.0, 2.0, 0.2, 3.0, 0.4])
    scene, state = LearnedScene(weights=file, share=0.5), LearnedScene(weights=file).begin()
    for scan in scans_of():
        state = scene.update(scan, state)
    assert len(state.tracks) == 2
    turn = person_frames(state.tracks.velocity)
    own = np.einsum("nij,tnj->tni", turn, scene.correct(state, AHEAD))
    ahead, left = [0.125, 0.25, 0.75, 1.5, 1.5], [0.0, 0.0, 0.05, 0.2, 0.2]
    for n in range(2):
        assert own[:, n, 0] == pytest.approx(ahead, abs=1e-6)
        assert own[:, n, 1] == pytest.approx(left, abs=1e-6)
    slow = dataclasses.replace(state.tracks, velocity=0.1 * state.tracks.velocity)
    assert np.abs(scene.correct(dataclasses.replace(state, tracks=slow), AHEAD)).max() < 0.3 * np.abs(own).max()
    none = LearnedScene(weights=file, share=0.0).predict(scans_of(), AHEAD).ranges
    assert np.array_equal(none, TrackedScene().predict(scans_of(), AHEAD).ranges)
    assert not np.array_equal(none, scene.predict(scans_of(), AHEAD).ranges)


def test_earlier_tracks_of_a_second_are_kept():
    scene, state = LearnedScene(), LearnedScene().begin()
    for scan in scans_of(30):
        state = scene.update(scan, state)
    assert isinstance(state, LearnedState)
    times = [item.time for item in state.earlier]
    assert times[-1] == pytest.approx(2.9)
    assert 1.0 <= times[-1] - times[0] <= 1.11


def test_a_training_learns_a_turn_and_repeats(tmp_path):
    """People walk on a circle to the left: the straight path is wrong by a known amount."""

    def run(phase):
        rows = []
        for k in range(60):
            turn = 0.5 * 0.1 * k + phase
            place = [[3.0 + 2.0 * math.sin(turn), 1.0 - 2.0 * math.cos(turn)]]
            rows.append((scan_at(0.1 * k, place), {0: tuple(place[0])}))
        return rows

    runs = [run(0.6 * k) for k in range(10)]
    fits = [train_learned_scene(tmp_path / f"{k}.npz", runs, epochs=25, seed=3) for k in range(2)]
    assert fits[0].samples == fits[1].samples > 100
    assert fits[0].learned == fits[1].learned
    assert fits[0].learned[2] < 0.7 * fits[0].straight[2]
    LearnedScene(weights=str(fits[0].file)).predict([scan for scan, _ in runs[0]], [1.0])


def test_wrong_values_and_weights_are_rejected(tmp_path):
    with pytest.raises(InputError, match=r"share = 1.5 must be from 0 to 1"):
        LearnedScene(share=1.5)
    np.savez(tmp_path / "wrong.npz", layer0=np.zeros((7, 8)), layer1=np.zeros(8))
    with pytest.raises(DataError, match="no weights of LearnedScene"):
        LearnedScene(weights=str(tmp_path / "wrong.npz"))
    with pytest.raises(InputError, match="at least two runs with tracked people"):
        train_learned_scene(tmp_path / "none.npz", [])
