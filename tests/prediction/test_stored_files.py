"""Weights and trainings that the first version wrote still load, predict the same and resume."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from crowdbot.data import Windows
from crowdbot.prediction import AnchorNet, Samples, SocialWays, TrainingSchedule, make_learner, train

FILES = Path(__file__).parent / "data" / "first-version"
SETTINGS = {
    "anchor-net": {"width": "8", "social": "4", "people": "16"},
    "social-ways": {"hidden": "4", "pooled": "4", "noise": "2"},
}


def samples() -> Samples:
    """Return 20 synthetic scenes of two people, those that the stored trainings were trained on."""
    rng = np.random.default_rng(7)
    people, rows = 40, 20
    angle = rng.uniform(-3.0, 3.0, (people, 1)) + np.cumsum(rng.normal(0.0, 0.1, (people, rows)), axis=1)
    step = 0.4 * rng.uniform(0.5, 1.5, (people, 1, 1)) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    position = rng.uniform(-6.0, 6.0, (people, 1, 2)) + np.cumsum(step, axis=1)
    here = np.ones((people, rows), dtype=bool)
    first, source = np.arange(0, people + 1, 2), np.zeros(people // 2, dtype=np.int64)
    return Samples(position, here, here[:, 0], first, source, ("made",), 8, 0.4)


def windows() -> Windows:
    position = samples().position.reshape(20, 2, 20, 2).swapaxes(1, 2)[:, :8]
    here, nobody = np.ones((20, 8, 2), dtype=bool), np.zeros((20, 2), dtype=bool)
    id, frame = np.tile(np.arange(2), (20, 1)), np.tile(np.arange(8), (20, 1))
    return Windows(position, here, nobody, nobody, id, frame, 0.4, "all", "made")


def ordered(futures: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the futures ``[K, T, 2]`` of a person in the order of their coordinates."""
    rows = futures.reshape(len(futures), -1)
    return rows[np.lexsort(rows.round(7).T)]


def test_stored_weights_predict_the_same() -> None:
    with np.load(FILES / "forecasts.npz") as stored:
        ours = AnchorNet(file=str(FILES / "anchor-net" / "best.npz")).predict(windows(), 12, 20)
        for w, a in np.ndindex(3, 2):  # how the futures of people combine is no part of the weights
            mine, earlier = ours.position[w, :, :, a], stored["anchor_net"][w, :, :, a]
            np.testing.assert_allclose(ordered(mine), ordered(earlier), atol=1e-9)
        ours = SocialWays(str(FILES / "social-ways" / "best.npz")).predict(windows(), 12, 2)
        np.testing.assert_allclose(ours.position[:3], stored["social_ways"], atol=1e-4)


@pytest.mark.parametrize("name", sorted(SETTINGS))
def test_a_stored_training_resumes(name: str, tmp_path: Path) -> None:
    shutil.copytree(FILES / name, tmp_path / name)
    model = make_learner(name, "report" if name == "social-ways" else None, SETTINGS[name], samples(), samples())
    schedule = TrainingSchedule(updates=4, check_every=2, keep_every=2, watch=("ade", "fde"))
    done = train(model, schedule, tmp_path / name, resume=True)
    assert done.updates == 4
    assert [row["update"] for row in done.rows] == [2, 4]
