"""Scene: state of all agents and walls at one instant, as arrays, for models, sensors and recorders."""

from __future__ import annotations

import hashlib
import math
import operator
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.typing import Bools, Floats

from .bodies import Bodies
from .errors import InputError
from .kernels import kernel
from .model_parameter import BOOL, FLOAT, dense
from .tree import Storage, storable, take
from .walls import Walls

PERSON_HEIGHT = 1.7
"""Default height [m] of an agent."""
WALL_HEIGHT = 3.0
"""Default height [m] of walls."""
INTEGER = np.dtype(np.int64)
PAIRS = ("position", "velocity", "goal", "preferred_velocity")
NUMBERS = ("heading", "radius", "preferred_speed", "max_speed")
MASKS = ("active", "visible", "external")
DENSE = {**dict.fromkeys((*PAIRS, *NUMBERS), FLOAT), **dict.fromkeys(MASKS, BOOL)}
"""Data type of the fields that kernels read."""
IS_DENSE = "_is_dense"
"""Entry of a scene whose arrays kernels accept as they are."""
CHECKED_NAMES = ("position", "velocity", "heading", "radius", "goal", "preferred_speed", "max_speed")
CHECKED = operator.itemgetter(*CHECKED_NAMES, "active")
ADVANCED = operator.itemgetter("position", "velocity", "heading", "active", "external")
STEP, STEP_TO_GOAL = (
    operator.itemgetter(
        "position", "velocity", "radius", "max_speed", aim, "preferred_speed", "active", "visible", "external"
    )
    for aim in ("preferred_velocity", "goal")
)
TURNING_SPEED = 0.05
"""Speed [m/s] below which an agent keeps its heading."""


@storable
@dataclass(frozen=True)
class Scene:
    """Agents and walls at one instant in E environments that share the walls.

    Fields (arrays over environments E and agents A):
        position: ``[E, A, 2]`` [m].
        velocity: ``[E, A, 2]`` [m/s].
        heading: ``[E, A]`` [rad], counter-clockwise from +x.
        radius: ``[E, A]`` [m].
        goal: ``[E, A, 2]`` [m].
        preferred_speed: ``[E, A]`` [m/s], free walking speed.
        max_speed: ``[E, A]`` [m/s].
        active: ``[E, A]`` bool, False for an absent agent.
        visible: ``[E, A]`` bool, whether other agents react to this one.
        external: ``[E, A]`` bool, True for agents that models consider but do not move (robots, replayed people).
        robot: ``[E, A]`` bool, which agents are robots; None if nobody is. Worlds set it for the crowd model.
        group: ``[E, A]`` int, number of the group; -1 for none.
        walls: shared by all environments.
        preferred_velocity: ``[E, A, 2]`` [m/s]; None derives it from goal and preferred speed.
        time: [s], a number for all environments or ``[E]`` if they are at different times.
        memory: state of a model between steps, by name, each ``[E, A, ...]``.
        bodies: limbs, props and skins at this instant, or None. An agent without limbs is an upright cylinder.
        height: ``[E, A]`` [m], height of these cylinders; None for 1.7 m.
        wall_height: height of all walls [m]; rays can pass above.

    >>> scene = Scene.of([[0.0, 0.0], [4.0, 0.0]], [[1.0, 0.0], [-1.0, 0.0]], goal=[[9.0, 0.0], [-9.0, 0.0]])
    >>> scene.position.shape, float(scene.advance(scene.velocity, 0.5).position[0, 0, 0])
    ((1, 2, 2), 0.5)
    """

    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats
    goal: Floats
    preferred_speed: Floats
    max_speed: Floats
    active: Bools
    visible: Bools
    external: Bools
    group: NDArray[np.int64]
    walls: Walls
    preferred_velocity: Floats | None = None
    robot: Bools | None = None
    time: float | Floats = 0.0
    memory: Mapping[str, Floats] = field(default_factory=dict)
    bodies: Bodies | None = None
    height: Floats | None = None
    wall_height: float = WALL_HEIGHT
    shared_fields: ClassVar[tuple[str, ...]] = ("walls",)
    storage = Storage(constants=("walls",))

    @classmethod
    def of(
        cls,
        position: ArrayLike,
        velocity: ArrayLike | None = None,
        *,
        heading: ArrayLike | None = None,
        radius: ArrayLike = 0.25,
        goal: ArrayLike | None = None,
        preferred_speed: ArrayLike = 1.3,
        preferred_velocity: ArrayLike | None = None,
        max_speed: ArrayLike | None = None,
        active: ArrayLike = True,
        visible: ArrayLike = True,
        external: ArrayLike = False,
        robot: ArrayLike | None = None,
        group: ArrayLike = -1,
        walls: Any = (),
        time: ArrayLike = 0.0,
        bodies: Bodies | None = None,
        height: ArrayLike | None = None,
        wall_height: float = WALL_HEIGHT,
    ) -> Scene:
        """Make a scene from ``[A, ...]`` or ``[E, A, ...]`` arrays.

        Defaults: velocity 0; heading along the velocity; goal at the position; ``max_speed`` 1.3 times the preferred
        speed (Helbing & Molnar 1995).

        Raises:
            InputError: a shape is wrong, a value of an active agent or the time is not finite, or a radius is not
                positive.
        """
        place = _vectors("position", position, None)
        shape = place.shape[:2]
        here = _spread(active, shape, BOOL)
        move = np.zeros_like(place) if velocity is None else _vectors("velocity", velocity, shape)
        wish = None if preferred_velocity is None else _vectors("preferred_velocity", preferred_velocity, shape)
        speed = _numbers("preferred_speed", preferred_speed, shape)
        look = move if wish is None or np.any(move) else wish
        scene = cls(
            position=place,
            velocity=move,
            heading=_numbers("heading", np.arctan2(look[..., 1], look[..., 0]) if heading is None else heading, shape),
            radius=_numbers("radius", radius, shape),
            goal=place.copy() if goal is None else _vectors("goal", goal, shape),
            preferred_speed=speed,
            max_speed=1.3 * speed if max_speed is None else _numbers("max_speed", max_speed, shape),
            active=here,
            visible=_spread(visible, shape, BOOL),
            external=_spread(external, shape, BOOL),
            robot=None if robot is None else _spread(robot, shape, BOOL),
            group=_spread(group, shape, INTEGER),
            walls=Walls.of(walls),
            preferred_velocity=wish,
            time=_time(time, shape[0]),
            bodies=bodies,
            height=None if height is None else _numbers("height", height, shape),
            wall_height=float(wall_height),
        )
        scene.check()
        return scene

    @property
    def shape(self) -> tuple[int, int]:
        """``(E, A)``."""
        return self.position.shape[0], self.position.shape[1]

    def check(self) -> None:
        """Raise :class:`InputError` if a value of an active agent is not finite or has the wrong sign."""
        if not _is_valid(*CHECKED(self._dense_arrays())):
            self._raise_first_error()
        if self.height is not None and not np.all(self.height[self.active] > 0.0):
            raise InputError(f"scene: height {self.height[self.active].min()} m is not above 0")
        if not self.wall_height > 0.0:
            raise InputError(f"scene: wall_height {self.wall_height} m is not above 0")
        if self.bodies is not None and self.bodies.batch != len(self.position):
            raise InputError(f"scene: bodies of {self.bodies.batch} environments for {len(self.position)} environments")

    def _raise_first_error(self) -> None:
        """Raise :class:`InputError` for the first field with a value that is not allowed."""
        for name in CHECKED_NAMES:
            value = getattr(self, name)[self.active]
            if not np.all(np.isfinite(value)):
                raise InputError(f"scene: {name} of an active agent is not finite; mark absent agents active=False")
        if np.any(self.radius[self.active] <= 0.0):
            raise InputError(f"scene: radius {self.radius[self.active].min()} m is not above 0")
        for name in ("preferred_speed", "max_speed"):
            if np.any(getattr(self, name)[self.active] < 0.0):
                raise InputError(f"scene: {name} {getattr(self, name)[self.active].min()} m/s is below 0")

    def desired_velocity(self, dt: float) -> Floats:
        """Return ``[E, A, 2]`` [m/s]: the given preferred velocity, or the preferred speed towards the goal.

        Near the goal, the speed is reduced so that a step of ``dt`` [s] does not overshoot.
        """
        if self.preferred_velocity is not None:
            return self.preferred_velocity
        away = self.goal - self.position
        distance = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
        speed = np.minimum(self.preferred_speed, distance / dt)
        return np.asarray(away * (speed / np.maximum(distance, 1e-12))[..., None])

    def advance(self, velocity: Floats, dt: float) -> Scene:
        """Return the scene ``dt`` [s] later: velocity first, then position (symplectic Euler).

        External and absent agents ignore the new velocity; external agents keep their own. Bodies of agents are
        removed (limbs must be posed again), bodies of the stage are kept.
        """
        pairs = (*self.shape, 2)
        chosen = dense(velocity, pairs, FLOAT)
        place, moved = np.empty(pairs), np.empty(pairs)
        # the arctan2 of numpy: that of the compiler differs in the last bit on some processors
        turned = np.arctan2(chosen[..., 1], chosen[..., 0])
        _advance(chosen, float(dt), place, moved, turned, *ADVANCED(self._dense_arrays()))
        later = self._copy()
        later.__dict__.update(position=place, velocity=moved, heading=turned, time=self.time + dt)
        if self.bodies is not None:
            later.__dict__["bodies"] = self.bodies.stage_bodies()
        return later

    def next_positions(self, velocity: Floats, dt: float) -> Floats:
        """Return the positions ``[E, A, 2]`` [m] of :meth:`advance`."""
        place, chosen = np.empty((*self.shape, 2)), dense(velocity, (*self.shape, 2), FLOAT)
        spare = np.empty(place.shape), np.empty(self.shape)
        _advance(chosen, float(dt), place, *spare, *ADVANCED(self._dense_arrays()))
        return place

    def replace(self, **changes: Any) -> Scene:
        """Return a copy with some fields changed.

        Raises:
            TypeError: a field is unknown.
        """
        later = self._copy()
        fields = later.__dict__
        count = len(fields)
        fields.update(changes)
        if IS_DENSE in fields and not self._are_dense(changes):
            del fields[IS_DENSE]
            count -= 1
        if len(fields) != count:
            unknown = sorted(changes.keys() - self.__dict__.keys())
            raise TypeError(f"Scene has no field {unknown[0]!r}")
        return later

    def step_arrays(self) -> tuple[NDArray[Any], ...]:
        """Return what models read in a step, as arrays that kernels accept.

        These are: position, velocity, radius, maximum speed, preferred velocity or (without it) goal, preferred speed,
        active, visible, external.
        """
        return tuple((STEP_TO_GOAL if self.preferred_velocity is None else STEP)(self._dense_arrays()))

    def _dense_arrays(self) -> Mapping[str, Any]:
        """Return arrays that kernels accept, by field; those of a scene that was advanced need no check."""
        fields = self.__dict__
        if IS_DENSE in fields:
            return fields
        shape = self.shape
        made = {name: dense(fields[name], (*shape, 2), FLOAT) for name in PAIRS if fields[name] is not None}
        made |= {name: dense(fields[name], shape, FLOAT) for name in NUMBERS}
        made |= {name: dense(fields[name], shape, BOOL) for name in MASKS}
        if all(value is fields[name] for name, value in made.items()):
            fields[IS_DENSE] = True
        return made

    def _are_dense(self, values: Mapping[str, Any]) -> bool:
        """Return whether new values of fields are arrays that kernels accept, or belong to no kernel."""
        place = self.__dict__["position"].shape
        for name, value in values.items():
            kind = DENSE.get(name)
            if kind is None or (value is None and name == "preferred_velocity"):
                continue
            shape = place if name in PAIRS else place[:2]
            if not (type(value) is np.ndarray and value.dtype is kind and value.shape == shape and value.flags.carray):
                return False
        return True

    def without(self, agent: int) -> Scene:
        """Return the scene without ``agent``, as its own sensors see it."""
        active = self.active.copy()
        active[:, agent] = False
        return self.replace(active=active)

    def environments(self, chosen: ArrayLike) -> Scene:
        """Return the environments with the indices ``chosen`` along E; an index may be repeated.

        >>> pair = Scene.of(np.zeros((2, 3, 2)))
        >>> pair.environments([1, 0, 1, 1]).shape
        (4, 3)
        """
        return take(self, np.asarray(chosen, dtype=np.int64))

    def environment(self, number: int) -> Scene:
        """Return one environment; its arrays are views, which must not be changed.

        >>> Scene.of(np.zeros((2, 3, 2))).environment(1).shape
        (1, 3)
        """
        rows, part = slice(number, number + 1), self._copy()
        part.__dict__.pop(IS_DENSE, None)
        for name, value in self.__dict__.items():
            if isinstance(value, np.ndarray):
                part.__dict__[name] = value[rows]
        if isinstance(self.time, np.ndarray):
            part.__dict__["time"] = float(self.time[number])
        part.__dict__["memory"] = {name: value[rows] for name, value in self.memory.items()}
        if self.bodies is not None:
            part.__dict__["bodies"] = self.bodies.environments(np.array([number]))
        return part

    def _copy(self) -> Scene:
        """Return a shallow copy, ten times faster than ``dataclasses.replace``."""
        copy = object.__new__(type(self))
        copy.__dict__.update(self.__dict__)
        return copy

    def digest(self) -> str:
        """Return a hash of position, velocity, heading, activity and bodies; equal bytes give equal hashes."""
        sum_ = hashlib.blake2b(digest_size=16)
        here = self.active[..., None]
        for value in (np.where(here, self.position, 0.0), np.where(here, self.velocity, 0.0)):
            sum_.update(np.ascontiguousarray(value).tobytes())
        sum_.update(np.where(self.active, self.heading, 0.0).tobytes())
        sum_.update(self.active.tobytes())
        if self.bodies is not None:
            sum_.update(self.bodies.digest_bytes(self.active))
        return sum_.hexdigest()


def _vectors(name: str, value: ArrayLike, shape: tuple[int, int] | None) -> Floats:
    array = np.asarray(value, dtype=np.float64)
    if array.ndim == 2:
        array = array[None]
    if array.ndim != 3 or array.shape[2] != 2:
        raise InputError(f"scene: {name} has shape {list(np.shape(value))}, it must be [A, 2] or [E, A, 2]")
    if shape is None:
        return np.array(array, order="C")
    return _broadcast(name, array, (*shape, 2))


def _numbers(name: str, value: ArrayLike, shape: tuple[int, int]) -> Floats:
    return _broadcast(name, np.asarray(value, dtype=np.float64), shape)


def _broadcast(name: str, array: Floats, shape: tuple[int, ...]) -> Floats:
    try:
        return _spread(array, shape, FLOAT)
    except ValueError:
        raise InputError(
            f"scene: {name} has shape {list(array.shape)}, which does not fit {list(shape)} from position"
        ) from None


def _spread(value: ArrayLike, shape: tuple[int, ...], kind: np.dtype[Any]) -> NDArray[Any]:
    """Return a new array that is broadcast from a value, three times faster than ``np.broadcast_to``."""
    array = np.asarray(value, dtype=kind)
    if array.ndim > len(shape):  # an assignment would drop leading axes of length 1
        raise ValueError(f"an array of shape {list(array.shape)} does not broadcast to {list(shape)}")
    out = np.empty(shape, dtype=kind)
    out[...] = array
    return out


def _time(value: Any, environments: int) -> float | Floats:
    if isinstance(value, float) and math.isfinite(value):
        return float(value)
    array = np.array(value, dtype=np.float64)
    if array.shape not in ((), (environments,)):
        raise InputError(f"scene: time has shape {list(array.shape)}, it must be a number or [E] = [{environments}]")
    if not np.all(np.isfinite(array)):
        raise InputError(f"scene: time {array[~np.isfinite(array)].flat[0]} s is not finite")
    return array if array.ndim else float(array)


@kernel
def _is_valid(
    position: Floats, velocity: Floats, heading: Floats, radius: Floats, goal: Floats, preferred_speed: Floats,
    max_speed: Floats, active: Bools,
) -> bool:  # fmt: skip
    """Return whether all values of active agents are finite and have the right sign."""
    for e in range(active.shape[0]):
        for a in range(active.shape[1]):
            if active[e, a] and not (
                math.isfinite(position[e, a, 0]) and math.isfinite(position[e, a, 1])
                and math.isfinite(velocity[e, a, 0]) and math.isfinite(velocity[e, a, 1])
                and math.isfinite(goal[e, a, 0]) and math.isfinite(goal[e, a, 1]) and math.isfinite(heading[e, a])
                and 0.0 < radius[e, a] < math.inf
                and 0.0 <= preferred_speed[e, a] < math.inf and 0.0 <= max_speed[e, a] < math.inf
            ):  # fmt: skip
                return False
    return True


@kernel
def _advance(
    chosen: Floats, dt: float, place: Floats, moved: Floats, turned: Floats, position: Floats, velocity: Floats,
    heading: Floats, active: Bools, external: Bools,
) -> None:  # fmt: skip
    """Write the next positions, velocities and headings; ``turned`` contains the directions of ``chosen``."""
    for e in range(active.shape[0]):
        for a in range(active.shape[1]):
            own = active[e, a] and not external[e, a]
            x, y = (chosen[e, a, 0], chosen[e, a, 1]) if own else (velocity[e, a, 0], velocity[e, a, 1])
            moved[e, a, 0], moved[e, a, 1] = x, y
            if not (own and math.sqrt(x * x + y * y) > TURNING_SPEED):
                turned[e, a] = heading[e, a]
            if active[e, a]:
                place[e, a, 0], place[e, a, 1] = position[e, a, 0] + x * dt, position[e, a, 1] + y * dt
            else:
                place[e, a, 0], place[e, a, 1] = position[e, a, 0], position[e, a, 1]
