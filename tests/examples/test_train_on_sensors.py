"""The training example: its samples, its scores, its file, and a short training that beats chance."""

import runpy
import sys

import numpy as np
import pytest
import torch
from page_commands import ROOT, page_commands

sys.path.insert(0, str(ROOT / "examples" / "train_on_sensors"))
from contact_samples import LAGS, NEAR, POOL, REACH, SampleStream, shorten, wander
from train_contact import ContactNetwork, area, load, operating_curve, probabilities, save


def test_inputs_are_the_shortest_of_neighbouring_beams():
    ranges = np.full((1, 1080), np.inf)
    ranges[0, 7] = 0.5 * REACH
    ranges[0, 8] = -np.inf  # below the smallest range
    found = shorten(ranges)
    assert found.shape == (1, 1080 // POOL)
    assert found[0, :3].tolist() == [1.0, 0.0, 1.0]


@pytest.mark.parametrize(("side", "sign"), [(1.0, -1.0), (-1.0, 1.0)])
def test_the_robot_turns_away_from_an_obstacle(side, sign):
    angles = np.linspace(-np.pi, np.pi, 361)
    ranges = np.where((angles * side > 0.0) & (angles * side < 0.5), 0.6, np.inf)
    assert np.sign(wander(ranges, angles).turn) == sign
    assert wander(np.full(361, np.inf), angles).turn == 0.0


def test_labels_are_the_future_of_the_simulation():
    stream, gaps, samples = SampleStream([0, 1]), [], []
    keep = stream.gap_to_people

    def note():
        result = keep()
        gaps.append(result)
        return result

    stream.gap_to_people = note
    for _ in range(LAGS[-1] + 1 + 24):
        found = stream.advance()
        if found is not None:
            samples.append(found)
    assert len(samples) == 5
    steps = np.array(gaps)  # two for each scan
    for k, (inputs, labels, nearest) in enumerate(samples):
        begin = 2 * (LAGS[-1] + 1 + k)
        np.testing.assert_array_equal(labels, steps[begin : begin + 40].min(axis=0) < NEAR)
        assert inputs.shape == (2, len(LAGS), 1080 // POOL)
        np.testing.assert_allclose(REACH * inputs[:, 0].min(axis=1), np.minimum(nearest, REACH), rtol=1e-6)
    np.testing.assert_array_equal(samples[3][0][:, 1], samples[0][0][:, 0])  # the scan 0.3 s ago


def test_the_area_under_the_curve():
    labels = np.array([False, True, False, True])
    assert area(np.array([0.1, 0.9, 0.2, 0.8]), labels) == 1.0
    assert area(np.array([0.9, 0.1, 0.8, 0.2]), labels) == 0.0
    assert area(np.array([0.9, 0.8, 0.7, 0.6]), labels) == 0.25
    wrong, right = operating_curve(np.array([0.9, 0.8, 0.7, 0.6]), labels)
    assert wrong.tolist() == [0.0, 0.5, 0.5, 1.0, 1.0]
    assert right.tolist() == [0.0, 0.0, 0.5, 0.5, 1.0]


def test_a_network_is_the_same_after_its_file(tmp_path):
    torch.manual_seed(1)
    network, inputs = ContactNetwork(), np.random.default_rng(0).random((3, len(LAGS), 1080 // POOL), dtype=np.float32)
    save(network, tmp_path / "contact.npz")
    np.testing.assert_array_equal(probabilities(load(tmp_path / "contact.npz"), inputs), probabilities(network, inputs))
    with np.load(tmp_path / "contact.npz", allow_pickle=False) as arrays:
        assert {array.dtype for array in arrays.values()} == {np.dtype(np.float32)}


def test_a_short_training_beats_chance_on_new_seeds(tmp_path, monkeypatch, capsys):
    file = tmp_path / "contact.npz"
    ((program, *words),) = page_commands("train-on-sensors", "python")
    words += ["--seconds", 20, "--environments", 8, "--test-seconds", 8]  # the last count
    words += ["--out", file, "--plot", tmp_path / "plot.png"]
    monkeypatch.setattr(sys, "argv", [program, *map(str, words)])
    runpy.run_path(str(ROOT / program), run_name="__main__")
    printed = capsys.readouterr().out.splitlines()
    assert printed[-3].startswith("trained on ")
    assert float(printed[-1].split()[5].rstrip(",")) > 0.6, printed
    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")
    assert file.stat().st_size > 1000
