"""Windows of the scenes of a TrajNet++ file: one window per scene, in which the primary person is scored."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError

from .trajectories import PrimaryScene, Trajectories
from .windows import Windows

OBSERVED, PREDICTED = 9, 12
"""Rows of a scene of TrajNet++."""

TRAJNET_CATEGORIES: Mapping[str, tuple[int, ...]] = {
    "static": (1,),
    "linear": (2,),
    "interacting": (3,),
    "leader-follower": (3, 1),
    "collision avoidance": (3, 2),
    "group": (3, 3),
    "other interactions": (3, 4),
    "non-interacting": (4,),
}
"""Categories of TrajNet++ (Kothari et al. 2021, doi 10.1109/TITS.2021.3069362): main tag, then sub-tag."""


def primary_windows(tracks: Trajectories) -> tuple[Windows, Windows, tuple[PrimaryScene, ...]]:
    """Return past, future and scenes of a TrajNet++ file; 9 observed and 12 predicted rows.

    Only the primary person of a scene is scored. Scenes whose primary person lacks a row are left out.

    Raises:
        DataError: the recording has no scenes, or none with 9 + 12 rows of its primary person.
    """
    if not tracks.scenes:
        raise DataError(f"{tracks.name} has no scenes with a primary person, as TrajNet++ files have")
    past, future = tracks.windows(observe=OBSERVED, predict=PREDICTED)
    at = {int(frame): window for window, frame in enumerate(past.frame[:, 0])}
    window, slot, kept = [], [], []
    for scene in tracks.scenes:
        number = at.get(scene.first)
        if number is None or int(future.frame[number, -1]) != scene.last:
            continue
        place = np.flatnonzero((past.id[number] == scene.person) & future.scored[number])
        if len(place):
            window.append(number)
            slot.append(int(place[0]))
            kept.append(scene)
    if not kept:
        raise DataError(f"{tracks.name}: no scene has {OBSERVED} + {PREDICTED} rows of its primary person")
    rows = np.array(window, dtype=np.int64)
    scored = np.zeros((len(rows), past.id.shape[1]), dtype=np.bool_)
    scored[np.arange(len(rows)), slot] = True
    return (
        dataclasses.replace(past[rows], protocol="trajnet++"),
        dataclasses.replace(future[rows], scored=scored, protocol="trajnet++"),
        tuple(kept),
    )


def scenes_of_category(scenes: tuple[PrimaryScene, ...], category: str) -> NDArray[np.int64]:
    """Return the indices of the scenes of a category of :data:`TRAJNET_CATEGORIES`.

    A scene has one main tag and any number of sub-tags: it may be in several categories of interactions.

    >>> scene = PrimaryScene(0, 7, 0, 200, (3, 1, 2))
    >>> [len(scenes_of_category((scene,), name)) for name in ("interacting", "collision avoidance", "linear")]
    [1, 1, 0]
    """
    main, *sub = TRAJNET_CATEGORIES[category]
    found = [k for k, scene in enumerate(scenes) if scene.tag[:1] == (main,) and set(sub) <= set(scene.tag[1:])]
    return np.array(found, dtype=np.int64)
