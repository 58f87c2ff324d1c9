"""Run the people of windows forward with a crowd model: what costs compare and what simulated predictions are."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, Walls
from crowdbot.data.forecast import Forecast
from crowdbot.data.motion import bridged, cut, observed_velocity
from crowdbot.data.windows import Windows
from crowdbot.models import CrowdModel
from crowdbot.models.goals import Goal

__all__ = ["Rollout"]

Floats = NDArray[np.float64]

HASTE = 1.3
"""How much faster than they walk people can go (Helbing & Molnár 1995)."""
STANDING_HASTE = 2.0
"""Maximum speed [m/s] of people who stand or stroll: they can still step aside."""


@dataclasses.dataclass(frozen=True)
class Rollout:
    """How observed people become a crowd that is simulated; W windows are the environments of one scene.

    Fields:
        model: how they walk.
        goal: where they want to go; it is resolved from what is known at the start of the simulation.
        radius: a number or ``[W, A]`` [m].
        substep: longest time step of the simulation [s]; a row of the recording is cut into equal steps.
        displacements: how many last displacements give the velocity and the preferred speed at the start.

    People start with their observed velocity; its length is the speed they prefer. Robots are external: the others
    avoid them and they keep their velocity.
    """

    model: CrowdModel
    goal: Goal
    radius: float | Floats = 0.25
    substep: float = 0.1
    displacements: int = 1

    def __post_init__(self) -> None:
        if not 0.0 < self.substep < math.inf:
            raise InputError(f"simulation: substep = {self.substep} s must be finite and above 0")
        radius = np.asarray(self.radius, dtype=float)
        if not (np.all(radius > 0.0) and np.all(np.isfinite(radius))):
            raise InputError(f"simulation: radius = {radius.min()} m must be finite and above 0")
        if self.displacements < 1:
            raise InputError(f"simulation: displacements = {self.displacements} must be at least 1")

    def scene(self, past: Windows, row: int) -> Scene:
        """Return everyone at a row of the windows, E = W; who is not simulated from there on is external.

        At row 0 the velocity is that towards the next row, later it is that of the last displacements. Holes in the
        observed tracks are bridged.

        Raises:
            InputError: the windows are in pixels.
        """
        if past.units != "m":
            raise InputError(
                f"{past.source} is in {past.units}: crowd models walk in metres, give the recording a scale"
            )
        whole = bridged(past)
        known = cut(whole, 0, max(row, 1) + 1)
        velocity = observed_velocity(known, 1 if row == 0 else self.displacements)
        here = whole.present[:, row]
        speed = np.sqrt(velocity[..., 0] ** 2 + velocity[..., 1] ** 2)
        place = whole.position[:, row]
        goal = np.where(here[..., None], self.goal.resolve(known), place)
        return Scene.of(
            place,
            velocity,
            radius=self.radius,
            goal=goal,
            preferred_speed=speed,
            max_speed=np.maximum(HASTE * speed, STANDING_HASTE),
            active=here,
            external=past.robot,
            walls=Walls.of(past.walls),
        )

    def ahead(self, past: Windows, steps: int, rng: np.random.Generator | None = None) -> Floats:
        """Return where everyone present at the last row goes: ``[W, steps, A, 2]`` [m]."""
        place = np.zeros((len(past), steps, *past.position.shape[2:]))
        scene = self.scene(past, past.position.shape[1] - 1)
        if not np.any(scene.active):
            return place
        for step in range(steps):
            scene = self._advanced(scene, past.dt, rng)
            place[:, step] = scene.position
        return place

    def forecast(self, past: Windows, steps: int, name: str, rng: np.random.Generator | None = None) -> Forecast:
        """Return :meth:`ahead` as a forecast with one sample."""
        return Forecast.of(self.ahead(past, steps, rng)[:, None], past.present[:, -1], past.dt, name)

    def again(self, past: Windows, row: int = 0, copies: int = 1) -> Floats:
        """Return the rows after ``row`` as the model would have made them: ``[copies, W, rows, A, 2]`` [m].

        Everyone present at ``row`` but the robots is simulated until their last observed row; robots and people who
        come later move as they were recorded. The copies lie along E, so parameters of the model may differ among
        them: ``[copies * W, 1]``, copy by copy; ``radius`` likewise.
        """
        W, T, A, _ = past.position.shape
        scene = _repeated(dataclasses.replace(self, radius=1.0).scene(past, row), copies)
        radius = np.broadcast_to(np.asarray(self.radius, dtype=float), (copies * W, A))
        scene = scene.replace(radius=radius.copy(), external=scene.external | ~scene.active)
        place = np.zeros((copies * W, T - 1 - row, A, 2))
        recorded = _recorded(bridged(past))
        if not np.any(past.present):
            return place.reshape(copies, W, T - 1 - row, A, 2)
        for step in range(T - 1 - row):
            scene = recorded.shown(scene, row + step, copies)
            scene = self._advanced(scene, past.dt)
            place[:, step] = scene.position
        return place.reshape(copies, W, T - 1 - row, A, 2)

    def _advanced(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        count = max(1, math.ceil(dt / self.substep - 1e-9))
        for _ in range(count):
            scene = self.model.step(scene, dt / count, rng)
        return scene


@dataclasses.dataclass(frozen=True)
class _Recorded:
    """What was recorded: where everyone is, ``[W, T, A]`` who is there, and until which row ``[W, A]``."""

    position: Floats
    velocity: Floats
    present: NDArray[np.bool_]
    last: NDArray[np.int64]

    def shown(self, scene: Scene, row: int, copies: int) -> Scene:
        """Return the scene with external agents as recorded at ``row``, and without those who have gone for good."""
        here, stays = _copied(self.present[:, row], copies), _copied(self.last >= row, copies)
        moved = scene.external & here
        place = np.where(moved[..., None], _copied(self.position[:, row], copies), scene.position)
        velocity = np.where(moved[..., None], _copied(self.velocity[:, row], copies), scene.velocity)
        heading = np.where(moved, np.arctan2(velocity[..., 1], velocity[..., 0]), scene.heading)
        active = np.where(scene.external, here, scene.active & stays)
        return scene.replace(position=place, velocity=velocity, heading=heading, active=active)


def _recorded(past: Windows) -> _Recorded:
    T = past.position.shape[1]
    both = past.present[:, :-1] & past.present[:, 1:]
    velocity = np.zeros_like(past.position)
    velocity[:, :-1] = np.where(both[..., None], np.diff(past.position, axis=1) / past.dt, 0.0)
    last = T - 1 - np.argmax(past.present[:, ::-1], axis=1)
    return _Recorded(past.position, velocity, past.present, last)


def _repeated(scene: Scene, copies: int) -> Scene:
    """Return ``copies`` of all environments one after the other along E."""
    arrays = {
        field.name: _copied(getattr(scene, field.name), copies)
        for field in dataclasses.fields(scene)
        if isinstance(getattr(scene, field.name), np.ndarray)
    }
    return scene.replace(**arrays)


def _copied(values: NDArray, copies: int) -> NDArray:  # type: ignore[type-arg]
    return np.tile(values, (copies, *(1,) * (values.ndim - 1)))
