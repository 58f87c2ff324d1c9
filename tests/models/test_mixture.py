"""Mixtures: each by its own model, all seen by all, and what models keep."""

from dataclasses import dataclass
from typing import ClassVar

import numba
import numpy as np
import pytest
from model_crowds import crowd, renumbered

from crowdbot.core import InputError, Paper, Scene, stream
from crowdbot.core.neighbors import CROWD
from crowdbot.models import ORCA, CrowdModel, Mixture, SocialForce
from crowdbot.models.mixture import MODEL

BOTH = (ORCA(), SocialForce())


@dataclass(frozen=True)
class Counter(CrowdModel):
    """Walks as desired, turns to a heading of its own, and remembers how far it has counted."""

    paper: ClassVar[Paper] = Paper("Nobody", 2000, "Counting", "Nowhere")
    by: float = 1.0
    name: str = "count"

    def velocity(self, scene, dt, rng=None):
        lucky = 0.0 if rng is None else rng.random(scene.shape)[..., None]
        return scene.desired_velocity(dt) * (1.0 + self.by) + lucky

    def step(self, scene, dt, rng=None):
        counted = scene.memory.get(self.name, np.zeros(scene.shape)) + self.by
        after = scene.advance(self.velocity(scene, dt, rng), dt)
        return after.replace(heading=np.full(scene.shape, self.by), memory={**scene.memory, self.name: counted})


def halves(scene, seed=0):
    return np.random.default_rng(seed).integers(0, 2, scene.shape[1])


def test_each_walks_by_its_own_model_and_sees_everybody():
    scene = crowd(1, E=2, width=5.0)
    which = halves(scene)
    chosen = Mixture(BOTH, which).velocity(scene, 0.1)
    alone = [model.velocity(scene, 0.1) for model in BOTH]
    for k in (0, 1):
        assert np.array_equal(chosen[:, which == k], alone[k][:, which == k])
    assert not np.array_equal(*alone)


def test_the_others_react_as_any_neighbour_does():
    # were the neighbour of another model external, ORCA would take the whole change of velocity
    ahead = Scene.of([[0, 0], [3, 0.1]], [[1, 0], [-1, 0]], preferred_velocity=[[1, 0], [-1, 0]])
    mixed = Mixture(BOTH, [0, 1]).velocity(ahead, 0.1)
    pushed = ORCA().velocity(ahead.replace(external=np.array([[False, True]])), 0.1)
    assert np.array_equal(mixed[0, 0], ORCA().velocity(ahead, 0.1)[0, 0])
    assert not np.array_equal(mixed[0, 0], pushed[0, 0])


def test_a_mixture_of_one_is_that_model():
    scene = crowd(2)
    one, same = Mixture((ORCA(),)).step(scene, 0.1), ORCA().step(scene, 0.1)
    assert one.digest() == same.digest()
    assert one.time == same.time


def test_which_may_differ_by_environment():
    scene = crowd(3, A=4, E=2, width=3.0)
    which = np.array([[0, 0, 1, 1], [1, 1, 0, 0]])
    chosen = Mixture(BOTH, which).velocity(scene, 0.1)
    for k, model in enumerate(BOTH):
        assert np.array_equal(chosen[which == k], model.velocity(scene, 0.1)[which == k])


def test_headings_and_memories_are_merged():
    scene = crowd(4, A=6)
    which = np.array([0, 1, 2, 0, 1, 2])
    mixture = Mixture((Counter(1.0), Counter(10.0), Counter(100.0, "other")), which)
    for _ in range(3):
        scene = mixture.step(scene, 0.1)
    assert scene.memory["count"][0].tolist() == [3.0, 30.0, 3.0, 3.0, 30.0, 3.0]
    assert scene.memory["other"][0].tolist() == [300.0] * 6
    assert scene.heading[0].tolist() == [1.0, 10.0, 100.0] * 2


def test_what_models_remember_of_somebody_new():
    class Calm(Counter):
        memory_at_start: ClassVar[dict[str, float]] = {"calm": 1.0}

    assert dict(Mixture((Counter(), Calm())).memory_at_start) == {"calm": 1.0}


def test_a_step_follows_the_velocity():
    scene = crowd(5)
    mixture = Mixture(BOTH, halves(scene))
    after = mixture.step(scene, 0.1)
    assert np.array_equal(after.velocity, mixture.velocity(scene, 0.1))
    assert np.array_equal(after.position, scene.position + 0.1 * after.velocity)


def test_the_memory_of_the_scene_goes_before_which():
    scene = crowd(6, A=3).replace(memory={MODEL: np.array([[1.0, 1.0, 0.0]])})
    mixture = Mixture(BOTH, 0)
    assert mixture.of(scene).tolist() == [[1, 1, 0]]
    assert np.array_equal(mixture.velocity(scene, 0.1)[:, :2], SocialForce().velocity(scene, 0.1)[:, :2])
    assert np.array_equal(mixture.step(scene, 0.1).memory[MODEL], scene.memory[MODEL])


def test_robots_are_seen_and_left_alone():
    scene = crowd(7, A=12, width=3.0)
    robot = np.broadcast_to(np.arange(12) == 3, (1, 12))
    which = halves(scene)
    seen = Mixture(BOTH, which).velocity(scene.replace(external=robot), 0.1)
    hidden = Mixture(BOTH, which).velocity(scene.replace(external=robot, visible=~robot), 0.1)
    assert np.array_equal(seen[robot], scene.velocity[robot])
    assert np.any(seen[~robot][which[np.arange(12) != 3] == 0] != hidden[~robot][which[np.arange(12) != 3] == 0])


@pytest.mark.parametrize("A", [30, CROWD + 20])
def test_batches_threads_and_renumbering(A):
    scene = crowd(8, A=A)
    which = halves(scene)
    alone = Mixture(BOTH, which).step(scene, 0.1)
    for copy in Mixture(BOTH, which).step(scene.environments([0] * 3), 0.1).velocity:
        assert np.array_equal(copy, alone.velocity[0])
    order = np.random.default_rng(0).permutation(A)
    assert np.array_equal(
        Mixture(BOTH, which[order]).step(renumbered(scene, order), 0.1).velocity, alone.velocity[:, order]
    )
    most = numba.get_num_threads()
    numba.set_num_threads(1)
    one = Mixture(BOTH, which).step(scene, 0.1)
    numba.set_num_threads(most)
    assert one.digest() == alone.digest()


def test_the_same_stream_gives_the_same_bytes():
    scene = crowd(9, A=5)
    mixture = Mixture((Counter(1.0), Counter(2.0)), halves(scene))
    one, two, other = (mixture.velocity(scene, 0.1, stream(seed, "crowd")) for seed in (3, 3, 4))
    assert np.array_equal(one, two)
    assert not np.array_equal(one, other)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"models": ()}, "it must be a tuple of at least one model"),
        ({"models": (ORCA(), "orca")}, "'orca' is not a crowd model"),
        ({"models": BOTH, "which": 2}, "which = 2 is out of range, it must be from 0 to 1"),
        ({"models": BOTH, "which": [0, -1]}, "which = -1 is out of range"),
        ({"models": BOTH, "which": [0.5]}, "must contain only whole numbers"),
        ({"models": BOTH, "which": [np.nan]}, "must contain only whole numbers"),
    ],
)
def test_a_wrong_mixture_is_explained(values, message):
    with pytest.raises(InputError, match=message):
        Mixture(**values)


def test_too_few_names_are_explained():
    with pytest.raises(InputError, match=r"shape \[2\], which does not broadcast to \[E, A\] = \[1, 30\]"):
        Mixture(BOTH, [0, 1]).velocity(crowd(0), 0.1)
