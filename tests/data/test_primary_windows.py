"""Windows of TrajNet++ scenes."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from synthetic_recordings import trajnetpp

from crowdbot.core import DataError
from crowdbot.data import TRAJNET_CATEGORIES, PrimaryScene, Trajectories, load, primary_windows, scenes_of_category


def row_of_people(scenes: tuple[PrimaryScene, ...]) -> Trajectories:
    """Three people, 24 rows of 10 frames; the third one has 12 rows."""
    frames = 10 * np.arange(24)
    id = np.concatenate([np.full(24, 1), np.full(24, 2), np.full(12, 3)])
    frame = np.concatenate([frames, frames, frames[:12]])
    x = 0.05 * frame
    return Trajectories(id, frame, x, id.astype(float), row_rate=2.5, frame_step=10, name="made", scenes=scenes)


def test_only_the_primary_person_of_a_scene_is_scored() -> None:
    scenes = (PrimaryScene(5, 2, 10, 210, (3, 2)), PrimaryScene(6, 1, 10, 210, (2,)), PrimaryScene(7, 3, 0, 200, (1,)))
    past, future, kept = primary_windows(row_of_people(scenes))
    assert [scene.id for scene in kept] == [5, 6]
    assert past.position.shape[:2] == (2, 9)
    assert future.position.shape[1] == 12
    assert [future.id[w, future.scored[w]].tolist() for w in range(2)] == [[2], [1]]
    assert not past.scored.any()
    assert future.protocol == "trajnet++"
    assert (past.frame[:, 0].tolist(), future.frame[:, -1].tolist()) == ([10, 10], [210, 210])


def test_categories() -> None:
    scenes = tuple(PrimaryScene(k, 1, 0, 200, tag) for k, tag in enumerate([(1,), (2,), (3, 1, 3), (3, 4), (4,), ()]))
    found = {name: scenes_of_category(scenes, name).tolist() for name in TRAJNET_CATEGORIES}
    assert found == {
        "static": [0], "linear": [1], "interacting": [2, 3], "leader-follower": [2], "collision avoidance": [],
        "group": [2], "other interactions": [3], "non-interacting": [4],
    }  # fmt: skip


def test_scenes_of_a_file(tmp_path: Path) -> None:
    trajnetpp(tmp_path / "a.ndjson")
    past, future, kept = primary_windows(load(tmp_path / "a.ndjson"))
    assert len(past) == len(future) == len(kept) > 0
    assert future.scored.sum(axis=1).tolist() == [1] * len(kept)


def test_recordings_without_scenes_are_refused() -> None:
    with pytest.raises(DataError, match="made has no scenes with a primary person"):
        primary_windows(row_of_people(()))
    late = row_of_people((PrimaryScene(1, 1, 60, 260),))
    with pytest.raises(DataError, match="no scene has 9 \\+ 12 rows of its primary person"):
        primary_windows(dataclasses.replace(late))
