"""Joint association and predictors as motion models: exact references, and people who are hidden while they cross."""

import itertools
import math

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.perception import (
    Coverage,
    Detections,
    GlobalNearestNeighbor,
    InteractingMultipleModel,
    JointProbabilisticDataAssociation,
    PredictorMotion,
)
from crowdbot.perception.trackers import association_probabilities
from crowdbot.prediction import ConstantVelocity, Simulated

DT = 0.1


def exact_probabilities(odds):
    """Return the marginals of all joint events in which each detection belongs to at most one track."""
    tracks, detections = odds.shape
    total, marginal = 0.0, np.zeros_like(odds)
    for event in itertools.product(range(-1, detections), repeat=tracks):
        used = [d for d in event if d >= 0]
        if len(set(used)) < len(used):
            continue
        chance = math.prod(odds[t, d] for t, d in enumerate(event) if d >= 0)
        total += chance
        for t, d in enumerate(event):
            if d >= 0:
                marginal[t, d] += chance
    return marginal / total


def run(tracker, rows, coverage=None):
    state, found = tracker.begin(), []
    for k, row in enumerate(rows):
        tracks, state = tracker.update(Detections.of(DT * k, row, 0.05, coverage), DT * k, state)
        found.append(tracks)
    return found, state


@pytest.mark.parametrize("seed", range(5))
def test_belief_propagation_is_close_to_the_sum_over_all_joint_events(seed):
    odds = stream(seed, "odds").exponential(2.0, (3, 4)) * (stream(seed, "gate").random((3, 4)) < 0.6)
    exact, found = exact_probabilities(odds), association_probabilities(odds)
    assert np.abs(found - exact).max() < 0.06
    assert (found.sum(axis=0) <= 1.0 + 1e-3).all()
    assert (found.sum(axis=1) <= 1.0 + 1e-9).all()


def test_belief_propagation_is_exact_without_cycles():
    odds = np.array([[1.5, 0.7, 0.0], [0.0, 2.0, 0.4]])
    assert association_probabilities(odds) == pytest.approx(exact_probabilities(odds), abs=1e-5)


def test_one_person_without_clutter_gets_the_kalman_update():
    places = np.cumsum(stream(4).normal(0.05, 0.02, (15, 2)), axis=0)[:, None]
    joint, _ = run(JointProbabilisticDataAssociation(clutter=1e-9), places)
    nearest, _ = run(GlobalNearestNeighbor(clutter=1e-9), places)
    assert joint[-1].position == pytest.approx(nearest[-1].position, abs=1e-5)
    assert joint[-1].covariance == pytest.approx(nearest[-1].covariance, abs=1e-4)


def test_two_close_detections_widen_the_covariance_of_one_track():
    walk = [[[0.12 * k, 0.0]] for k in range(10)]
    last = [[1.2, 0.15], [1.2, -0.15]]
    joint, nearest = (
        run(kind(), [*walk, last])[0][-1] for kind in (JointProbabilisticDataAssociation, GlobalNearestNeighbor)
    )
    assert abs(joint.position[0, 1]) < 0.02 < abs(nearest.position[0, 1])
    assert joint.covariance[0, 1, 1] > 1.5 * nearest.covariance[0, 1, 1]


@pytest.mark.parametrize("kind", [GlobalNearestNeighbor, InteractingMultipleModel, JointProbabilisticDataAssociation])
def test_constant_velocity_as_the_motion_model_changes_nothing(kind):
    paths = stream(2).normal(0.0, 0.03, (30, 2, 2)) + np.arange(30)[:, None, None] * [[0.1, 0.0], [-0.1, 0.02]]
    plain, _ = run(kind(), paths)
    moved, _ = run(kind(motion=PredictorMotion(predictor=ConstantVelocity())), paths)
    assert moved[-1].position == pytest.approx(plain[-1].position, abs=1e-9)
    assert moved[-1].covariance == pytest.approx(plain[-1].covariance, abs=1e-9)


def test_a_crowd_model_moves_hidden_people_around_each_other():
    """Two people walk towards each other while nobody sees them."""
    x = 1.2 * DT * np.arange(15)
    rows = [[[-2.6 + a, 0.05], [2.6 - a, -0.05]] for a in x] + [np.zeros((0, 2))] * 12
    hidden = Coverage(np.zeros(2), -math.pi, 0.1, np.zeros(63))
    apart = []
    for motion in (None, PredictorMotion(predictor=Simulated("social-force"))):
        found, _ = run(GlobalNearestNeighbor(motion=motion), rows, hidden)
        gaps = [np.linalg.norm(one.position[0] - one.position[1]) for one in found[14:]]
        apart.append(min(gaps))
    assert apart[1] > apart[0] + 0.1


def test_the_predictor_gets_rows_of_its_step_and_the_velocity_of_the_filter():
    motion = PredictorMotion(step=0.4)
    rows = [[[0.12 * k, 0.0]] if k < 5 else [[0.12 * k, 0.0], [5.0, 0.1 * k]] for k in range(40)]
    _, state = run(GlobalNearestNeighbor(motion=motion), rows)
    past = motion.windows(state)
    assert past.position.shape == (1, 8, 2, 2)
    assert past.dt == 0.4
    assert past.present[0, :, 0].all()
    assert np.diff(past.position[0, 2:, 0, 0]) == pytest.approx(0.48, abs=0.02)
    assert len(state.times) <= 8 * 4 + 2


def test_a_new_track_is_absent_before_its_first_detection():
    motion = PredictorMotion(step=0.4)
    rows = [[[0.12 * k, 0.0]] if k < 10 else [[0.12 * k, 0.0], [5.0, 0.1 * k]] for k in range(20)]
    _, state = run(GlobalNearestNeighbor(motion=motion), rows)
    present = motion.windows(state).present[0]
    assert present[:, 1].tolist() == [False] * 5 + [True] * 3


def test_wrong_steps_are_rejected():
    with pytest.raises(InputError, match="step"):
        PredictorMotion(step=0.0)
