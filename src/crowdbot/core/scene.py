"""Scene: state of all agents and walls at one instant, as arrays, for models, sensors and recorders."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .bodies import Bodies
from .errors import InputError
from .walls import Walls

__all__ = ["Scene"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

PERSON_HEIGHT = 1.7
"""Default height [m] of an agent."""
WALL_HEIGHT = 3.0
"""Default height [m] of walls."""
TURNING_SPEED = 0.05
"""Speed [m/s] below which an agent keeps its heading."""


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
        group: ``[E, A]`` int, number of the group; -1 for none.
        walls: shared by all environments.
        preferred_velocity: ``[E, A, 2]`` [m/s]; None derives it from goal and preferred speed.
        time: [s].
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
    time: float = 0.0
    memory: Mapping[str, Floats] = field(default_factory=dict)
    bodies: Bodies | None = None
    height: Floats | None = None
    wall_height: float = WALL_HEIGHT

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
        group: ArrayLike = -1,
        walls: Any = (),
        time: float = 0.0,
        bodies: Bodies | None = None,
        height: ArrayLike | None = None,
        wall_height: float = WALL_HEIGHT,
    ) -> Scene:
        """Make a scene from ``[A, ...]`` or ``[E, A, ...]`` arrays.

        Defaults: velocity 0; heading along the velocity; goal at the position; ``max_speed`` 1.3 times the preferred
        speed (Helbing & Molnar 1995).

        Raises:
            InputError: a shape is wrong, a value of an active agent is not finite, or a radius is not positive.
        """
        place = _vectors("position", position, None)
        shape = place.shape[:2]
        here = np.broadcast_to(np.asarray(active, dtype=np.bool_), shape).copy()
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
            visible=np.broadcast_to(np.asarray(visible, dtype=np.bool_), shape).copy(),
            external=np.broadcast_to(np.asarray(external, dtype=np.bool_), shape).copy(),
            group=np.broadcast_to(np.asarray(group, dtype=np.int64), shape).copy(),
            walls=Walls.of(walls),
            preferred_velocity=wish,
            time=float(time),
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
        for name in ("position", "velocity", "heading", "radius", "goal", "preferred_speed", "max_speed"):
            value = getattr(self, name)[self.active]
            if not np.all(np.isfinite(value)):
                raise InputError(f"scene: {name} of an active agent is not finite; mark absent agents active=False")
        if np.any(self.radius[self.active] <= 0.0):
            raise InputError(f"scene: radius {self.radius[self.active].min()} m is not above 0")
        for name in ("preferred_speed", "max_speed"):
            if np.any(getattr(self, name)[self.active] < 0.0):
                raise InputError(f"scene: {name} {getattr(self, name)[self.active].min()} m/s is below 0")
        if self.height is not None and not np.all(self.height[self.active] > 0.0):
            raise InputError(f"scene: height {self.height[self.active].min()} m is not above 0")
        if not self.wall_height > 0.0:
            raise InputError(f"scene: wall_height {self.wall_height} m is not above 0")
        if self.bodies is not None and self.bodies.batch != len(self.position):
            raise InputError(f"scene: bodies of {self.bodies.batch} environments for {len(self.position)} environments")

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
        own = self.active & ~self.external
        moved = np.where(own[..., None], velocity, self.velocity)
        speed = np.sqrt(moved[..., 0] ** 2 + moved[..., 1] ** 2)
        turned = np.where(own & (speed > TURNING_SPEED), np.arctan2(moved[..., 1], moved[..., 0]), self.heading)
        place = np.where(self.active[..., None], self.position + moved * dt, self.position)
        bodies = None if self.bodies is None else self.bodies.stage_bodies()
        return dataclasses.replace(
            self, position=place, velocity=moved, heading=turned, time=self.time + dt, bodies=bodies
        )

    def replace(self, **changes: Any) -> Scene:
        """Return a copy with some fields changed."""
        return dataclasses.replace(self, **changes)

    def without(self, agent: int) -> Scene:
        """Return the scene without ``agent``, as its own sensors see it."""
        active = self.active.copy()
        active[:, agent] = False
        return dataclasses.replace(self, active=active)

    def environments(self, chosen: ArrayLike) -> Scene:
        """Return the environments with the indices ``chosen`` along E; an index may be repeated.

        >>> pair = Scene.of(np.zeros((2, 3, 2)))
        >>> pair.environments([1, 0, 1, 1]).shape
        (4, 3)
        """
        index = np.asarray(chosen, dtype=np.int64)
        arrays: dict[str, Any] = {
            part.name: getattr(self, part.name)[index]
            for part in dataclasses.fields(self)
            if isinstance(getattr(self, part.name), np.ndarray)
        }
        memory = {name: value[index] for name, value in self.memory.items()}
        bodies = None if self.bodies is None else self.bodies.environments(index)
        return dataclasses.replace(self, **arrays, memory=memory, bodies=bodies)

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
    array = np.array(value, dtype=np.float64)
    if array.ndim == 2:
        array = array[None]
    if array.ndim != 3 or array.shape[2] != 2:
        raise InputError(f"scene: {name} has shape {list(np.shape(value))}, it must be [A, 2] or [E, A, 2]")
    if shape is None:
        return np.ascontiguousarray(array)
    return np.ascontiguousarray(_broadcast(name, array, (*shape, 2)))


def _numbers(name: str, value: ArrayLike, shape: tuple[int, int]) -> Floats:
    return np.ascontiguousarray(_broadcast(name, np.asarray(value, dtype=np.float64), shape))


def _broadcast(name: str, array: Floats, shape: tuple[int, ...]) -> Floats:
    try:
        return np.broadcast_to(array, shape).copy()
    except ValueError:
        raise InputError(
            f"scene: {name} has shape {list(array.shape)}, which does not fit {list(shape)} from position"
        ) from None
