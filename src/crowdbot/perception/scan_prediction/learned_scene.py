"""LearnedScene: tracked people leave their straight paths as a network has learned."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, check_number, kernel
from crowdbot.perception.network_layers import read_layers, run_layers
from crowdbot.perception.tracker import Tracks
from crowdbot.prediction import torch_module, torch_threads
from crowdbot.sensors import Scan, planar_pose
from crowdbot.typing import Floats

from .tracked_scene import SceneState, TrackedScene

LAGS = (0.5, 1.0)
"""Times before now [s] whose velocities are features."""
NEIGHBOURS, SIGHT = 5, 6.0
"""Number of neighbours, and their largest distance [m]."""
SECTORS, FREE = 8, 4.0
"""Sectors around a person, and the largest distance of a surface [m]."""
OWN = 0.5
"""Returns at most this far from a tracked person [m] are no surface."""
SOFT = 0.3
"""Distance [m] that is added before the inverse of a distance is taken."""
FASTEST = 3.0
"""Limit of velocities in features [m/s]."""
SAME_TIME = 0.06
"""Largest difference of two times that are the same [s]."""
FEATURES = 4 + 3 * len(LAGS) + 6 * NEIGHBOURS + SECTORS
"""Number of features of a person."""


class EarlierTracks(NamedTuple):
    """Identities ``[N]`` and velocities ``[N, 2]`` [m/s] of tracked people at an earlier time [s]."""

    time: float
    ids: NDArray[np.int64]
    velocity: Floats


def person_frames(velocity: Floats) -> Floats:
    """Return the rotations ``[N, 2, 2]`` from the world to frames whose x axis is along velocities ``[N, 2]``."""
    size = np.hypot(velocity[:, 0], velocity[:, 1])
    ahead = np.where(size[:, None] > 1e-6, velocity / np.maximum(size, 1e-6)[:, None], [1.0, 0.0])
    return np.stack([ahead, np.stack([-ahead[:, 1], ahead[:, 0]], axis=-1)], axis=1)


def track_features(tracks: Tracks, earlier: Sequence[EarlierTracks], scans: Sequence[Scan]) -> Floats:
    """Return the features ``[N, FEATURES]`` of tracked people, each in the frame of its velocity.

    They are the speed, the logarithms of two variances, whether the person is detected, changes of the velocity in the
    last 0.5 and 1 s, place and velocity of the five nearest people (the scanner is one of them), and the inverse
    distances of surfaces in eight sectors.

    Args:
        tracks: N people at the last scan.
        earlier: the tracks before, in the order of time.
        scans: the last scans.
    """
    turn, N = person_frames(tracks.velocity), len(tracks)
    speed = np.minimum(np.hypot(*tracks.velocity.T), FASTEST)
    spread = np.log(np.clip(tracks.covariance[:, (0, 2), (0, 2)], 1e-6, 10.0))
    parts = [speed[:, None], spread, tracks.detected[:, None].astype(np.float64)]
    for lag in LAGS:
        parts.append(_change(tracks, earlier, lag, turn))
    parts.append(_neighbours(tracks, scans, turn).reshape(N, -1))
    points = scans[-1].points()[0][:, :2]
    nearest = np.full((N, SECTORS), FREE)
    _measure_sectors(np.ascontiguousarray(points), tracks.position, turn, nearest)
    parts.append(1.0 / (SOFT + nearest))
    return np.concatenate(parts, axis=1)


def _change(tracks: Tracks, earlier: Sequence[EarlierTracks], lag: float, turn: Floats) -> Floats:
    """Return the velocity some time ago minus that of now, and whether it is known, ``[N, 3]``."""
    change = np.zeros((len(tracks), 3))
    row = min(earlier, key=lambda one: abs(one.time - tracks.time + lag), default=None)
    if row is None or abs(row.time - tracks.time + lag) > SAME_TIME:
        return change
    _, now, then = np.intersect1d(tracks.ids, row.ids, assume_unique=True, return_indices=True)
    away = row.velocity[then] - tracks.velocity[now]
    change[now, :2] = np.clip(np.einsum("nij,nj->ni", turn[now], away), -FASTEST, FASTEST)
    change[now, 2] = 1.0
    return change


def _neighbours(tracks: Tracks, scans: Sequence[Scan], turn: Floats) -> Floats:
    """Return place, velocity, inverse distance and presence ``[N, NEIGHBOURS, 6]`` of the nearest people."""
    here, before = (planar_pose(scan.pose).position[0] for scan in (scans[-1], scans[max(0, len(scans) - 2)]))
    passed = float(np.max(scans[-1].time) - np.max(scans[max(0, len(scans) - 2)].time))
    own = (here - before) / passed if passed > 0.0 else np.zeros(2)
    place, velocity = np.vstack([tracks.position, here]), np.vstack([tracks.velocity, own])
    away = place[None] - tracks.position[:, None]
    distance = np.hypot(away[..., 0], away[..., 1])
    N = len(tracks)
    distance[np.arange(N), np.arange(N)] = math.inf
    order = np.argsort(distance, axis=1, kind="stable")[:, :NEIGHBOURS]
    found, row = np.zeros((N, NEIGHBOURS, 6)), np.arange(N)[:, None]
    near = distance[row, order]
    there, width = near < SIGHT, order.shape[1]
    found[:, :width, :2] = np.einsum("nij,nkj->nki", turn, away[row, order])
    motion = np.einsum("nij,nkj->nki", turn, velocity[order] - tracks.velocity[:, None])
    found[:, :width, 2:4] = np.clip(motion, -2.0 * FASTEST, 2.0 * FASTEST)
    found[:, :width, 4], found[:, :width, 5] = 1.0 / (SOFT + near), 1.0
    found[:, :width][~there] = 0.0
    return found


@kernel
def _measure_sectors(points: Floats, people: Floats, turn: Floats, nearest: Floats) -> None:
    """Shorten the distances ``[N, S]`` to the surfaces in the sectors around people."""
    N, S = nearest.shape
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        if math.isnan(x):
            continue
        owned = False
        for n in range(N):
            owned = owned or (people[n, 0] - x) ** 2 + (people[n, 1] - y) ** 2 <= OWN * OWN
        if owned:
            continue
        for n in range(N):
            dx, dy = x - people[n, 0], y - people[n, 1]
            away = math.sqrt(dx * dx + dy * dy)
            if away < FREE:
                ahead, left = turn[n, 0, 0] * dx + turn[n, 0, 1] * dy, turn[n, 1, 0] * dx + turn[n, 1, 1] * dy
                s = int((math.atan2(left, ahead) + math.pi) / (2.0 * math.pi) * S) % S
                nearest[n, s] = min(nearest[n, s], away)


AHEAD = (0.5, 1.0, 2.0, 3.0)
"""Times [s] for which the network predicts; between them the correction is interpolated, after them it stays."""
WALKING = 0.5
"""Speed [m/s] from which the whole correction holds; for slower people, whom no run has taught, it fades."""


@dataclass(frozen=True)
class LearnedState(SceneState):
    """State of a :class:`LearnedScene`.

    Fields:
        earlier: tracks of the last scans.
    """

    earlier: tuple[EarlierTracks, ...] = ()


@dataclass(frozen=True, kw_only=True)
class LearnedScene(TrackedScene):
    """As :class:`TrackedScene`, with a learned correction of the path of each person.

    A perceptron reads the motion of a person in the last second, the nearest people and the surfaces around, all from
    scans, and gives the distance from the straight path at four times. The built-in weights are trained on runs of
    built-in trials by ``crowdbot train learned-scene``.

    Fields:
        weights: file of weights; default: the built-in ones.
        share: share of the correction that is used, 0 to 1. Below 1 the predicted bodies blur less towards the mean.

    Raises:
        InputError: a value is not allowed.
        DataError: the weights cannot be read.

    >>> LearnedScene().begin().earlier
    ()
    """

    weights: str = ""
    share: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 <= self.share <= 1.0:
            raise InputError(f"LearnedScene: share = {self.share} must be from 0 to 1")
        self._layers()

    def begin(self) -> LearnedState:
        start = super().begin()
        return LearnedState(start.scans, start.tracker, start.tracks)

    def update(self, scan: Scan, state: SceneState) -> LearnedState:
        after = super().update(scan, state)
        before = state.earlier if isinstance(state, LearnedState) else ()
        now = EarlierTracks(after.tracks.time, after.tracks.ids, after.tracks.velocity)
        kept = tuple(item for item in before if now.time - item.time <= max(LAGS) + 0.1)
        return LearnedState(after.scans, after.tracker, after.tracks, (*kept, now))

    def correct(self, state: SceneState, ahead: Floats) -> Floats:
        if not len(state.tracks) or not isinstance(state, LearnedState):
            return super().correct(state, ahead)
        features = track_features(state.tracks, state.earlier, state.scans)
        own = run_layers(self._layers(), features).reshape(-1, len(AHEAD), 2)
        turn = person_frames(state.tracks.velocity)
        world = np.einsum("nij,nki->nkj", turn, own)
        knots = np.concatenate([np.zeros((len(world), 1, 2)), world], axis=1)
        times = (0.0, *AHEAD)
        place = np.clip(np.searchsorted(times, ahead, side="right") - 1, 0, len(AHEAD) - 1)
        begin, end = (np.asarray(times)[place + k] for k in (0, 1))
        part = np.minimum((ahead - begin) / (end - begin), 1.0)[None, :, None]
        found = knots[:, place] + part * (knots[:, place + 1] - knots[:, place])
        pace = np.minimum(np.hypot(*state.tracks.velocity.T) / WALKING, 1.0)
        return np.asarray(self.share * np.swapaxes(pace[:, None, None] * found, 0, 1))

    def _layers(self) -> tuple[NDArray[np.float32], ...]:
        return read_layers(self.weights, "learned-scene.npz", "LearnedScene", FEATURES, 2 * len(AHEAD))


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
    fit = [part for k, part in enumerate(parts) if k % HELD_OUT != HELD_OUT - 1]
    held = parts[HELD_OUT - 1 :: HELD_OUT] or fit[-1:]
    fit = fit if len(parts) >= HELD_OUT else fit[:-1]
    if not fit or not sum(len(item[0]) for item in fit) or not sum(len(item[0]) for item in held):
        raise InputError("training of LearnedScene: at least two runs with tracked people are needed")
    features, target, known = (np.concatenate([item[k] for item in fit]) for k in range(3))
    with torch_threads(1):
        torch.manual_seed(seed)
        network, linear = _network(torch, features)
        _fit(torch, network, (features, target, known), epochs, progress)
        network.eval()
        checked = tuple(np.concatenate([item[k] for item in held]) for k in range(3))
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
        earlier = (*(item for item in earlier if now.time - item.time <= 1.1), now)
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
    features, target, known = (torch.tensor(item, dtype=torch.float32) for item in data)
    optimizer = torch.optim.AdamW(
        [parameter for parameter in network.parameters() if parameter.requires_grad], RATE, weight_decay=DECAY
    )
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
    scale, first = (item.weight.detach().numpy().T.astype(np.float64) for item in linear[:2])
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
    return tuple(float(item) for item in (away * known).sum(axis=0) / np.where(total > 0.0, total, np.nan))
