"""Learned predictors in ``crowdbot bench``: windows per second, seconds per epoch, memory, prediction time."""

from __future__ import annotations

import functools
import subprocess
import sys
from collections.abc import Callable

import numpy as np

from crowdbot.core import InputError, stream
from crowdbot.data import Windows
from crowdbot.prediction import (
    AnchorNet,
    Predictor,
    Samples,
    SocialWays,
    Trainable,
    make_learner,
    torch_module,
    torch_threads,
)

from .measurement import Gauge, Measurement

UPDATES = 4
SIZES = (1, 1, 2, 2, 3, 3, 4, 5, 8, 20, 35)
"""Number of people in synthetic scenes: mostly a few, sometimes dozens, as in recordings."""
MEMORY = 2000.0
"""Maximum memory of training [MB]."""
PEOPLE = 50


def learning_measurements() -> dict[str, Callable[[], Measurement | Gauge]]:
    """Return name -> function that prepares the measurement.

    >>> "learn-anchor-net" in learning_measurements()
    True
    """
    result: dict[str, Callable[[], Measurement | Gauge]] = {}
    for name in ("anchor-net", "social-ways"):
        result[f"learn-{name}"] = functools.partial(_learning, name)
        result[f"epoch-{name}"] = functools.partial(_epoch, name)
        result[f"predict-{name}-{PEOPLE}"] = functools.partial(_live, name)
    result["learn-memory"] = _memory
    return result


def synthetic_samples(scenes: int = 440) -> Samples:
    """Return windows of 8 + 12 rows with slowly turning people, as many as in usual recordings."""
    torch_module()  # raises MissingExtra if it is not installed
    rng = stream(0, "learning")
    count = np.tile(SIZES, -(-scenes // len(SIZES)))[:scenes]
    people, first = int(count.sum()), np.concatenate([[0], np.cumsum(count)])
    angle = rng.uniform(-np.pi, np.pi, (people, 1)) + np.cumsum(rng.normal(0.0, 0.1, (people, 20)), axis=1)
    step = 0.4 * rng.normal(1.2, 0.3, (people, 1, 1)) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    place = rng.uniform(-6.0, 6.0, (people, 1, 2)) + np.cumsum(step, axis=1)
    yes = np.ones((people, 20), dtype=bool)
    return Samples(place, yes, yes[:, 0], first, np.zeros(scenes, dtype=np.int64), ("made",), 8, 0.4)


def untrained_network(name: str, samples: Samples) -> Trainable:
    """Return a network ready to train with the settings of the shipped weights."""
    settings: tuple[str | None, dict[str, str]] = (None, {})
    if name == "social-ways":
        settings = "variety", {"variety-draws": "6"}
    return make_learner(name, *settings, samples, samples.subsample(20))


def _learning(name: str) -> Measurement:
    samples = synthetic_samples()
    model = untrained_network(name, samples)
    share = UPDATES / len(model.batches(stream(0, "order")))
    words = f"3000 windows per minute; one PyTorch thread, {len(samples)} windows of 1 to {max(SIZES)} people"
    return Measurement("windows/s", share * len(samples), functools.partial(_updates, model, UPDATES), words, 50.0)


def _epoch(name: str) -> Gauge:
    """Time one epoch of the synthetic windows."""
    import time

    samples = synthetic_samples()
    model = untrained_network(name, samples)
    _updates(model, 1)
    begin = time.perf_counter()
    _updates(model, len(model.batches(stream(0, "order"))))
    words = f"60 s for {len(samples)} windows with {samples.people} futures"
    return Gauge("s/epoch", time.perf_counter() - begin, words, 60.0)


def _updates(model: Trainable, count: int) -> None:
    with torch_threads():
        batches = model.batches(stream(0, "order"))
        for number in range(count):
            model.update(batches[number % len(batches)], stream(0, "update", number), number, 1000)


def _live(name: str) -> Measurement:
    """Predict one window of fifty people, 20 futures each."""
    past = _square()
    predictor: Predictor = AnchorNet() if name == "anchor-net" else SocialWays()
    if name == "social-ways":
        torch_module()
    words = f"20 ms for a window of {PEOPLE} people with 20 futures of 12 rows"
    return Measurement("windows/s", 1.0, lambda: predictor.predict(past, 12, 20), words, 50.0)


def _square() -> Windows:
    rng = stream(0, "square")
    place = rng.uniform(-6.0, 6.0, (1, PEOPLE, 2)) + 0.4 * np.arange(8.0)[:, None, None] * rng.normal(
        0.0, 0.9, (1, PEOPLE, 2)
    )
    here, nobody = np.ones((1, 8, PEOPLE), dtype=bool), np.zeros((1, PEOPLE), dtype=bool)
    id, frame = np.arange(PEOPLE)[None], np.arange(8)[None]
    return Windows(place[None], here, nobody, nobody, id, frame, 0.4, "all", "square")


def _memory() -> Gauge:
    """Read the peak memory of a child process that trains Social Ways."""
    synthetic_samples(1)
    program = (
        "from crowdbot.benchmark.speed.learning import synthetic_samples, untrained_network, _updates\n"
        "from crowdbot.core import peak_memory\n"
        "_updates(untrained_network('social-ways', synthetic_samples()), 12)\n"
        "print(peak_memory() / 2**20)"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)  # noqa: S603
    if run.returncode:
        raise InputError(f"training in a child process failed: {run.stderr.strip().splitlines()[-1]}")
    return Gauge("MB", float(run.stdout), f"{MEMORY:.0f} MB for the training of Social Ways", MEMORY)
