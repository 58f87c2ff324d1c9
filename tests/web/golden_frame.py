"""A state frame and its bytes, which the test of the page reads, too.

``python tests/web/golden_frame.py`` writes the bytes. Write them again only when the format is
changed on purpose, and say so in the commit.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from crowdbot.web import StateFrame

GOLDEN = Path(__file__).with_name("state_frame.bin")
FRAME = StateFrame(
    "crowd",
    0.25,
    {
        "people": np.array([[1.0, 2.0], [3.0, 4.0]], dtype=np.float32),
        "ids": np.array([5, 6, 65535], dtype=np.uint16),
        "bones": np.zeros((0, 4), dtype=np.int16),
    },
    7,
)

if __name__ == "__main__":
    GOLDEN.write_bytes(FRAME.encode())
