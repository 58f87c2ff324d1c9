"""Trackers: the contract over all built-in ones, and people whose motion is known."""

import copy
import math

import numpy as np
import pytest

from crowdbot import perception
from crowdbot.core import InputError, builtin_classes, stream, tree
from crowdbot.perception import Coverage, Detections, GlobalNearestNeighbor, InteractingMultipleModel

TRACKERS = builtin_classes(perception, perception.Tracker)
DT = 0.1


def follow(tracker, rows, state=None, begin=0, coverage=None):
    """Return the tracks of detections at each of ``rows``, and the state."""
    state, found = tracker.begin() if state is None else state, []
    for k, row in enumerate(rows):
        time = DT * (begin + k)
        tracks, state = tracker.update(Detections.of(time, row, 0.05, coverage), time, state)
        found.append(tracks)
    return found, state


def two_walkers(steps=40, seed=0):
    """Return noisy positions of two people who pass each other 0.8 m apart."""
    rng = stream(seed, "walk")
    x = 1.3 * DT * np.arange(steps)
    paths = np.stack([np.stack([x - 2.6, np.full(steps, 0.4)], -1), np.stack([2.6 - x, np.full(steps, -0.4)], -1)], 1)
    return paths, paths + rng.normal(0.0, 0.05, paths.shape)


@pytest.mark.parametrize("kind", TRACKERS.values(), ids=TRACKERS)
class TestContract:
    def test_identities_positions_and_velocities_of_people_who_pass(self, kind):
        paths, seen = two_walkers()
        found, _ = follow(kind(), seen)
        assert all(tracks.ids.tolist() == [0, 1] for tracks in found[5:])
        last = found[-1]
        assert np.abs(last.position - paths[-1]).max() < 0.12
        assert np.abs(last.velocity - [[1.3, 0.0], [-1.3, 0.0]]).max() < 0.35
        assert (last.existence > 0.99).all()
        assert last.detected.all()

    def test_a_stored_state_continues_with_the_same_tracks(self, kind):
        _, seen = two_walkers()
        whole, _ = follow(kind(), seen)
        _, state = follow(kind(), seen[:20])
        kept = copy.deepcopy(state)
        follow(kind(), seen[20:] + 3.0, state, 20)  # another future from the same state
        branch, _ = follow(kind(), seen[20:], state, 20)
        np.testing.assert_equal(tree.flatten(state), tree.flatten(kept))
        for item, other in zip(branch, whole[20:], strict=True):
            assert np.array_equal(item.position, other.position)
            assert np.array_equal(item.covariance, other.covariance)

    def test_covariances_are_positive_and_grow_without_detections(self, kind):
        _, seen = two_walkers()
        view = Coverage(np.zeros(2), -math.pi, 0.1, np.zeros(63))
        found, state = follow(kind(), seen)
        blind, _ = follow(kind(), [np.zeros((0, 2))] * 10, state, len(seen), view)
        sizes = [np.linalg.eigvalsh(one.covariance).min(axis=1) for one in (found[-1], blind[-1])]
        assert (sizes[0] > 0.0).all()
        assert (blind[-1].covariance[:, 0, 0] > 2.0 * found[-1].covariance[:, 0, 0]).all()
        assert not blind[-1].detected.any()

    def test_a_track_survives_while_its_person_is_hidden(self, kind):
        _, seen = two_walkers(20)
        hidden = Coverage(np.zeros(2), -math.pi, 0.1, np.zeros(63))
        clear = Coverage(np.zeros(2), -math.pi, 0.1, np.full(63, 9.0))
        _, state = follow(kind(), seen)
        behind, _ = follow(kind(), [np.zeros((0, 2))] * 10, state, 20, hidden)
        gone, _ = follow(kind(), [np.zeros((0, 2))] * 10, state, 20, clear)
        assert behind[-1].ids.tolist() == [0, 1]
        assert len(gone[-1]) == 0

    def test_a_single_false_detection_is_not_reported(self, kind):
        found, _ = follow(kind(), [[[0.0, 0.0]], *[np.zeros((0, 2))] * 5])
        assert [len(one) for one in found] == [0] * 6

    def test_identities_are_not_used_twice(self, kind):
        nobody = [np.zeros((0, 2))] * 40
        first, state = follow(kind(), [[[0.0, 0.0]]] * 10)
        _, state = follow(kind(), nobody, state, 10)
        second, _ = follow(kind(), [[[0.0, 0.0]]] * 10, state, 50)
        assert not set(first[-1].ids.tolist()) & set(second[-1].ids.tolist())

    def test_no_detections_at_all(self, kind):
        found, _ = follow(kind(), [np.zeros((0, 2))] * 3)
        assert [len(one) for one in found] == [0, 0, 0]

    def test_time_does_not_go_back(self, kind):
        _, state = follow(kind(), [[[0.0, 0.0]]] * 3)
        with pytest.raises(InputError, match=r"time = 0.1 s must be finite and not before the last update at 0.2 s"):
            kind().update(Detections.of(0.1, [[0.0, 0.0]], 0.05), 0.1, state)
        with pytest.raises(InputError, match="time = nan s must be finite"):
            kind().update(Detections.of(0.1, [[0.0, 0.0]], 0.05), math.nan, kind().begin())


def test_the_filter_equals_a_kalman_filter_step_by_step():
    tracker = GlobalNearestNeighbor(acceleration=0.7, speed=0.9)
    rng = stream(4)
    places = np.cumsum(rng.normal(0.05, 0.02, (15, 2)), axis=0)
    mean, covariance = np.r_[places[0], 0.0, 0.0], np.diag([0.0025, 0.0025, 0.81, 0.81])
    move = np.eye(4)
    move[0, 2] = move[1, 3] = DT
    block = np.array([[DT**3 / 3, DT**2 / 2], [DT**2 / 2, DT]])
    noise = 0.7 * np.kron(block, np.eye(2))
    for place in places[1:]:
        mean, covariance = move @ mean, move @ covariance @ move.T + noise
        gain = covariance[:, :2] @ np.linalg.inv(covariance[:2, :2] + 0.0025 * np.eye(2))
        mean = mean + gain @ (place - mean[:2])
        covariance = covariance - gain @ covariance[:2]
    found, _ = follow(tracker, places[:, None])
    assert np.concatenate([found[-1].position[0], found[-1].velocity[0]]) == pytest.approx(mean, abs=1e-9)
    assert found[-1].covariance[0] == pytest.approx(covariance, abs=1e-9)


def test_the_assignment_is_global():
    tracker = GlobalNearestNeighbor()
    _, state = follow(tracker, [[[0.0, 0.0], [0.5, 0.0]]] * 10)
    tracks, _ = tracker.update(Detections.of(1.0, [[0.4, 0.0], [0.8, 0.0]], 0.2), 1.0, state)
    assert tracks.position[0, 0] < tracks.position[1, 0]
    assert tracks.detected.all()


def test_two_models_follow_a_turn_closer_than_one_stiff_model():
    angle = np.clip(np.arange(40) * DT - 2.0, 0.0, 1.0) * math.pi / 2
    step = 1.3 * DT * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    path = np.cumsum(step, axis=0)
    seen = path + stream(1).normal(0.0, 0.03, path.shape)
    stiff, _ = follow(GlobalNearestNeighbor(acceleration=0.1), seen[:, None])
    mixed, _ = follow(InteractingMultipleModel(acceleration=0.1), seen[:, None])
    errors = [max(np.abs(one.position[0] - p).max() for one, p in zip(found[20:], path[20:], strict=True))
              for found in (stiff, mixed)]  # fmt: skip
    assert errors[1] < errors[0]


def test_wrong_values_are_rejected_by_the_tracker():
    with pytest.raises(InputError, match="confirm = 1.5 must be above 0 and below 1"):
        GlobalNearestNeighbor(confirm=1.5)
    with pytest.raises(InputError, match="turning"):
        InteractingMultipleModel(turning=0.0)
