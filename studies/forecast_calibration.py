"""Measures how often people are inside the 95 % ellipse of a forecast, on data sets that no training saw.

    python studies/forecast_calibration.py DATA [--windows 12] [--only CITR ETH] [--share 0.95]

DATA is that of studies/zero_shot.py. Prints a Markdown table: share of true positions inside the ellipse, mean over all
steps, and at 0.4, 2.4 and 4.8 s. A calibrated forecast has the asked share everywhere; less is overconfident.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from crowdbot.data import Windows
from crowdbot.metrics import ellipse_coverage
from crowdbot.prediction import AnchorNet, Kalman, Predictor
from zero_shot import RECORDINGS, ROWS, TRIALS, read, thinned, trial_tracks

SHOWN = (1, 6, 12)
"""Steps of the table, of 0.4 s."""


def coverage(predictor: Predictor, cut: list[tuple[Windows, Windows]], share: float) -> np.ndarray:
    """Return the share ``[T]`` of people inside the ellipse at each step, over all people of several recordings."""
    inside, count = 0.0, 0.0
    for past, future in cut:
        steps = future.present.shape[1]
        there = (future.present & future.scored[:, None]).sum(axis=(0, 2))
        found = ellipse_coverage(predictor.predict(past, steps), future, share)
        inside = inside + np.where(there > 0, found, 0.0) * there
        count = count + there
    return np.asarray(inside / count)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--windows", type=int, default=12)
    parser.add_argument("--only", nargs="+", default=[*RECORDINGS, *TRIALS])
    parser.add_argument("--share", type=float, default=0.95)
    options = parser.parse_args()
    asked: dict[str, Predictor] = {"AnchorNet": AnchorNet("open"), "Kalman": Kalman()}
    print("| data set | persons | " + " | ".join(f"{name}: mean; 0.4, 2.4, 4.8 s" for name in asked) + " |")
    print("|---" * (len(asked) + 2) + "|")
    for name in options.only:
        tracks = read(options.data, RECORDINGS[name]) if name in RECORDINGS else trial_tracks(name)
        short = [track.name for track in tracks if np.unique(track.frame).size < ROWS]
        if short:
            print(f"{name}: shorter than {ROWS} rows, not scored: {', '.join(short)}", file=sys.stderr)
        cut = thinned([track for track in tracks if track.name not in short], options.windows)
        persons = sum(int(future.scored.sum()) for _, future in cut)
        cells = []
        for predictor in asked.values():
            held = coverage(predictor, cut, options.share)
            cells.append(f"{held.mean():.3f}; " + ", ".join(f"{held[step - 1]:.3f}" for step in SHOWN))
        print(f"| {name} | {persons} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
