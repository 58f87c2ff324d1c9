"""State frames: bytes that the page reads, round trip, hostile bytes."""

import numpy as np
import pytest
from golden_frame import FRAME, GOLDEN

from crowdbot.core import InputError
from crowdbot.web import StateFrame


def test_the_bytes_are_those_that_the_test_of_the_page_reads():
    assert FRAME.encode() == GOLDEN.read_bytes()


@pytest.mark.parametrize("kind", ["<f4", "<i2", "<u2", "|u1", "<i4", "<u4", "<f8"])
def test_every_type_comes_back(kind):
    array = np.arange(15).astype(kind)
    back = StateFrame.decode(StateFrame("x", 1.5, {"a": array[:3], "b": array.reshape(5, 3)}, 9).encode())
    assert (back.channel, back.time, back.sequence) == ("x", 1.5, 9)
    assert back.arrays["a"].tolist() == array[:3].tolist()
    assert back.arrays["b"].tolist() == array.reshape(5, 3).tolist()


@pytest.mark.parametrize("size", range(0, len(GOLDEN.read_bytes()), 5))
def test_torn_frames_are_refused(size):
    with pytest.raises(InputError, match="state frame"):
        StateFrame.decode(GOLDEN.read_bytes()[:size])


def test_names_and_types_are_checked():
    with pytest.raises(InputError, match="'pedestrians': expected 1 to 8 ASCII letters"):
        StateFrame("pedestrians", 0.0).encode()
    with pytest.raises(InputError, match="array a in a state frame has type complex128"):
        StateFrame("a", 0.0, {"a": np.zeros(2, dtype=complex)}).encode()
