"""Crowd motion, the first phase of a step: people move, from the scene at its start."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.models import CrowdModel
from crowdbot.world.crowd.contact import ContactModel, ContactSurfaces
from crowdbot.world.crowd.environment_rows import stack_scenes
from crowdbot.world.crowd.limits import CrowdLimits

__all__ = ["contact_surfaces", "move_people", "resolve_overlaps", "show_robots", "step_models"]

Floats = NDArray[np.float64]


def show_robots(scene: Scene, robots: Iterable[int], margin: float) -> Scene:
    """Return the scene for the crowd model: it knows which agents are robots, and their radii are larger by a margin.

    >>> shown = show_robots(Scene.of([[0.0, 0.0], [3.0, 0.0]], radius=0.3), [1], 0.1)
    >>> shown.radius.tolist(), shown.robot.tolist()
    ([[0.3, 0.4]], [[False, True]])
    """
    index, wide, robot = list(robots), scene.radius.copy(), np.zeros(scene.shape, dtype=np.bool_)
    wide[:, index] += margin
    robot[:, index] = True
    return scene.replace(radius=wide, robot=robot if index else None)


def move_people(
    start: Scene,
    step: Callable[[Scene, float], Scene],
    resolve: Callable[[Scene, Scene], Scene],
    limits: CrowdLimits | None,
    dt: float,
    substeps: int,
    radius: Floats,
) -> tuple[Scene, Scene]:
    """Return the scenes before and after the last substep of the crowd.

    Args:
        start: scene at the start of the step, with the radii and goals for the model.
        step: moves people by a time [s].
        resolve: resolves the overlaps between substeps.
        limits: limits of speed and acceleration.
        dt: time step [s].
        substeps: number of substeps.
        radius: ``[E, A]`` radii of all bodies [m], without margins.
    """
    crowd = earlier = start
    h = dt / substeps
    for k in range(substeps):
        if k > 0:
            crowd = resolve(earlier, crowd.replace(radius=radius)).replace(radius=start.radius)
        earlier = crowd
        crowd = step(earlier, h)
        if limits is not None:
            crowd = limits.apply(earlier, crowd, h)
    return earlier, crowd


def step_models(
    scene: Scene, dt: float, models: Sequence[CrowdModel], rngs: Sequence[Generator], together: CrowdModel | None
) -> Scene:
    """Return the scene after a step of the crowd model.

    Args:
        scene: scene of E environments.
        dt: time step [s].
        models, rngs: model and generator of each environment.
        together: a model for all environments at once, None: call the model of each.
    """
    if together is not None:
        return together.step(scene, dt, rngs[0])
    alone = (scene.environments([e]).replace(walls=scene.walls) for e in range(len(models)))
    rows = [model.step(one, dt, rng) for model, one, rng in zip(models, alone, rngs, strict=True)]
    return stack_scenes(rows).replace(walls=scene.walls)


def contact_surfaces(scene: Scene, known: ContactSurfaces | None) -> ContactSurfaces:
    """Return the surfaces of the walls of a scene, the known ones if they still fit."""
    largest = float(scene.radius[scene.active].max(initial=0.0))
    if known is None or known.walls is not scene.walls or known.reach < largest:
        return ContactSurfaces.of(scene.walls, largest)
    return known


def resolve_overlaps(
    earlier: Scene, after: Scene, contact: ContactModel, dt: float, surfaces: ContactSurfaces
) -> Scene:
    """Return the scene with overlaps of people resolved, after a substep of ``dt`` [s]."""
    return contact.resolve_overlaps(earlier, after, dt, surfaces)
