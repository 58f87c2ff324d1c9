"""AnchorNet: a small network that predicts residuals around 20 anchors, and joint futures without collisions."""

from __future__ import annotations

import dataclasses
import math
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, Paper, did_you_mean
from crowdbot.data import Forecast, Windows
from crowdbot.prediction.constant import ConstantVelocity, SampledConstantVelocity
from crowdbot.prediction.joint_futures import coordinate_draws, coordinate_modes, separate_people, stop_at_walls
from crowdbot.prediction.predictor import Predictor, window_streams
from crowdbot.prediction.pretrained_weights import (
    ALL,
    AUTO,
    STEP,
    Numbers,
    check_fold,
    fold_of,
    incompatibility,
    load_pretrained,
    read_weights,
)
from crowdbot.prediction.training.checkpoint import load_checkpoint

from .agent_frame import (
    HISTORY,
    PREDICTED_ROWS,
    agent_features,
    agent_histories,
    heading_vectors,
    rotate,
    speed_class,
)
from .anchors import CHAI, resample_paths, scatter_to_slots
from .layers import attend, dense
from .network_shapes import wrong_array
from .out_of_distribution import out_of_distribution

__all__ = ["AnchorNet", "Modes", "feature_limit", "network_output", "reach_of"]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

SAMPLES = ("set", "draws")
MOST_AT_ONCE = 2048
"""Number of people per network evaluation."""
WALL = 0.02
"""Factor on the probability of a future that crosses a wall."""
DRAWS = 20
"""Draws are combined into joint futures in blocks of this size; the first draws do not depend on K."""


class Modes(NamedTuple):
    """Individual futures of N people and their probabilities."""

    path: Floats
    """``[N, K, T, 2]`` [m] futures, relative to the last position."""
    probability: Floats
    """``[N, K]`` calibrated probabilities that a future is the nearest to the truth, in decreasing order."""
    single: Floats
    """``[N, T, 2]`` [m] single trajectory."""
    window: Integers
    slot: Integers


class _Bends(NamedTuple):
    """Output of the network for N people, in their frames."""

    mode: Floats
    """``[N, K, 6]``."""
    probability: Floats
    single: Floats
    """``[N, 6]``."""
    spread: Floats
    """``[N, K, 6]`` standard deviation around each future."""
    heading: Floats
    step: Floats
    window: Integers
    slot: Integers
    foreign: Floats
    """``[N]`` out-of-distribution score."""


@dataclass(frozen=True)
class AnchorNet(Predictor):
    """Learned predictor with 20 weighted futures per person, a single trajectory for K = 1, or random draws.

    A multilayer perceptron reads the last 8 positions of a person in the person's frame and, through attention, the 12
    nearest neighbors (default weights: within 8 m), including the plans of robots. For each of 20 anchors (see
    :class:`~crowdbot.prediction.Anchors`) it predicts a correction with 6 coefficients and the probability to be the
    nearest future. A separate output serves K = 1. The training includes missing rows, noise, late tracks and identity
    switches. Futures that cross a wall get a low probability and stop at the wall.

    The futures of the people in a window are combined into joint futures with few collisions; remaining ones are
    removed by offsets of some centimetres. Each person keeps all 20 futures; the most probable ones are in the first
    joint futures.

    People who are unlike the training data have a high ``out_of_distribution`` score in the forecast. The corrections
    of the network are multiplied by 1 minus the score: at a score of 1 the set is the fixed anchors, and the single
    trajectory is constant velocity. Leave-one-out weights have no score.

    Fields:
        fold: shipped weights: trained without a place (``eth``, ``hotel``, ``univ``, ``zara1``, ``zara2``), with
            ``all`` places, or ``auto``: without the place of the recording, by its name, else ``all``.
        sample: ``set``: the weighted futures, at most 20, and the single trajectory for K = 1; ``draws``: any number
            of independent random draws.
        file: own weights from ``crowdbot train anchor-net``, instead of the shipped ones.
        contact: minimum distance between people of a joint future [m]; 0 disables joint futures.

    Forecasts are equivariant to translations and rotations, except for people who never moved. Other time steps up to
    0.7 s are interpolated; with longer ones, or in pixels, a baseline is used, with a warning. Beyond 4.8 s the
    residual is constant. People observed once have a constant position.

    Paper: anchors, Chai et al. (2019), arXiv 1910.05449.
    """

    fold: str = AUTO
    sample: str = "set"
    file: str = ""
    contact: float = 0.25

    paper: ClassVar[Paper] = CHAI
    history: ClassVar[float] = HISTORY

    def __post_init__(self) -> None:
        check_fold(self.fold)
        if self.sample not in SAMPLES:
            raise InputError(
                f"anchor-net: sample {self.sample!r}{did_you_mean(self.sample, SAMPLES)}; it is set or draws"
            )
        if not 0.0 <= self.contact < math.inf:
            raise InputError(f"anchor-net: contact = {self.contact} m must be finite and at least 0")

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return the forecast, see :meth:`Predictor.predict`."""
        self.check(past, steps, samples)
        why = incompatibility(past)
        if why:
            one: Predictor = ConstantVelocity() if samples == 1 else SampledConstantVelocity()
            warnings.warn(f"anchor-net: {why}; {one.name} is used instead", stacklevel=2)
            return one.predict(past, steps, samples, rng)
        numbers = self._numbers(past)
        bends = _around_walls(_bends(numbers, past), numbers, past)
        if self.sample == "draws":
            return self._draws(past, steps, samples, rng, numbers, bends)
        if samples == 1:
            path = _path(numbers, bends, bends.single[:, None], past, steps)[0]
            place = scatter_to_slots(past, path, bends.window, bends.slot)
            return self._scored(past, separate_people(past, place, self.contact), bends)
        path = _path(numbers, bends, bends.mode, past, steps)[0]
        place = scatter_to_slots(past, path, bends.window, bends.slot)
        share = np.full((len(past), past.present.shape[2], path.shape[1]), 0.0)
        share[bends.window, bends.slot] = bends.probability
        place, weight = coordinate_modes(past, place, share, self.contact)
        weight = weight[:, :samples] / weight[:, :samples].sum(axis=1, keepdims=True)
        forecast = self._scored(past, separate_people(past, place[:, :samples], self.contact), bends)
        return dataclasses.replace(forecast, weight=weight)

    def _scored(self, past: Windows, place: Floats, bends: _Bends) -> Forecast:
        """Return the forecast with the out-of-distribution score of each person."""
        foreign = np.zeros((len(past), past.present.shape[2]))
        foreign[bends.window, bends.slot] = bends.foreign
        return dataclasses.replace(self.forecast(past, place), out_of_distribution=foreign)

    def modes(self, past: Windows, steps: int = PREDICTED_ROWS) -> Modes:
        """Return the individual futures and probabilities of all agents present at the last row.

        Raises:
            InputError: the windows have pixels or too long time steps.
        """
        self.check(past, steps)
        why = incompatibility(past)
        if why:
            raise InputError(f"anchor-net: {why}")
        numbers = self._numbers(past)
        bends = _around_walls(_bends(numbers, past), numbers, past)
        path = _path(numbers, bends, bends.mode, past, steps)[0]
        single = _path(numbers, bends, bends.single[:, None], past, steps)[0][:, 0]
        return Modes(path, bends.probability, single, bends.window, bends.slot)

    def note(self, past: Windows) -> str:
        """Return a one-sentence remark on forecasts of such windows, or an empty string."""
        why = incompatibility(past)
        if why:
            return f"anchor-net: {why}; a baseline is used instead"
        if not self.file and self.fold == AUTO and fold_of(past.source) == ALL:
            return (
                f"anchor-net: {past.source} is not named after a training place; using the weights trained on all"
                " places; set fold if the recording is from one of them"
            ) + self._foreign_note(past)
        return self._foreign_note(past).removeprefix("; ")

    def _foreign_note(self, past: Windows) -> str:
        """Return how many people are unlike the training data; empty if fewer than 5 %."""
        numbers = self._numbers(past)
        people, window, _ = agent_histories(past)
        score = out_of_distribution(numbers, people.within(reach_of(numbers)), window)
        if np.mean(score > 0.5) < 0.05 or not len(score):
            return ""
        return (
            f"; {np.mean(score > 0.5):.0%} of the people of {past.source} are unlike the training data (score above"
            " 0.5): their forecasts are mostly constant velocity or the anchors"
        )

    def _numbers(self, past: Windows) -> Numbers:
        if not self.file:
            return load_pretrained("anchor-net", fold_of(past.source) if self.fold == AUTO else self.fold)
        return _own(self.file, Path(self.file).stat().st_mtime_ns if Path(self.file).is_file() else 0)

    def _draws(
        self, past: Windows, steps: int, samples: int, rng: np.random.Generator | None, numbers: Numbers, bends: _Bends
    ) -> Forecast:
        """Return independent draws of the individual mixtures, combined into joint futures."""
        blocks = -(-samples // DRAWS)
        N, K, D = bends.mode.shape
        which = np.zeros((N, blocks * DRAWS), dtype=np.int64)
        noise = np.zeros((N, blocks * DRAWS, D))
        ladder = np.cumsum(bends.probability, axis=1)
        order = np.lexsort((past.id[bends.window, bends.slot], bends.window))
        first = np.searchsorted(bends.window[order], np.arange(len(past) + 1))
        for window, own in enumerate(window_streams(rng, len(past))):
            who = order[first[window] : first[window + 1]]
            for block in range(blocks):
                part = slice(block * DRAWS, (block + 1) * DRAWS)
                level = own.random((len(who), DRAWS)) * ladder[who, -1:]
                which[who, part] = np.minimum((level[:, :, None] >= ladder[who, None]).sum(axis=2), K - 1)
                noise[who, part] = own.standard_normal((len(who), DRAWS, D))
        rows = np.arange(N)[:, None]
        middle = bends.mode[rows, which]
        bend = middle + bends.spread[rows, which] * noise
        if past.walls:  # draws that cross a wall are replaced by their mean
            _, through = _path(numbers, bends, bend, past)
            bend = np.where(through[..., None], middle, bend)
        path, _ = _path(numbers, bends, bend, past, steps)
        place = coordinate_draws(past, scatter_to_slots(past, path, bends.window, bends.slot), self.contact, DRAWS)
        return self._scored(past, separate_people(past, place[:, :samples], self.contact), bends)


def network_output(numbers: Numbers, own: Floats, company: Floats, there: NDArray[np.bool_]) -> Floats:
    """Return the network output ``[N, O]``: residuals of all futures, scores, single residual, spreads."""

    def layer(x: Floats, name: str, rectify: bool = True) -> Floats:
        return np.asarray(dense(np.ascontiguousarray(x), numbers[f"{name}_weight"], numbers[f"{name}_bias"], rectify))

    N, M, _ = company.shape
    hidden = layer(layer(own, "own_1"), "own_2")
    near = layer(layer(company.reshape(N * M, -1), "near_1"), "near_2").reshape(N, M, -1)
    query = layer(hidden, "query", rectify=False)
    seen = attend(query, near, np.ascontiguousarray(there), numbers["nobody"], numbers["alone"])
    both = layer(np.concatenate([hidden, seen], axis=1), "both_1")
    return layer(layer(both, "both_2"), "out", rectify=False)


def reach_of(numbers: Numbers) -> float:
    """Return the largest distance of a neighbor that is read [m]; infinite for weights without the array ``reach``."""
    return float(numbers["reach"]) if "reach" in numbers else math.inf


def feature_limit(numbers: Numbers) -> float:
    """Return the bound of the features [m]; infinite for weights that learned from unbounded ones."""
    return math.inf if "unbounded" in numbers else reach_of(numbers)


def _own(file: str, changed: int) -> Numbers:
    known = _OWN.get(file)
    if known is None or known[0] != changed:
        numbers = read_weights(Path(file))
        if "content" in numbers:  # a checkpoint of crowdbot train
            numbers = _checkpoint_weights(file)
        wrong = wrong_array(numbers)
        if wrong:
            raise DataError(f"{file} is not a file of AnchorNet weights: {wrong}")
        _OWN[file] = known = changed, numbers
    return known[1]


_OWN: dict[str, tuple[int, Numbers]] = {}


def _checkpoint_weights(file: str) -> Numbers:
    """Return the weights in a checkpoint."""
    try:
        weights = load_checkpoint(file, "anchor-net")["weights"]
        numbers = {name: np.asarray(values, dtype=np.float64) for name, values in weights.items()}
    except (KeyError, TypeError, ValueError, AttributeError):
        raise DataError(f"{file} has no AnchorNet weights; train again") from None
    bad = next((name for name, values in numbers.items() if not np.all(np.isfinite(values))), None)
    if bad is not None:
        raise DataError(f"{file}: {bad} has values that are not finite; the file is damaged")
    return numbers


def _bends(numbers: Numbers, past: Windows) -> _Bends:
    people, window, slot = agent_histories(past)
    people = people.within(reach_of(numbers))
    foreign = out_of_distribution(numbers, people, window)
    heading = heading_vectors(people.past)
    K, D = numbers["centres"].shape
    out = np.zeros((len(window), K * D + K + 2 * D))
    for first in range(0, len(window), MOST_AT_ONCE):
        part = slice(first, first + MOST_AT_ONCE)
        some = people.at(part)
        out[part] = network_output(numbers, *agent_features(some, heading[part], feature_limit(numbers)), some.there)
    own = (1.0 - foreign)[:, None]  # share of the network; the rest is the anchors, or constant velocity
    mode = numbers["centres"] + own[..., None] * out[:, : K * D].reshape(-1, K, D) * numbers["spread"]
    kind = speed_class(people.past)
    score = out[:, K * D : K * D + K] / numbers["temperature"][kind, None]
    probability = np.exp(score - score.max(axis=1, keepdims=True, initial=-np.inf))
    total = np.cumsum(probability, axis=1)[:, -1:]  # summation order independent of the batch
    probability = probability / total
    if "share" in numbers:
        probability = own * probability + (1.0 - own) * numbers["share"]
    spread = np.exp(np.clip(numbers["width"] + out[:, None, K * D + K + D :], -6.0, 2.0))
    spread = spread * numbers["spread"] * numbers["widening"][kind, None, None]
    order = np.argsort(-probability, axis=1, kind="stable")
    row = np.arange(len(order))[:, None]
    walked = (people.seen.sum(axis=1) > 1)[:, None]
    return _Bends(
        np.where(walked[..., None], mode[row, order], 0.0),
        probability[row, order],
        np.where(walked, own * out[:, K * D + K : K * D + K + D] * numbers["spread"], 0.0),
        np.where(walked[..., None], spread[row, order], 0.0),
        heading,
        people.past[:, -1] - people.past[:, -2],
        window,
        slot,
        foreign,
    )


def _around_walls(bends: _Bends, numbers: Numbers, past: Windows) -> _Bends:
    """Return the output with a low probability of futures that cross a wall, and a single trajectory that does not."""
    if not past.walls:
        return bends
    _, hit = _path(numbers, bends, bends.mode, past)
    probability = np.where(hit, WALL, 1.0) * bends.probability
    probability = probability / np.cumsum(probability, axis=1)[:, -1:]
    order = np.argsort(-probability, axis=1, kind="stable")
    row = np.arange(len(order))[:, None]
    mode = bends.mode[row, order]
    _, lone = _path(numbers, bends, bends.single[:, None], past)
    single = np.where(lone & ~hit.all(axis=1, keepdims=True), mode[:, 0], bends.single)
    return bends._replace(
        mode=mode, probability=probability[row, order], spread=bends.spread[row, order], single=single
    )


def _path(
    numbers: Numbers, bends: _Bends, bend: Floats, past: Windows, steps: int = 0
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return displacements ``[N, K, T, 2]`` [m] that stop at walls, and a mask ``[N, K]`` of the stopped ones.

    Without ``steps``, the horizon is that of the training (12 steps of 0.4 s): probabilities do not depend on the
    requested horizon.
    """
    basis = numbers["basis"]
    away = np.zeros((*bend.shape[:2], basis.shape[1]))
    for d in range(len(basis)):  # summation order independent of the batch
        away += bend[..., d, None] * basis[d]
    local = away.reshape(*bend.shape[:2], PREDICTED_ROWS, 2)
    time = (steps, past.dt) if steps else (PREDICTED_ROWS, STEP)
    path = resample_paths(rotate(local, bends.heading, back=True), bends.step, *time)
    return stop_at_walls(past, path, bends.window, bends.slot)
