"""Measures how often people are inside the central regions of a forecast, on data sets that no training saw.

    python studies/forecast_calibration.py DATA [--windows 12] [--only CITR ETH]
    python studies/forecast_calibration.py DATA --fit

DATA is that of studies/zero_shot.py. Prints a Markdown table: share of true positions inside the regions of 50, 80 and
95 % of the mixture of AnchorNet (K = 20) and of the ellipse of the Kalman filter, mean over all steps, and at 0.4, 2.4
and 4.8 s. A calibrated forecast has the asked shares everywhere; less is overconfident. The last row is the mean of the
data sets.

--fit chooses the factors of the spread (`WIDTH`, `EARLY_WIDTH` of prediction/anchor_net/mixture.py): the least squared
difference of all shares at all steps, each data set alike. It also leaves out each data set in turn, and prints the
shares on it with the factors that the other ones choose.
"""

from __future__ import annotations

import argparse
import dataclasses
import itertools
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crowdbot.data import Forecast, Windows
from crowdbot.metrics import region_levels
from crowdbot.prediction import AnchorNet, Kalman
from crowdbot.prediction.anchor_net.mixture import EARLY_WIDTH, WIDTH
from zero_shot import RECORDINGS, ROWS, TRIALS, read, thinned, trial_tracks

SHARES = (0.5, 0.8, 0.95)
SHOWN = (1, 6, 12)
"""Steps of the table, of 0.4 s."""
FACTORS = tuple(itertools.product((0.9, 1.0, 1.1, 1.2, 1.3, 1.45, 1.6, 1.8), (0.4, 0.7, 1.0, 1.4, 1.8)))
"""Values of `WIDTH` and `EARLY_WIDTH` that --fit tries."""
Cut = list[tuple[Windows, Windows]]


def coverage(forecasts: Sequence[Forecast], cut: Cut) -> np.ndarray:
    """Return the shares ``[3, T]`` of people inside the regions at each step, over all people of several recordings."""
    inside, count = np.zeros((len(SHARES), ROWS - 8)), np.zeros(ROWS - 8)
    for forecast, (_, future) in zip(forecasts, cut, strict=True):
        weight, mean, covariance = forecast.mixture()
        window, step, person = np.nonzero(future.present & future.scored[:, None])
        level = region_levels(
            weight[window, :, person], mean[window, :, step, person], covariance[window, :, step, person],
            future.position[window, step, person],
        )  # fmt: skip
        count += np.bincount(step, minlength=len(count))
        inside += [np.bincount(step, level <= share, minlength=len(count)) for share in SHARES]
    return np.asarray(inside / count)


def widened(forecast: Forecast, width: float, early: float) -> Forecast:
    """Return a forecast whose futures have other factors of their spread; tracks have no covariances."""
    step = np.arange(1.0, forecast.steps + 1.0)
    factor = ((width + early / step) / (WIDTH + EARLY_WIDTH / step)) ** 2
    assert forecast.future_covariance is not None
    return dataclasses.replace(forecast, future_covariance=forecast.future_covariance * factor[:, None, None, None])


def windows_of(folder: Path, name: str, windows: int) -> Cut:
    """Return windows of a data set."""
    tracks = read(folder, RECORDINGS[name]) if name in RECORDINGS else trial_tracks(name)
    short = [track.name for track in tracks if np.unique(track.frame).size < ROWS]
    if short:
        print(f"{name}: shorter than {ROWS} rows, not scored: {', '.join(short)}", file=sys.stderr)
    cut = thinned([track for track in tracks if track.name not in short], windows)
    return [(past, future) for past, future in cut if future.scored.any()]


def words(shares: np.ndarray) -> str:
    """Return shares ``[3, T]`` as a cell: mean over the steps, and at some of them [%]."""
    columns = [shares.mean(axis=1), *(shares[:, step - 1] for step in SHOWN)]
    return "; ".join(" / ".join(f"{100 * share:.0f}" for share in column) for column in columns)


def fit(cuts: dict[str, Cut]) -> None:
    """Print the factors that all data sets choose, and those of all but one with the shares on that one."""
    held: dict[str, np.ndarray] = {}
    for name, cut in cuts.items():
        forecasts = [AnchorNet("open").predict(past, 12, 20) for past, _ in cut]
        held[name] = np.array([coverage([widened(one, *pair) for one in forecasts], cut) for pair in FACTORS])
    lost = {name: ((shares - np.array(SHARES)[:, None]) ** 2).mean(axis=(1, 2)) for name, shares in held.items()}
    print("chosen by all:", FACTORS[int(np.argmin(sum(lost.values())))])
    left = []
    for name in cuts:
        best = int(np.argmin(sum(values for other, values in lost.items() if other != name)))
        left.append(held[name][best])
        print(f"| {name} | {FACTORS[best]} | {words(left[-1])} |")
    mean = np.mean(left, axis=0)
    worst = 100.0 * np.abs(mean - np.array(SHARES)[:, None]).max(axis=1)
    print(f"| mean | | {words(mean)} |\nlargest difference at a step: " + " / ".join(f"{x:.1f}" for x in worst))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--windows", type=int, default=12)
    parser.add_argument("--only", nargs="+", default=None, choices=[*RECORDINGS, *TRIALS])
    parser.add_argument("--fit", action="store_true")
    options = parser.parse_args()
    names = options.only or ([*RECORDINGS] if options.fit else [*RECORDINGS, *TRIALS])
    cuts = {name: windows_of(options.data, name, options.windows) for name in names}
    if options.fit:
        fit(cuts)
        return
    head = ("data set", "persons", "AnchorNet, 20: mean; 0.4; 2.4; 4.8 s", "Kalman: mean; 0.4; 2.4; 4.8 s")
    print(f"| {' | '.join(head)} |\n{'|---' * len(head)}|")
    rows = []
    for name, cut in cuts.items():
        nets = [AnchorNet("open").predict(past, 12, 20) for past, _ in cut]
        rows.append((coverage(nets, cut), coverage([Kalman().predict(past, 12) for past, _ in cut], cut)))
        persons = sum(int(future.scored.sum()) for _, future in cut)
        print(f"| {name} | {persons} | {words(rows[-1][0])} | {words(rows[-1][1])} |", flush=True)
    print(f"| mean | | {' | '.join(words(np.mean(part, axis=0)) for part in zip(*rows, strict=True))} |")


if __name__ == "__main__":
    main()
