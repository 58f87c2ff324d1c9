"""AgentRows: checked values of all agents, side by side in memory, with which a model begins a step.

A kernel reads the position, velocity and radius of a neighbour from one or two cache lines instead of four or more.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Neighbors, PerAgent, Scene, kernel, per_agent, prange
from crowdbot.core.model_parameter import BOOL
from crowdbot.core.neighbors import Seekers, nearest_of_rows
from crowdbot.typing import Bools, Floats

X, Y, VX, VY, RADIUS, WISH_X, WISH_Y, LIMIT = range(8)
"""Columns of :attr:`AgentRows.agents`: position, velocity, radius, desired velocity, maximum speed."""
COLUMNS = 8
LARGEST = 1e9
"""Upper limit of positions [m], speeds [m/s] and parameters, against overflow."""
PART = 1024
"""Number of rows in one work item of a thread."""
SERIAL = 4 * PART
"""Maximum number of rows for which one thread is faster than several (measured)."""
COUNT = np.dtype(np.int32)


class AgentRows(NamedTuple):
    """Values of all agents by row ``e * A + a``.

    Fields:
        agents: ``[E * A, 8]``, see the columns; the desired velocity of absent agents is 0.
        walking: ``[E * A]`` bool, whether the model moves the agent: active and not external.
        seen: ``[E * A]`` bool, whether others react to the agent: active and visible.
        external: ``[E * A]`` bool, whether the agent is moved by others.
        place: ``[E * A, 2]``, positions [m].
        velocity: ``[E, A, 2]`` [m/s], output array of the model: the velocity of external agents, 0 for all others.
        out: ``[E * A, 2]``, the same array by row.
    """

    agents: Floats
    walking: Bools
    seen: Bools
    external: Bools
    place: Floats
    velocity: Floats
    out: Floats

    def neighbors(self, reach: PerAgent, most: PerAgent) -> Neighbors:
        """Return the neighbours of walking agents: the nearest seen agents, limited in distance and number.

        Environment e has the neighbours ``agent[e % len(agent)]``: copies of the same environments share them.
        """
        shape = self.velocity.shape[0], self.velocity.shape[1]
        count = len(self.place)
        if isinstance(reach, float):
            far = np.empty(count)
            far.fill(reach)
        else:
            far = per_agent(reach, shape, "neighbor_distance").reshape(-1)
        capacity = np.empty(count, dtype=COUNT)
        if isinstance(most, float):
            largest = round(most)
            capacity.fill(largest)
        else:
            capacity[:] = np.rint(per_agent(most, shape, "max_neighbors")).reshape(-1)
            largest = int(capacity.max(initial=0))
        seekers = Seekers(self.place, far, capacity, self.walking)
        return nearest_of_rows(seekers, self.seen, shape, largest, shared=True)


class StepStart(NamedTuple):
    """Checked values with which most models begin a step.

    Fields:
        desired: ``[E, A, 2]`` desired velocity [m/s], 0 for absent agents.
        walking: ``[E, A]`` bool, whether the model moves the agent: active and not external.
        seen: ``[E, A]`` bool, whether others react to the agent: active and visible.
        velocity: ``[E, A, 2]`` [m/s], output array of the model: the velocity of external agents, 0 for all others.
    """

    desired: Floats
    walking: Bools
    seen: Bools
    velocity: Floats


def begin_rows(scene: Scene, dt: float, max_speed: PerAgent | None = None) -> AgentRows:
    """Check the values that models read; return them by row.

    Args:
        scene: the scene.
        dt: time step [s].
        max_speed: maximum speed of the model [m/s]; None: that of the scene.

    Raises:
        InputError: ``dt`` is not positive, or a value of an active agent is not finite or larger than 1e9.

    >>> start = begin_rows(Scene.of([[0.0, 0.0]], goal=[[9.0, 0.0]], preferred_speed=1.0), 0.5)
    >>> float(start.agents[0, WISH_X]), start.walking.tolist()
    (1.0, [True])
    """
    if not (math.isfinite(dt) and dt > 0.0):
        raise InputError(f"time step {dt} s is not allowed, it must be above 0 and finite")
    position, velocity, radius, own_limit, aim, speed, active, visible, external = scene.step_arrays()
    limit = own_limit if max_speed is None else speed_limit(max_speed, scene)
    shape = active.shape
    count = shape[0] * shape[1]
    chosen = np.empty((*shape, 2))
    start = AgentRows(
        np.empty((count, COLUMNS)),
        np.empty(count, BOOL),
        np.empty(count, BOOL),
        external.reshape(-1),
        position.reshape(-1, 2),
        chosen,
        chosen.reshape(-1, 2),
    )
    given = scene.preferred_velocity is not None
    values: tuple[Any, ...] = (
        position, velocity, radius, own_limit, limit, aim, speed, active, visible, external, given, float(dt),
        start.agents, start.walking, start.seen, start.out,
    )  # fmt: skip
    if fill_rows(0, count, *values) if count <= SERIAL else _fill(*values):
        _raise_wrong_value(scene, start.agents[:, WISH_X : WISH_Y + 1].reshape(*shape, 2))
    return start


def begin_step(scene: Scene, dt: float) -> StepStart:
    """Check the values that models read; return them together with the desired velocities.

    Raises:
        InputError: ``dt`` is not positive, or a value of an active agent is not finite or larger than 1e9.
    """
    start, shape = begin_rows(scene, dt), scene.shape
    wish = np.empty((*shape, 2))
    wish.reshape(-1, 2)[:] = start.agents[:, WISH_X : WISH_Y + 1]
    return StepStart(wish, start.walking.reshape(shape), start.seen.reshape(shape), start.velocity)


def speed_limit(max_speed: PerAgent | None, scene: Scene) -> Floats:
    """Return the maximum speeds ``[E, A]`` [m/s] of the model, or of the scene if the model has none."""
    return scene.max_speed if max_speed is None else per_agent(max_speed, scene.shape, "max_speed")


def _raise_wrong_value(scene: Scene, desired: Floats) -> None:
    """Raise :class:`InputError` for the first value of an active agent that is not finite or larger than 1e9."""
    aim = () if scene.preferred_velocity is not None else ("goal", "preferred_speed")
    for name in ("position", "velocity", "radius", "max_speed", *aim):
        _check(name, getattr(scene, name), scene.active)
    _check("preferred velocity", desired, scene.active)


def _check(name: str, value: Floats, active: NDArray[np.bool_]) -> None:
    fits = np.abs(value) <= LARGEST  # False for NaN too
    if value.ndim == 3:
        fits = fits[..., 0] & fits[..., 1]
    wrong = active & ~fits
    if np.any(wrong):
        e, a = np.argwhere(wrong)[0]
        raise InputError(
            f"scene: {name} {value[e, a]} of agent {a} in environment {e} is not finite or larger than {LARGEST:g};"
            " mark absent agents active=False"
        )


@kernel
def _wanted_velocity(x: float, y: float, speed: float, dt: float) -> tuple[float, float]:
    """Return the desired velocity [m/s] towards a goal at x, y [m]; it does not pass the goal within ``dt`` [s]."""
    distance = math.sqrt(x * x + y * y)
    share = min(speed, distance / dt) / max(distance, 1e-12)
    return x * share, y * share


@kernel(parallel=True)
def _fill(
    position: Floats, velocity: Floats, radius: Floats, max_speed: Floats, limit: Floats, aim: Floats,
    preferred_speed: Floats, active: Bools, visible: Bools, external: Bools, given: bool, dt: float, agents: Floats,
    walking: Bools, seen: Bools, chosen: Floats,
) -> int:  # fmt: skip
    wrong = 0
    for part in prange((len(agents) + PART - 1) // PART):
        wrong += fill_rows(
            part * PART, min((part + 1) * PART, len(agents)), position, velocity, radius, max_speed, limit, aim,
            preferred_speed, active, visible, external, given, dt, agents, walking, seen, chosen,
        )  # fmt: skip
    return wrong


@kernel
def fill_rows(
    begin: int, end: int, position: Floats, velocity: Floats, radius: Floats, max_speed: Floats, limit: Floats,
    aim: Floats, preferred_speed: Floats, active: Bools, visible: Bools, external: Bools, given: bool, dt: float,
    agents: Floats, walking: Bools, seen: Bools, chosen: Floats,
) -> int:  # fmt: skip
    """Fill the rows of :class:`AgentRows`; return whether a value of an active agent is not allowed.

    Args:
        aim: desired velocities if they are ``given``, otherwise goals.
    """
    count = active.size
    place, move, target = position.reshape(count, 2), velocity.reshape(count, 2), aim.reshape(count, 2)
    size, fastest, most = radius.reshape(count), max_speed.reshape(count), limit.reshape(count)
    speed = preferred_speed.reshape(count)
    is_here, is_visible, is_external = active.reshape(count), visible.reshape(count), external.reshape(count)
    fits = True
    for row in range(begin, end):
        here, outside = is_here[row], is_external[row]
        x, y, vx, vy = place[row, 0], place[row, 1], move[row, 0], move[row, 1]
        wx, wy = target[row, 0], target[row, 1]
        right = abs(x) <= LARGEST and abs(y) <= LARGEST and abs(vx) <= LARGEST and abs(vy) <= LARGEST  # False for NaN
        right &= abs(size[row]) <= LARGEST and abs(fastest[row]) <= LARGEST
        if not given:
            right &= abs(wx) <= LARGEST and abs(wy) <= LARGEST and abs(speed[row]) <= LARGEST
            wx, wy = _wanted_velocity(wx - x, wy - y, speed[row], dt)
        right &= abs(wx) <= LARGEST and abs(wy) <= LARGEST
        fits &= right or not here
        walking[row], seen[row] = here and not outside, here and is_visible[row]
        agents[row, X], agents[row, Y], agents[row, VX], agents[row, VY] = x, y, vx, vy
        agents[row, RADIUS], agents[row, LIMIT] = size[row], most[row]
        agents[row, WISH_X], agents[row, WISH_Y] = (wx, wy) if here else (0.0, 0.0)
        chosen[row, 0], chosen[row, 1] = (vx, vy) if here and outside else (0.0, 0.0)
    return 0 if fits else 1
