"""Noise: statistics, text, and draws that do not depend on what else is measured."""

import math

import numpy as np
import pytest

from crowdbot.core import InputError, from_attributes, stream
from crowdbot.sensors import Dropout, Gaussian, Lidar2D, Noise, Offset, Peak, Quantised, apply_noise


def test_gaussian_has_its_mean_and_standard_deviation():
    drawn = Gaussian(0.2).draw((200_000,), stream(1, "noise"))
    assert abs(drawn.mean()) < 4 * 0.2 / math.sqrt(200_000)
    assert drawn.std() == pytest.approx(0.2, rel=0.01)
    assert np.mean(np.abs(drawn) < 0.2) == pytest.approx(0.6827, abs=0.005)


def test_peak_comes_with_its_probability_and_height():
    drawn = Peak(0.03, -1.5).draw((200_000,), stream(2, "noise"))
    assert set(np.unique(drawn).tolist()) == {-1.5, 0.0}
    assert np.mean(drawn != 0.0) == pytest.approx(0.03, abs=0.0015)


def test_peaks_may_spread_and_come_at_their_rate():
    drawn = Peak(0.01, 2.0, 1.0).draw((400_000,), stream(6, "noise"))  # the spikes of the first simulator
    spikes = drawn[drawn != 0.0]
    assert len(spikes) / len(drawn) == pytest.approx(0.01, abs=4 * math.sqrt(0.01 * 0.99 / 400_000))
    assert spikes.mean() == pytest.approx(2.0, abs=4 / math.sqrt(len(spikes)))
    assert spikes.std() == pytest.approx(1.0, rel=0.05)


def test_dropouts_come_at_their_rate_and_end_a_reading():
    lost = apply_noise(np.ones((1, 200_000)), (Dropout(0.02), Gaussian(0.1)), stream(7))
    assert np.mean(np.isinf(lost)) == pytest.approx(0.02, abs=4 * math.sqrt(0.02 * 0.98 / 200_000))


def test_quantised_values_are_whole_steps_and_uniformly_wrong():
    values = stream(8).uniform(0.0, 10.0, (1, 200_000))
    steps = apply_noise(values, (Quantised(0.125),), stream(8))
    assert np.all(steps % 0.125 == 0.0)
    error = steps - values
    assert np.abs(error).max() <= 0.0625
    assert abs(error.mean()) < 4 * 0.125 / math.sqrt(12 * 200_000)
    assert error.std() == pytest.approx(0.125 / math.sqrt(12), rel=0.01)
    assert apply_noise(np.array([[np.inf, -np.inf]]), (Quantised(0.1),), stream(0)).tolist() == [[np.inf, -np.inf]]


def test_bits_give_as_many_values():
    noise = Quantised.bits(4, 0.0, 3.0)
    assert noise.step == 0.2
    values = apply_noise(np.linspace(0.0, 3.0, 1000)[None], (noise,), stream(0))
    assert len(np.unique(values.round(9))) == 16
    with pytest.raises(InputError, match="bits = 0"):
        Quantised.bits(0, 0.0, 1.0)


def test_several_noises_add_up():
    drawn = apply_noise(np.full((1, 100_000), 5.0), (Gaussian(0.1), Offset(0.3), Peak(0.5, 2.0)), stream(3))
    assert drawn.mean() == pytest.approx(5.0 + 0.3 + 1.0, abs=0.02)
    assert drawn.std() == pytest.approx(math.hypot(0.1, 1.0), rel=0.01)


def test_the_infinite_stays_infinite():
    drawn = apply_noise(np.array([[np.inf, -np.inf, 1.0]]), (Gaussian(1.0), Peak(1.0, 3.0)), stream(4))
    assert drawn[0, 0] == np.inf
    assert drawn[0, 1] == -np.inf
    assert np.isfinite(drawn[0, 2])


def test_each_environment_draws_as_if_alone():
    values = np.arange(12.0).reshape(3, 4)
    noise = (Gaussian(0.1), Peak(0.5, 1.0))
    together = apply_noise(values, noise, [stream(9, "scan", e) for e in range(3)])
    for e in range(3):
        alone = apply_noise(values[e : e + 1], noise, stream(9, "scan", e))
        assert alone.tobytes() == together[e : e + 1].tobytes()


def test_what_is_measured_does_not_change_the_draws():
    near, far = np.ones((1, 50)), np.full((1, 50), np.inf)
    one, two = stream(5), stream(5)
    apply_noise(near, (Gaussian(0.1), Peak(0.1, 1.0)), one)
    apply_noise(far, (Gaussian(0.1), Peak(0.1, 1.0)), two)
    assert one.random() == two.random()


@pytest.mark.parametrize(
    "noise", [(), (Gaussian(0.01),), (Gaussian(0.01), Peak(0.001, 1.0)), (Offset(-0.25), Gaussian(0.0), Offset(1e-7))]
)
def test_text_goes_both_ways(noise):
    assert Noise.parse(" ".join(map(str, noise))) == noise


def test_text_is_read_as_trial_files_write_it():
    assert Noise.parse("gaussian(0.01) peak(0.001, 1.0)") == (Gaussian(0.01), Peak(0.001, 1.0))
    assert Noise.parse(" Offset( -2 ), gaussian(.5)+peak(1,2)") == (Offset(-2.0), Gaussian(0.5), Peak(1.0, 2.0))
    assert from_attributes(Lidar2D, {"noise": "gaussian(0.02)", "rays": "90"}) == Lidar2D(rays=90, noise=Gaussian(0.02))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("gausian(0.1)", "unknown noise 'gausian'.*did you mean 'gaussian'"),
        ("gaussian", "list of name"),
        ("gaussian(0.1", "list of name"),
        ("gaussian(a)", "must be numbers: gaussian\\(sd\\)"),
        ("peak(0.1)", "has 1 values, it takes peak\\(probability, height, sd\\)"),
        ("gaussian(-1)", "sd = -1.0 must be finite and at least 0"),
        ("gaussian(nan)", "sd = nan"),
        ("peak(1.5, 2)", "probability = 1.5 must be at least 0 and at most 1"),
        ("peak(0.5, inf)", "height = inf must be finite"),
        ("offset(nan)", "value = nan must be finite"),
        ("peak(0.5, 1, -1)", "sd = -1.0 must be finite"),
        ("dropout(2)", "dropout noise: probability = 2.0"),
        ("quantised(0)", "step = 0.0 must be finite and above 0"),
    ],
)
def test_wrong_text_is_explained(text, message):
    with pytest.raises(InputError, match=message):
        Noise.parse(text)


def test_noise_needs_a_generator():
    with pytest.raises(InputError, match="needs a random generator"):
        apply_noise(np.ones((1, 2)), (Gaussian(0.1),), None)
    with pytest.raises(InputError, match="2 generators were given for 3 environments"):
        apply_noise(np.ones((3, 2)), (Gaussian(0.1),), [stream(0), stream(1)])


class Louder(Gaussian):
    """Gaussian noise with its own rule."""

    def apply(self, values, rng):
        return values + 2.0 * self.draw(values.shape, rng)


NOISES = (
    (Gaussian(0.1),),
    (Gaussian(0.0),),
    (Peak(0.3, 1.0),),
    (Peak(0.3, 1.0, 0.2),),
    (Dropout(0.3),),
    (Louder(0.1),),
    (Gaussian(0.1), Offset(-0.2), Peak(0.2, 0.5), Peak(0.2, 0.5, 0.1), Dropout(0.2), Quantised(0.125)),
)


@pytest.mark.parametrize("noise", NOISES, ids=str)
@pytest.mark.parametrize("shape", [(4,), (4, 7), (4, 3, 5), (1, 9), (4, 0), (0, 3)], ids=str)
@pytest.mark.parametrize("shared", ["none", "all", "two"])
def test_a_batch_draws_the_streams_of_its_environments(noise, shape, shared):
    """The bytes and the later draws equal those of :meth:`Noise.apply`, environment by environment."""

    def generators():
        own = [stream(4, "noise", e) for e in range(shape[0])]
        return own if shared == "none" else own[:1] * shape[0] if shared == "all" else own[:2] * (shape[0] // 2 + 1)

    values = stream(5).normal(size=shape)
    values[values > 1.0] = np.inf
    values[values < -1.0] = -0.0
    slow, ours, theirs = values.copy(), generators()[: shape[0]], generators()[: shape[0]]
    for row, rng in enumerate(theirs):
        for part in noise:
            slow[row] = part.apply(slow[row], rng)
    before = values.tobytes()
    fast = apply_noise(values, noise, ours)
    assert fast.tobytes() == slow.tobytes()
    assert values.tobytes() == before
    assert [rng.random() for rng in ours] == [rng.random() for rng in theirs]


def test_normal_draws_equal_scaled_standard_draws():
    for seed, sd in enumerate([0.0, 1e-300, 0.02, 0.1, 1.0, 3.7]):
        scaled = abs(sd) * stream(seed).standard_normal(10_000) + 0.0
        assert stream(seed).normal(0.0, sd, 10_000).tobytes() == scaled.tobytes()


def test_a_number_of_generators_that_does_not_fit_is_rejected():
    with pytest.raises(InputError, match="2 generators were given for 3 environments"):
        apply_noise(np.ones((3, 2)), (Gaussian(0.1),), [stream(0), stream(1)])
