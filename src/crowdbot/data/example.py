"""Small example windows, for checks and examples."""

from __future__ import annotations

import numpy as np

from crowdbot.core import stream

from .windows import Windows

STEP = 0.4


def example_windows(rows: int = 8, seed: int = 0) -> Windows:
    """Return 3 windows of 6 people with typical features of recordings.

    Person 3 appears at the last row, person 4 is missing at some rows, person 5 is a robot, and the last person of the
    second window is padding.

    Args:
        rows: number of observed rows.
        seed: seed of the positions.

    >>> past = example_windows()
    >>> past.position.shape, past.present[:, -1].sum(axis=1).tolist()
    ((3, 8, 6, 2), [6, 5, 6])
    """
    rng = stream(seed, "example windows")
    start, speed = rng.uniform(-4.0, 4.0, (3, 1, 6, 2)), rng.uniform(-1.5, 1.5, (3, 1, 6, 2))
    time = STEP * np.arange(rows)[None, :, None, None]
    position = start + speed * time + rng.normal(0.0, 0.02, (3, rows, 6, 2))
    present = np.ones((3, rows, 6), dtype=bool)
    present[:, :-1, 3] = False
    present[:, 1:-1:2, 4] = False
    present[1, :, 5] = False
    robot = np.zeros((3, 6), dtype=bool)
    robot[:, 5] = present[:, -1, 5]
    identity = np.where(present.any(axis=1), np.arange(6), -1)
    frame = np.broadcast_to(10 * np.arange(rows), (3, rows))
    return Windows(
        position=np.where(present[..., None], position, 0.0),
        present=present,
        scored=present[:, -1] & ~robot,
        robot=robot,
        id=identity.astype(np.int64),
        frame=frame.astype(np.int64),
        dt=STEP,
        protocol="all",
        source="example",
    )
