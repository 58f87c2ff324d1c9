"""Training of ScanNetwork on generated scans, with PyTorch."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import check_number, stream
from crowdbot.prediction import torch_module, torch_threads
from crowdbot.typing import Floats

from .cutouts import SAMPLES, cut_windows
from .generated_scans import LabelledScan, generate_scan

HIDDEN = 64
"""Width of the two hidden layers."""
BATCH = 1024
RATE = 2e-3
"""Learning rate at the beginning; it falls to 0 along a cosine."""
SKIPPED = 0.75
"""Share of the beams on walls and furniture that is left out of the training."""
REACH = 12.0
"""Largest range of a trained beam [m]."""


class NetworkFit(NamedTuple):
    """Result of a training.

    Fields:
        file: the weights.
        beams: number of beams of the training.
        precision, recall: of beams of held-out scans at the probability 0.5.
        error: mean distance of the votes of people's beams from the centres [m].
    """

    file: Path
    beams: int
    precision: float
    recall: float
    error: float


def train_scan_network(
    file: Path | str,
    scans: int = 3000,
    epochs: int = 12,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> NetworkFit:
    """Train a network on generated scans, write its weights, and return its scores on scans of another seed.

    Args:
        file: file of the weights (.npz).
        scans: number of generated scans.
        epochs: passes over the scans.
        seed: seed of the scans and of the training.
        progress: called with the share that is done.

    Raises:
        InputError: a number is too small.
        MissingExtra: torch is not installed.
    """
    check_number("scan network", "scans", scans, min=10, whole=True)
    check_number("scan network", "epochs", epochs, min=1, whole=True)
    torch = torch_module()
    with torch_threads(1):
        torch.manual_seed(seed)
        shape = (SAMPLES, HIDDEN, HIDDEN, 3)
        layers: list[Any] = []
        for before, after in itertools.pairwise(shape):
            layers += [torch.nn.Linear(before, after), torch.nn.ReLU()]
        network = torch.nn.Sequential(*layers[:-1])
        count = _fit(torch, network, scans, epochs, seed, progress)
        stored = {}
        for k, layer in enumerate(layers[::2]):
            stored[f"layer{2 * k}"] = layer.weight.detach().numpy().T.astype(np.float32)
            stored[f"layer{2 * k + 1}"] = layer.bias.detach().numpy().astype(np.float32)
        np.savez_compressed(file, **stored)
        return NetworkFit(Path(file), count, *_validate(torch, network, seed))


def beam_samples(scan: LabelledScan, rng: np.random.Generator, skipped: float) -> tuple[Floats, Floats]:
    """Return cutouts ``[B, SAMPLES]``, and of each beam whether it met a person and the vote for the centre ``[B, 3]``.

    Args:
        scan: a generated scan.
        rng: chooses the beams that are left out.
        skipped: share of the beams without a person that is left out.
    """
    there = np.isfinite(scan.ranges) & (scan.ranges <= REACH)
    there &= (scan.person >= 0) | (rng.random(len(scan.ranges)) >= skipped)
    beams = np.flatnonzero(there)
    windows = np.empty((len(beams), SAMPLES))
    filled = np.where(np.isfinite(scan.ranges), scan.ranges, 1e3)
    cut_windows(filled, beams, 2.0 * math.pi / len(scan.ranges), True, windows)
    person, angle = scan.person[beams], scan.angles[beams]
    centre = scan.centre[np.maximum(person, 0)] if len(scan.centre) else np.zeros((len(beams), 2))
    along = np.cos(angle) * centre[:, 0] + np.sin(angle) * centre[:, 1] - scan.ranges[beams]
    across = -np.sin(angle) * centre[:, 0] + np.cos(angle) * centre[:, 1]
    return windows, np.stack([person >= 0, along, across], axis=-1).astype(np.float64)


def _data(scans: int, seed: int, name: str, skipped: float) -> tuple[Floats, Floats]:
    rng = stream(seed, "scan-network", name)
    parts = [beam_samples(generate_scan(rng), rng, skipped) for _ in range(scans)]
    return np.concatenate([one for one, _ in parts]), np.concatenate([other for _, other in parts])


def _fit(torch: Any, network: Any, scans: int, epochs: int, seed: int, progress: Callable[[float], None] | None) -> int:
    """Train the network and return the number of beams."""
    windows, labels = (torch.tensor(one, dtype=torch.float32) for one in _data(scans, seed, "train", SKIPPED))
    optimizer = torch.optim.Adam(network.parameters(), lr=RATE, weight_decay=1e-5)
    batches = max(1, len(windows) // BATCH)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs * batches)
    for epoch in range(epochs):
        order = torch.randperm(len(windows))
        for batch in range(batches):
            chosen = order[batch * BATCH : (batch + 1) * BATCH]
            given = windows[chosen]
            if epoch % 2:  # the mirror image of a place is a place
                given = given.flip(1)
            answer, wanted = network(given), labels[chosen]
            person = wanted[:, 0] > 0.5
            side = wanted[:, 2] * (-1.0 if epoch % 2 else 1.0)
            loss = torch.nn.functional.binary_cross_entropy_with_logits(answer[:, 0], wanted[:, 0])
            target = torch.stack([wanted[:, 1], side], dim=1)[person]
            loss = loss + 3.0 * torch.nn.functional.smooth_l1_loss(answer[:, 1:][person], target, beta=0.1)
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            schedule.step()
        if progress is not None:
            progress((epoch + 1) / epochs)
    return len(windows)


def _validate(torch: Any, network: Any, seed: int) -> tuple[float, float, float]:
    """Return precision and recall of beams and the error of votes [m] on scans of another stream."""
    windows, labels = _data(200, seed, "check", 0.0)
    with torch.no_grad():
        answer = network(torch.tensor(windows, dtype=torch.float32)).numpy()
    person, found = labels[:, 0] > 0.5, answer[:, 0] > 0.0
    right = float((person & found).sum())
    away = np.linalg.norm(answer[person, 1:] - labels[person, 1:], axis=1)
    return right / max(1.0, float(found.sum())), right / max(1.0, float(person.sum())), float(away.mean())
