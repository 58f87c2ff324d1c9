"""``crowdbot train scan-network``: train the detector of people in scans on generated scans."""

from __future__ import annotations

import argparse
from pathlib import Path

from crowdbot.cli.output import print_json, progress

from .scan_training import check_scan_training

DETECTOR = "scan-network"
EPOCHS = 12
"""Default number of passes over the generated scans."""
FILE = "scan-network.npz"


def train_detector(options: argparse.Namespace) -> int:
    """Train the network and print the path of the weights.

    Raises:
        InputError: recordings are given, or options of other trainings.
    """
    from crowdbot.core import explain_write_errors
    from crowdbot.perception import train_scan_network

    check_scan_training(options, DETECTOR)
    file = Path(options.out) / FILE
    with explain_write_errors(options.out), progress(options.json) as report:
        options.out.mkdir(parents=True, exist_ok=True)
        fit = train_scan_network(
            file, options.scans, options.epochs or EPOCHS, options.seed,
            lambda share: report(f"train {DETECTOR}", share),
        )  # fmt: skip
    if options.json:
        print_json({**fit._asdict(), "file": str(fit.file)})
        return 0
    print(
        f"{fit.beams} beams of {options.scans} generated scans; beams of other scans: precision"
        f" {fit.precision:.2f}, recall {fit.recall:.2f}, error of votes {fit.error:.3f} m"
    )
    print(fit.file)
    return 0
