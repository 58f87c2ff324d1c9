"""AnchorNet: a small network that predicts residuals around 20 anchors, and joint futures without collisions."""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, did_you_mean
from crowdbot.data import Forecast, Windows
from crowdbot.prediction.constant import ConstantVelocity, SampledConstantVelocity
from crowdbot.prediction.joint_futures import coordinate_draws, coordinate_modes, separate_people, stop_at_walls
from crowdbot.prediction.predictor import Predictor, window_streams
from crowdbot.prediction.pretrained_weights import (
    AUTO,
    OPEN,
    STEP,
    Numbers,
    check_fold,
    fold_of,
    incompatibility,
    load_pretrained,
)
from crowdbot.typing import Floats, Ints

from .agent_frame import (
    HISTORY,
    PREDICTED_ROWS,
    ROWS,
    AgentHistories,
    agent_features,
    agent_histories,
    heading_vectors,
    rotate,
    speed_class,
)
from .anchors import CHAI, resample_paths, scatter_to_slots
from .filtered_line import filtered_lines
from .forward_pass import feature_limit, network_output, reach_of
from .mixture import future_covariances, placed_covariances
from .own_weights import load_own_weights, load_reaction
from .plan_reaction import PlanReaction, Walks, reaction_displacements

SAMPLES = ("set", "draws")
MOST_AT_ONCE = 2048
"""Number of people per network evaluation."""
WALL = 0.02
"""Factor on the probability of a future that crosses a wall."""
SLOW = 0.5
"""Distance walked in 2.8 s [m] below which the futures of a person are combined by probability, not by anchor."""
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
    window: Ints
    slot: Ints


class _Bends(NamedTuple):
    """Output of the network for N people, in their frames."""

    mode: Floats
    """``[N, K, 6]``."""
    probability: Floats
    single: Floats
    """``[N, 6]``; with a share of the filtered line, see :mod:`.filtered_line`."""
    spread: Floats
    """``[N, K, 6]`` standard deviation around each future."""
    heading: Floats
    step: Floats
    window: Ints
    slot: Ints
    foreign: Floats
    """``[N]`` out-of-distribution score."""
    anchor: Ints
    """``[N, K]`` anchor of each future."""
    slow: NDArray[np.bool_]
    """``[N]``, whether a person walked less than :data:`SLOW`."""


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
    trajectory is the line of Kalman filters whose noise is fitted to the track. The line also has a share of up to 0.8
    in the single trajectory of people who walk straight with a noisy track. The single trajectory of people whose last
    three displacements are equal is constant velocity. Leave-one-out weights have none of these.

    Fields:
        fold: shipped weights: trained without a place (``eth``, ``hotel``, ``univ``, ``zara1``, ``zara2``), with
            ``all`` places, ``open``: with data whose terms allow it (UCY, corridors and bottlenecks of the Jülich
            archive, simulated crowds with and without robots; made by ``python studies/train_anchor_net.py train DATA
            OUT --fold open``), or ``auto``: without the place of the recording, by its name, else ``open``.
        sample: ``set``: the weighted futures, at most 20, and the single trajectory for K = 1; ``draws``: any number
            of independent random draws.
        file: own weights from ``crowdbot train anchor-net``, instead of the shipped ones.
        reaction: how people react to a robot whose plan is known: ``open``, the shipped coefficients (see
            :class:`.PlanReaction`), ``none``, or a file of own ones.
        contact: minimum distance between the centres of people of a joint future, also between rows [m], where the
            windows have no radii; 0 disables joint futures.

    The forecast has the covariance of the mixture of futures around the single trajectory; with K > 1 also the
    Gaussian mixture itself (:meth:`.Forecast.mixture`), which is whole with K = 20. Where the windows have covariances
    of the measured positions, the filters and these covariances use them.

    Forecasts are equivariant to translations and rotations, except for people who never moved. Other time steps up to
    0.7 s are interpolated; with longer ones, or in pixels, a baseline is used, with a warning. Beyond 4.8 s the
    residual is constant. People observed once have a constant position.

    Paper: anchors, Chai et al. (2019), arXiv 1910.05449.

    >>> from crowdbot.data import Trajectories
    >>> rows = range(20)
    >>> tracks = Trajectories([7] * 20, rows, [0.5 * row for row in rows], [0.0] * 20, row_rate=2.5)
    >>> past, _ = tracks.windows(observe=8, predict=12)
    >>> AnchorNet().predict(past, steps=12, samples=20).position.shape
    (1, 20, 12, 1, 2)
    """

    fold: str = AUTO
    sample: str = "set"
    file: str = ""
    contact: float = 0.25
    reaction: str = OPEN

    paper: ClassVar[Paper] = CHAI
    history: ClassVar[float] = HISTORY
    batched = draws = learned = True

    def __post_init__(self) -> None:
        check_fold(self.fold)
        if self.sample not in SAMPLES:
            raise InputError(
                f"anchor-net: sample {self.sample!r}{did_you_mean(self.sample, SAMPLES)}; it is set or draws"
            )
        if not 0.0 <= self.contact < math.inf:
            raise InputError(f"anchor-net: contact = {self.contact} m must be finite and at least 0")

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
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
            return _with_uncertainty(
                self.forecast(past, separate_people(past, place, self.contact)), past, numbers, bends
            )
        pairing, modes = _pairing(bends, samples), _path(numbers, bends, bends.mode, past, steps)[0]
        path = modes[np.arange(len(modes))[:, None], pairing]
        place = scatter_to_slots(past, path, bends.window, bends.slot)
        share = np.full((len(past), past.present.shape[2], path.shape[1]), 0.0)
        share[bends.window, bends.slot] = np.take_along_axis(bends.probability, pairing, axis=1)
        place, weight, order = coordinate_modes(past, place, share, self.contact)
        weight = weight[:, :samples] / weight[:, :samples].sum(axis=1, keepdims=True)
        forecast = self.forecast(past, separate_people(past, place[:, :samples], self.contact))
        forecast, futures = _with_mixture(forecast, past, numbers, bends, modes)
        chosen = np.take_along_axis(pairing, order[bends.window, :samples, bends.slot], axis=1)
        futures = placed_covariances(past, futures, chosen, bends.window, bends.slot)
        own = np.take_along_axis(share.swapaxes(1, 2), order[:, :samples], axis=1)
        total = own.sum(axis=1, keepdims=True)
        own = own / np.where(total > 0.0, total, 1.0)
        return dataclasses.replace(forecast, weight=weight, person_weight=own, future_covariance=futures)

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
        why = incompatibility(past)
        if why:
            return f"anchor-net: {why}; a baseline is used instead"
        if not self.file and self.fold == AUTO and fold_of(past.source) == OPEN:
            return (
                f"anchor-net: {past.source} is not named after a training place; using the weights trained on UCY, the"
                " Jülich archive and simulated crowds; set fold if the recording is from one of the places"
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
            " 0.5): their forecasts are mostly a fitted line or the anchors"
        )

    def _numbers(self, past: Windows) -> Numbers:
        if self.file:
            numbers = load_own_weights(self.file)
        else:
            numbers = load_pretrained("anchor-net", fold_of(past.source) if self.fold == AUTO else self.fold)
        return numbers if past.plan is None else numbers | load_reaction(self.reaction)

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
        forecast = self.forecast(past, separate_people(past, place[:, :samples], self.contact))
        return _with_uncertainty(forecast, past, numbers, bends)


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
    own = (1.0 - foreign)[:, None]  # share of the network; the rest is the anchors, or the filtered line
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
    single = out[:, K * D + K : K * D + K + D] * numbers["spread"]
    if "line_share" in numbers:
        line, straight = filtered_lines(people.past, people.seen, people.noise, heading, numbers["basis"])
        single = line + own * (1.0 - numbers["line_share"] * straight[:, None]) * (single - line)
        single = (1.0 - steadiness(people)[:, None]) * single
    return _Bends(
        np.where(walked[..., None], mode[row, order], 0.0),
        probability[row, order],
        np.where(walked, single, 0.0),
        np.where(walked[..., None], spread[row, order], 0.0),
        heading,
        people.past[:, -1] - people.past[:, -2],
        window,
        slot,
        foreign,
        order,
        np.hypot(*people.past[:, 0].T) < SLOW,
    )


def _pairing(bends: _Bends, samples: int) -> Ints:
    """Return the order ``[N, K]`` in which the futures of people are combined into joint futures.

    People in a window often deviate in the same way: they walk in groups, or the recording has a wrong time base. If
    all futures are asked for, the same anchors of people who walk are combined; else the most probable ones.
    """
    N, K = bends.probability.shape
    rank = np.broadcast_to(np.arange(K), (N, K))
    if samples < K:
        return rank
    return np.where(bends.slow[:, None], rank, np.argsort(bends.anchor, axis=1))


def _with_uncertainty(forecast: Forecast, past: Windows, numbers: Numbers, bends: _Bends) -> Forecast:
    """Return the forecast with the covariance and the out-of-distribution score of each person."""
    return _with_mixture(forecast, past, numbers, bends, _path(numbers, bends, bends.mode, past, forecast.steps)[0])[0]


def _with_mixture(
    forecast: Forecast, past: Windows, numbers: Numbers, bends: _Bends, modes: Floats
) -> tuple[Forecast, Floats]:
    """Return the forecast with uncertainty, and the covariances ``[N, K, T, 2, 2]`` of the paths of all futures."""
    foreign = np.zeros((len(past), past.present.shape[2]))
    foreign[bends.window, bends.slot] = bends.foreign
    steps = forecast.steps
    middle = _path(numbers, bends, bends.single[:, None], past, steps)[0]
    own, whole = future_covariances(
        numbers["basis"], bends.probability, bends.spread, modes - middle, bends.heading, steps, past.dt
    )  # fmt: skip
    single = np.zeros((len(whole), 1), dtype=np.int64)
    covariance = placed_covariances(past, whole[:, None], single, bends.window, bends.slot)[:, 0]
    return dataclasses.replace(forecast, covariance=covariance, out_of_distribution=foreign), own


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
        mode=mode, probability=probability[row, order], spread=bends.spread[row, order], single=single,
        anchor=bends.anchor[row, order],
    )  # fmt: skip


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
    local = rotate(local, bends.heading, back=True)
    count, dt = (steps, past.dt) if steps else (PREDICTED_ROWS, STEP)
    path = resample_paths(local, bends.step, count, dt)
    reaction = None if past.plan is None else PlanReaction.of(numbers)
    if reaction is not None:
        shown, time = resample_paths(local, bends.step, PREDICTED_ROWS, STEP), dt * np.arange(1.0, count + 1.0)
        walks = Walks(bends.window, bends.slot, bends.heading, bends.step, shown)
        path = path + reaction_displacements(reaction, past, walks, time)
    return stop_at_walls(past, path, bends.window, bends.slot)


EVEN = (0.005, 0.015)
"""Deviation of a track from a straight line at constant speed [m]: even below the first, not even above the second."""
EVEN_SHARE = (0.1, 0.3)
"""Share of even tracks among the moving people of a window from which, and above which, all of them are foreign."""
FEWEST_EVEN = 3
"""Number of moving people in a window for which the share of even tracks counts."""
FAST = (1.6, 2.4)
"""Mean displacement in 0.4 s [m] from which, and above which, a person is foreign: 4 and 6 m/s."""
EQUAL = (0.0001, 0.0003)
"""Difference of the last displacements [m] below which a person is steady, and above which not at all."""
MOVING = 0.08
"""Displacement in 0.4 s below which a person does not count as moving [m]."""


def out_of_distribution(
    numbers: Mapping[str, NDArray[Any]], people: AgentHistories, window: NDArray[np.int64]
) -> Floats:
    """Return scores ``[N]`` between 0 (like the training data) and 1; 0 for the leave-one-out weights.

    Args:
        numbers: weights; those for other places have the array ``reach``.
        people: histories.
        window: ``[N]`` window of each person.

    The score is the largest of three: the speed above 4 m/s, the evenness of the person's track, and the share of even
    tracks in the window. No measured person walks in a straight line at constant speed to a few millimetres; simulated
    people do.
    """
    if "reach" not in numbers:
        return np.zeros(len(people.past))
    even, moves = _evenness(people)
    count = np.bincount(window, moves.astype(np.float64))
    share = np.bincount(window, np.where(moves, even, 0.0)) / np.maximum(count, 1.0)
    simulated = np.where(count >= FEWEST_EVEN, _ramp(share, *EVEN_SHARE), 0.0)
    fast = _ramp(np.hypot(*(people.past[:, -1] - people.past[:, 0]).T) / (ROWS - 1.0), *FAST)
    return np.asarray(np.max([even, simulated[window], fast], axis=0))


def steadiness(people: AgentHistories) -> Floats:
    """Return ``[N]``, between 0 and 1, whether the last three displacements of a person are equal, to 0.2 mm.

    Simulated people who walk or stand undisturbed do so, and people in some recordings whose tracks are interpolated or
    who stand. The last displacement then has no noise, and no learned correction is better on average.
    """
    change = np.diff(people.past[:, -4:], 2, axis=1)
    largest = np.sqrt(change[..., 0] ** 2 + change[..., 1] ** 2).max(axis=1)
    return np.where(people.seen[:, -4:].all(axis=1), 1.0 - _ramp(largest, *EQUAL), 0.0)


def _evenness(people: AgentHistories) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the evenness ``[N]`` of tracks of moving people, between 0 and 1, and who moves with all rows observed."""
    row = np.arange(ROWS) - 0.5 * (ROWS - 1)
    away = people.past - people.past.mean(axis=1, keepdims=True)
    step = (away * row[:, None]).sum(axis=1) / float((row * row).sum())
    rest = away - step[:, None] * row[:, None]
    deviation = np.sqrt((rest[..., 0] ** 2 + rest[..., 1] ** 2).mean(axis=1))
    moves = (np.hypot(step[:, 0], step[:, 1]) > MOVING) & people.seen.all(axis=1)
    return np.where(moves, 1.0 - _ramp(deviation, *EVEN), 0.0), moves


def _ramp(value: Floats, low: float, high: float) -> Floats:
    """Return 0 below ``low``, 1 above ``high`` and a smooth value between."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share))
