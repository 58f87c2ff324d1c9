"""OptimalSteps: potentials and steps of Vadere in random states, and how steps follow each other in time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from engine_steps import report
from extremes import assert_bounded, extreme, heaped
from model_crowds import crowd, moved

from crowdbot.core import InputError, Scene, stream
from crowdbot.models import OptimalSteps
from crowdbot.models.speed_models.optimal_steps import LAW, MEMORY, person_potential, wall_potential

FILE = Path(__file__).with_name("golden") / "vadere_steps.npz"
WHOLE = {"neighbor_distance": 6.0, "max_neighbors": 60.0}


@pytest.fixture(scope="module")
def vadere():
    with np.load(FILE) as file:
        return dict(file)


def test_potentials_are_those_of_vadere(vadere):
    model = OptimalSteps()
    law = np.array([getattr(model, name) for name in LAW])
    pairs = list(zip(vadere["distance"], vadere["reach"], strict=True))
    own = [(person_potential(d, 2.0 * r, law[0], law[1], law), wall_potential(d, r, law)) for d, r in pairs]
    assert np.allclose(own, vadere["potentials"], rtol=1e-12, atol=1e-300)
    assert np.all(np.count_nonzero(vadere["potentials"] > 1.0, axis=0) > 100)


def test_steps_are_those_of_vadere(vadere):
    scene = Scene.of(
        vadere["position"],
        radius=vadere["radius"],
        goal=vadere["goal"],
        preferred_speed=vadere["preferred_speed"],
        max_speed=9.0,
        walls=vadere["walls"].reshape(-1, 2, 2),
    )
    model, velocity, left = OptimalSteps(**WHOLE), np.empty_like(scene.position), np.empty(scene.shape)
    for k in range(scene.shape[1]):  # one after the other: nobody waits
        others = np.where(np.arange(scene.shape[1]) == k, 0.0, 1.0)
        after = model.step(scene.replace(memory={MEMORY: np.broadcast_to(others, scene.shape)}), 0.1)
        velocity[:, k], left[:, k] = after.velocity[:, k], after.memory[MEMORY][:, k]
    duration = (0.4625 + 0.2345 * scene.preferred_speed) / scene.preferred_speed
    assert np.allclose(left, duration - 0.1)
    landing = scene.position + velocity * duration[..., None]
    error = np.linalg.norm(landing - vadere["step"][..., :2], axis=-1)
    share, _, _ = report("random states, Vadere", error, 1e-9, "m")
    assert (error.size, share) == (1000, 1.0)
    ahead = scene.goal - scene.position
    straight = ahead / np.linalg.norm(ahead, axis=-1, keepdims=True) * scene.preferred_speed[..., None]
    aside = np.linalg.norm(velocity - straight, axis=-1) > 0.01
    assert 0.5 < np.mean(aside) < 1.0


def walk(scene, steps, dt, model=None):
    """Return positions and velocities ``[T, A, 2]``, and remaining times of steps ``[T, A]``."""
    out = []
    for _ in range(steps):
        scene = (model or OptimalSteps()).step(scene, dt)
        out.append((scene.position[0], scene.velocity[0], scene.memory[MEMORY][0]))
    return tuple(np.array(values) for values in zip(*out, strict=True))


@pytest.mark.parametrize("dt", [0.05, 0.1, 0.25])
def test_steps_follow_each_other_at_their_rate(dt):
    alone = Scene.of([[0.0, 0.0]], goal=[[50.0, 0.0]], preferred_speed=1.3)
    place, velocity, left = walk(alone, round(20.0 / dt), dt)
    assert velocity[:, 0] == pytest.approx(np.broadcast_to([1.3, 0.0], (len(velocity), 2)), abs=1e-9)
    assert place[-1, 0, 0] == pytest.approx(26.0, abs=1e-6)
    steps = np.count_nonzero(np.diff(left[:, 0]) > 0.0) + 1
    assert steps == pytest.approx(20.0 / ((0.4625 + 0.2345 * 1.3) / 1.3), abs=1.0)


def test_a_step_is_finished_and_the_last_one_ends_at_the_goal():
    model, scene = OptimalSteps(), Scene.of([[0.0, 0.0]], goal=[[9.0, 0.0]], preferred_speed=1.3)
    scene = model.step(scene, 0.1)
    turned = model.step(scene.replace(goal=np.array([[[0.13, 9.0]]])), 0.1)
    assert turned.velocity[0, 0] == pytest.approx([1.3, 0.0])
    place, velocity, _ = walk(Scene.of([[0.0, 0.0]], goal=[[2.0, 1.0]], preferred_speed=1.3), 40, 0.1)
    assert place[-1, 0] == pytest.approx([2.0, 1.0], abs=0.07)  # half of a tick
    assert np.linalg.norm(velocity[-1, 0]) < 0.1
    assert np.all(model.velocity(scene.replace(goal=scene.position), 0.1) == 0.0)


def test_others_are_seen_where_their_steps_end():
    scene = Scene.of(
        [[0.0, 0.0], [1.2, 1.0]], [[0.0, 0.0], [0.0, -1.3]], goal=[[9.0, 0.0], [1.2, -9.0]], preferred_speed=1.3
    )
    free = OptimalSteps().velocity(scene, 0.1)[0, 0]
    coming = OptimalSteps().velocity(scene.replace(memory={MEMORY: np.array([[0.0, 0.5]])}), 0.1)[0, 0]
    there = scene.replace(position=np.array([[[0.0, 0.0], [1.2, 0.35]]]))
    assert not np.allclose(free, coming)
    assert np.array_equal(coming, OptimalSteps().velocity(there, 0.1)[0, 0])


def test_of_two_who_step_to_one_place_the_second_waits():
    scene = Scene.of([[0.0, 0.4], [0.0, -0.4]], goal=[[0.6, 0.05], [0.6, -0.05]], preferred_speed=1.3, radius=0.25)
    model = OptimalSteps(strength=0.0)
    for first in (0, 1):
        left = np.where(np.arange(2) == first, -0.02, 0.02)[None]
        after = model.step(scene.replace(memory={MEMORY: left}), 0.1)
        assert np.linalg.norm(after.velocity[0, first]) == pytest.approx(1.3)
        assert np.all(after.velocity[0, 1 - first] == 0.0)
        assert after.memory[MEMORY][0, 1 - first] == 0.0


def test_people_pass_each_other_and_do_not_step_over_walls():
    meeting = Scene.of([[0.0, 0.0], [8.0, 0.1]], goal=[[8.0, 0.0], [0.0, 0.1]], preferred_speed=1.3, radius=0.2)
    place, _, _ = walk(meeting, 100, 0.1)
    assert np.linalg.norm(place[:, 0] - place[:, 1], axis=-1).min() > 0.4
    assert place[-1] == pytest.approx(meeting.goal[0], abs=0.1)
    fence = Scene.of([[0.0, 0.0]], goal=[[9.0, 0.0]], walls=[[(0.9, -5.0), (0.9, 5.0)]])
    place, _, _ = walk(fence, 100, 0.1)
    assert place[:, 0, 0].max() < 0.9 - 0.25


def test_people_differ_in_the_length_of_their_steps():
    model = OptimalSteps()
    drawn = model.individual(200, stream(0, "people"))
    assert model.is_individual
    assert not drawn.is_individual
    assert np.std(drawn.step_length) == pytest.approx(0.036, rel=0.15)
    scene = crowd(1, A=200, width=40.0)
    left = drawn.step(scene, 0.1).memory[MEMORY]
    assert not np.array_equal(left, model.step(scene, 0.1).memory[MEMORY])


def test_turning_and_shifting_turns_and_shifts():
    scene = crowd(2, A=40, walls=())
    cos, sin = np.cos(1.1), np.sin(1.1)
    turned = OptimalSteps().velocity(moved(scene, (), 1.1, (30.0, -7.0)), 0.1)
    assert np.allclose(turned, OptimalSteps().velocity(scene, 0.1) @ [[cos, sin], [-sin, cos]], atol=1e-7)


@pytest.mark.parametrize("seed", range(12))
def test_extreme_parameters_take_bounded_steps(seed):
    rng = np.random.default_rng(seed)
    assert_bounded(extreme(OptimalSteps, rng), heaped(rng), float(rng.choice([1e-3, 0.1, 1.0])))


def test_what_is_wrong_is_said():
    with pytest.raises(InputError, match="OptimalSteps: personal_space = 0.0"):
        OptimalSteps(personal_space=0.0)
