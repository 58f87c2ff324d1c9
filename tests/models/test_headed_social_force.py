"""HeadedSocialForce: against JHSFM, another program and a plain twin, and by what headings must do."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from engine_steps import report
from extremes import assert_bounded, extreme, heaped
from model_crowds import crowd

from crowdbot.core import InputError, Scene
from crowdbot.models import HeadedSocialForce, Mixture, SocialForce
from crowdbot.models.forces.headed_social_force import MEMORY, VARIANTS

FILE = Path(__file__).with_name("golden") / "headed_states.npz"
DT = 0.001
WALL = [(-9.0, -2.7), (9.0, -2.7)]
ALL = {"neighbor_distance": 30.0, "max_neighbors": 60.0}
MODELS = {
    "farina2017": HeadedSocialForce(mass=80.0, **ALL),
    "jhsfm": HeadedSocialForce(variant="jhsfm", sliding=120.0, turn_gain=0.1, **ALL),
}
every_variant = pytest.mark.parametrize("variant", VARIANTS)


def body_velocity(scene):
    """Return the velocities along headings, left of them and of turning, ``[E, A, 3]``."""
    cos, sin = np.cos(scene.heading), np.sin(scene.heading)
    x, y = scene.velocity[..., 0], scene.velocity[..., 1]
    turn = np.broadcast_to(scene.memory.get(MEMORY, 0.0), scene.shape)
    return np.stack([cos * x + sin * y, cos * y - sin * x, turn], axis=-1)


@pytest.mark.parametrize(("variant", "engine"), [("jhsfm", "JHSFM"), ("farina2017", "Social-Navigation-PyEnvs")])
def test_accelerations_are_those_of_the_original(variant, engine):
    with np.load(FILE, allow_pickle=False) as file:
        states = dict(file)
    scene = Scene.of(
        states["position"],
        states["velocity"],
        heading=states["heading"],
        radius=0.3,
        goal=states["goal"],
        preferred_speed=states["preferred_speed"],
        max_speed=states["preferred_speed"],
        walls=[WALL] if variant == "jhsfm" else (),
    ).replace(memory={MEMORY: states["angular_velocity"]})
    before, after = body_velocity(scene), body_velocity(MODELS[variant].step(scene, DT))
    error = np.linalg.norm(after - states[variant], axis=-1) / DT
    share, _, _ = report(f"random states, {engine}", error, 1e-6, "m/s^2, rad/s^2")
    assert error.size == 1000
    assert share == 1.0
    assert np.median(np.linalg.norm(after - before, axis=-1)) / DT > 1.0  # there is something to compare
    apart = np.linalg.norm(scene.position[:, :, None] - scene.position[:, None], axis=-1) + 9.0 * np.eye(20)
    assert np.mean(apart.min(axis=-1) < 0.6) > 0.1  # some are in contact


def twin(scene, dt):
    """Return the next body velocities in an open space by the formulas of the paper."""
    x, v, r = scene.position[0], scene.velocity[0], scene.radius[0]
    m, tau, gain, ratio = 75.0, 0.5, 0.3, 3.0
    out = np.empty((len(x), 3))
    for i in range(len(x)):
        force = np.zeros(2)
        for j in range(len(x)):
            if i == j:
                continue
            n = (x[i] - x[j]) / math.dist(x[i], x[j])
            t = np.array([-n[1], n[0]])
            over = r[i] + r[j] - math.dist(x[i], x[j])
            force += (2000.0 * math.exp(over / 0.08) + 1.2e5 * max(over, 0.0)) * n
            force += 2.4e5 * max(over, 0.0) * ((v[j] - v[i]) @ t) * t
        drive = m * (scene.desired_velocity(dt)[0, i] - v[i]) / tau
        angle, spin = scene.heading[0, i], scene.memory[MEMORY][0, i]
        ahead, left = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
        inertia = 0.5 * m * r[i] ** 2
        stiffness = inertia * gain * math.hypot(*drive)
        damping = inertia * (1.0 + ratio) * math.sqrt(gain * math.hypot(*drive) / ratio)
        off = math.remainder(angle - math.atan2(drive[1], drive[0]), 2.0 * math.pi)
        out[i] = (
            v[i] @ ahead + dt * (drive + force) @ ahead / m,
            v[i] @ left + dt * (1.0 * force @ left - 500.0 * v[i] @ left) / m,
            spin + dt * (-stiffness * off - damping * spin) / inertia,
        )
    return out


def test_a_step_follows_the_text():
    scene = crowd(4, A=20, width=3.0, walls=(), max_speed=500.0, radius=0.2)
    scene = scene.replace(memory={MEMORY: np.random.default_rng(4).normal(0.0, 1.0, (1, 20))})
    after = body_velocity(HeadedSocialForce(**ALL).step(scene, 1e-4))[0]
    assert after == pytest.approx(twin(scene, 1e-4), abs=1e-12)


def test_people_turn_before_they_walk_aside():
    scene = Scene.of([[0.0, 0.0]], heading=[0.0], preferred_velocity=[[0.0, 1.3]], max_speed=1.7)
    for k in range(200):
        scene = HeadedSocialForce().step(scene, 0.02)
        assert k > 5 or 0.0 < scene.heading[0, 0] < 0.5
        forward, left, _ = body_velocity(scene)[0, 0]
        assert abs(left) < 1e-12
        assert forward >= 0.0
    assert scene.heading[0, 0] == pytest.approx(0.5 * math.pi, abs=0.02)
    assert scene.velocity[0, 0, 1] == pytest.approx(1.3, abs=0.01)


def test_a_push_from_the_side_is_damped():
    # the heading stays, and the step aside fades with mass / side_damping = 0.15 s
    scene = Scene.of([[0.0, 0.0]], [[0.0, 0.5]], heading=[0.0], preferred_velocity=[[0.0, 0.0]])
    for _ in range(15):
        scene = HeadedSocialForce().step(scene, 0.01)
    assert scene.heading.tolist() == [[0.0]]
    assert scene.velocity[0, 0, 1] == pytest.approx(0.5 * (1.0 - 0.01 * 500.0 / 75.0) ** 15, abs=1e-12)


def test_walls_brake_people_who_slide_along_them():
    scene = Scene.of(
        [[0.0, 0.28]],
        [[1.0, 0.0]],
        heading=[0.0],
        preferred_velocity=[[1.0, 0.0]],
        radius=0.3,
        walls=[[(-5.0, 0.0), (5.0, 0.0)]],
    )
    smooth = HeadedSocialForce(friction=0.0).step(scene, DT).velocity[0, 0]
    rough = HeadedSocialForce().step(scene, DT).velocity[0, 0]
    assert smooth[0] - rough[0] == pytest.approx(DT * 2.4e5 * 0.02 / 75.0, rel=1e-9)
    assert smooth[1] == rough[1] > 0.0


def test_others_keep_their_headings_and_memory_begins_at_rest():
    scene = crowd(1, A=6)
    robot = np.broadcast_to(np.arange(6) == 2, (1, 6))
    after = HeadedSocialForce().step(scene.replace(external=robot), 0.02)
    assert after.heading[0, 2] == scene.heading[0, 2]
    assert after.memory[MEMORY][0, 2] == 0.0
    assert HeadedSocialForce().memory_at_start == {MEMORY: 0.0}
    mixed = Mixture((SocialForce(), HeadedSocialForce()), which=np.array([0, 1, 1, 0, 1, 0])).step(scene, 0.02)
    alone = HeadedSocialForce().step(scene, 0.02)
    assert np.array_equal(mixed.heading[0, [1, 2, 4]], alone.heading[0, [1, 2, 4]])
    assert np.array_equal(mixed.heading[0, [0, 3, 5]], SocialForce().step(scene, 0.02).heading[0, [0, 3, 5]])


@every_variant
def test_extreme_parameters_take_bounded_steps(variant):
    rng = np.random.default_rng(5)
    for _ in range(20):
        assert_bounded(
            extreme(HeadedSocialForce, rng, variant=variant), heaped(rng), float(rng.choice([1e-3, 0.1, 9.0]))
        )


def test_bad_values_are_refused():
    with pytest.raises(InputError, match=r"HeadedSocialForce: variant 'jhfsm' is unknown.*choose farina2017 or jhsfm"):
        HeadedSocialForce(variant="jhfsm")
    with pytest.raises(InputError, match="turn_ratio"):
        HeadedSocialForce(turn_ratio=0.0)
    with pytest.raises(InputError, match=MEMORY):
        HeadedSocialForce().step(crowd(0, A=3).replace(memory={MEMORY: np.zeros(5)}), 0.02)
