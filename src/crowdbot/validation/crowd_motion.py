"""Motion of the crowds of the checks on periodic and open tracks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from crowdbot.core import InputError, Scene
from crowdbot.models import CrowdModel
from crowdbot.typing import Bools, Floats

from .scenario import RADIUS, SEEN, STEP, CrowdTracks, Report, Solid, inside_solids, substeps

PATIENCE = 60.0
"""A crowd of which nobody has left for this time [s] is jammed."""


def _steps(model: CrowdModel, step: float | None) -> tuple[float, int]:
    """Return the time between goals and walls [s], and the number of steps of the model in it."""
    if step is None:
        return STEP, substeps(model)
    parts = max(1, round(STEP / step))
    return parts * step, parts


def simulate_periodic(
    model: CrowdModel,
    crowd: Scene,
    length: float,
    seconds: float,
    rng: np.random.Generator,
    report: Report,
    step: float | None = None,
) -> CrowdTracks:
    """Simulate a crowd that walks along x on a periodic track of ``length`` [m].

    Each person has a copy one length ahead or behind, whichever is nearer to the track, with the same velocity, heading
    and memory. Other people avoid copies like any neighbor; the motion of the copies is discarded. Positions are stored
    every 0.2 s. ``step`` is the time step of the model [s] (default: that of :func:`substeps`).

    Raises:
        InputError: a position is not finite.
    """
    outer, parts = _steps(model, step)
    A, steps, stored = crowd.shape[1], round(seconds / outer), round(4.0 * STEP / outer)
    scene, rounds = _with_copies(crowd), np.zeros(crowd.shape)
    places = [crowd.position]
    for k in range(steps):
        for _ in range(parts):
            scene = model.step(_update_copies(scene, A, length), outer / parts, rng)
        place = scene.position.copy()
        _check(place[:, :A], crowd.active, float(np.max(scene.time)))
        turn = np.floor(place[:, :A, 0] / length)
        place[:, :A, 0] -= length * turn
        rounds += turn
        scene = scene.replace(position=place)
        if (k + 1) % stored == 0:
            unrolled = place[:, :A].copy()
            unrolled[..., 0] += length * rounds
            places.append(unrolled)
            report((k + 1) / steps)
    times = 4.0 * STEP * np.arange(len(places), dtype=np.float64)
    return CrowdTracks(times, np.stack(places), np.broadcast_to(crowd.active, (len(places), *crowd.shape)))


def simulate_open(
    model: CrowdModel,
    crowd: Scene,
    goals: Callable[[Floats], Floats],
    left: Callable[[Floats], Bools],
    seconds: float,
    rng: np.random.Generator,
    report: Report,
    step: float | None = None,
    begin: Floats | None = None,
) -> CrowdTracks:
    """Simulate a crowd until all people have left or the time limit is reached; positions are stored at every step.

    The preferred velocity of each person points straight to the current goal, with the preferred speed. A start in
    which nobody has left for 60 s is jammed and ends.

    Args:
        model: crowd model.
        crowd: initial scene.
        goals: function of positions ``[E, A, 2]`` [m] that returns the goals of the next step.
        left: function of positions ``[E, A, 2]`` that returns a mask ``[E, A]`` of people who have left; they are
            removed.
        seconds: time limit [s].
        rng: random generator of the model.
        report: called with the completed share of the time, or of the people if that is larger.
        step: time step of the model [s] (default: that of :func:`substeps`).
        begin: ``[E, A]`` times [s] before which people want to stand (default: 0).

    Raises:
        InputError: a position is not finite.
    """
    outer, parts = _steps(model, step)
    latest = np.zeros(len(crowd.position)) if begin is None else begin.max(axis=1)
    scene, steps, count = crowd, round(seconds / outer), max(1, int(crowd.active.sum()))
    places, present = [crowd.position], [crowd.active]
    for k in range(steps):
        goal = goals(scene.position)
        away = goal - scene.position
        wish = away * (scene.preferred_speed / np.maximum(np.hypot(away[..., 0], away[..., 1]), 1e-9))[..., None]
        if begin is not None:
            wish = np.where((k * outer >= begin)[..., None], wish, 0.0)
        scene = scene.replace(goal=goal, preferred_velocity=wish)
        for _ in range(parts):
            scene = model.step(scene, outer / parts, rng)
        _check(scene.position, scene.active, float(np.max(scene.time)))
        places.append(scene.position)
        present.append(scene.active)
        gone = scene.active & left(scene.position)
        latest = np.where(np.any(gone, axis=1), (k + 1) * outer, latest)
        jammed = (k + 1) * outer - latest > PATIENCE
        scene = scene.replace(active=scene.active & ~gone & ~jammed[:, None])
        if k % 20 == 0:
            report(max(k / steps, 1.0 - int(scene.active.sum()) / count))
        if not scene.active.any():
            break
    report(1.0)
    return CrowdTracks(outer * np.arange(len(places), dtype=np.float64), np.stack(places), np.stack(present))


def one_start(walk: CrowdTracks, e: int) -> CrowdTracks:
    """Return the tracks of one environment, until its last person has left."""
    present = walk.present[:, e : e + 1]
    last = int(np.flatnonzero(np.any(present, axis=(1, 2)))[-1]) + 1
    return CrowdTracks(walk.times[:last], walk.position[:last, e : e + 1], present[:last])


def each_start(walk: CrowdTracks) -> Iterator[CrowdTracks]:
    """Yield the tracks of each environment, until its last person has left."""
    for e in range(walk.present.shape[1]):
        yield one_start(walk, e)


def safety_of(walk: CrowdTracks, solids: Sequence[Solid]) -> dict[str, float]:
    """Return the share of people in solids and the largest overlap [m] of a start, for its row."""
    return {"outside": inside_solids(walk, solids), "overlap": deepest_overlap(walk)}


def deepest_overlap(walk: CrowdTracks, length: float | None = None) -> float:
    """Return the maximum overlap of two bodies [m], 0 without overlap.

    Args:
        walk: tracks; they are sampled once per second.
        length: length of a periodic track [m].
    """
    every = max(1, round(1.0 / float(walk.times[1] - walk.times[0])))
    nearest = 2.0 * RADIUS
    for place, present in zip(walk.position[::every], walk.present[::every], strict=True):
        away = place[:, :, None] - place[:, None]
        if length is not None:
            away[..., 0] -= length * np.round(away[..., 0] / length)
        distance = np.hypot(away[..., 0], away[..., 1])
        pair = present[:, :, None] & present[:, None] & ~np.eye(place.shape[1], dtype=np.bool_)
        nearest = min(nearest, float(np.min(distance[pair], initial=nearest)))
    return 2.0 * RADIUS - nearest


def _with_copies(crowd: Scene) -> Scene:
    def repeat(value: Any) -> Any:
        return np.concatenate([value, value], axis=1)

    names = ("position", "velocity", "heading", "radius", "goal", "preferred_speed", "max_speed")
    flags = ("active", "visible", "external", "group", "preferred_velocity")
    return crowd.replace(**{name: repeat(getattr(crowd, name)) for name in (*names, *flags)})


def _update_copies(scene: Scene, A: int, length: float) -> Scene:
    """Return the scene with the second half of its agents as copies of the first, one length away."""

    def copy(value: Any) -> Any:
        return np.concatenate([value[:, :A], value[:, :A]], axis=1)

    place, active = copy(scene.position), copy(scene.active)
    place[:, A:, 0] += np.where(place[:, A:, 0] < 0.5 * length, length, -length)
    active[:, A:] &= (place[:, A:, 0] > -SEEN) & (place[:, A:, 0] < length + SEEN)
    wish = scene.preferred_velocity
    assert wish is not None
    return scene.replace(
        position=place,
        velocity=copy(scene.velocity),
        heading=copy(scene.heading),
        goal=place + 1000.0 * wish,
        active=active,
        memory={name: copy(value) for name, value in scene.memory.items()},
    )


def _check(place: Floats, active: Bools, time: float) -> None:
    if not np.all(np.isfinite(place[active])):
        raise InputError(f"positions are not finite after {time:.1f} s")
