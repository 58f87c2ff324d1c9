"""Options of the trainings that learn from simulated scans."""

from __future__ import annotations

import argparse


def check_scan_training(options: argparse.Namespace, name: str) -> None:
    """Refuse options of trainings on recordings.

    Raises:
        InputError: recordings are given, or the training is to be resumed.
    """
    from crowdbot.core import InputError

    if options.data:
        raise InputError(f"{name} learns from simulated scans, --data is not read")
    if options.resume:
        raise InputError(f"a training of {name} takes minutes and cannot be resumed; omit --resume")
