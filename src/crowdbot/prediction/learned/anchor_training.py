"""Training of the anchor network: a few minutes on one core, the same bits for the same seed, stopped and gone on with.

The numbers that come out are those that :class:`~crowdbot.prediction.AnchorNet` reads.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, stream
from crowdbot.core.errors import MissingExtra
from crowdbot.prediction.anchors import centres
from crowdbot.prediction.own_frame import AHEAD, COMPANY, INPUTS, forward, turned

from .anchor_data import Batch, Material, Variation, batch

__all__ = ["AnchorTraining", "network", "outputs", "shapes_of", "train"]

Floats = NDArray[np.float64]
Numbers = dict[str, NDArray[Any]]

KEPT_EVERY = 500
"""Updates after which the state is written."""
RANK = 6
"""Numbers that a bend is made of; they reconstruct what constant velocity misses to about 2 cm."""


@dataclasses.dataclass(frozen=True)
class AnchorTraining:
    """How the anchor network is trained.

    Fields:
        updates: steps of the optimiser; the last weights are taken, averaged over the last thousand, none is picked.
        people: in one batch.
        width, social: numbers in a hidden layer, and about a neighbour.
        count: futures.
        rate, decay, warm: learning rate, weight decay, updates until the full rate.
        average: of the weights.
        apart: weight of the mean error of all futures at the begin, falling to 0; it keeps every future alive.
        choice: weight of the cross-entropy of the probabilities against a soft nearest future.
        single: weight of the error of the single answer.
        likely: weight of the likelihood under the mixture, which trains probabilities and spreads only.
        seed: of everything that is drawn.
        variation: of the people.
    """

    updates: int = 4000
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
    variation: Variation = dataclasses.field(default_factory=Variation)


def shapes_of(material: Material, count: int = 20, seed: int = 0) -> Numbers:
    """Return ``basis [6, 24]``, ``centres [count, 6]`` and ``spread [6]`` of what constant velocity misses."""
    if len(material) < count:
        raise InputError(f"{len(material)} people are too few to learn {count} futures from")
    past = material.people.past
    step = past[:, -1] - past[:, -2]
    missed = turned(material.ahead - step[:, None] * np.arange(1.0, AHEAD + 1.0)[:, None], forward(past))
    both = np.concatenate([missed, missed * np.array([1.0, -1.0])]).reshape(-1, 2 * AHEAD)
    _, vectors = np.linalg.eigh(both.T @ both)
    basis = vectors[:, ::-1][:, :RANK].T
    basis = basis * np.where(basis[np.arange(RANK), np.abs(basis).argmax(axis=1)] < 0.0, -1.0, 1.0)[:, None]
    points = both @ basis.T
    found, _ = centres(points, count, seed)
    return {"basis": basis, "centres": found, "spread": points.std(axis=0)}


def network(how: AnchorTraining) -> Any:
    """Return the layers, a torch module; what they give is turned into futures by :func:`_losses`."""
    import torch

    W, S, K = how.width, how.social, how.count
    torch.manual_seed(how.seed)
    layers: Any = torch.nn.ModuleDict(
        {
            "own_1": torch.nn.Linear(INPUTS, W), "own_2": torch.nn.Linear(W, W),
            "query": torch.nn.Linear(W, S), "near_1": torch.nn.Linear(COMPANY, S), "near_2": torch.nn.Linear(S, S),
            "both_1": torch.nn.Linear(W + S, W), "both_2": torch.nn.Linear(W, W),
            "out": torch.nn.Linear(W, RANK * K + K + 2 * RANK),
        }
    )  # fmt: skip
    with torch.no_grad():
        layers["out"].weight.mul_(0.1)
        layers["out"].bias.zero_()
    layers.register_parameter("nobody", torch.nn.Parameter(torch.zeros(S)))
    layers.register_parameter("alone", torch.nn.Parameter(torch.zeros(S)))
    layers.register_parameter("width", torch.nn.Parameter(torch.full((K, RANK), -1.0)))
    return layers


def outputs(layers: Any, own: Any, company: Any, there: Any) -> Any:
    """Return ``[N, 20 * 6 + 20 + 6 + 6]``: bends of all futures, their scores, the single bend, and spreads."""
    import torch

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


def train(
    material: Material,
    how: AnchorTraining | None = None,
    progress: Callable[[int, float], None] | None = None,
    keep: Path | None = None,
) -> Numbers:
    """Return the trained numbers, those of :func:`shapes_of` among them.

    Args:
        material: people to learn from.
        how: None means the defaults.
        progress: told the update and the loss, every hundred updates.
        keep: file of the state, written every :data:`KEPT_EVERY` updates; training goes on from it when it exists.

    Raises:
        MissingExtra: PyTorch is not installed.
        InputError: the state in ``keep`` belongs to another training.
    """
    try:
        import torch
    except ImportError:
        raise MissingExtra("learned prediction", "learn") from None
    before = torch.get_num_threads()
    torch.set_num_threads(1)  # sums are then made in one order
    try:
        return _trained(material, how or AnchorTraining(), progress, keep)
    finally:
        torch.set_num_threads(before)


def _trained(
    material: Material, how: AnchorTraining, progress: Callable[[int, float], None] | None, keep: Path | None
) -> Numbers:
    import torch

    shapes = shapes_of(material, how.count, how.seed)
    fixed = {name: torch.tensor(values, dtype=torch.float32) for name, values in shapes.items()}
    layers = network(how)
    mean = {name: value.detach().clone() for name, value in layers.state_dict().items()}
    optimiser = torch.optim.AdamW(layers.parameters(), lr=how.rate, weight_decay=how.decay)
    state = {"layers": layers, "optimiser": optimiser}
    first = _resumed(state, mean, keep, _mark(material, how))
    for update in range(first, how.updates):
        rng = stream(how.seed, "batch", update)
        shown = batch(material, rng.integers(0, len(material), how.people), how.variation, rng)
        for group in optimiser.param_groups:
            group["lr"] = how.rate * _pace(update, how)
        loss = _loss(layers, fixed, shown, how, 1.0 - update / how.updates)
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(layers.parameters(), 1.0)
        optimiser.step()
        share = min(how.average, (1.0 + update) / (10.0 + update))
        with torch.no_grad():
            for name, value in layers.state_dict().items():
                mean[name].lerp_(value, 1.0 - share)
        if progress is not None and (update + 1) % 100 == 0:
            progress(update + 1, float(loss.detach()))
        if keep is not None and (update + 1) % KEPT_EVERY == 0:
            _kept(state, mean, keep, update + 1, _mark(material, how))
    return shapes | _plain(mean)


def _pace(update: int, how: AnchorTraining) -> float:
    if update < how.warm:
        return (update + 1) / how.warm
    done = (update - how.warm) / max(1, how.updates - how.warm)
    return float(0.5 + 0.5 * np.cos(np.pi * done))


def _loss(layers: Any, fixed: dict[str, Any], shown: Batch, how: AnchorTraining, early: float) -> Any:
    """Return the loss of one batch; ``early`` falls from 1 to 0 over the training."""
    import torch

    K = how.count
    own, company, missed = (torch.from_numpy(np.ascontiguousarray(v)).float()
                            for v in (shown.own, shown.company, shown.missed))  # fmt: skip
    found = outputs(layers, own, company, torch.from_numpy(shown.there))
    N = len(found)
    bend = fixed["centres"] + found[:, : RANK * K].reshape(N, K, RANK) * fixed["spread"]
    score, single, wide = found[:, RANK * K :].split([K, RANK, RANK], dim=1)
    away = (bend @ fixed["basis"]).reshape(N, K, AHEAD, 2) - missed[:, None]
    distance = (away.square().sum(3) + 1e-8).sqrt()
    mean, end = distance.mean(2), distance[:, :, -1]
    error = mean + 0.5 * end
    best = mean.min(1).values + 0.5 * end.min(1).values
    with torch.no_grad():
        warmth = 0.1 + 0.2 * error.min(1, keepdim=True).values
        target = torch.softmax(-error / warmth, 1)
        truth = missed.reshape(N, 2 * AHEAD) @ fixed["basis"].T
    log_share = torch.log_softmax(score, 1)
    one = ((single * fixed["spread"]) @ fixed["basis"]).reshape(N, AHEAD, 2) - missed
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
    found = {}
    for name, value in mean.items():
        array = value.numpy().astype(np.float64)
        found[name.replace(".", "_")] = array.T.copy() if name.endswith(".weight") else array
    return found


def _mark(material: Material, how: AnchorTraining) -> str:
    return f"{len(material)} people, {float(material.ahead.sum()):.6f}, {how}"


def _kept(state: dict[str, Any], mean: dict[str, Any], keep: Path, update: int, mark: str) -> None:
    """Write the state so that a kill at any moment leaves a whole file."""
    import torch

    new = keep.with_suffix(".new")
    torch.save({n: s.state_dict() for n, s in state.items()} | {"mean": mean, "update": update, "mark": mark}, new)
    os.replace(new, keep)


def _resumed(state: dict[str, Any], mean: dict[str, Any], keep: Path | None, mark: str) -> int:
    """Load the state when there is one; return the update to go on with."""
    import torch

    if keep is None or not keep.exists():
        return 0
    found = torch.load(keep, weights_only=True)
    if found["mark"] != mark:
        raise InputError(f"{keep} holds a training of other people or settings; remove it, or name another file")
    for name, part in state.items():
        part.load_state_dict(found[name])
    mean.update(found["mean"])
    return int(found["update"])
