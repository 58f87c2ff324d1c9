"""Synthetic recovery: a crowd made by a model with known parameters is fitted back and foretold."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from crowdbot.calibration import Calibrator, resolve_model
from crowdbot.core import Scene, parameters, stream
from crowdbot.data import Windows
from crowdbot.metrics import score
from crowdbot.models import GroundTruth
from crowdbot.prediction import ConstantVelocity
from samples import sample

OBSERVE, PREDICT, DT, SUBSTEP = 8, 12, 0.4, 0.1


def sparse_crowd(name: str, W: int = 24, A: int = 8, side: float = 24.0) -> tuple[Windows, Windows, np.ndarray]:
    """Make windows of people who cross a square, with parameters up to 20 % off their defaults.

    Returns past, future and everyone's comfort speed ``[W, A]`` [m/s].
    """
    rng = stream(1, "made", name)
    start = rng.uniform(-side / 2.0, side / 2.0, (W, A, 2))
    angle = rng.uniform(0.0, 2.0 * np.pi, (W, A))
    speed = rng.uniform(0.9, 1.6, (W, A))
    velocity = speed[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    known = resolve_model(name)
    values = {p.name: float(np.clip(p.default * rng.uniform(0.8, 1.2), p.low, p.high)) for p in parameters(known)}
    model = dataclasses.replace(known, **values)
    scene = Scene.of(
        start, velocity, goal=start + 40.0 * velocity, preferred_speed=speed, radius=0.28,
        max_speed=np.maximum(2.0, 1.3 * speed),
    )  # fmt: skip
    for _ in range(20):  # they find their pace before anybody looks
        scene = model.step(scene, SUBSTEP)
    rows = OBSERVE + PREDICT
    position = np.zeros((W, rows, A, 2))
    for row in range(rows):
        position[:, row] = scene.position
        for _ in range(round(DT / SUBSTEP)):
            scene = model.step(scene, SUBSTEP)
    here, nobody = np.ones((W, rows, A), dtype=bool), np.zeros((W, A), dtype=bool)
    id, frame = np.tile(np.arange(A), (W, 1)), np.tile(np.arange(rows), (W, 1))
    whole = Windows(position, here, nobody, nobody, id, frame, DT, "all", "made")
    past, future = (
        dataclasses.replace(whole, position=position[:, part], present=here[:, part], frame=frame[:, part])
        for part in (slice(0, OBSERVE), slice(OBSERVE, rows))
    )
    return past, dataclasses.replace(future, scored=~nobody), speed


@pytest.mark.parametrize("name", sample(["orca", "social-force", "power-law", "boids"], ["social-force"]))
def test_a_made_crowd_is_fitted_back(name: str) -> None:
    past, future, speed = sparse_crowd(name)
    scheme = Calibrator(name, "progressive", "genetic", GroundTruth(past, future), budget=300, substep=SUBSTEP)
    fit = scheme.fit(past, seed=1)
    found = score(fit.predict(past, PREDICT), future)
    plain = score(ConstantVelocity().predict(past, PREDICT), future)
    comfort = fit.values[..., fit.space.names.index("preferred_speed")]
    print(f"{name}: ADE {found.ade:.4f} m held out (constant velocity {plain.ade:.4f}),")
    print(f"  comfort speed off by {np.quantile(np.abs(comfort / speed - 1.0), 0.9):.2%} for 90 % of people")
    assert found.ade < 0.05
    assert np.quantile(np.abs(comfort / speed - 1.0), 0.9) < 0.05
    assert abs(np.mean(comfort / speed) - 1.0) < 0.05
