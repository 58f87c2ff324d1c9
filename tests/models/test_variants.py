"""What holds for the compatibility variants of the force models too: batches, threads, numbers, values per agent."""

from __future__ import annotations

import dataclasses

import numba
import numpy as np
import pytest
from model_crowds import crowd, renumbered

from crowdbot.core import parameters
from crowdbot.models import Boids, EscapePanic, GroupForce, HeadedSocialForce

VARIANTS = [
    Boids(variant="crowdbot"),
    EscapePanic(variant="crowdbot"),
    GroupForce(variant="pysocialforce"),
    HeadedSocialForce(variant="jhsfm"),
]
every_variant = pytest.mark.parametrize("model", VARIANTS, ids=lambda model: f"{type(model).__name__}-{model.variant}")
MANY = 300


def grouped(seed, A=MANY):
    return crowd(seed, A=A, group=np.random.default_rng(seed).integers(-1, A // 3, A))


@every_variant
def test_alone_or_in_a_batch_the_bytes_are_the_same(model):
    scene = grouped(0)
    alone = model.velocity(scene, 0.1)
    for copy in model.velocity(scene.environments([0] * 3), 0.1):
        assert np.array_equal(copy, alone[0])


@every_variant
def test_the_number_of_threads_does_not_matter(model):
    scene = grouped(1)
    most = numba.get_num_threads()
    results = []
    for count in (1, min(2, numba.config.NUMBA_NUM_THREADS)):
        numba.set_num_threads(count)
        results.append(model.velocity(scene, 0.1))
    numba.set_num_threads(most)
    assert np.array_equal(*results)


@every_variant
def test_renumbering_renumbers(model):
    scene = grouped(2)
    order = np.random.default_rng(0).permutation(MANY)
    expected = model.velocity(scene, 0.1)[:, order]
    assert np.allclose(model.velocity(renumbered(scene, order), 0.1), expected, rtol=0.0, atol=1e-12)


@every_variant
def test_every_parameter_may_differ_per_agent(model):
    scene = grouped(3, A=30)
    expected = model.velocity(scene, 0.1)
    for row in parameters(model):
        values = np.full((1, 30), row.default)
        assert np.array_equal(dataclasses.replace(model, **{row.name: values}).velocity(scene, 0.1), expected)
        values[0, 4] = row.high if row.default != row.high else row.low
        other = dataclasses.replace(model, **{row.name: values}).velocity(scene, 0.1)
        assert np.array_equal(np.delete(other, 4, axis=1), np.delete(expected, 4, axis=1))


@every_variant
def test_absent_agents_do_not_matter(model):
    scene = grouped(4, A=40)
    here = np.arange(40) % 3 > 0
    holes = scene.replace(
        active=here[None],
        position=np.where(here[:, None], scene.position, np.nan),
        velocity=np.where(here[:, None], scene.velocity, 1e200),
        radius=np.where(here, scene.radius, -1.0),
    )
    chosen = model.velocity(holes, 0.1)
    expected = model.velocity(renumbered(scene, np.flatnonzero(here)), 0.1)
    assert np.array_equal(chosen[:, here], expected)
    assert np.all(chosen[:, ~here] == 0.0)
