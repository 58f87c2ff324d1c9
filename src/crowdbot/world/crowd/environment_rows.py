"""Rows of environments: scenes, models and commands of several worlds as the environments of one."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene, Twist, tree
from crowdbot.models import CrowdModel, Mixture
from crowdbot.world.robots.drives.drive import Twists
from crowdbot.world.robots.drives.servo import Pending

FILLS = {"radius": 0.25, "group": -1, "external": True, "visible": True}
"""Values of the slots that pad a scene. They are external, so that nobody enters in them."""


Delayed = dict[int, tuple[tuple[Pending, ...], Twist | Twists]]
"""Pending commands and command in force of robots, by agent."""


def stack_scenes(scenes: Sequence[Scene]) -> Scene:
    """Join scenes with the walls and bodies of the first; those with fewer agents are padded.

    >>> stack_scenes([Scene.of([[0.0, 0.0]]), Scene.of([[1.0, 0.0], [2.0, 0.0]])]).active.tolist()
    [[True, False], [True, True]]
    """
    return scenes[0] if len(scenes) == 1 else with_common_time(tree.join(align_scenes(scenes)), scenes[0])


def align_scenes(scenes: Sequence[Scene]) -> list[Scene]:
    """Scenes without bodies, with equally many agents and the same memories.

    A memory that a scene lacks, such as that of pushes before the first one, is zero.
    """
    agents = max(scene.shape[1] for scene in scenes)
    kinds = {name: (value.shape[2:], value.dtype) for scene in scenes for name, value in scene.memory.items()}
    rows = []
    for scene in scenes:
        memory = {
            name: scene.memory.get(name, np.zeros((*scene.shape, *tail), of)) for name, (tail, of) in kinds.items()
        }
        rows.append(resize_scene(scene.replace(bodies=None, memory=memory), agents))
    return rows


def align_twists(twists: Sequence[Twists]) -> list[Twists]:
    """Twists of a robot in several worlds, of one class: a car has a steering angle after its first step, 0 before."""
    kind = max(map(type, twists), key=lambda one: len(dataclasses.fields(one)))
    names = [field.name for field in dataclasses.fields(kind) if field.init]
    return [
        twist if type(twist) is kind else kind(*(getattr(twist, name, np.zeros_like(twist.forward)) for name in names))
        for twist in twists
    ]


def align_delays(all_delayed: Sequence[Delayed], counts: Sequence[int]) -> list[Delayed]:
    """Delayed commands of worlds, equally many; robots without pending commands stand still until their first one.

    Args:
        all_delayed: delayed commands of each world.
        counts: number of environments of each world.
    """
    rows: list[Delayed] = [{} for _ in counts]
    for robot in {robot for delayed in all_delayed for robot in delayed}:
        delays = [delayed.get(robot, ((), Twist())) for delayed in all_delayed]
        longest = max((pending for pending, _ in delays), key=len)
        for row, count, (pending, now) in zip(rows, counts, delays, strict=True):
            commands = [Twist()] * (len(longest) - len(pending)) + [item.command for item in pending]
            both = zip(longest, commands, strict=True)
            row[robot] = (
                tuple(Pending(item.wait, Twists.of(command, count)) for item, command in both),
                Twists.of(now, count),
            )
    return rows


def with_common_time(scene: Scene, first: Scene) -> Scene:
    """Scene with the bodies of the first one, and with one number as its time if all environments agree."""
    time = scene.time
    if isinstance(time, np.ndarray) and np.all(time == time[0]):
        time = float(time[0])
    return scene.replace(time=time, bodies=first.bodies if scene.bodies is None else scene.bodies)


def resize_scene(scene: Scene, agents: int) -> Scene:
    """Remove the last agents of a scene, or add absent, external ones, so that it has this number of agents."""
    plain = tree.resize(scene.replace(memory={}, bodies=None), agents, FILLS)
    return plain.replace(memory=tree.resize(scene.memory, agents, {}), bodies=scene.bodies)


def pad_ids(ids: NDArray[np.int64], agents: int) -> NDArray[np.int64]:
    """Return identities with unique negative ones for further slots."""
    more = agents - ids.shape[1]
    if more <= 0:
        return ids
    least = np.minimum(ids.min(axis=1, initial=0), 0)[:, None]
    return np.concatenate([ids, least - 1 - np.arange(more)], axis=1)


def join_models(models: Sequence[CrowdModel], agents: int) -> CrowdModel | None:
    """Return one model for several environments, with a row for each in parameters that differ.

    None if the models are of different classes or differ in more than numbers.

    >>> from crowdbot.models import ORCA
    >>> join_models([ORCA(time_horizon=1.0), ORCA(time_horizon=3.0)], 2).time_horizon.tolist()
    [[1.0, 1.0], [3.0, 3.0]]
    """
    first: Any = models[0]
    if all(model is first for model in models):
        return _widen_model(models[0], agents)
    if not all(_is_alike(first, model) for model in models[1:]):
        return None
    changes: dict[str, Any] = {}
    for part in dataclasses.fields(first):
        values = [getattr(model, part.name) for model in models]
        if part.name == "models" and isinstance(first, Mixture):
            changes["models"] = tuple(join_models(ones, agents) for ones in zip(*values, strict=True))
        elif not all(_is_same(values[0], v) for v in values):
            changes[part.name] = np.stack([_pad_row(np.asarray(v), agents) for v in values])
        elif isinstance(values[0], np.ndarray) and values[0].ndim:
            changes[part.name] = np.broadcast_to(_pad_row(values[0], agents), (len(models), agents)).copy()
    crowd_model: CrowdModel = dataclasses.replace(first, **changes) if changes else first
    return crowd_model


def _widen_model(model: CrowdModel, agents: int) -> CrowdModel:
    """Return a model whose parameters by agent reach for this number of agents."""
    changes: dict[str, Any] = {}
    for part in dataclasses.fields(model):
        value = getattr(model, part.name)
        if part.name == "models" and isinstance(model, Mixture):
            wide = tuple(_widen_model(item, agents) for item in value)
            if any(item is not other for item, other in zip(wide, value, strict=True)):
                changes["models"] = wide
        elif isinstance(value, np.ndarray) and value.ndim and 1 < value.shape[-1] < agents:
            more = np.repeat(value[..., -1:], agents - value.shape[-1], axis=-1)
            changes[part.name] = np.concatenate([value, more], axis=-1)
    return dataclasses.replace(model, **changes) if changes else model


def _is_alike(first: CrowdModel, other: CrowdModel) -> bool:
    """Return whether two models are of the same class and differ only in numbers."""
    if type(first) is not type(other):
        return False
    if isinstance(first, Mixture) and isinstance(other, Mixture):
        return len(first.models) == len(other.models) and all(map(_is_alike, first.models, other.models))
    values = [(getattr(first, part.name), getattr(other, part.name)) for part in dataclasses.fields(first)]
    return all((_is_number(a) and _is_number(b)) or _is_same(a, b) for a, b in values)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.ndarray) and not isinstance(value, bool)


def _is_same(a: Any, b: Any) -> bool:
    return type(a) is type(b) and (np.array_equal(a, b) if isinstance(a, np.ndarray) else bool(a == b))


def _pad_row(value: NDArray[Any], agents: int) -> NDArray[Any]:
    """Return a number or ``[A]`` or ``[1, A]`` as ``[agents]``; further agents get the last value, or 1."""
    row = np.atleast_1d(value).reshape(-1)
    return np.concatenate([row, np.full(agents - len(row), row[-1] if len(row) else 1, dtype=row.dtype)])
