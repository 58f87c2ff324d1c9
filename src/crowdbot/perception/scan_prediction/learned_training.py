"""Training of LearnedScene on scans with true positions, with PyTorch."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import InputError, check_number
from crowdbot.prediction import torch_module, torch_threads
from crowdbot.sensors import Scan
from crowdbot.typing import Floats

from .learned_scene import AHEAD
from .track_features import FEATURES, EarlierTracks, person_frames, track_features
from .tracked_scene import TrackedScene

ScannedRun = Sequence[tuple[Scan, Mapping[int, tuple[float, float]]]]
"""Scans of a run in the order of time, each with the true positions x, y [m] of people by id."""

HIDDEN = 64
"""Width of the two hidden layers."""
BATCH = 128
RATE, DECAY = 1e-3, 1e-2
DROPOUT = 0.1
REACH = 0.6
"""Largest distance of a track and the person whom it follows [m]."""
EVERY, WARM_UP = 2, 8
"""Scans between samples, and before the first."""
HELD_OUT = 10
"""Every run of this number is left out of the training."""


class MotionFit(NamedTuple):
    """Result of a training.

    Fields:
        file: the weights.
        samples: number of people in scans of the training.
        straight, learned: mean distance [m] from the true place on held-out runs after 0.5, 1, 2 and 3 s, of straight
            paths and of those with the whole correction.
    """

    file: Path
    samples: int
    straight: tuple[float, ...]
    learned: tuple[float, ...]


def train_learned_scene(
    file: Path | str, runs: Iterable[ScannedRun], epochs: int = 20, seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> MotionFit:  # fmt: skip
    """Train the correction of paths, write its weights, and return its errors on held-out runs.

    Args:
        file: file of the weights (.npz).
        runs: runs of a scanner at 10 Hz; every tenth is held out.
        epochs: passes over the samples.
        seed: seed of the training.
        progress: called with the share of the passes.

    Raises:
        InputError: there are fewer than two runs, or nobody is tracked in them.
        MissingExtra: torch is not installed.
    """
    check_number("learned scene", "epochs", epochs, min=1, whole=True)
    torch = torch_module()
    parts = [_samples(run) for run in runs]
    fit = [one for k, one in enumerate(parts) if k % HELD_OUT != HELD_OUT - 1]
    held = parts[HELD_OUT - 1 :: HELD_OUT] or fit[-1:]
    fit = fit if len(parts) >= HELD_OUT else fit[:-1]
    if not fit or not sum(len(one[0]) for one in fit) or not sum(len(one[0]) for one in held):
        raise InputError("training of LearnedScene: at least two runs with tracked people are needed")
    features, target, known = (np.concatenate([one[k] for one in fit]) for k in range(3))
    with torch_threads(1):
        torch.manual_seed(seed)
        network, linear = _network(torch, features)
        _fit(torch, network, (features, target, known), epochs, progress)
        network.eval()
        checked = tuple(np.concatenate([one[k] for one in held]) for k in range(3))
        with torch.no_grad():
            answer = network(torch.tensor(checked[0], dtype=torch.float32)).numpy().reshape(-1, len(AHEAD), 2)
        _write(Path(file), network, linear)
    zero = np.zeros_like(answer)
    return MotionFit(Path(file), len(features), _errors(zero, checked), _errors(answer, checked))


def _samples(run: ScannedRun) -> tuple[Floats, Floats, Floats]:
    """Return features ``[B, F]``, and wanted corrections ``[B, T, 2]`` [m] in frames of people with what is known."""
    scene, found = TrackedScene(), []
    state, earlier = scene.begin(), tuple[EarlierTracks, ...]()
    times = np.array([float(np.max(scan.time)) for scan, _ in run])
    for i, (scan, _) in enumerate(run):
        state = scene.update(scan, state)
        tracks = state.tracks
        now = EarlierTracks(tracks.time, tracks.ids, tracks.velocity)
        earlier = (*(one for one in earlier if now.time - one.time <= 1.1), now)
        if i < WARM_UP or i % EVERY or not len(tracks):
            continue
        whose = _followed(tracks.position, run[i][1])
        turn = person_frames(tracks.velocity)
        wanted, known = np.zeros((len(tracks), len(AHEAD), 2)), np.zeros((len(tracks), len(AHEAD)))
        for k, ahead in enumerate(AHEAD):
            j = int(np.argmin(np.abs(times - times[i] - ahead)))
            if abs(times[j] - times[i] - ahead) > 0.06:
                continue
            for n, who in enumerate(whose):
                if who is not None and who in run[j][1]:
                    away = np.array(run[j][1][who]) - tracks.position[n] - ahead * tracks.velocity[n]
                    wanted[n, k], known[n, k] = turn[n] @ away, 1.0
        use = known.any(axis=1)
        found.append((track_features(tracks, earlier, state.scans)[use], wanted[use], known[use]))
    if not found:
        return np.zeros((0, FEATURES)), np.zeros((0, len(AHEAD), 2)), np.zeros((0, len(AHEAD)))
    return tuple(np.concatenate([one[k] for one in found]) for k in range(3))  # type: ignore[return-value]


def _followed(place: Floats, people: Mapping[int, tuple[float, float]]) -> list[int | None]:
    """Return the person whom each track follows, if one is within reach."""
    ids, true = list(people), np.array(list(people.values())).reshape(-1, 2)
    if not ids:
        return [None] * len(place)
    away = np.linalg.norm(place[:, None] - true[None], axis=-1)
    return [ids[int(row.argmin())] if row.min() < REACH else None for row in away]


def _network(torch: Any, features: Floats) -> tuple[Any, list[Any]]:
    """Return the network behind a scaling of its inputs, and its linear layers."""
    linear = [torch.nn.Linear(a, b) for a, b in itertools.pairwise((FEATURES, HIDDEN, HIDDEN, 2 * len(AHEAD)))]
    scale = torch.nn.Linear(FEATURES, FEATURES)
    spread = torch.tensor(1.0 / (features.std(axis=0) + 1e-3), dtype=torch.float32)
    with torch.no_grad():
        scale.weight.copy_(torch.diag(spread))
        scale.bias.copy_(-spread * torch.tensor(features.mean(axis=0), dtype=torch.float32))
    scale.requires_grad_(False)
    drop = torch.nn.Dropout(DROPOUT)
    rectify = torch.nn.ReLU()
    return torch.nn.Sequential(scale, linear[0], rectify, drop, linear[1], rectify, linear[2]), [scale, *linear]


def _fit(
    torch: Any, network: Any, data: tuple[Floats, ...], epochs: int, progress: Callable[[float], None] | None
) -> None:
    features, target, known = (torch.tensor(one, dtype=torch.float32) for one in data)
    optimizer = torch.optim.AdamW([one for one in network.parameters() if one.requires_grad], RATE, weight_decay=DECAY)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs)
    for epoch in range(epochs):
        order = torch.randperm(len(features))
        for begin in range(0, len(features), BATCH):
            chosen = order[begin : begin + BATCH]
            away = network(features[chosen]).view(-1, len(AHEAD), 2) - target[chosen]
            distance = torch.sqrt((away**2).sum(dim=-1) + 1e-4)
            loss = (distance * known[chosen]).sum() / known[chosen].sum()
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
        schedule.step()
        if progress is not None:
            progress((epoch + 1) / epochs)


def _write(file: Path, network: Any, linear: list[Any]) -> None:
    """Write the layers; the scaling of the inputs becomes a part of the first one."""
    scale, first = (one.weight.detach().numpy().T.astype(np.float64) for one in linear[:2])
    shift = linear[0].bias.detach().numpy() @ first + linear[1].bias.detach().numpy()
    stored = {"layer0": (scale @ first).astype(np.float32), "layer1": shift.astype(np.float32)}
    for k, layer in enumerate(linear[2:], 1):
        stored[f"layer{2 * k}"] = layer.weight.detach().numpy().T.astype(np.float32)
        stored[f"layer{2 * k + 1}"] = layer.bias.detach().numpy().astype(np.float32)
    np.savez_compressed(file, **stored)


def _errors(answer: Floats, data: tuple[Floats, ...]) -> tuple[float, ...]:
    _, target, known = data
    away = np.linalg.norm(answer - target, axis=-1)
    total = known.sum(axis=0)
    return tuple(float(one) for one in (away * known).sum(axis=0) / np.where(total > 0.0, total, np.nan))
