"""Weights with arrays of wrong shapes, types and values are rejected before a compiled kernel reads them."""

from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import CrowdbotError, DataError, InputError
from crowdbot.data import Trajectories
from crowdbot.prediction import AnchorNet, load_checkpoint, save_checkpoint
from crowdbot.prediction.anchor_net.own_weights import NEEDED, wrong_array
from crowdbot.prediction.pretrained_weights import load_pretrained

CHECKPOINT = Path(__file__).parent / "data" / "first-version" / "anchor-net" / "best.npz"


@pytest.fixture(scope="module")
def past():
    frame, ids = (item.ravel() for item in np.meshgrid(np.arange(20), np.arange(3), indexing="ij"))
    return Trajectories(ids, frame, 0.4 * frame + ids, 1.0 * ids, 2.5).windows()[0]


def predict(path, past):
    return AnchorNet(file=str(path)).predict(past, 12, 20)


def test_shipped_weights_have_the_right_shapes():
    assert wrong_array(load_pretrained("anchor-net", "all")) == ""


@pytest.mark.parametrize("name", NEEDED)
def test_an_array_of_another_shape_is_named(tmp_path, past, name):
    numbers = dict(load_pretrained("anchor-net", "all"))
    for shape in (numbers[name][..., None], numbers[name][:1], numbers[name][..., :0]):
        path = tmp_path / f"weights-{shape.size}-{shape.ndim}.npz"
        np.savez(path, **{**numbers, name: shape})
        with pytest.raises(DataError, match="is not a file of AnchorNet weights: .* has shape"):
            predict(path, past)


@pytest.mark.parametrize("weights", [None, 3, {"spread": "x"}, {"spread": np.full(6, np.nan)}, {}])
def test_a_checkpoint_without_usable_weights_is_named(tmp_path, past, weights):
    content = {**load_checkpoint(CHECKPOINT, "anchor-net"), "weights": weights}
    path = tmp_path / "weights.npz"
    save_checkpoint(path, "anchor-net", content)
    with pytest.raises(CrowdbotError, match="weights.npz"):
        predict(path, past)


def test_an_unknown_compression_is_one_sentence(tmp_path):
    data = bytearray(CHECKPOINT.read_bytes())
    data[data.rindex(b"PK\x01\x02") + 10] = 99  # in the directory of the last array
    (tmp_path / "weights.npz").write_bytes(data)
    with pytest.raises(
        InputError, match=r"weights.npz is no checkpoint of crowdbot or is damaged \(NotImplementedError"
    ):
        load_checkpoint(tmp_path / "weights.npz")
