"""Counts collisions of forecasts between rows, beside those of the truth, on the leave-one-out files of ETH/UCY.

    python studies/swept_collisions.py DATA [--every 20]

DATA holds all_data/. Prints a Markdown table: share of people who come closer than 0.2 m, and than 0.4 m (the sum of
two radii of 0.2 m), to another one in the same future; people move straight between rows.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from crowdbot.data import load
from crowdbot.evaluation import score_predictor
from crowdbot.metrics import Score
from crowdbot.prediction import AnchorNet, ConstantVelocity, Predictor, Simulated

FILES = {
    "eth": ("biwi_eth",), "hotel": ("biwi_hotel",), "univ": ("students001", "students003"),
    "zara1": ("crowds_zara01",), "zara2": ("crowds_zara02",),
}  # fmt: skip
LIMITS = {0.2: "swept_collisions", 0.4: "swept_contacts"}


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
        scores = [
            Score.total([score_predictor(predictor, past, future, samples) for past, future in cut])
            for predictor, samples in asked(fold).values()
        ]
        shares = {
            limit: [getattr(scores[0], f"{name}_truth"), *(getattr(item, name) for item in scores)]
            for limit, name in LIMITS.items()
        }
        for limit, row in shares.items():
            print(f"| {fold}; {limit} | " + " | ".join(f"{100 * value:.1f} %" for value in row) + " |", flush=True)


if __name__ == "__main__":
    main()
