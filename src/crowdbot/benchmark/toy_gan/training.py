"""Training of Social Ways on the toy data, with different subsystems of its GAN."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, did_you_mean, stream
from crowdbot.metrics import earth_mover_distance, mode_count, mode_coverage, nearest_neighbor_accuracy
from crowdbot.prediction import SocialWaysConfig, SocialWaysTraining

from .methods import METHODS
from .toy_data import ToyData

__all__ = ["ToyTraining", "compare_distributions", "gan_config", "real_paths", "sample_futures"]

COMPARED, REPEATS = 20, 10
"""Number of real and drawn paths per group in one comparison, and number of comparisons."""
WITHIN = 0.05
"""Maximum distance [m] of a path from the center of its mode; adjacent modes are 0.1 m apart."""


def gan_config(method: str, toy: ToyData, values: Mapping[str, Any] | None = None) -> SocialWaysConfig:
    """Return the settings of a method: no neighbors, world frame.

    Raises:
        InputError: the method is unknown.
    """
    if method not in METHODS:
        raise InputError(f"unknown method {method!r}{did_you_mean(method, METHODS)}; known are {', '.join(METHODS)}")
    plain = SocialWaysConfig(
        use_info_loss=False, social=False, frame="world", residual=False, observe=toy.observe, predict=toy.predict
    )
    return dataclasses.replace(plain, **{**METHODS[method], **(values or {})})


class ToyTraining(SocialWaysTraining):
    """Training of a method on the toy data, monitored by metrics of distributions."""

    kind: ClassVar[str] = "social-ways"

    def __init__(self, toy: ToyData, config: SocialWaysConfig, seed: int = 0, device: str = "cpu") -> None:
        samples = toy.samples(stream(seed, "toy"))
        super().__init__(config, samples, samples, seed, device)
        self.toy, self.seed = toy, seed

    def check(self) -> Mapping[str, float]:
        """Return 1-NN accuracy, EMD [m], number of modes and coverage, means over groups and repeats."""
        real = real_paths(self.toy, stream(self.seed, "real"))
        return compare_distributions(
            self.toy, real, sample_futures(self, COMPARED * REPEATS, stream(self.seed, "drawn"))
        )


def real_paths(toy: ToyData, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw real future paths with random modes for every group, ``[groups, draws, T, 2]`` [m]."""
    count = COMPARED * REPEATS
    mode = rng.integers(len(toy.modes), size=(toy.groups, count))
    return toy.paths(rng, count)[np.arange(toy.groups)[:, None], mode, np.arange(count), toy.observe :]


def compare_distributions(toy: ToyData, real: NDArray[np.float64], drawn: NDArray[np.float64]) -> dict[str, float]:
    """Return metrics of drawn paths against the same number of real paths, means over the groups.

    ``nearest_neighbor`` and ``emd`` compare all 200 paths of a group. The keys with ``_20`` compare 20 paths at a time,
    ten times, as the report does; real paths against real paths then have an EMD of 0.027 m, since the number of paths
    per mode is random. ``whole`` is the share of groups with all modes.
    """
    split = (toy.groups, REPEATS, COMPARED, toy.predict, 2)
    few = real.reshape(split), drawn.reshape(split)
    middles = toy.middles()[:, :, toy.observe :]
    modes = mode_count(drawn, middles, WITHIN)
    measures = {
        "nearest_neighbor": nearest_neighbor_accuracy(real, drawn),
        "emd": earth_mover_distance(real, drawn),
        "modes": modes,
        "coverage": mode_coverage(drawn, middles, WITHIN),
        "whole": modes == len(toy.modes),
        "nearest_neighbor_20": nearest_neighbor_accuracy(*few),
        "emd_20": earth_mover_distance(*few),
    }
    return {name: float(np.mean(values)) for name, values in measures.items()}


def sample_futures(model: ToyTraining, draws: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw future paths of each group with the averaged generator, ``[groups, draws, T, 2]`` [m]."""
    past = model.toy.middles()[:, 0, : model.toy.observe, None]  # [groups, T, 1, 2]
    futures = model.sample_futures(past, draws, rng)  # [K, groups, T, 1, 2]
    return np.ascontiguousarray(futures[:, :, :, 0].swapaxes(0, 1))
