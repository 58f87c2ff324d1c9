"""AnchorNet: a small network that bends 20 anchors for each person, weighs them, and keeps joint futures apart."""

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
from crowdbot.prediction.joint_futures import before_walls, drawn_together, kept_apart, set_together
from crowdbot.prediction.predictor import Predictor, window_streams
from crowdbot.prediction.pretrained_weights import (
    ALL,
    AUTO,
    STEP,
    Numbers,
    check_fold,
    fold_of,
    learned,
    misfit,
    read_numbers,
)
from crowdbot.prediction.training.checkpoint import load_checkpoint

from .agent_frame import AHEAD, COMPANY, GAITS, INPUTS, features, forward, gait, people_of, turned
from .anchors import CHAI, scattered, spread_over_time
from .layers import attend, dense

__all__ = ["AnchorNet", "Modes", "network_output"]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

SAMPLES = ("set", "draws")
NEEDED = ("basis", "centres", "spread", "width", "temperature", "widening", "nobody", "alone", *(
    f"{layer}_{part}"
    for layer in ("own_1", "own_2", "query", "near_1", "near_2", "both_1", "both_2", "out")
    for part in ("weight", "bias")
))  # fmt: skip
MOST_AT_ONCE = 2048
"""People whose numbers are held at once."""
WALL = 0.02
"""What is left of the probability of a future that leads through a wall."""
DRAWS = 20
"""Draws are shared out among joint futures in blocks of so many, so that more draws do not change the first."""


class Modes(NamedTuple):
    """What is believed of N people, each for itself."""

    path: Floats
    """``[N, K, T, 2]`` [m] futures, from the last place."""
    probability: Floats
    """``[N, K]`` that each is the nearest to what will be, calibrated; the futures stand in this order."""
    single: Floats
    """``[N, T, 2]`` [m] the one answer."""
    window: Integers
    slot: Integers


class _Bends(NamedTuple):
    """What the network says of N people, in their own frames."""

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


@dataclass(frozen=True)
class AnchorNet(Predictor):
    """Learned: 20 futures of every person, their probabilities, one answer for who wants one, and real draws.

    A multilayer perceptron reads the last 8 places of a person in the own frame and, through attention, the 12 nearest
    others; of a robot with a plan it is told where it will be. It bends 20 anchors (see
    :class:`~crowdbot.prediction.Anchors`) in a space of 6 numbers, says how probable each is to be the nearest, and has
    an answer of its own for K = 1. Missing rows, noise, late tracks and switched identities were part of the training.
    Futures that lead through a wall of the map are made improbable afterwards, and end before it.

    People of a window belong together: who takes which of the own futures in which joint future is chosen so that
    they do not walk through each other, and what remains is moved aside by some centimetres. Every person still has
    all 20, the likeliest in the first joint futures.

    Fields:
        fold: which shipped weights are used: those learned without this place (``eth``, ``hotel``, ``univ``,
            ``zara1``, ``zara2``), with ``all`` of them, or ``auto``: without the place that the recording is named
            after, else ``all``.
        sample: what more than one sample is. ``set``: the fixed futures, weighed by how probable they are, at most
            20, and K = 1 is the single answer. ``draws``: as many independent draws of one future as are asked for.
        file: own weights, as ``crowdbot train anchor-net`` makes them, in place of the shipped ones.
        contact: people of one joint future stay so far apart [m]; 0 leaves everyone alone.

    Predictions commute with shifts and rotations of the world, except for who has never moved. Rows at other time
    steps up to 0.7 s are interpolated; with longer ones, or in pixels, a baseline answers and a warning says so.
    After 4.8 s the bend stays as it is. Somebody seen once stands.

    Paper: anchors, Chai et al. (2019), arXiv 1910.05449.
    """

    fold: str = AUTO
    sample: str = "set"
    file: str = ""
    contact: float = 0.25

    paper: ClassVar[Paper] = CHAI

    def __post_init__(self) -> None:
        check_fold(self.fold)
        if self.sample not in SAMPLES:
            raise InputError(
                f"anchor-net: sample {self.sample!r}{did_you_mean(self.sample, SAMPLES)}; it is set or draws"
            )
        if not 0.0 <= self.contact < math.inf:
            raise InputError(f"anchor-net: contact = {self.contact} m must be finite and at least 0")

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where people will be, see :meth:`Predictor.predict`."""
        self.check(past, steps, samples)
        why = misfit(past)
        if why:
            one: Predictor = ConstantVelocity() if samples == 1 else SampledConstantVelocity()
            warnings.warn(f"anchor-net: {why}; {one.name} answers instead", stacklevel=2)
            return one.predict(past, steps, samples, rng)
        numbers = self._numbers(past)
        bends = _around_walls(_bends(numbers, past), numbers, past)
        if self.sample == "draws":
            return self._draws(past, steps, samples, rng, numbers, bends)
        if samples == 1:
            path = _path(numbers, bends, bends.single[:, None], past, steps)[0]
            place = scattered(past, path, bends.window, bends.slot)
            return self.forecast(past, kept_apart(past, place, self.contact))
        path = _path(numbers, bends, bends.mode, past, steps)[0]
        place = scattered(past, path, bends.window, bends.slot)
        share = np.full((len(past), past.present.shape[2], path.shape[1]), 0.0)
        share[bends.window, bends.slot] = bends.probability
        place, weight = set_together(past, place, share, self.contact)
        weight = weight[:, :samples] / weight[:, :samples].sum(axis=1, keepdims=True)
        forecast = self.forecast(past, kept_apart(past, place[:, :samples], self.contact))
        return dataclasses.replace(forecast, weight=weight)

    def modes(self, past: Windows, steps: int = AHEAD) -> Modes:
        """Return the futures and probabilities of everyone there at the last row, each for itself.

        Raises:
            InputError: the windows do not fit what was learned.
        """
        self.check(past, steps)
        why = misfit(past)
        if why:
            raise InputError(f"anchor-net: {why}; there are no modes of it")
        numbers = self._numbers(past)
        bends = _around_walls(_bends(numbers, past), numbers, past)
        path = _path(numbers, bends, bends.mode, past, steps)[0]
        single = _path(numbers, bends, bends.single[:, None], past, steps)[0][:, 0]
        return Modes(path, bends.probability, single, bends.window, bends.slot)

    def note(self, past: Windows) -> str:
        """Return what a user should know of forecasts of such windows in one sentence, or nothing."""
        why = misfit(past)
        if why:
            return f"anchor-net: {why}; a baseline answers instead"
        if not self.file and self.fold == AUTO and fold_of(past.source) == ALL:
            return (
                f"anchor-net: {past.source} is not named after one of the five places it knows, so the weights learned"
                " at all of them, perhaps from this recording too, are used; name the place with fold when it is one"
            )
        return ""

    def _numbers(self, past: Windows) -> Numbers:
        if not self.file:
            return learned("anchor-net", fold_of(past.source) if self.fold == AUTO else self.fold)
        return _own(self.file, Path(self.file).stat().st_mtime_ns if Path(self.file).is_file() else 0)

    def _draws(
        self, past: Windows, steps: int, samples: int, rng: np.random.Generator | None, numbers: Numbers, bends: _Bends
    ) -> Forecast:
        """Return independent draws of everyone's own mixture, shared out so that people of one draw keep apart."""
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
        if past.walls:  # what scatters through a wall stays in the middle
            _, through = _path(numbers, bends, bend, past)
            bend = np.where(through[..., None], middle, bend)
        path, _ = _path(numbers, bends, bend, past, steps)
        place = drawn_together(past, scattered(past, path, bends.window, bends.slot), self.contact, DRAWS)
        return self.forecast(past, kept_apart(past, place[:, :samples], self.contact))


def network_output(numbers: Numbers, own: Floats, company: Floats, there: NDArray[np.bool_]) -> Floats:
    """Return what the last layer gives ``[N, O]``: bends of all futures, their scores, the single bend, spreads."""

    def layer(x: Floats, name: str, rectify: bool = True) -> Floats:
        return np.asarray(dense(np.ascontiguousarray(x), numbers[f"{name}_weight"], numbers[f"{name}_bias"], rectify))

    N, M, _ = company.shape
    hidden = layer(layer(own, "own_1"), "own_2")
    near = layer(layer(company.reshape(N * M, -1), "near_1"), "near_2").reshape(N, M, -1)
    query = layer(hidden, "query", rectify=False)
    seen = attend(query, near, np.ascontiguousarray(there), numbers["nobody"], numbers["alone"])
    both = layer(np.concatenate([hidden, seen], axis=1), "both_1")
    return layer(layer(both, "both_2"), "out", rectify=False)


def _own(file: str, changed: int) -> Numbers:
    known = _OWN.get(file)
    if known is None or known[0] != changed:
        numbers = read_numbers(Path(file))
        if "content" in numbers:  # what crowdbot train keeps
            weights = load_checkpoint(file, "anchor-net")["weights"]
            numbers = {name: np.asarray(values, dtype=np.float64) for name, values in weights.items()}
        missing = [name for name in NEEDED if name not in numbers]
        shapes = {"own_1_weight": INPUTS, "near_1_weight": COMPANY, "temperature": len(GAITS) + 1}
        wrong = [name for name, rows in shapes.items() if not missing and numbers[name].shape[:1] != (rows,)]
        if missing or wrong:
            what = f"it has no {missing[0]}" if missing else f"its {wrong[0]} is of another shape"
            raise DataError(f"{file} holds no weights of this network: {what}; train it with this version")
        _OWN[file] = known = changed, numbers
    return known[1]


_OWN: dict[str, tuple[int, Numbers]] = {}


def _bends(numbers: Numbers, past: Windows) -> _Bends:
    people, window, slot = people_of(past)
    heading = forward(people.past)
    K, D = numbers["centres"].shape
    out = np.zeros((len(window), K * D + K + 2 * D))
    for first in range(0, len(window), MOST_AT_ONCE):
        part = slice(first, first + MOST_AT_ONCE)
        some = people.at(part)
        out[part] = network_output(numbers, *features(some, heading[part]), some.there)
    mode = numbers["centres"] + out[:, : K * D].reshape(-1, K, D) * numbers["spread"]
    kind = gait(people.past)
    score = out[:, K * D : K * D + K] / numbers["temperature"][kind, None]
    probability = np.exp(score - score.max(axis=1, keepdims=True, initial=-np.inf))
    total = np.cumsum(probability, axis=1)[:, -1:]  # summed in one order, whatever the number of people
    probability = probability / total
    spread = np.exp(np.clip(numbers["width"] + out[:, None, K * D + K + D :], -6.0, 2.0))
    spread = spread * numbers["spread"] * numbers["widening"][kind, None, None]
    order = np.argsort(-probability, axis=1, kind="stable")
    row = np.arange(len(order))[:, None]
    walked = (people.seen.sum(axis=1) > 1)[:, None]
    return _Bends(
        np.where(walked[..., None], mode[row, order], 0.0),
        probability[row, order],
        np.where(walked, out[:, K * D + K : K * D + K + D] * numbers["spread"], 0.0),
        np.where(walked[..., None], spread[row, order], 0.0),
        heading,
        people.past[:, -1] - people.past[:, -2],
        window,
        slot,
    )


def _around_walls(bends: _Bends, numbers: Numbers, past: Windows) -> _Bends:
    """Return what is believed where there are walls: futures through them are hardly probable, no answer is one."""
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
    """Return displacements ``[N, K, T, 2]`` [m] of bends ``[N, K, 6]`` that end before walls, and which did not.

    Without ``steps`` they are the 12 of 0.4 s that were learned, so that what is believed does not depend on how far
    is asked.
    """
    basis = numbers["basis"]
    away = np.zeros((*bend.shape[:2], basis.shape[1]))
    for d in range(len(basis)):  # in one order, whatever the number of people
        away += bend[..., d, None] * basis[d]
    local = away.reshape(*bend.shape[:2], AHEAD, 2)
    time = (steps, past.dt) if steps else (AHEAD, STEP)
    path = spread_over_time(turned(local, bends.heading, back=True), bends.step, *time)
    return before_walls(past, path, bends.window, bends.slot)
