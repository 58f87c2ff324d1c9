"""Rollout: simulation of the people in windows with a crowd model, for costs and predictions."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from crowdbot.core import InputError, Scene, Walls
from crowdbot.data import Windows, fill_gaps, slice_rows
from crowdbot.models import CrowdModel, Goal
from crowdbot.typing import Floats

HASTE = 1.3
"""Maximum speed relative to the walking speed (Helbing & Molnár 1995)."""
STANDING_HASTE = 2.0
"""Lower limit of the maximum speed [m/s]: standing people can step aside."""


@dataclasses.dataclass(frozen=True)
class Rollout:
    """Simulates observed people; the W windows are the environments of one scene.

    Fields:
        model: crowd model; its parameters are scalars or ``[W, A]``.
        goal: goals of people, resolved from the data at the start of the simulation.
        radius: [m], one number, where the windows have no radii, or ``[W, A]``, instead of those of the windows.
        preferred_speed: ``[W, A]`` [m/s]; None for the observed speed, the magnitude of the velocity of the goal.
        substep: maximum time step of the simulation [s]; a row of the recording has equal steps.

    People start with their observed velocity. Robots are external: people avoid them, and they follow their plan if it
    is known, otherwise they keep their velocity.
    """

    model: CrowdModel
    goal: Goal
    radius: float | Floats = 0.25
    preferred_speed: Floats | None = None
    substep: float = 0.1

    def __post_init__(self) -> None:
        if not 0.0 < self.substep < math.inf:
            raise InputError(f"simulation: substep = {self.substep} s must be finite and above 0")
        radius = np.asarray(self.radius, dtype=float)
        if not (np.all(radius > 0.0) and np.all(np.isfinite(radius))):
            raise InputError(f"simulation: radius = {radius.min()} m must be finite and above 0")

    def scene(self, past: Windows, row: int) -> Scene:
        """Return the scene at a row of the windows, E = W; people who are not simulated afterwards are external.

        The velocity is the one that the goal is based on; at row 0, it is the velocity to the next row. Gaps in the
        observed tracks are interpolated.

        Raises:
            InputError: the windows are in pixels.
        """
        if past.units != "m":
            raise InputError(
                f"{past.source} is in {past.units}: crowd models need metres; pass a scale for the recording"
            )
        whole = fill_gaps(past)
        known = slice_rows(whole, 0, max(row, 1) + 1)
        velocity = self.goal.velocity(known)
        here = whole.present[:, row]
        place = whole.position[:, row]
        scene = Scene.of(
            place,
            velocity,
            radius=self.radii(past),
            goal=np.where(here[..., None], self.goal.resolve(known), place),
            active=here,
            external=past.robot,
            robot=past.robot if np.any(past.robot) else None,
            walls=Walls.of(past.walls),
        )
        observed = np.sqrt(velocity[..., 0] ** 2 + velocity[..., 1] ** 2)
        return set_preferred_speed(scene, observed if self.preferred_speed is None else self.preferred_speed)

    def radii(self, past: Windows) -> float | Floats:
        """Return the radii [m] of people and robots; a single one counts where the windows have none."""
        if past.radius is None or np.ndim(self.radius) > 0:
            return self.radius
        return np.where(np.isnan(past.radius), self.radius, past.radius)

    def predict_positions(self, past: Windows, steps: int, rng: np.random.Generator | None = None) -> Floats:
        """Return the predicted positions of people present at the last row: ``[W, steps, A, 2]`` [m]."""
        if not np.any(past.present[:, -1:]):
            return np.zeros((len(past), steps, *past.position.shape[2:]))
        return self.run(self.scene(past, past.position.shape[1] - 1), past, steps, rng)

    def run(self, scene: Scene, past: Windows, steps: int, rng: np.random.Generator | None = None) -> Floats:
        """Return the positions in a scene over ``steps`` rows: ``[E, steps, A, 2]`` [m].

        The environments of the scene are copies of all windows."""
        copies = len(scene.position) // max(1, len(past))
        place = np.zeros((*scene.shape[:1], steps, *scene.shape[1:], 2))
        for step in range(steps):
            if past.plan is not None:
                planned = np.tile(past.plan_at(step + 1), (copies, 1, 1))
                known = ~np.isnan(planned[..., 0]) & scene.external
                toward = (planned - scene.position) / past.dt
                scene = scene.replace(velocity=np.where(known[..., None], toward, scene.velocity))
            scene = self.advance(scene, past.dt, rng)
            place[:, step] = scene.position
        return place

    def advance(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        """Return the scene one row later, in equal steps of at most ``substep``."""
        count = self._substeps(dt)
        for _ in range(count):
            scene = self.model.step(scene, dt / count, rng)
        return scene

    def next_positions(self, scene: Scene, dt: float) -> Floats:
        """Return the positions of :meth:`advance`, ``[E, A, 2]`` [m], without the rest of the scene."""
        count = self._substeps(dt)
        for _ in range(count - 1):
            scene = self.model.step(scene, dt / count)
        if type(self.model).step is not CrowdModel.step:
            return self.model.step(scene, dt / count).position
        return scene.next_positions(self.model.velocity(scene, dt / count), dt / count)

    def _substeps(self, dt: float) -> int:
        return max(1, math.ceil(dt / self.substep - 1e-9))


def set_preferred_speed(scene: Scene, speed: Floats) -> Scene:
    """Return the scene with the preferred speed ``speed`` [E, A] and a maximum speed above it."""
    return scene.replace(preferred_speed=speed, max_speed=np.maximum(HASTE * speed, STANDING_HASTE))
