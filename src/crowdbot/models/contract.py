"""Contract checks for custom crowd models and goals."""

from __future__ import annotations

import dataclasses

import numpy as np

from crowdbot.core import InputError, Paper, Scene, stream
from crowdbot.data import Windows, example_windows
from crowdbot.typing import Floats

from .goals import Goal
from .model import CrowdModel

DT = 0.1


def check_model(model: CrowdModel) -> None:
    """Check that a crowd model fulfils its contract, on small scenes.

    Raises:
        InputError: the first violated rule.

    >>> from crowdbot.models import ORCA
    >>> check_model(ORCA())
    """
    name = type(model).__name__
    if not isinstance(model, CrowdModel):
        raise InputError(f"{name} is not a CrowdModel")
    _check_frozen(model)
    if not isinstance(getattr(model, "paper", None), Paper):
        raise InputError(f"{name}.paper is missing; it must be a crowdbot.Paper")
    scene = _example_scene()
    velocity = _check_velocity(model, scene)
    if not np.array_equal(_check_velocity(model, scene), velocity):
        raise InputError(f"{name}.velocity is not deterministic: the same scene and generator give new velocities")
    draws = _draws(model, scene)
    if draws and model.is_batched:
        raise InputError(
            f"{name} declares batched = True, but draws random numbers; environments that are computed together share"
            " the generator, so leave batched out"
        )
    moved = scene.external & scene.active
    if not np.array_equal(velocity[moved], scene.velocity[moved]):
        raise InputError(f"{name}.velocity changes external agents; they must keep their velocity")
    if np.any(velocity[~scene.active] != 0.0):
        raise InputError(f"{name}.velocity moves absent agents (active=False); their velocity must be 0")
    before = _example_scene()
    if not np.array_equal(scene.position, before.position) or not np.array_equal(scene.velocity, before.velocity):
        raise InputError(f"{name}.velocity changes the scene; it must only read it")
    whole = model.velocity(scene, DT, stream(1, "contract"))
    for e in range(0 if draws else scene.shape[0]):  # who draws is called for each environment
        if not np.array_equal(model.velocity(scene.environments([e]), DT, stream(1, "contract"))[0], whole[e]):
            raise InputError(f"{name}.velocity of environment {e} differs when it is computed alone")
    single = Scene.of([[0.0, 0.0]], goal=[[9.0, 0.0]])
    rng = stream(1, "contract")
    for _ in range(20):
        single = model.step(single, DT, rng)
    if not np.all(np.isfinite(single.position)):
        raise InputError(f"{name}: the position of a single person is not finite after 20 steps")


def check_goal(goal: Goal) -> None:
    """Check that a goal fulfils its contract, on small windows.

    Raises:
        InputError: the first violated rule.

    >>> from crowdbot.models import CurrentDirection
    >>> check_goal(CurrentDirection())
    """
    name = type(goal).__name__
    if not isinstance(goal, Goal):
        raise InputError(f"{name} is not a Goal")
    _check_frozen(goal)
    for rows in (1, 8):
        past = example_windows(rows)
        place = _check_resolve(goal, past)
        if not np.array_equal(place, goal.resolve(dataclasses.replace(past, scored=~past.scored))):
            raise InputError(f"{name}.resolve uses past.scored; it must not")
        for window in range(len(past)):
            if not np.array_equal(goal.resolve(past[window : window + 1])[0], place[window]):
                raise InputError(f"{name}.resolve of window {window} differs when it is computed alone")
        weight = goal.choices(past).weight
        if np.any(weight < 0.0) or not np.allclose(weight.sum(axis=-1), past.present[:, -1]):
            raise InputError(f"{name}.choices: the weights of a person who is present must sum to 1, of others to 0")


def _check_frozen(value: object) -> None:
    parameters = getattr(value, "__dataclass_params__", None)
    if parameters is None or not parameters.frozen:
        raise InputError(f"{type(value).__name__} is not frozen; decorate the class with @dataclass(frozen=True)")


def _check_resolve(goal: Goal, past: Windows) -> Floats:
    name, before, here = type(goal).__name__, past.position.copy(), past.present[:, -1]
    place, wanted = np.asarray(goal.resolve(past)), [*here.shape, 2]
    if list(place.shape) != wanted:
        raise InputError(f"{name}.resolve returned shape {list(place.shape)}, it must be [W, A, 2] = {wanted}")
    if not np.all(np.isfinite(place)) or np.any(place[~here] != 0.0):
        raise InputError(f"{name}.resolve must be finite, and 0 for people who are absent at the last row")
    if not np.array_equal(past.position, before):
        raise InputError(f"{name}.resolve changes past.position; it must only read it")
    return place


def _check_velocity(model: CrowdModel, scene: Scene) -> Floats:
    velocity = np.asarray(model.velocity(scene, DT, stream(1, "contract")))
    name, wanted = type(model).__name__, [*scene.shape, 2]
    if list(velocity.shape) != wanted:
        raise InputError(f"{name}.velocity returned shape {list(velocity.shape)}, it must be [E, A, 2] = {wanted}")
    if not np.all(np.isfinite(velocity)):
        raise InputError(f"{name}.velocity returned values that are not finite")
    return velocity


def _draws(model: CrowdModel, scene: Scene) -> bool:
    """Return whether a model draws random numbers."""
    rng, untouched = stream(1, "contract"), stream(1, "contract")
    model.velocity(scene, DT, rng)
    return bool(rng.bit_generator.state != untouched.bit_generator.state)


def _example_scene() -> Scene:
    """Return 2 environments with 12 agents, including walls, an external agent and an absent agent."""
    rng = stream(0, "contract")
    grid = np.stack(np.meshgrid(np.arange(4.0), np.arange(3.0)), axis=-1).reshape(1, 12, 2)
    position = np.concatenate([grid, grid]) + rng.uniform(-0.2, 0.2, (2, 12, 2))
    active, external = np.ones((2, 12), dtype=bool), np.zeros((2, 12), dtype=bool)
    active[:, 11] = False
    external[:, 0] = True
    return Scene.of(
        position,
        rng.uniform(-1.0, 1.0, (2, 12, 2)),
        goal=position + rng.uniform(-6.0, 6.0, (2, 12, 2)),
        active=active,
        external=external,
        walls=[[(-2.0, -1.0), (6.0, -1.0)]],
    )
