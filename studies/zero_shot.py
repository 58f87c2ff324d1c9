"""Scores predictors on whole data sets that the default weights did not learn from, and prints the table of the site.

    python studies/zero_shot.py DATA [--noise 0.05] [--weights NEW.npz OLD.npz]
    python studies/zero_shot.py DATA --only HERMES --weights OUT/anchor-net-open.npz

DATA holds eth_biwi/, sdd_trajnet/, citr/, hermes/, juelich/ and eth_ucy_splits/ in the formats of their authors. 8 + 12
rows of 0.4 s, at most --windows windows per recording, evenly spaced. K = 1 and the best of 20 per person. The default
weights learned from the data sets in LEARNED: give --weights of `train_anchor_net.py train ... --leave-out NAME`.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
from pathlib import Path
from typing import Any

import numpy as np

import crowdbot as cb
from crowdbot.core import stream
from crowdbot.data import Trajectories, Windows, load
from crowdbot.evaluation import score_predictor
from crowdbot.metrics import Score
from crowdbot.prediction import AnchorNet, Anchors, ConstantVelocity, Kalman, LeastSquares, Predictor

STEP = 0.4
ROWS = 20
RECORDINGS = {
    "ETH": ("eth_biwi/seq_eth/obsmat.txt", "eth_biwi/seq_hotel/obsmat.txt"),
    "SDD gates": ("sdd_trajnet/Train/stanford/gates_*.txt",),
    "SDD hyang": ("sdd_trajnet/Train/stanford/hyang_*.txt",),
    "CITR": ("citr/*/*ped_filtered.csv",),
}
"""Data set that no default weights learned from -> patterns of its files."""
LEARNED = {
    "HERMES": ("hermes/Corridor-1D/uo-*.txt", "hermes/Corridor-2D/bo*.txt"),
    "Jülich": ("juelich/b*/*.txt",),
    "UCY": ("eth_ucy_splits/all_data/crowds_*.txt", "eth_ucy_splits/all_data/students*.txt"),
}
"""Data set that the default weights learned from -> patterns of its files."""
TRIALS = ("one-way-with", "crossing-flows")
"""Built-in trials."""
OPTIONS: dict[str, dict[str, Any]] = {
    "citr": {"fps": 29.97, "columns": {"x": "x_est", "y": "y_est"}},
    "hermes": {"fps": 16.0, "units": "cm"},
    "eth_ucy_splits": {"fps": 25},
}
"""Folder -> options of :func:`crowdbot.data.load`."""


def read(folder: Path, patterns: tuple[str, ...]) -> list[Trajectories]:
    """Return the recordings at 0.4 s."""
    trajectories = []
    for pattern in patterns:
        for path in sorted(folder.glob(pattern)):
            tracks = load(path, **OPTIONS.get(pattern.partition("/")[0], {}))
            trajectories.append(tracks if abs(tracks.dt - STEP) < 1e-6 else tracks.resample(STEP))
    return trajectories


def trial_tracks(name: str) -> list[Trajectories]:
    """Return the tracks of a built-in trial at 0.4 s."""
    return [cb.run(cb.load_trial(name)).tracks(STEP)]


def thinned(tracks: list[Trajectories], windows: int) -> list[tuple[Windows, Windows]]:
    """Return past and future of at most so many windows of each recording, evenly spaced."""
    cut = [track.windows() for track in tracks]
    every = [max(1, len(past) // windows) for past, _ in cut]
    return [(past[::n], future[::n]) for (past, future), n in zip(cut, every, strict=True)]


def with_noise(past: Windows, deviation: float) -> Windows:
    """Return windows with independent noise [m] on every observed row."""
    noise = deviation * stream(0, "noise", past.source).standard_normal(past.position.shape)
    return dataclasses.replace(past, position=np.where(past.present[..., None], past.position + noise, 0.0))


def predictors(weights: list[Path]) -> dict[str, tuple[Predictor, int]]:
    """Return the columns of the table: name -> predictor and number of samples."""
    asked: dict[str, tuple[Predictor, int]] = {
        "constant velocity": (ConstantVelocity(), 1), "Kalman": (Kalman(), 1), "least squares": (LeastSquares(), 1),
    }  # fmt: skip
    nets = {path.parent.name: AnchorNet(file=str(path)) for path in weights} or {"AnchorNet": AnchorNet("open")}
    asked |= {f"{name}, K = 1": (net, 1) for name, net in nets.items()}
    asked |= {"anchors, 20": (Anchors("open"), 20)}
    return asked | {f"{name}, 20": (net, 20) for name, net in nets.items()}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--weights", type=Path, nargs="+", default=[], help="files, named after their folders")
    parser.add_argument("--windows", type=int, default=60)
    parser.add_argument("--noise", type=float, default=0.0, help="noise on the observed rows [m] (default: 0)")
    parser.add_argument("--only", nargs="+", default=[*RECORDINGS, *TRIALS], choices=[*RECORDINGS, *LEARNED, *TRIALS])
    options = parser.parse_args()
    asked = predictors(options.weights)
    print("| data set | persons | " + " | ".join(asked) + " |")
    print("|---" * (len(asked) + 2) + "|")
    for name in options.only:
        patterns = RECORDINGS.get(name) or LEARNED.get(name)
        tracks = trial_tracks(name) if patterns is None else read(options.data, patterns)
        short = [track.name for track in tracks if np.unique(track.frame).size < ROWS]
        if short:
            print(f"{name}: shorter than {ROWS} rows, not scored: {', '.join(short)}", file=sys.stderr)
        cut = thinned([track for track in tracks if track.name not in short], options.windows)
        cut = [(with_noise(past, options.noise), future) for past, future in cut if future.scored.any()]
        scores = [Score.total([score_predictor(p, past, future, k) for past, future in cut]) for p, k in asked.values()]
        cells = " | ".join(f"{score.ade:.3f}/{score.fde:.3f}" for score in scores)
        print(f"| {name} | {scores[0].persons} | {cells} |", flush=True)


if __name__ == "__main__":
    main()
