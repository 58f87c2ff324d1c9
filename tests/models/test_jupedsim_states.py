"""Models of JuPedSim: steps from 1000 random states in a room with a pillar, kept in ``golden/jupedsim_states.npz``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from engine_steps import report

from crowdbot.core import Scene, Walls
from crowdbot.models import (
    AnticipationVelocity,
    CollisionFreeSpeed,
    CollisionFreeSpeedV3,
    GeneralizedCentrifugalForce,
    WarpDriver,
)

FILE = Path(__file__).with_name("golden") / "jupedsim_states.npz"
ROOM = [(-6.0, -6.0), (-6.0, 6.0), (6.0, 6.0), (6.0, -6.0)]  # clockwise: people are inside
PILLAR = [(0.5, 0.0), (1.5, 0.5), (1.0, 1.5), (0.0, 1.0)]
DT = 0.01


@pytest.fixture(scope="module")
def states():
    with np.load(FILE, allow_pickle=False) as file:
        return dict(file)


def scene_of(states):
    return Scene.of(
        states["position"],
        states["velocity"],
        heading=states["heading"],
        radius=0.2,
        goal=states["goal"],
        preferred_speed=states["preferred_speed"],
        max_speed=9.0,
        walls=Walls.of([ROOM, PILLAR]),
    )


def errors(states, name, scene, step):
    """Return the distance of every position after every step from that of the engine, ``[E, steps, A]`` [m]."""
    found = []
    for after in np.moveaxis(states[name], 1, 0):
        scene = step(scene)
        found.append(np.linalg.norm(scene.position - after, axis=-1))
    return np.stack(found, axis=1)


@pytest.mark.parametrize(
    ("name", "model", "least"),
    [
        ("CollisionFreeSpeedModelV2", CollisionFreeSpeed(), 1.0),
        ("CollisionFreeSpeedModelV3", CollisionFreeSpeedV3(), 1.0),
        # the engine misses the pillar between two people now and then
        ("GeneralizedCentrifugalForceModel", GeneralizedCentrifugalForce(), 0.995),
    ],
)
def test_positions_are_those_of_jupedsim(states, name, model, least):
    error = errors(states, name, scene_of(states), lambda scene: model.step(scene, DT))
    share, _, _ = report(f"random states, {name}", error, 1e-9, "m")
    assert share >= least


def test_positions_of_warp_driver_are_those_of_jupedsim(states):
    # the engine shifts the points of a path by uniform numbers of a Mersenne Twister with the seed 42
    raw = np.random.MT19937()
    raw._legacy_seeding(42)
    draws = raw.random_raw(2 * 20 * states["position"].shape[1]).astype(float).reshape(-1, 20, 2)
    shift = 0.1 * (draws[..., 0] + 2.0**32 * draws[..., 1]) / 2.0**64 - 0.05
    shift = np.tile(shift, (len(states["position"]), 1))
    model = WarpDriver()
    error = errors(states, "WarpDriverModel", scene_of(states), lambda s: s.advance(model.plan(s, DT, shift), DT))
    share, _, _ = report("random states, WarpDriverModel", error, 1e-9, "m")
    assert share == 1.0


def test_positions_of_anticipation_velocity_are_those_of_jupedsim(states):
    # without those whom the engine leads around a corner of the pillar; it ignores the ends of walls
    name = "AnticipationVelocityModel"
    scene = scene_of(states | {part: states[f"{name}.{part}"] for part in ("position", "velocity", "heading")})
    error = errors(states, name, scene, lambda scene: AnticipationVelocity().step(scene, DT))
    error = error[:, 0][states[f"{name}.sees_goal"]]
    share, _, _ = report(f"random states, {name}", error, 1e-9, "m")
    assert error.size > 900
    assert share > 0.995
