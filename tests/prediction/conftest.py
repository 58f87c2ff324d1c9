"""Windows that the tests of the prediction room share."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import stream
from crowdbot.data import Trajectories, Windows, load

Maker = Callable[..., Windows]

sys.path.insert(0, str(Path(__file__).parents[2] / "studies"))  # simulated training data: training_crowds.py


@pytest.fixture(scope="session")
def windows() -> Maker:
    """Make windows from positions ``[W, T, A, 2]``; NaN where nobody is."""

    def made(position: object, robot: object = False, dt: float = 0.4, **more: object) -> Windows:
        place = np.array(position, dtype=float)
        W, T, A, _ = place.shape
        present = ~np.isnan(place[..., 0])
        return Windows(
            position=np.where(present[..., None], place, 0.0),
            present=present,
            scored=np.zeros((W, A), dtype=bool),
            robot=np.broadcast_to(robot, (W, A)).copy(),
            id=np.tile(np.arange(A), (W, 1)),
            frame=np.tile(np.arange(T), (W, 1)),
            dt=dt,
            protocol="all",
            source="made",
            **more,  # type: ignore[arg-type]
        )

    return made


@pytest.fixture(scope="session")
def crowd(windows: Maker) -> Maker:
    """Make W windows of A wandering people; ``holes`` leaves rows out, windows are padded, one agent is a robot."""

    def made(seed: int = 0, W: int = 4, T: int = 8, A: int = 7, holes: float = 0.0) -> Windows:
        rng = stream(seed, "crowd")
        speed = rng.normal(0.0, 1.0, (W, 1, A, 2)) + rng.normal(0.0, 0.2, (W, T, A, 2))
        place = rng.uniform(-4.0, 4.0, (W, 1, A, 2)) + np.cumsum(0.4 * speed, axis=1)
        place[rng.random((W, T, A)) < holes] = np.nan
        for window in range(W):
            place[window, :, A - window % 3 :] = np.nan
        return windows(place, robot=np.arange(A) == 1)

    return made


@pytest.fixture(scope="session")
def recorded(recordings: Path) -> Callable[[str], Trajectories]:
    """Read a whole scene of the leave-one-out files by its name; each once."""
    known: dict[str, Trajectories] = {}

    def read(name: str) -> Trajectories:
        if name not in known:
            known[name] = load(recordings / "eth_ucy_splits" / "all_data" / f"{name}.txt", fps=25)
        return known[name]

    return read
