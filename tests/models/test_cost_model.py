"""Costs over velocities: against UMANS and the built-in models, and how they are made small."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from engine_steps import arrived, report, umans
from hypothesis import given, settings
from hypothesis import strategies as st
from model_crowds import PILLAR, ROOM, SCREEN, crowd, moved

import crowdbot.models.costs.cost_model as room
from crowdbot.core import InputError, Scene, stream
from crowdbot.core.geometry import time_to_contact, time_to_segment
from crowdbot.models import ORCA, CollisionFreeSpeed, CostModel, Heuristics, PLEdestrians, PowerLaw, SocialForce
from crowdbot.models.costs import (
    AdmissibleRange,
    CollisionDistance,
    Effort,
    FocusOfExpansion,
    FreeWay,
    GoalForce,
    HalfPlanes,
    Inertia,
    ModelForce,
    NoiseTerm,
    PassingTimes,
    PowerLawEnergy,
    PowerLawForce,
    PreferredVelocity,
    ReciprocalObstacles,
    VelocityCost,
)

EVERY = [
    AdmissibleRange(),
    CollisionDistance(),
    Effort(),
    FocusOfExpansion(),
    FreeWay(),
    GoalForce(),
    HalfPlanes(),
    Inertia(),
    PassingTimes(),
    PowerLawEnergy(),
    PowerLawForce(),
    PreferredVelocity(),
]
EVERY += [ReciprocalObstacles(), NoiseTerm(), ModelForce(SocialForce())]
UMANS = {"max_acceleration": 5.0, "contact_stiffness": 62.5, "max_neighbors": 59.0}
SAMPLED = {**UMANS, "samples": "umans", "optimiser": "sampling", "relaxation_time": 0.5, "neighbor_distance": 10.0}


def straight(scene):
    """Return the scene with the preferred velocities of UMANS, not shortened before the goal."""
    away = scene.goal - scene.position
    wish = away / np.linalg.norm(away, axis=-1, keepdims=True) * scene.preferred_speed[..., None]
    return scene.replace(preferred_velocity=wish)


@pytest.mark.parametrize(
    ("name", "model", "share"),
    [
        ("PLEdestrians", CostModel(Effort(), **SAMPLED), 1.0),
        ("Moussaid", CostModel(FreeWay(sight_distance=8.0), **SAMPLED), 0.999),  # one tie of two sides
        ("VanToll", CostModel(CollisionDistance(), **SAMPLED), 0.97),
        ("PowerLaw", CostModel(GoalForce() + PowerLawForce(), **UMANS), 1.0),
        ("ORCA", CostModel(HalfPlanes(time_horizon=3.0), relaxation_time=0.1, **UMANS), 0.985),  # not in contact
    ],
)
def test_velocities_are_those_of_umans(reference, name, model, share):
    scene, after = umans(reference, name)
    walking = ~arrived(scene)  # who has arrived stands at once there
    scene = scene if name == "PLEdestrians" else straight(scene)
    error = np.linalg.norm(model.velocity(scene, 0.1) - after, axis=-1)[walking]
    found, median, _ = report(f"CostModel({model.costs})", error, 1e-4, "m/s")
    assert found >= share
    assert median < 1e-6


def test_what_differs_from_the_orca_of_umans_are_people_in_contact(reference):
    scene, after = umans(reference, "ORCA")
    model = CostModel(HalfPlanes(time_horizon=3.0), relaxation_time=0.1, **UMANS)
    wrong = np.linalg.norm(model.velocity(straight(scene), 0.1) - after, axis=-1) > 1e-4
    apart = np.linalg.norm(scene.position[:, :, None] - scene.position[:, None], axis=-1) + 9.0 * np.eye(scene.shape[1])
    assert np.mean(apart.min(axis=-1)[wrong & ~arrived(scene)] < 0.5) > 0.95


def robots(scene):
    return scene.replace(external=np.broadcast_to(np.arange(scene.shape[1]) % 7 == 0, scene.shape))


@pytest.mark.parametrize("seed", range(3))
def test_half_planes_are_orca(seed):
    scene = robots(crowd(seed, A=40, E=2))
    assert np.allclose(CostModel().velocity(scene, 0.1), ORCA().velocity(scene, 0.1), atol=1e-12)
    horizon = np.linspace(0.5, 4.0, 40)
    mine = CostModel(HalfPlanes(time_horizon=horizon), max_neighbors=5.0, max_speed=1.2)
    theirs = ORCA(time_horizon=horizon, max_neighbors=5.0, max_speed=1.2)
    assert np.allclose(mine.velocity(scene, 0.1), theirs.velocity(scene, 0.1), atol=1e-12)


def spaced(seed, **more):
    """Return people who do not touch each other."""
    grid = np.stack(np.meshgrid(np.arange(7.0), np.arange(6.0)), axis=-1).reshape(-1, 2)
    rng = np.random.default_rng(seed)
    values = {"goal": rng.uniform(-5.0, 15.0, (42, 2)), "max_speed": 2.0} | more
    return Scene.of(1.2 * grid + rng.uniform(-0.3, 0.3, (42, 2)), rng.normal(0.0, 0.8, (42, 2)), **values)


@pytest.mark.parametrize("seed", range(3))
def test_the_power_law_is_the_built_in_one(seed):
    scene = spaced(seed)
    mine = CostModel(
        GoalForce(0.54) + PowerLawForce(), neighbor_distance=10.0, max_neighbors=41.0, max_acceleration=20.0
    )
    assert np.allclose(mine.velocity(scene, 0.1), PowerLaw(max_neighbors=41.0).velocity(scene, 0.1), atol=1e-9)


@pytest.mark.parametrize(
    "model",
    [SocialForce(), SocialForce(variant="umans2018"), PowerLaw(), Heuristics(), PLEdestrians(), CollisionFreeSpeed()],
    ids=lambda model: type(model).__name__,
)
def test_every_model_is_a_force(model):
    scene = robots(crowd(4, A=30, E=2, max_speed=50.0))
    assert np.allclose(CostModel(ModelForce(model)).velocity(scene, 0.1), model.velocity(scene, 0.1), atol=1e-9)


def test_forces_and_other_costs_mix_by_sampling():
    scene = spaced(5)
    mix = ModelForce(SocialForce()) + 2.0 * HalfPlanes()
    model = CostModel(mix, refinements=8)
    chosen = model.velocity(scene, 0.1)
    assert model.optimiser == "natural"
    assert np.array_equal(chosen, CostModel(mix, optimiser="sampling", refinements=8).velocity(scene, 0.1))
    assert not np.allclose(chosen, SocialForce().velocity(scene, 0.1), atol=0.01)


class _Look(VelocityCost):
    """Keep the surroundings and the candidates that a cost gets."""

    seen: list = []  # noqa: RUF012

    def value(self, world, candidates):
        self.seen.append((world, candidates))
        return np.zeros(candidates.shape[:2])


def surroundings(scene, dt=0.1, **more):
    _Look.seen.clear()
    CostModel(_Look(), **more).velocity(scene, dt)
    return _Look.seen[0]


def test_every_cost_is_a_number_for_every_velocity():
    world, candidates = surroundings(crowd(6, A=30, E=2))
    assert candidates.shape == (60, 363, 2)
    for cost in EVERY:
        value = cost.value(world, candidates)
        assert value.shape == (60, 363), cost
        assert not np.any(np.isnan(value)), cost
        assert cost.gradient(world, world.velocity).shape == (60, 2)
        assert str(cost) in str(cost + PreferredVelocity())


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), span=st.floats(0.5, 20.0))
def test_times_to_contact_are_those_of_the_kernels(seed, span):
    rng = np.random.default_rng(seed)
    walls = [rng.uniform(-span, span, (2, 2)) for _ in range(3)]
    scene = Scene.of(rng.uniform(-span, span, (4, 2)), rng.normal(0.0, 1.0, (4, 2)), walls=walls, goal=np.zeros((4, 2)))
    world, _ = surroundings(scene, neighbor_distance=100.0)
    tries = rng.normal(0.0, 1.5, (4, 5, 2))
    times, wall_times = world.contact_times(tries), world.wall_times(tries)
    for i in range(4):
        for c in range(5):
            for k in range(3):
                x, v = world.offset[i, k], tries[i, c] - world.motion[i, k]
                expected = time_to_contact(*x, *v, 0.5)
                assert times[i, c, k] == pytest.approx(np.inf if expected == 0.0 else expected, rel=1e-9)
            meets = [time_to_segment(*world.position[i], *tries[i, c], 0.25, *wall) for wall in scene.walls.segments()]
            first = min([t for t in meets if t > 0.0], default=np.inf)
            assert wall_times[i, c] == pytest.approx(first, rel=1e-9)
            assert world.first_contact(tries)[i, c] == min(*times[i, c], wall_times[i, c])


def test_slopes_are_differences():
    world, _ = surroundings(spaced(7))
    for cost in (GoalForce(), PowerLawForce(), ModelForce(SocialForce())):
        exact = cost.gradient(world, world.velocity)
        assert np.allclose(exact, VelocityCost.gradient(cost, world, world.velocity), rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_the_power_law_pushes_down_the_slope_of_its_energy_over_place(seed):
    scene = spaced(seed, walls=[[(-1.5, -2.0), (10.0, -2.0)], [(8.0, 7.0), (9.0, 7.5), (8.5, 8.5)]])
    world, _ = surroundings(scene, max_neighbors=41.0)
    force = PowerLawForce().force(world)
    slope = np.zeros((42, 2))
    step = 1e-6
    for i in range(42):
        for c in range(2):
            energy = []
            for sign in (1.0, -1.0):
                place = scene.position.copy()
                place[0, i, c] += sign * step
                moved_world, _ = surroundings(scene.replace(position=place), max_neighbors=41.0)
                energy.append(PowerLawEnergy().value(moved_world, moved_world.velocity[:, None])[i, 0])
            slope[i, c] = (energy[0] - energy[1]) / (2.0 * step)
    # the energy jumps where a collision begins to count; there a difference says nothing
    near = np.isclose(force, -slope, rtol=1e-4, atol=1e-5)
    assert near.mean() > 0.98
    assert np.count_nonzero(np.abs(force) > 0.1) > 20


def test_refined_samples_come_to_the_linear_program():
    scene = spaced(8)
    exact = CostModel(HalfPlanes()).velocity(scene, 0.1)
    world, _ = surroundings(scene)

    def cost(velocity):
        return HalfPlanes().value(world, velocity[0][:, None])[:, 0]

    off = []
    for refinements in (0, 4, 10):
        model = CostModel(HalfPlanes(), optimiser="sampling", refinements=refinements)
        off.append(np.mean(cost(model.velocity(scene, 0.1)) - cost(exact)))
    assert off[0] > off[1] > off[2] > -1e-9
    assert off[2] < 0.02


def test_a_cost_of_ones_own_in_a_few_lines():
    @dataclass(frozen=True)
    class KeepRight(VelocityCost):
        def value(self, world, candidates):
            ahead = world.direction()[:, None]
            return candidates[..., 1] * ahead[..., 0] - candidates[..., 0] * ahead[..., 1]

    alone = Scene.of([[0.0, 0.0]], goal=[[50.0, 0.0]])
    model = CostModel(PreferredVelocity(exponent=2.0) + 0.3 * KeepRight(), refinements=10)
    chosen = model.velocity(alone, 0.1)[0, 0]
    assert chosen == pytest.approx([1.3, -0.15], abs=1e-3)
    assert CostModel(PreferredVelocity() + 0.0 * KeepRight()).velocity(alone, 0.1)[0, 0] == pytest.approx([1.3, 0.0])


def test_reciprocal_obstacles_are_avoided():
    scene = Scene.of([[0.0, 0.0], [6.0, 0.1]], goal=[[6.0, 0.0], [0.0, 0.1]])
    model = CostModel(ReciprocalObstacles(), refinements=3)
    for _ in range(80):
        scene = model.step(scene, 0.1)
        assert np.linalg.norm(scene.position[0, 0] - scene.position[0, 1]) > 0.45
    assert scene.position[0, 0, 0] > 5.5


@pytest.mark.parametrize("cost", [*EVERY[:12], PreferredVelocity() + PowerLawEnergy()], ids=str)
def test_alone_in_a_batch_or_in_parts_the_bytes_are_the_same(cost, monkeypatch):
    scene = crowd(9, A=12)
    model = CostModel(cost, optimiser="sampling", refinements=1, speeds=4, angles=9, contact_stiffness=50.0)
    alone = model.velocity(scene, 0.1)
    for copy in model.velocity(scene.environments([0] * 3), 0.1):
        assert np.array_equal(copy, alone[0])
    monkeypatch.setattr(room, "BUDGET", 1000)
    assert np.array_equal(model.velocity(scene, 0.1), alone)


@pytest.mark.parametrize(
    "cost",
    [
        PreferredVelocity() + PowerLawEnergy(),
        HalfPlanes(),
        FreeWay(),
        AdmissibleRange(),
        PassingTimes(),
        FocusOfExpansion(),
    ],
    ids=str,
)
def test_turning_and_shifting_turns_and_shifts(cost):
    scene = crowd(11, A=40)
    model = CostModel(cost, optimiser="sampling")
    cos, sin = np.cos(1.1), np.sin(1.1)
    turned = model.velocity(moved(scene, (ROOM, PILLAR, SCREEN), 1.1, (30.0, -7.0)), 0.1)
    assert np.allclose(turned, model.velocity(scene, 0.1) @ [[cos, sin], [-sin, cos]], atol=1e-7)


def test_random_samples_come_from_a_seed_or_a_stream():
    scene = crowd(12, A=20)
    drawn = CostModel(PreferredVelocity(), optimiser="sampling", samples="random", seed=1)
    other = CostModel(PreferredVelocity(), optimiser="sampling", samples="random", seed=2)
    assert np.array_equal(drawn.velocity(scene, 0.1), drawn.velocity(scene, 0.1))
    assert np.linalg.norm(drawn.velocity(scene, 0.1) - scene.desired_velocity(0.1), axis=-1).max() < 0.7
    hard = PreferredVelocity() + PowerLawEnergy()
    first = CostModel(hard, optimiser="sampling", samples="random", seed=1)
    assert not np.array_equal(
        first.velocity(scene, 0.1, stream(0, "walk")), first.velocity(scene, 0.1, stream(1, "walk"))
    )
    assert other.seed == 2


def test_noise_needs_a_stream():
    scene = crowd(13, A=20, walls=())
    model = CostModel(PreferredVelocity() + NoiseTerm(0.5))
    quiet = CostModel(PreferredVelocity(), optimiser="sampling").velocity(scene, 0.1)
    assert np.array_equal(model.velocity(scene, 0.1), quiet)
    loud = model.velocity(scene, 0.1, stream(0, "walk"))
    assert not np.array_equal(loud, quiet)
    assert np.array_equal(loud, model.velocity(scene, 0.1, stream(0, "walk")))


def test_contacts_relaxation_and_limits():
    touching = Scene.of([[0.0, 0.0], [0.4, 0.0], [5.0, 0.0]], walls=[[(5.2, -1.0), (5.2, 1.0)]], max_speed=2.0)
    push = CostModel(Inertia(), contact_stiffness=62.5).velocity(touching, 0.01)[0, :, 0]
    assert push == pytest.approx([-0.0625, 0.0625, -0.03125])
    ended = CostModel(Inertia(), contact_stiffness=1e6).velocity(touching, 0.1)[0, :, 0]
    assert ended == pytest.approx([-1.0, 1.0, -0.5])
    alone = Scene.of([[0.0, 0.0]], goal=[[50.0, 0.0]])
    assert CostModel(PreferredVelocity(), relaxation_time=0.5).velocity(alone, 0.1)[0, 0, 0] == pytest.approx(0.26)
    assert CostModel(PreferredVelocity(), max_acceleration=2.0).velocity(alone, 0.1)[0, 0, 0] == pytest.approx(0.2)


@pytest.mark.parametrize("cost", EVERY, ids=str)
@pytest.mark.parametrize("optimiser", ["gradient", "sampling"])
def test_impossible_crowds_take_a_bounded_step(cost, optimiser):
    heap = Scene.of(np.zeros((5, 2)), goal=np.ones((5, 2)), walls=[[(0.0, 0.0), (1.0, 1.0), (0.0, 1.0)]])
    dense = crowd(14, A=25, width=2.0, radius=0.3)
    for scene in (
        heap,
        dense,
        dense.replace(velocity=1e8 * dense.velocity),
        dense.replace(max_speed=np.zeros((1, 25))),
    ):
        model = CostModel(cost, optimiser=optimiser, contact_stiffness=62.5, speeds=3, angles=8)
        chosen = model.velocity(scene, 0.1)
        assert np.all(np.isfinite(chosen))
        assert np.all(np.linalg.norm(chosen, axis=-1) <= scene.max_speed * (1.0 + 1e-9))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: CostModel(optimiser="gradiant"), "optimiser 'gradiant' is unknown, did you mean 'gradient'"),
        (lambda: CostModel(samples="grid"), "samples 'grid' is unknown"),
        (lambda: CostModel("orca"), "costs = 'orca' must be a VelocityCost or a sum of them"),
        (lambda: CostModel(speeds=0), "speeds = 0 is not allowed, it must be a whole number from 1 to 1000"),
        (lambda: CostModel(refinements=1.5), "refinements = 1.5 is not allowed"),
        (lambda: CostModel(max_acceleration=-1.0), "max_acceleration = -1.0"),
        (lambda: np.nan * Inertia(), "weight nan of Inertia"),
        (lambda: PowerLawForce(time_horizon=0.0), "PowerLawForce: time_horizon = 0.0"),
        (
            lambda: CostModel(Effort(), optimiser="closed-form").velocity(crowd(0, A=2), 0.1),
            "has no closed form; use",
        ),
        (lambda: CostModel(GoalForce(np.ones(3))).velocity(crowd(0, A=2), 0.1), r"relaxation_time has shape \(3,\)"),
    ],
)
def test_what_is_wrong_is_said(make, message):
    with pytest.raises(InputError, match=message):
        make()
