"""Simulated training data of predictors, free of any licence: crowds, and encounters of people and robots.

Crowds have several models, layouts, densities and speeds; robots have known plans, radii and speeds.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from crowdbot.calibration import Rollout, resolve_model
from crowdbot.core import stream
from crowdbot.data import Trajectories, Windows, slice_rows
from crowdbot.models import CurrentDirection
from crowdbot.prediction import Simulated
from crowdbot.typing import Floats

__all__ = [
    "CROWD_LAYOUTS",
    "CROWD_MODELS",
    "REACTING_MODELS",
    "people_encounters",
    "robot_encounters",
    "simulated_crowds",
]

CROWD_MODELS = ("orca", "social-force", "power-law", "collision-free-speed", "anticipation-velocity")
"""Crowd models of the training data."""
CROWD_LAYOUTS = ("one-way", "two-way", "crossing", "everywhere")
"""Directions of walking: all the same, opposite, at right angles, random."""
STEP = 0.4
"""Time step of the tracks [s]."""
ROWS = 24
"""Rows of a simulated crowd."""
APART = 0.7
"""Smallest initial distance between two people [m]."""


def simulated_crowds(scenes: int = 6, seed: int = 0) -> list[Trajectories]:
    """Return tracks at 0.4 s of simulated crowds, one recording per model and layout.

    Args:
        scenes: number of crowds per model and layout, each of 4 to 40 people at 0.05 to 0.8 persons per square metre.
        seed: random seed.

    People walk at their preferred speed, normal(1.3, 0.25) m/s, in the direction of the layout, around each other.
    """
    trajectories = []
    for model in CROWD_MODELS:
        predictor = Simulated(model, substep=0.05, contact=0.0)
        for layout in CROWD_LAYOUTS:
            rng = stream(seed, "crowds", model, layout)
            crowds = [_rows(predictor, layout, rng) for _ in range(scenes)]
            trajectories.append(_recording(crowds, f"simulated-{model}-{layout}"))
    return trajectories


def _rows(predictor: Simulated, layout: str, rng: np.random.Generator) -> Floats:
    """Return positions ``[T, A, 2]`` [m] of one crowd."""
    count = int(rng.integers(4, 41))
    side = float(np.sqrt(count / rng.uniform(0.05, 0.8)))
    place = _places(count, side, rng)
    A = len(place)
    angle = {
        "one-way": np.zeros(A),
        "two-way": np.pi * rng.integers(0, 2, A),
        "crossing": 0.5 * np.pi * rng.integers(0, 2, A),
        "everywhere": rng.uniform(-np.pi, np.pi, A),
    }[layout] + rng.normal(0.0, 0.1, A)
    speed = np.clip(rng.normal(1.3, 0.25, A), 0.4, 2.2)
    velocity = speed[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    position = np.stack([place - STEP * velocity, place])[None]
    here, nobody = np.ones((1, 2, A), dtype=np.bool_), np.zeros((1, A), dtype=np.bool_)
    past = Windows(position, here, nobody, nobody, np.arange(A)[None], np.arange(2)[None], STEP, "all", "simulated")
    return np.asarray(predictor.predict(past, ROWS).position[0, 0])


def _places(count: int, side: float, rng: np.random.Generator) -> Floats:
    """Return at most ``count`` random points in a square, at least ``APART`` from each other."""
    kept: list[Floats] = []
    for point in rng.uniform(0.0, side, (20 * count, 2)):
        if len(kept) < count and all(np.hypot(*(point - other)) >= APART for other in kept):
            kept.append(point)
    return np.array(kept)


def _recording(crowds: list[Floats], name: str) -> Trajectories:
    """Return crowds as one recording; they follow each other without a common row."""
    id, frame, place, first = [], [], [], 0
    for number, rows in enumerate(crowds):
        T, A, _ = rows.shape
        id.append(np.tile(first + np.arange(A), T))
        frame.append(np.repeat(number * (ROWS + 40) + np.arange(T), A))
        place.append(rows.reshape(-1, 2))
        first += A
    xy = np.concatenate(place)
    return Trajectories(
        np.concatenate(id), np.concatenate(frame), xy[:, 0], xy[:, 1], row_rate=1.0 / STEP, frame_step=1, name=name
    )


ENCOUNTERS = {"head-on": np.pi, "crossing": 0.5 * np.pi, "overtaking": 0.0, "oblique": 0.75 * np.pi}
"""Kind of encounter -> angle between the directions of the people and of the robot [rad]."""
REACTING_MODELS = tuple(model for model in CROWD_MODELS if model != "social-force")
"""Crowd models whose people keep out of a robot; the repulsion of the social force ignores bodies."""
OBSERVED, PREDICTED = 8, 12
"""Rows of the windows."""
PEOPLE = 4
"""People in a scene, who do not meet each other: what is learned is their reaction to the robot."""
SPREAD = 48.0
"""Distance between people of a scene [m]."""
ALIKE = 0.5
"""Cosine of the angle between two directions from which they are similar."""
BODY = 0.25
"""Radius of people [m]."""


def robot_encounters(scenes: int = 40, seed: int = 0) -> dict[str, tuple[Windows, Windows]]:
    """Return past and future of simulated encounters, by crowd model and kind, with the plan and all radii.

    Args:
        scenes: number of scenes per model and kind, each with 4 people and 4 robots far apart.
        seed: random seed.

    People walk at normal(1.3, 0.25) m/s, robots of radius 0.2 to 0.9 m drive at 0.3 to 2 m/s along a plan that is
    straight, bends, or brakes to a stop. Undisturbed, they would be at most 2.5 m apart at a time between the fourth
    observed row and the end of the future.
    """
    result = {}
    for model in REACTING_MODELS:
        for kind, angle in ENCOUNTERS.items():
            rng = stream(seed, "encounters", model, kind)
            result[f"{model} {kind}"] = _simulate(model, _starts(scenes, angle, rng), f"{model}-{kind}")
    return result


def people_encounters(tracks: Trajectories, every: int = 6) -> tuple[Windows, Windows]:
    """Return past and future of every so many-th window, once for each person as a robot whose plan is the true future.

    People give way to each other as to a robot that does not react. Those who walk in a similar direction (within 60
    degrees) are not scored: many of them walk together. Everybody has a radius of 0.25 m.

    Args:
        tracks: recording at 0.4 s.
        every: distance of the windows.
    """
    past, future = (windows[::every] for windows in tracks.windows(OBSERVED, PREDICTED))
    whole = past.present.all(axis=1) & future.present.all(axis=1)
    window, person = np.nonzero(whole)
    is_robot = np.zeros((len(window), whole.shape[1]), np.bool_)
    is_robot[np.arange(len(window)), person] = True
    velocity = (past.position[:, -1] - past.position[:, -3])[window]
    own = velocity[np.arange(len(window)), person][:, None]
    speed = np.hypot(velocity[..., 0], velocity[..., 1]) * np.hypot(own[..., 0], own[..., 1])
    crosses = (velocity * own).sum(axis=2) < ALIKE * speed
    before, after = past[window], future[window]
    plan = np.where(is_robot[:, None, :, None], after.position, np.nan)
    scored = after.scored & crosses & ~is_robot
    return (
        dataclasses.replace(before, robot=is_robot, plan=plan, radius=np.full(is_robot.shape, BODY)),
        dataclasses.replace(after, robot=is_robot, scored=scored),
    )


def _starts(scenes: int, angle: float, rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Return first positions [m] and velocities [m/s] of people ``[W, 2, A, 2]``, paths of robots, and radii [m]."""
    shape = scenes, PEOPLE
    speed = np.clip(rng.normal(1.3, 0.25, shape), 0.5, 2.2)
    turn = rng.uniform(-np.pi, np.pi, shape)
    velocity = speed[..., None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    time = STEP * np.arange(OBSERVED + PREDICTED)
    drive, bend = rng.uniform(0.3, 2.0, shape), rng.choice([0.0, 0.0, 0.25, -0.25], shape)
    brake = np.where(rng.random(shape) < 0.25, rng.uniform(2.0, 6.0, shape), np.inf)
    way = turn + angle * rng.choice([-1.0, 1.0], shape) + rng.normal(0.0, 0.15, shape)
    pace = np.where(time[None, :, None] < brake[:, None], drive[:, None], 0.0)
    course = way[:, None] + bend[:, None] * time[None, :, None]
    step = STEP * pace[..., None] * np.stack([np.cos(course), np.sin(course)], axis=-1)
    robot = np.cumsum(step, axis=1) - step[:, :1]
    meet = rng.integers(3, OBSERVED + PREDICTED, shape)
    offset = rng.uniform(0.0, 2.5, shape)[..., None] * _unit(rng.uniform(-np.pi, np.pi, shape))
    centre = SPREAD * np.stack([np.arange(float(PEOPLE)), np.zeros(PEOPLE)], axis=-1)
    begin = np.broadcast_to(centre, (*shape, 2))
    there = begin + velocity * (STEP * meet)[..., None] + offset
    at_meeting = np.take_along_axis(robot, meet[:, None, :, None], axis=1)[:, 0]
    robot = robot + (there - at_meeting)[:, None]
    radius = np.concatenate([np.full(shape, BODY), rng.uniform(0.2, 0.9, shape)], axis=1)
    return np.concatenate([begin[:, None], velocity[:, None]], axis=1), robot, radius


def _unit(angle: Floats) -> Floats:
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _simulate(model: str, start: tuple[Floats, Floats, Floats], name: str) -> tuple[Windows, Windows]:
    """Return past and future of scenes in which people walk with a crowd model and robots follow their plans."""
    (begin, velocity), robot, radius = np.moveaxis(start[0], 1, 0), start[1], start[2]
    W, rows, A, _ = robot.shape
    two = np.stack([begin - STEP * velocity, begin], axis=1)
    drive = np.stack([2.0 * robot[:, 0] - robot[:, 1], robot[:, 0]], axis=1)
    is_robot = np.broadcast_to(np.arange(2 * A) >= A, (W, 2 * A)).copy()
    past = Windows(
        np.concatenate([two, drive], axis=2), np.ones((W, 2, 2 * A), np.bool_), np.zeros_like(is_robot), is_robot,
        np.tile(np.arange(2 * A), (W, 1)), np.tile(np.arange(2), (W, 1)), STEP, "all", f"simulated-{name}",
        plan=np.concatenate([np.full((W, rows - 1, A, 2), np.nan), robot[:, 1:]], axis=2), radius=radius,
    )  # fmt: skip
    rollout = Rollout(resolve_model(model), CurrentDirection(), radius, None, 0.05)
    later = rollout.predict_positions(past, rows - 1)
    later[:, :, A:] = robot[:, 1:]
    whole = dataclasses.replace(
        past, position=np.concatenate([past.position[:, -1:], later], axis=1),
        present=np.ones((W, rows, 2 * A), np.bool_), frame=np.tile(np.arange(rows), (W, 1)), plan=None,
    )  # fmt: skip
    known = np.where(is_robot[:, None, :, None], whole.position[:, OBSERVED:], np.nan)
    seen = dataclasses.replace(slice_rows(whole, 0, OBSERVED), plan=known)
    return seen, dataclasses.replace(slice_rows(whole, OBSERVED, rows), scored=~is_robot)
