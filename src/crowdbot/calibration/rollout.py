"""Simulation of the people in windows with a crowd model, for costs and predictions."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, Walls, tree
from crowdbot.data import Windows, fill_gaps, slice_rows
from crowdbot.models import CrowdModel, Goal
from crowdbot.typing import Floats, Ints

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

    def predict_positions(self, past: Windows, steps: int) -> Floats:
        """Return the predicted positions of people present at the last row: ``[W, steps, A, 2]`` [m]."""
        if not np.any(past.present[:, -1:]):
            return np.zeros((len(past), steps, *past.position.shape[2:]))
        return self.run(self.scene(past, past.position.shape[1] - 1), past, steps)

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


Candidate = Callable[[Rollout, Scene, int], tuple[Rollout, Scene]]
"""Assigns the parameters of candidates to copies of a scene, in which each window is repeated ``copies`` times."""


class ResimulatedTracks:
    """Tracks of P candidates over the observed rows of W windows; simulated on first access.

    Fields:
        past: the simulated windows.
    """

    def __init__(self, past: Windows, once: Callable[[], Floats], stepwise: Callable[[], Floats]) -> None:
        self.past = past
        self._once = once
        self._stepwise = stepwise

    @functools.cached_property
    def once(self) -> Floats:
        """Rows 1 to T - 1, simulated from the first row: ``[P, W, T - 1, A, 2]`` [m]."""
        return self._once()

    @functools.cached_property
    def stepwise(self) -> Floats:
        """Rows 2 to T - 1, each simulated from the previous recorded row: ``[P, W, T - 2, A, 2]`` [m]."""
        return self._stepwise()


class Resimulation:
    """Repeated simulation of observed windows with different parameters.

    People who are present at the first row of a simulation are simulated until their last observed row. Robots and
    people who appear later follow their recorded tracks. Scenes are created once and then copied.
    """

    def __init__(self, rollout: Rollout, past: Windows) -> None:
        self.rollout = rollout
        self.past = past
        self.whole = fill_gaps(past)
        self._repeated: tuple[object, Scene] | None = None

    def resimulate(self, candidate: Candidate, copies: int, which: Ints) -> ResimulatedTracks:
        """Return the tracks of ``copies`` candidates in the windows ``which``."""
        return ResimulatedTracks(
            self.past[which],
            lambda: self._from_first_row(candidate, copies, which),
            lambda: self._row_by_row(candidate, copies, which),
        )

    @functools.cached_property
    def _first(self) -> Scene:
        scene = self.rollout.scene(self.past, 0)
        return scene.replace(external=scene.external | ~scene.active)

    @functools.cached_property
    def _each(self) -> Scene:
        """Scenes at rows 1 to T - 2, ordered by window: ``E = W * (T - 2)``."""
        rows = range(1, self.past.position.shape[1] - 1)
        scenes = [self.rollout.scene(slice_rows(self.past, 0, row + 1), row) for row in rows]
        order = np.arange(len(rows) * len(self.past)).reshape(len(rows), -1).T.ravel()
        return tree.join(scenes).environments(order)

    @functools.cached_property
    def _tracks(self) -> _RecordedTracks:
        return _recorded_tracks(self.whole)

    def _from_first_row(self, candidate: Candidate, copies: int, which: Ints) -> Floats:
        T, A = self.past.position.shape[1:3]
        index = np.tile(which, copies)
        place = np.zeros((len(index), T - 1, A, 2))
        rollout, scene = candidate(self.rollout, self._first.environments(index), 1)
        for row in range(T - 1):
            scene = self._tracks.apply(scene, row, index)
            scene = rollout.advance(scene, self.past.dt)
            place[:, row] = scene.position
        return place.reshape(copies, len(which), T - 1, A, 2)

    def _row_by_row(self, candidate: Candidate, copies: int, which: Ints) -> Floats:
        T, A = self.past.position.shape[1:3]
        if T < 3:
            return np.zeros((copies, len(which), 0, A, 2))
        rollout, scene = candidate(self.rollout, self._copies(copies, which), T - 2)
        place = rollout.next_positions(scene, self.past.dt)
        return place.reshape(copies, len(which), T - 2, A, 2)

    def _copies(self, copies: int, which: Ints) -> Scene:
        """Return the scenes of all rows of some windows, repeated; they are kept, because most calls use them again."""
        key = copies, which.tobytes()
        if self._repeated is None or self._repeated[0] != key:
            rows = self.past.position.shape[1] - 2
            index = np.tile((which[:, None] * rows + np.arange(rows)).ravel(), copies)
            self._repeated = key, self._each.environments(index)
        return self._repeated[1]


@dataclass(frozen=True)
class _RecordedTracks:
    """Recorded positions and velocities, presence ``[W, T, A]``, and last observed row ``[W, A]``.

    ``changes``: whether any agent appears, disappears or follows a recorded track.
    """

    position: Floats
    velocity: Floats
    present: NDArray[np.bool_]
    last: Ints
    changes: bool

    def apply(self, scene: Scene, row: int, index: Ints) -> Scene:
        """Return the scene with external agents at their recorded states of ``row``, without people who have left."""
        if not self.changes:
            return scene
        here, stays = self.present[index, row], self.last[index] >= row
        moved = scene.external & here
        place = np.where(moved[..., None], self.position[index, row], scene.position)
        velocity = np.where(moved[..., None], self.velocity[index, row], scene.velocity)
        heading = np.where(moved, np.arctan2(velocity[..., 1], velocity[..., 0]), scene.heading)
        active = np.where(scene.external, here, scene.active & stays)
        return scene.replace(position=place, velocity=velocity, heading=heading, active=active)


def _recorded_tracks(past: Windows) -> _RecordedTracks:
    T = past.position.shape[1]
    both = past.present[:, :-1] & past.present[:, 1:]
    velocity = np.zeros_like(past.position)
    velocity[:, :-1] = np.where(both[..., None], np.diff(past.position, axis=1) / past.dt, 0.0)
    last = T - 1 - np.argmax(past.present[:, ::-1], axis=1)
    changes = bool(np.any(past.robot) or np.any(past.present != past.present[:, :1]))
    return _RecordedTracks(past.position, velocity, past.present, last, changes)
