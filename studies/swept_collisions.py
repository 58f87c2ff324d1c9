"""Counts collisions of forecasts between rows, beside those of the truth, on the leave-one-out files of ETH/UCY.

    python studies/swept_collisions.py DATA [--every 20]

DATA holds all_data/. Prints a Markdown table: share of people who come closer than 0.2 m, and than 0.4 m (the sum of
two radii of 0.2 m), to another one in the same future; people move straight between rows.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from crowdbot.data import load
from crowdbot.metrics import swept_collision_shares
from crowdbot.prediction import AnchorNet, ConstantVelocity, Predictor, Simulated

FILES = {
    "eth": ("biwi_eth",), "hotel": ("biwi_hotel",), "univ": ("students001", "students003"),
    "zara1": ("crowds_zara01",), "zara2": ("crowds_zara02",),
}  # fmt: skip
LIMITS = (0.2, 0.4)


def asked(fold: str) -> dict[str, tuple[Predictor, int]]:
    """Return the columns of the table."""
    return {
        "constant velocity": (ConstantVelocity(), 1),
        "AnchorNet, contact 0.25, K = 1": (AnchorNet(fold), 1),
        "20": (AnchorNet(fold), 20),
        "AnchorNet, contact 0.4, K = 1": (AnchorNet(fold, contact=0.4), 1),
        "20 ": (AnchorNet(fold, contact=0.4), 20),
        "social force alone": (Simulated("social-force", substep=0.05, contact=0.0), 1),
        "contact 0.25": (Simulated("social-force", substep=0.05), 1),
        "contact 0.4": (Simulated("social-force", substep=0.05, contact=0.4), 1),
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--every", type=int, default=20)
    options = parser.parse_args()
    print("| place; limit [m] | truth | " + " | ".join(asked("eth")) + " |")
    print("|---" * (len(asked("eth")) + 2) + "|")
    for fold, names in FILES.items():
        cut = [load(options.data / "all_data" / f"{name}.txt", fps=25).windows() for name in names]
        cut = [(past[:: options.every], future[:: options.every]) for past, future in cut]
        people = np.array([int((f.scored & (f.scored.sum(axis=1) > 1)[:, None]).sum()) for _, f in cut])
        shares: dict[float, list[float]] = {limit: [] for limit in LIMITS}
        for predictor, samples in asked(fold).values():
            forecasts = [predictor.predict(past, 12, samples) for past, _ in cut]
            for limit in LIMITS:
                both = [swept_collision_shares(f, *pair, limit) for f, pair in zip(forecasts, cut, strict=True)]
                own, true = (np.array(both).T @ people / people.sum()).tolist()
                shares[limit] = (shares[limit] or [true]) + [own]
        for limit, row in shares.items():
            print(f"| {fold}; {limit} | " + " | ".join(f"{100 * value:.1f} %" for value in row) + " |", flush=True)


if __name__ == "__main__":
    main()
