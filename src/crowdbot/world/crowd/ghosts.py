"""Ghosts: robots that drive, but are absent to everybody else."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from crowdbot.core import Scene


def hide_ghosts(scene: Scene, ghosts: Sequence[int]) -> Scene:
    """Return the scene as everybody perceives it: ghosts, given by agent index, are absent.

    >>> hide_ghosts(Scene.of([[0.0, 0.0], [1.0, 0.0]]), [1]).active.tolist()
    [[True, False]]
    """
    return _with_presence(scene, ghosts, False) if ghosts else scene


def show_ghosts(scene: Scene, ghosts: Sequence[int], before: Scene) -> Scene:
    """Return the scene in which those ghosts are present that were present before."""
    return _with_presence(scene, ghosts, before.active[:, list(ghosts)]) if ghosts else scene


def _with_presence(scene: Scene, ghosts: Sequence[int], present: Any) -> Scene:
    active = scene.active.copy()
    active[:, list(ghosts)] = present
    return scene.replace(active=active)
