"""The kernel that moves limbs against a plain implementation with arrays, bit by bit."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot.world.physics.people_bodies import move_limbs

SPEEDS, STEP = np.array([5.0, 1.5, 0.2]), 0.005


def plain(here, walk, touched, wary, toward, fresh, late, stride, limbs):
    """Return ends, velocities, lateness and capsules after a step."""
    held = (touched[here] > 0) & ~fresh[here]
    slow = held | late[here]
    lag = walk - limbs[here]
    length = np.sqrt(np.maximum(np.sum(lag[..., :3] ** 2, axis=-1), np.sum(lag[..., 3:] ** 2, axis=-1)))
    share = np.minimum(1.0, np.where(slow, SPEEDS[1], SPEEDS[0])[:, None] * STEP / np.maximum(length, 1e-12))
    share[held], share[fresh[here]] = 0.0, 1.0
    moved = share[..., None] * lag
    to = np.where((slow & (wary[here] > 0))[:, None], toward[here], 0.0)
    ends = moved.reshape(*moved.shape[:2], 2, 3).copy()
    closing = ends[..., 0] * to[:, None, None, 0] + ends[..., 1] * to[:, None, None, 1]
    ends[..., :2] -= np.maximum(0.0, closing - SPEEDS[2] * STEP)[..., None] * to[:, None, None]
    guarded = ends.reshape(moved.shape)
    slow &= held | np.any(share < 1.0, axis=1) | np.any(guarded != moved, axis=(1, 2))
    behind = (slow[:, None] | (share < 1.0))[..., None]
    now = np.where(behind, limbs[here] + guarded, walk)
    swing = np.where(behind, guarded / STEP, stride[here])
    axis = now[..., 3:] - now[..., :3]
    size = np.maximum(np.sqrt(np.sum(axis * axis, axis=-1)), 1e-9)
    x, y, z = np.moveaxis(axis / size[..., None], -1, 0)
    turn = np.stack([1.0 + z, -y, x, np.zeros_like(x)], axis=-1)
    turn[z < -1.0 + 1e-9] = (0.0, 1.0, 0.0, 0.0)
    turn /= np.sqrt(np.sum(turn * turn, axis=-1, keepdims=True))
    return now, swing, slow, 0.5 * (now[..., 3:] + now[..., :3]), turn, 0.5 * size


@pytest.mark.parametrize("seed", range(20))
def test_limbs_move_as_in_the_plain_implementation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    here = np.sort(rng.choice(6, 4, replace=False))
    limbs, stride = rng.normal(size=(6, 17, 6)), rng.normal(size=(6, 17, 6))
    walk = limbs[here] + rng.normal(size=(4, 17, 6)) * rng.choice([0.0, 0.002, 0.05], size=(4, 1, 1))
    limbs[here[0], 0], walk[0, 0] = (0.0, 0.0, 1.0, 0.0, 0.0, 0.5), (0.0, 0.0, 1.0, 0.0, 0.0, 0.5)  # points down
    touched, wary = rng.integers(0, 2, 6), rng.integers(0, 2, 6)
    angle = rng.uniform(0.0, 6.0, 6)
    toward = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    fresh, late = rng.random(6) < 0.2, rng.random(6) < 0.5
    now, swing, slow, middle, turn, half = plain(here, walk, touched, wary, toward, fresh, late, stride, limbs)
    moved, walked, speeds = limbs.copy(), np.zeros((6, 17, 6)), np.zeros((6, 17, 6))
    position, rotation, size, bound = (np.zeros((6, 17, *more)) for more in ((3,), (4,), (3,), ()))
    size[..., 0] = 0.1
    move_limbs(
        here, walk, touched, wary, toward, SPEEDS, STEP, fresh, late, stride, moved, walked, speeds, position, rotation,
        size, bound,
    )  # fmt: skip
    for got, wanted in (
        (moved[here], now), (speeds[here], swing), (late[here], slow), (position[here], middle), (rotation[here], turn),
        (size[here, :, 1], half), (walked[here], walk), (bound[here], half + 0.1),
    ):  # fmt: skip
        np.testing.assert_array_equal(got, wanted)
    assert not fresh[here].any()
