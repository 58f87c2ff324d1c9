"""Random forecasts and futures that the tests of scores share."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from crowdbot.core import stream
from crowdbot.data import Forecast, Windows


def case(seed: int, W: int = 3, K: int = 4, T: int = 5, A: int = 6) -> tuple[Forecast, Windows]:
    """Random forecasts and futures that end early, have holes, padding and a robot."""
    rng = stream(seed, "displacement")
    present = rng.random((W, T, A)) < 0.8
    length = rng.integers(0, T + 1, (W, A))
    present &= np.arange(T)[:, None] < length[:, None]
    robot = np.zeros((W, A), dtype=bool)
    robot[:, 0] = True
    scored = present.any(axis=1) & ~robot & (rng.random((W, A)) < 0.8)
    position = np.where(present[..., None], rng.normal(size=(W, T, A, 2)), 0.0)
    id = np.tile(np.arange(A), (W, 1))
    frame = np.tile(np.arange(T), (W, 1))
    future = Windows(position, present, scored, robot, id, frame, 0.4, "partial", "test")
    guess = rng.normal(size=(W, K, T, A, 2)) * 0.5
    return Forecast.of(guess, np.ones((W, A), dtype=bool), 0.4, "guess"), future


def weighted(forecast: Forecast, seed: int) -> Forecast:
    """The same samples with random weights, some of them 0, the last always."""
    rng = stream(seed, "weights")
    W, K = forecast.weight.shape
    weight = rng.random((W, K)) * (rng.random((W, K)) < 0.7)
    weight[:, 0] += 0.1
    weight[:, -1] = 0.0
    return dataclasses.replace(forecast, weight=weight / weight.sum(axis=1, keepdims=True))


def without_padding(forecast: Forecast, future: Windows) -> list[tuple[Forecast, Windows]]:
    """Every window on its own, with only those samples that weigh something."""
    return [
        (
            dataclasses.replace(
                forecast[w : w + 1],
                position=forecast.position[w : w + 1, forecast.weight[w] > 0.0],
                weight=forecast.weight[w : w + 1, forecast.weight[w] > 0.0],
            ),
            future[w : w + 1],
        )
        for w in range(len(future))
    ]


def moved(forecast: Forecast, future: Windows, angle: float, shift: float) -> tuple[Forecast, Windows]:
    """Both in a world that is turned and shifted."""
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    return (
        dataclasses.replace(forecast, position=forecast.position @ turn + [shift, -shift]),
        dataclasses.replace(future, position=future.position @ turn + [shift, -shift]),
    )


def shuffled(forecast: Forecast, future: Windows, seed: int) -> tuple[Forecast, Windows, np.ndarray]:
    """Both with people and samples in another order, and the order of the people."""
    rng = stream(seed, "order")
    people, samples = rng.permutation(future.id.shape[1]), rng.permutation(forecast.samples)
    return (
        dataclasses.replace(
            forecast,
            position=forecast.position[:, samples][..., people, :],
            weight=forecast.weight[:, samples],
            valid=forecast.valid[:, people],
        ),
        dataclasses.replace(
            future,
            position=future.position[:, :, people],
            present=future.present[..., people],
            scored=future.scored[:, people],
            robot=future.robot[:, people],
            id=future.id[:, people],
        ),
        people,
    )


def scene(truth: object, samples: object, weight: object = None) -> tuple[Forecast, Windows]:
    """One window: truth ``[T, A, 2]``, samples ``[K, T, A, 2]``, everyone there and scored."""
    there, guess = np.array(truth, dtype=float)[None], np.array(samples, dtype=float)[None]
    here = np.ones(there.shape[:3], dtype=bool)
    future = Windows(
        there, here, here[:, 0], ~here[:, 0], np.arange(there.shape[2])[None], np.arange(there.shape[1])[None], 0.4,
        "all", "test",
    )  # fmt: skip
    K = guess.shape[1]
    shares = np.full((1, K), 1.0 / K) if weight is None else np.array([weight], dtype=float)
    return Forecast(guess, shares, here[:, 0], 0.4, "guess"), future
