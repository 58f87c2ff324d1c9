"""The toy set: where the tracks of the report lie, and that it can be learned from."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot.benchmark.toy_gan.toy_data import ToyData
from crowdbot.benchmark.toy_gan.training import gan_config
from crowdbot.core import InputError, stream


def test_tracks_lie_on_circles_and_turn_off_to_three_sides() -> None:
    toy = ToyData()
    paths = toy.paths(stream(0, "toy"), 200)
    assert paths.shape == (6, 3, 200, 4, 2)
    np.testing.assert_allclose(np.linalg.norm(paths, axis=-1), np.broadcast_to(toy.radii, (6, 3, 200, 4)))
    assert np.ptp(paths[:, :, :, :2], axis=(1, 2)).max() == 0.0  # what is seen does not say the mode
    angle = np.degrees(np.arctan2(paths[0, ..., 1], paths[0, ..., 0]))
    for row, jitter in ((2, 2.0), (3, 3.0)):
        off = angle[..., row] - np.array([[-16.0], [0.0], [16.0]])
        assert np.abs(off).max() <= jitter + 1e-9
        assert np.abs(off).max() > 0.95 * jitter
    np.testing.assert_allclose(toy.middles()[0, 1], np.array(toy.radii)[:, None] * [1.0, 0.0], atol=1e-12)


def test_it_is_a_set_of_samples_with_one_person_each() -> None:
    samples = ToyData(tracks=5).samples(stream(0, "toy"))
    assert (len(samples), samples.people, samples.observe, samples.predict) == (90, 90, 2, 2)
    assert sum(len(batch) for batch in samples.batches(stream(0, "order"), 64)) == 90


def test_wrong_numbers_and_methods_are_said() -> None:
    with pytest.raises(InputError, match="1 of 4 rows are observed"):
        ToyData(observe=1)
    with pytest.raises(InputError, match="must be at least 1"):
        ToyData(groups=0)
    with pytest.raises(InputError, match="unknown method 'vanila', did you mean 'vanilla'"):
        gan_config("vanila", ToyData())
    assert gan_config("s-gan-v20", ToyData()).variety_draws == 20
