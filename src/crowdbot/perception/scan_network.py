"""ScanNetwork: a learned detector of people in planar scans, with its training on generated scans."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, Walls, check_number, kernel, stream
from crowdbot.prediction import torch_module, torch_threads
from crowdbot.sensors import Reading, Scan, cast_plane, planar_pose
from crowdbot.typing import Floats, Ints

from .clusters import hide_walls
from .detector import Coverage, Detections, Detector
from .network_layers import Layers, read_layers, run_layers

SAMPLES = 48
"""Number of ranges of a cutout."""
WIDTH = 1.66
"""Width of a cutout at the range of its beam [m]."""
DEPTH = 1.0
"""Ranges are cut off this far before and behind that of the beam [m]."""


@kernel
def cut_windows(ranges: Floats, beams: Ints, step: float, circle: bool, windows: Floats) -> None:
    """Write the cutout ``[B, SAMPLES]`` of each beam: ranges relative to its own, from -1 to 1 [m].

    A cutout has the same width in metres at all ranges. Of the beams between two samples, the nearest surface counts.
    """
    count = len(ranges)
    for b in range(len(beams)):
        k = beams[b]
        centre = ranges[k]
        half = math.atan(0.5 * WIDTH / centre) / step
        for s in range(SAMPLES):
            low = k + half * (2.0 * s / SAMPLES - 1.0)
            high = k + half * (2.0 * (s + 1) / SAMPLES - 1.0)
            first, last = math.floor(low + 0.5), math.floor(high + 0.5)
            near = np.inf
            for beam in range(first, max(first + 1, last)):
                if circle:
                    value = ranges[beam % count]
                elif 0 <= beam < count:
                    value = ranges[beam]
                else:
                    continue
                if 0.0 < value < near:
                    near = value
            windows[b, s] = min(max(near - centre, -DEPTH), DEPTH)


@kernel
def collect_votes(
    votes: Floats, score: Floats, least: float, radius: float, fewest: Floats, place: Floats, count: Ints
) -> int:
    """Write place ``[P, 2]`` and number of votes of each person, and return the number P of people.

    The vote with the highest score takes the others within ``radius`` [m] of it; the person is their weighted mean.
    People with a total score below ``fewest`` ``[B]`` of their first vote are left out.
    """
    free = score >= least
    found = 0
    while True:
        best, top = -1, 0.0
        for k in range(len(score)):
            if free[k] and score[k] > top:
                best, top = k, score[k]
        if best < 0:
            return found
        x, y, weight, number = 0.0, 0.0, 0.0, 0
        for k in range(len(score)):
            away = (votes[k, 0] - votes[best, 0]) ** 2 + (votes[k, 1] - votes[best, 1]) ** 2
            if free[k] and away <= radius * radius:
                free[k] = False
                x, y = x + score[k] * votes[k, 0], y + score[k] * votes[k, 1]
                weight, number = weight + score[k], number + 1
        if weight >= fewest[best]:
            place[found, 0], place[found, 1], count[found] = x / weight, y / weight, number
            found += 1


FAR = 1e3
"""Range of a beam without a return in cutouts [m]."""


@dataclass(frozen=True, kw_only=True)
class ScanNetwork(Detector):
    """Learned detector of people in planar scans, at the height of legs or of bodies.

    A perceptron sees the ranges in a window of 1.66 m around each beam, cut out at the same width in metres at all
    ranges. It gives the probability that the beam meets a person, and a vote for the centre of the person; votes within
    ``radius`` are one person. The idea is that of Beyer, Hermans and Leibe (2017), DROW: real-time deep learning-based
    wheelchair detection in 2-D range data, doi 10.1109/LRA.2016.2645131. The built-in weights are trained on generated
    scans only, by ``crowdbot train scan-network``.

    Fields:
        weights: file of weights; default: the built-in ones.
        threshold: smallest probability of a beam that votes.
        share: smallest total of the votes of a person, as a share of the beams on a leg.
        radius: distance of votes for one person [m].
        margin: distance from walls of the map up to which points belong to them [m].
        max_range: largest distance [m].
        deviation: standard deviation of a position [m].

    Raises:
        InputError: a value is not allowed.
        DataError: the weights cannot be read.

    >>> from crowdbot.core import Pose, Scene
    >>> from crowdbot.sensors import Lidar2D
    >>> scene = Scene.of([[2.0, 0.0], [0.0, 3.0]], radius=0.25)
    >>> found = ScanNetwork().detect(Lidar2D(rays=720).read(scene, Pose.of((0.0, 0.0), 0.0)))
    >>> sorted(np.abs(found.position).round().tolist())
    [[0.0, 3.0], [2.0, 0.0]]
    """

    reads: ClassVar[tuple[type[Reading], ...]] = (Scan,)
    weights: str = ""
    threshold: float = 0.5
    share: float = 0.6
    radius: float = 0.35
    margin: float = 0.15
    max_range: float = 12.0
    deviation: float = 0.08

    def __post_init__(self) -> None:
        for name in ("radius", "max_range", "deviation"):
            check_number("ScanNetwork", name, getattr(self, name), "m", exclusive_min=0.0)
        check_number("ScanNetwork", "margin", self.margin, "m", min=0.0)
        check_number("ScanNetwork", "share", self.share, min=0.0)
        if not 0.0 < self.threshold < 1.0:
            raise InputError(f"ScanNetwork: threshold = {self.threshold} must be above 0 and below 1")
        _layers(self.weights)

    def detect(self, reading: Reading, walls: Walls | None = None) -> Detections:
        self.check(reading)
        assert isinstance(reading, Scan)
        pose = planar_pose(reading.pose)
        origin, heading = np.ascontiguousarray(pose.position[0]), float(pose.heading[0])
        angles, ranges = reading.angles, reading.ranges[0]
        step = float(angles[1] - angles[0]) if len(angles) > 1 else 2.0 * math.pi
        bearing = heading + angles
        use = np.isfinite(ranges) & (ranges <= self.max_range) & (ranges > 0.0)
        if walls is not None and len(walls):
            length = np.where(use, ranges, 0.0)
            points = origin + length[:, None] * np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
            hide_walls(points, np.ascontiguousarray(walls.segments()), self.margin, use)
        beams = np.flatnonzero(use)
        far = min(self.max_range, 0.5 / (2.0 * step))
        reach = np.where(np.isneginf(ranges) | np.isnan(ranges), 0.0, np.minimum(ranges, far))
        coverage = Coverage(origin, float(bearing[0]), step, reach)
        votes, score = self._votes(ranges, beams, bearing, step, origin)
        place, count = np.empty((len(beams), 2)), np.empty(len(beams), dtype=np.int64)
        fewest = self.share * np.minimum(4.0, 0.12 / (step * ranges[beams]))
        found = collect_votes(votes, score, self.threshold, self.radius, fewest, place, count)
        covariance = np.tile(self.deviation**2 * np.eye(2), (found, 1, 1))
        return Detections(float(np.max(reading.time)), place[:found].copy(), covariance, count[:found].copy(), coverage)

    def _votes(
        self, ranges: Floats, beams: NDArray[np.int64], bearing: Floats, step: float, origin: Floats
    ) -> tuple[Floats, Floats]:
        """Return the vote ``[B, 2]`` [m] and the probability ``[B]`` of each beam."""
        filled = np.ascontiguousarray(np.where(np.isposinf(ranges), FAR, np.where(np.isfinite(ranges), ranges, 0.0)))
        windows = np.empty((len(beams), SAMPLES))
        cut_windows(filled, beams, step, step * len(ranges) > 2.0 * math.pi - 0.5 * step, windows)
        answer = run_layers(_layers(self.weights), windows)
        length, angle = ranges[beams] + answer[:, 1], bearing[beams]
        along, across = (np.stack([f(angle), g(angle)], axis=-1) for f, g in ((np.cos, np.sin), (_minus_sin, np.cos)))
        votes = origin + length[:, None] * along + answer[:, 2:] * across
        return np.ascontiguousarray(votes), np.asarray(1.0 / (1.0 + np.exp(-np.clip(answer[:, 0], -30.0, 30.0))))


def _minus_sin(angle: Floats) -> Floats:
    return np.asarray(-np.sin(angle))


def _layers(weights: str) -> Layers:
    return read_layers(weights, "scan-network.npz", "ScanNetwork", SAMPLES, 3)


RAYS = (360, 450, 541, 720, 811, 1080)
"""Numbers of beams in a full turn."""
SPACE = 10.0
"""Half width of the place of the objects [m]."""


class LabelledScan(NamedTuple):
    """A scan of a full turn and the people in it.

    Fields:
        ranges, angles: ``[R]`` [m], [rad]; inf without a return.
        person: ``[R]`` index of the person that the beam met, -1 for everything else.
        centre: ``[N, 2]`` of the people in the frame of the scanner [m].
    """

    ranges: Floats
    angles: Floats
    person: Ints
    centre: Floats


def generate_scan(rng: np.random.Generator) -> LabelledScan:
    """Return a scan of a random place.

    Half of the scans are at the height of legs: two discs of 5 to 9 cm, up to a stride apart along the walking
    direction. The others are at the height of bodies, discs of 18 to 30 cm. People walk in part in groups of two.
    There are walls, and objects that look like people: columns, poles, bins, and four legs of chairs and tables.

    >>> scan = generate_scan(np.random.default_rng(0))
    >>> scan.ranges.shape == scan.angles.shape, set(scan.person.tolist()) <= {-1, *range(len(scan.centre))}
    (True, True)
    """
    rays = int(rng.choice(RAYS))
    centre = _places(rng, int(rng.integers(1, 25)))
    at_legs = rng.random() < 0.5
    discs, radius, owner = _legs(rng, centre) if at_legs else _bodies(rng, centre)
    things, widths = _furniture(rng)
    discs = np.concatenate([discs, things])
    radius = np.concatenate([radius, widths])
    owner = np.concatenate([owner, np.full(len(things), -1)])
    angles: Floats = -math.pi + 2.0 * math.pi / rays * np.arange(float(rays))
    clear = np.linalg.norm(discs, axis=1) > radius + 0.2
    discs, radius, owner = discs[clear], radius[clear], owner[clear]
    ranges, hit = cast_plane(
        Pose.of((0.0, 0.0), 0.0), angles, discs[None], radius[None], _walls(rng), float(rng.uniform(12.0, 30.0))
    )
    person = np.where(hit[0] >= 0, owner[np.maximum(hit[0], 0)], -1)
    noise = rng.normal(0.0, rng.uniform(0.002, 0.03), rays)
    lost = rng.random(rays) < rng.uniform(0.0, 0.02)
    measured = np.where(lost, np.inf, np.maximum(ranges[0] + noise, 0.02))
    return LabelledScan(measured, angles, np.where(np.isfinite(measured), person, -1), centre)


def _places(rng: np.random.Generator, count: int) -> Floats:
    """Return centres of people; every third one has a companion beside."""
    centre = rng.uniform(-0.9 * SPACE, 0.9 * SPACE, (count, 2)) * rng.choice([0.4, 1.0])
    aside = rng.uniform(0.0, 2.0 * math.pi, count)
    beside = centre + rng.uniform(0.5, 0.9, count)[:, None] * np.stack([np.cos(aside), np.sin(aside)], axis=-1)
    places = np.concatenate([centre, beside[: count // 3]])
    kept: list[Floats] = []
    for place in places:
        if np.linalg.norm(place) > 0.6 and all(np.linalg.norm(place - other) > 0.45 for other in kept):
            kept.append(place)
    return np.array(kept).reshape(-1, 2)


def _legs(rng: np.random.Generator, centre: Floats) -> tuple[Floats, Floats, Ints]:
    count = len(centre)
    heading, stride = rng.uniform(0.0, 2.0 * math.pi, count), 0.4 * np.sin(rng.uniform(0.0, 2.0 * math.pi, count))
    along = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    left = np.stack([-np.sin(heading), np.cos(heading)], axis=-1)
    half = 0.5 * (stride[:, None] * along + rng.uniform(0.12, 0.28, count)[:, None] * left)
    radius = rng.uniform(0.05, 0.09, count)
    return np.concatenate([centre + half, centre - half]), np.tile(radius, 2), np.tile(np.arange(count), 2)


def _bodies(rng: np.random.Generator, centre: Floats) -> tuple[Floats, Floats, Ints]:
    return centre, rng.uniform(0.18, 0.3, len(centre)), np.arange(len(centre))


def _furniture(rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return columns, poles and bins, and the legs of chairs and tables."""
    count = int(rng.integers(0, 12))
    round_things = rng.uniform(-SPACE, SPACE, (count, 2))
    widths = rng.choice([rng.uniform(0.01, 0.05), rng.uniform(0.3, 0.6)], count) * rng.uniform(0.7, 1.3, count)
    places, radii = [round_things], [widths]
    for _ in range(int(rng.integers(0, 8))):
        turn, half = rng.uniform(0.0, math.pi), 0.5 * rng.uniform(0.35, 1.2)
        corner = half * math.sqrt(2.0) * np.exp(1j * (turn + math.pi / 2 * np.arange(4)))
        middle = rng.uniform(-SPACE, SPACE, 2)
        places.append(middle + np.stack([corner.real, corner.imag], axis=-1))
        radii.append(np.full(4, rng.uniform(0.01, 0.03)))
    return np.concatenate(places), np.concatenate(radii)


def _walls(rng: np.random.Generator) -> Floats:
    """Return a room of random size and turn, boxes and pieces of walls, as segments ``[S, 4]``."""
    corners = [rng.uniform(3.0, 12.0, 2) * [sx, sy] for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    loops = [np.array(corners)] if rng.random() < 0.8 else []
    for _ in range(int(rng.integers(0, 8))):
        turn, size = rng.uniform(0.0, math.pi), rng.uniform([0.05, 0.1], [0.6, 3.0])
        axis = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        middle = rng.uniform(1.5, SPACE) * np.exp(1j * rng.uniform(0.0, 2.0 * math.pi))
        box = 0.5 * size * [[-1, -1], [1, -1], [1, 1], [-1, 1]] @ axis + [middle.real, middle.imag]
        loops.append(box)
    if not loops:
        return np.zeros((0, 4))
    return np.concatenate([np.concatenate([loop, np.roll(loop, -1, axis=0)], axis=1) for loop in loops])


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
    return np.concatenate([item for item, _ in parts]), np.concatenate([other for _, other in parts])


def _fit(torch: Any, network: Any, scans: int, epochs: int, seed: int, progress: Callable[[float], None] | None) -> int:
    """Train the network and return the number of beams."""
    windows, labels = (torch.tensor(item, dtype=torch.float32) for item in _data(scans, seed, "train", SKIPPED))
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
