"""Training of AnchorNet; reproducible bit for bit, and resumable."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
import torch
from numpy.typing import NDArray

from crowdbot.core import InputError, did_you_mean, from_attributes, stream
from crowdbot.prediction.pretrained_weights import STEP
from crowdbot.prediction.training.loop import Trainable
from crowdbot.prediction.training.samples import Samples
from crowdbot.prediction.training.torch_backend import to_tensors, torch_device
from crowdbot.typing import Floats

from .agent_frame import (
    AGENT_FEATURES,
    NEIGHBOR_FEATURES,
    PREDICTED_ROWS,
    REACH,
    SPEED_CLASSES,
    heading_vectors,
    rotate,
    speed_class,
)
from .anchors import cluster_centers
from .filtered_line import LINE_SHARE
from .forward_pass import feature_limit, network_output
from .own_weights import load_start_weights
from .training_data import (
    GENERAL,
    NO_AUGMENTATION,
    Augmentation,
    TrainingBatch,
    TrainingSet,
    make_batch,
    training_set_of,
)

Numbers = dict[str, NDArray[Any]]

UPDATES = 4000
"""Optimizer steps of the shipped leave-one-out weights, which are the averaged weights after the last step."""
ADAPTING = 3e-4
"""Learning rate of a training that starts from other weights."""
RANK = 6
"""Number of coefficients of a residual; the reconstruction error is about 2 cm."""


@dataclasses.dataclass(frozen=True)
class AnchorTraining:
    """Training settings of AnchorNet.

    Fields:
        people: number of people per batch.
        width, social: sizes of the hidden layers, and of the neighbor features.
        count: number of futures.
        rate, decay, warm: learning rate, weight decay, number of warm-up updates.
        average: factor of the moving average of the weights.
        apart: initial weight of the mean error of all futures, decreasing to 0; it prevents unused futures.
        choice: weight of the cross-entropy of the probabilities with a soft assignment to the nearest future.
        single: weight of the error of the single trajectory.
        likely: weight of the likelihood under the mixture, which trains probabilities and spreads only.
        seed: random seed.
        variation: data augmentation.
        reach: largest distance of a neighbor [m], which also bounds the features; inf: 12 neighbors at any distance
            and unbounded features.
        line: share of the filtered line in the single trajectory of people who walk straight with a noisy track,
            between 0 and 1.
    """

    people: int = 256
    width: int = 256
    social: int = 64
    count: int = 20
    rate: float = 1e-3
    decay: float = 1e-4
    warm: int = 200
    average: float = 0.999
    apart: float = 0.05
    choice: float = 0.1
    single: float = 0.5
    likely: float = 0.02
    seed: int = 0
    variation: Augmentation = dataclasses.field(default_factory=Augmentation)
    reach: float = math.inf
    line: float = 0.0

    def __post_init__(self) -> None:
        if not self.reach > 0.0:
            raise InputError(f"anchor-net: reach = {self.reach} m must be above 0")
        if not 0.0 <= self.line <= 1.0:
            raise InputError(f"anchor-net: line = {self.line} must be between 0 and 1")


PRESETS = {"shipped": AnchorTraining(), "general": AnchorTraining(reach=REACH, line=LINE_SHARE, variation=GENERAL)}
"""Recipes: of the leave-one-out weights, and for other places and trackers."""


def learner(
    settings: str | None,
    values: Mapping[str, str],
    samples: Samples,
    watched: Samples,
    seed: int,
    device: str,
    start: str = "",
) -> AnchorNetTraining:
    """Return an AnchorNet ready to train, from the options of the command line.

    Args:
        settings: name of the preset: ``shipped``, the recipe of the leave-one-out weights (default), or ``general``,
            with bounded features and augmentation for other places and trackers.
        values: settings that differ from the preset, including those of the augmentation, as text.
        samples, watched: training data and validation data.
        seed: random seed.
        device: ``cpu`` or ``cuda``.
        start: weights from which the training starts, see :func:`.load_start_weights`; empty: random weights. They
            determine the sizes, the reach and the line; the learning rate is :data:`ADAPTING` unless it is given.

    Raises:
        InputError: a name or value is unknown, or the samples do not have 8 + 12 rows of 0.4 s in metres.
    """
    if settings not in (None, *PRESETS):
        raise InputError(f"anchor-net: unknown settings {settings!r}{did_you_mean(str(settings), [*PRESETS])}; they"
                         f" are {' or '.join(PRESETS)}")  # fmt: skip
    preset = PRESETS[settings or "shipped"]
    varied = {field.name for field in dataclasses.fields(Augmentation)}
    plain = {name.replace("-", "_"): value for name, value in values.items()}
    given = from_attributes(Augmentation, {name: value for name, value in plain.items() if name in varied})
    variation = dataclasses.replace(preset.variation, **_named(given, plain))
    how = from_attributes(AnchorTraining, {name: value for name, value in plain.items() if name not in varied})
    found = load_start_weights(start) if start else None
    preset = preset if found is None else dataclasses.replace(preset, rate=ADAPTING, **_sizes(found))
    how = dataclasses.replace(preset, **_named(how, plain) | {"seed": seed, "variation": variation})
    return AnchorNetTraining(
        how, training_set_of(samples), training_set_of(watched, reverse=False), samples.names, device, found
    )


def _sizes(start: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """Return the settings that weights determine."""
    return {
        "width": start["own_1_bias"].size, "social": start["near_2_bias"].size, "count": len(start["centres"]),
        "reach": feature_limit(dict(start)), "line": float(start.get("line_share", 0.0)),
    }  # fmt: skip


def _named(settings: Any, names: Mapping[str, str]) -> dict[str, Any]:
    """Return the settings that were given by name."""
    return {field.name: getattr(settings, field.name) for field in dataclasses.fields(settings) if field.name in names}


def shapes_of(material: TrainingSet, count: int = 20, seed: int = 0) -> Numbers:
    """Return ``basis [6, 24]``, ``centres [count, 6]``, their ``share`` and ``spread [6]`` of training residuals."""
    if len(material) < count:
        raise InputError(f"{len(material)} people are too few to train {count} futures")
    past = material.people.past
    step = past[:, -1] - past[:, -2]
    missed = rotate(
        material.ahead - step[:, None] * np.arange(1.0, PREDICTED_ROWS + 1.0)[:, None], heading_vectors(past)
    )
    both = np.concatenate([missed, missed * np.array([1.0, -1.0])]).reshape(-1, 2 * PREDICTED_ROWS)
    _, vectors = np.linalg.eigh(both.T @ both)
    basis = vectors[:, ::-1][:, :RANK].T
    basis = basis * np.where(basis[np.arange(RANK), np.abs(basis).argmax(axis=1)] < 0.0, -1.0, 1.0)[:, None]
    points = both @ basis.T
    found, share = cluster_centers(points, count, seed)
    return {"basis": basis, "centres": found, "spread": points.std(axis=0), "share": share}


def network(how: AnchorTraining) -> Any:
    """Return the layers as a torch module; :func:`outputs` evaluates them."""
    W, S, K = how.width, how.social, how.count
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(how.seed)
        layers = _layers(W, S, K)
    with torch.no_grad():
        layers["out"].weight.mul_(0.1)
        layers["out"].bias.zero_()
    return layers


def _layers(W: int, S: int, K: int) -> Any:
    layers: Any = torch.nn.ModuleDict(
        {
            "own_1": torch.nn.Linear(AGENT_FEATURES, W), "own_2": torch.nn.Linear(W, W),
            "query": torch.nn.Linear(W, S),
            "near_1": torch.nn.Linear(NEIGHBOR_FEATURES, S), "near_2": torch.nn.Linear(S, S),
            "both_1": torch.nn.Linear(W + S, W), "both_2": torch.nn.Linear(W, W),
            "out": torch.nn.Linear(W, RANK * K + K + 2 * RANK),
        }
    )  # fmt: skip
    layers.register_parameter("nobody", torch.nn.Parameter(torch.zeros(S)))
    layers.register_parameter("alone", torch.nn.Parameter(torch.zeros(S)))
    layers.register_parameter("width", torch.nn.Parameter(torch.full((K, RANK), -1.0)))
    return layers


def outputs(layers: Any, own: Any, company: Any, there: Any) -> Any:
    """Return ``[N, 20 * 6 + 20 + 6 + 6]``: residuals of all futures, their scores, the single residual, and spreads."""
    hidden = torch.relu(layers["own_2"](torch.relu(layers["own_1"](own))))
    near = torch.relu(layers["near_2"](torch.relu(layers["near_1"](company))))  # [N, M, S]
    query = layers["query"](hidden)
    score = (near * query[:, None]).sum(2) / near.shape[2] ** 0.5
    score = torch.where(there, score, -torch.inf)
    empty = (query * layers.nobody).sum(1, keepdim=True) / near.shape[2] ** 0.5
    share = torch.softmax(torch.cat([score, empty], 1), 1)
    seen = (share[:, :-1, None] * near).sum(1) + share[:, -1:] * layers.alone
    both = torch.relu(layers["both_1"](torch.cat([hidden, seen], 1)))
    return layers["out"](torch.relu(layers["both_2"](both)))


class AnchorNetTraining(Trainable):
    """AnchorNet with its training data; see :class:`~crowdbot.prediction.Trainable`.

    With ``check_every`` equal to the number of updates, the averaged weights after the last update are used.
    Probabilities and spreads are calibrated on the validation data.

    Args:
        config: settings.
        material: training data.
        watched: validation data, also used to calibrate the probabilities.
        names: names of the training recordings.
        device: ``cpu`` or ``cuda``.
        start: weights from which the training starts; None: random ones. Their anchors are kept.

    Raises:
        InputError: the sizes of the settings are not those of ``start``.
    """

    kind: ClassVar[str] = "anchor-net"

    def __init__(
        self, config: AnchorTraining, material: TrainingSet, watched: TrainingSet, names: Sequence[str] = (),
        device: str = "cpu", start: Mapping[str, NDArray[Any]] | None = None,
    ) -> None:  # fmt: skip
        self.device = torch_device(device)
        self.config, self.material, self.watched = config, material, watched
        self.data = f"{material.digest}-{watched.digest}"
        self.facts = {"dt": STEP, "units": "m", "learned": list(names)}
        self.shapes = shapes_of(material, config.count, config.seed) if start is None else _anchors_of(start, config)
        self.fixed = {
            name: torch.tensor(values, dtype=torch.float32, device=self.device) for name, values in self.shapes.items()
        }
        self.layers = network(config).to(self.device)
        if start is not None:
            self.data += f"-{_digest(start)}"
            self.layers.load_state_dict(_tensors_of(start, self.layers.state_dict()))
        self.mean = {name: value.detach().clone() for name, value in self.layers.state_dict().items()}
        self.optimiser = torch.optim.AdamW(self.layers.parameters(), lr=config.rate, weight_decay=config.decay)

    def batches(self, rng: np.random.Generator) -> list[Any]:
        # placeholders for the batches of an epoch; each update draws random people
        del rng
        return [None] * -(-len(self.material) // self.config.people)

    def update(self, batch: Any, rng: np.random.Generator, number: int, total: int) -> Mapping[str, float]:
        # run one update; people and their augmentation are drawn from a stream given by the seed and the number
        del batch, rng
        how, own = self.config, stream(self.config.seed, "batch", number)
        shown = make_batch(
            self.material, own.integers(0, len(self.material), how.people), how.variation, own, how.reach
        )
        for group in self.optimiser.param_groups:
            group["lr"] = how.rate * _rate_factor(number, total, how)
        loss = _loss(self.layers, self.fixed, shown, how, 1.0 - number / total)
        self.optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.layers.parameters(), 1.0)
        self.optimiser.step()
        share = min(how.average, (1.0 + number) / (10.0 + number))
        with torch.no_grad():
            for name, value in self.layers.state_dict().items():
                self.mean[name].lerp_(value, 1.0 - share)
        return {"loss": float(loss.detach())}

    def check(self) -> Mapping[str, float]:
        numbers = self.numbers()
        own, company, there, missed = make_batch(
            self.watched, np.arange(len(self.watched)), NO_AUGMENTATION, stream(0, "check"), self.config.reach
        )
        found = network_output(numbers, own, company, there)
        K = self.config.count
        bend = numbers["centres"] + found[:, : RANK * K].reshape(-1, K, RANK) * numbers["spread"]
        lone = found[:, RANK * K + K : RANK * K + K + RANK] * numbers["spread"]
        paths = np.concatenate([bend, lone[:, None]], axis=1) @ numbers["basis"]
        away = np.linalg.norm(paths.reshape(len(missed), K + 1, PREDICTED_ROWS, 2) - missed[:, None], axis=3)
        ade, fde = away.mean(axis=2), away[:, :, -1]
        nearest = {"ade": ade[:, :K].min(axis=1), "fde": fde[:, :K].min(axis=1), "single": ade[:, K]}
        return {name: float(values.mean()) for name, values in nearest.items()}

    def numbers(self) -> Numbers:
        """Return the averaged weights before the calibration."""
        found = self.shapes | _plain(self.mean)
        bounded = np.isfinite(self.config.reach)
        if bounded or self.config.line > 0.0:  # bounded weights fall back on the line, even if its share is 0
            found["line_share"] = np.array(self.config.line)
        return found | ({"reach": np.array(self.config.reach)} if bounded else {})

    def weights(self) -> Mapping[str, Any]:
        # averaged weights with probabilities calibrated on the validation data
        return calibrate_confidence(self.numbers(), self.watched)

    def state(self) -> Mapping[str, Any]:
        return {
            "layers": dict(self.layers.state_dict()), "optimiser": self.optimiser.state_dict(), "mean": self.mean,
        }  # fmt: skip

    def restore(self, state: Mapping[str, Any]) -> None:
        kept = to_tensors(dict(state), self.device)
        self.layers.load_state_dict(kept["layers"])
        self.optimiser.load_state_dict(kept["optimiser"])
        self.mean = kept["mean"]


def _anchors_of(start: Mapping[str, NDArray[Any]], how: AnchorTraining) -> Numbers:
    """Return the anchors of weights."""
    own = {name: getattr(how, name) for name in _sizes(start)}
    if own != _sizes(start):
        raise InputError(f"anchor-net: the settings {own} are not those of the start weights, {_sizes(start)}")
    share = start.get("share", np.full(how.count, 1.0 / how.count))
    return {"share": share} | {name: start[name] for name in ("basis", "centres", "spread")}


def _tensors_of(start: Mapping[str, NDArray[Any]], layers: Mapping[str, Any]) -> dict[str, Any]:
    """Return weights as a state of the layers, the inverse of :func:`_plain`."""
    found = {name: start[name.replace(".", "_")] for name in layers}
    return {
        name: torch.tensor(values.T if name.endswith(".weight") else values, dtype=torch.float32)
        for name, values in found.items()
    }


def _digest(start: Mapping[str, NDArray[Any]]) -> str:
    found = hashlib.blake2b(digest_size=6)
    for name in sorted(start):
        found.update(np.ascontiguousarray(start[name]).tobytes())
    return found.hexdigest()


def _rate_factor(update: int, total: int, how: AnchorTraining) -> float:
    if update < how.warm:
        return (update + 1) / how.warm
    done = (update - how.warm) / max(1, total - how.warm)
    return float(0.5 + 0.5 * np.cos(np.pi * done))


def _loss(layers: Any, fixed: dict[str, Any], shown: TrainingBatch, how: AnchorTraining, early: float) -> Any:
    """Return the loss of one batch; ``early`` decreases from 1 to 0 over the training."""
    K = how.count
    device = fixed["basis"].device
    own, company, missed = (torch.from_numpy(np.ascontiguousarray(v)).float().to(device)
                            for v in (shown.own, shown.company, shown.missed))  # fmt: skip
    found = outputs(layers, own, company, torch.from_numpy(shown.there).to(device))
    N = len(found)
    bend = fixed["centres"] + found[:, : RANK * K].reshape(N, K, RANK) * fixed["spread"]
    score, single, wide = found[:, RANK * K :].split([K, RANK, RANK], dim=1)
    away = (bend @ fixed["basis"]).reshape(N, K, PREDICTED_ROWS, 2) - missed[:, None]
    distance = (away.square().sum(3) + 1e-8).sqrt()
    mean, end = distance.mean(2), distance[:, :, -1]
    error = mean + 0.5 * end
    best = mean.min(1).values + 0.5 * end.min(1).values
    with torch.no_grad():
        warmth = 0.1 + 0.2 * error.min(1, keepdim=True).values
        target = torch.softmax(-error / warmth, 1)
        truth = missed.reshape(N, 2 * PREDICTED_ROWS) @ fixed["basis"].T
    log_share = torch.log_softmax(score, 1)
    one = ((single * fixed["spread"]) @ fixed["basis"]).reshape(N, PREDICTED_ROWS, 2) - missed
    lone = (one.square().sum(2) + 1e-8).sqrt()
    log_spread = (layers.width + wide[:, None]).clamp(-6.0, 2.0)
    z = (truth[:, None] - bend.detach()) / fixed["spread"] * torch.exp(-log_spread)
    density = torch.logsumexp(log_share - (0.5 * z.square() + log_spread).sum(2), 1)
    return (
        best.mean()
        + how.apart * early * error.mean()
        - how.choice * (target * log_share).sum(1).mean()
        + how.single * (lone.mean(1) + 0.5 * lone[:, -1]).mean()
        - how.likely * density.clamp(min=-50.0).mean()
    )


def _plain(mean: dict[str, Any]) -> Numbers:
    """Return the layers as arrays; the weight of a layer is ``[inputs, outputs]``."""
    numbers = {}
    for name, value in mean.items():
        array = value.cpu().numpy().astype(np.float64)
        numbers[name.replace(".", "_")] = array.T.copy() if name.endswith(".weight") else array
    return numbers


TEMPERATURES = np.exp(np.linspace(-3.0, 1.5, 91))
WIDENINGS = np.exp(np.linspace(-2.5, 1.5, 81))
FEW = 200
"""Minimum number of people per speed class; below it, all people are used."""
WORST = -50.0
"""Lower bound of log-densities, to limit the influence of outliers."""


def calibrate_confidence(numbers: Numbers, material: TrainingSet) -> Numbers:
    """Return the weights with ``temperature`` and ``widening`` for each speed class.

    The temperature divides the logits of the probabilities, the widening multiplies the spreads. Both maximize the
    likelihood of validation data: of the nearest future, and of the truth under the mixture.
    """
    held = {name: np.asarray(values, dtype=np.float64) for name, values in numbers.items()}
    own, company, there, missed = make_batch(
        material, np.arange(len(material)), NO_AUGMENTATION, stream(0, "calibrated"), feature_limit(held)
    )
    out = network_output(held, own, company, there)
    K, D = held["centres"].shape
    bend = held["centres"] + out[:, : D * K].reshape(-1, K, D) * held["spread"]
    score, spread = out[:, D * K : D * K + K], np.clip(held["width"] + out[:, None, -D:], -6.0, 2.0)
    nearest = np.array([_nearest(item @ held["basis"], truth) for item, truth in zip(bend, missed, strict=True)])
    truth = missed.reshape(len(missed), -1) @ held["basis"].T
    z2 = ((truth[:, None] - bend) / held["spread"] * np.exp(-spread)) ** 2
    kind = speed_class(material.people.past)
    temperature, widening = [], []
    for bin_ in range(len(SPEED_CLASSES) + 1):
        who = np.flatnonzero(kind == bin_)
        who = who if len(who) >= FEW else np.arange(len(kind))
        warmth = _temperature(score[who], nearest[who])
        temperature.append(warmth)
        widening.append(_widening(_log_share(score[who] / warmth), z2[who], spread[who]))
    return numbers | {"temperature": np.asarray(temperature), "widening": np.asarray(widening)}


def _nearest(path: Floats, truth: Floats) -> int:
    away = path.reshape(-1, PREDICTED_ROWS, 2) - truth
    return int(np.argmin(np.sqrt((away**2).sum(axis=2)).mean(axis=1)))


def _temperature(score: Floats, nearest: NDArray[np.int64]) -> float:
    row = np.arange(len(score))
    return float(min(TEMPERATURES, key=lambda t: -_log_share(score / t)[row, nearest].mean()))


def _widening(log_share: Floats, z2: Floats, spread: Floats) -> float:
    def negative_log_likelihood(width: float) -> float:
        each = log_share - (0.5 * z2 / width**2 + spread + np.log(width)).sum(axis=2)
        top = each.max(axis=1)
        return float(-np.maximum(top + np.log(np.exp(each - top[:, None]).sum(axis=1)), WORST).mean())

    return float(min(WIDENINGS, key=negative_log_likelihood))


def _log_share(score: Floats) -> Floats:
    top = score.max(axis=1, keepdims=True)
    return np.asarray(score - top - np.log(np.exp(score - top).sum(axis=1, keepdims=True)))
