"""``crowdbot track`` on recorded scans with annotated people: files of DROW and FROG, folders of L-CAS, bags."""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from crowdbot.cli.output import print_json, print_table

from .tracker_choice import chosen_detectors, chosen_trackers

if TYPE_CHECKING:
    from crowdbot.evaluation import AnnotatedScan


FROG_SUFFIXES, BAG_SUFFIXES = (".h5", ".hdf5"), (".bag", ".db3")


def is_annotated(source: str) -> bool:
    """Return whether a source is a file or a folder of recorded scans."""
    return source.endswith((".csv", *FROG_SUFFIXES)) or any(Path(source).glob("*.pcd")) or bool(_bags(source))


def _bags(source: str) -> list[Path]:
    """Return the bag, or the bags of a folder."""
    path = Path(source)
    return sorted(file for file in (path.iterdir() if path.is_dir() else [path]) if file.suffix in BAG_SUFFIXES)


def score_annotated(options: argparse.Namespace) -> int:
    """Print precision, recall and error of the detectors, and of the trackers behind them."""
    from crowdbot.core import InputError
    from crowdbot.evaluation import score_positions
    from crowdbot.perception import ScanOdometry

    if options.by or options.predictor or options.plot or options.trial:
        raise InputError("--by, --predictor, --plot and --trial are for trials and episodes, not for recorded scans")
    clouds = any(Path(options.source).glob("*.pcd"))
    options.detector = options.detector or ["cloud-clusters" if clouds else "lidar-clusters"]
    detectors, trackers = chosen_detectors(options), chosen_trackers(options)
    odometry = ScanOdometry() if options.match_scans else None
    scores = score_positions(read_annotated(options), detectors, trackers, options.reach, odometry)
    name, first = Path(options.source).name, next(iter(scores.values()))
    if options.json:
        print_json({"source": name, "people": first.people,
            "scores": {key: score._asdict() for key, score in scores.items()}})  # fmt: skip
        return 0
    table = [
        [
            key,
            f"{score.precision:.3f}",
            f"{score.recall:.3f}",
            f"{score.f1:.3f}",
            f"{score.error:.3f}",
            str(score.detections),
            f"{score.false_rate:.2f}",
        ]
        for key, score in scores.items()
    ]
    motion = "motion of the scanner from its scans" if options.match_scans else "no odometry"
    caption = f"{first.people} annotated people without identities; no map, {motion}; reach {options.reach:g} m"
    head = ("detector, tracker", "precision", "recall", "F1", "error [m]", "positions", "false a scan")
    print_table(f"{name}, recorded scans", head, table, caption)
    return 0


def read_annotated(options: argparse.Namespace) -> Iterable[AnnotatedScan]:
    """Return the recorded scans of the source, a file or a folder."""
    from crowdbot.core import InputError
    from crowdbot.evaluation import read_drow, read_frog, read_lcas, read_scan_bag

    source = options.source
    if bags := _bags(source):
        return itertools.chain.from_iterable(read_scan_bag(bag, options.sensor, options.nobody) for bag in bags)
    if options.nobody or options.sensor:
        raise InputError("--nobody and --sensor are not for files of DROW and FROG and folders of L-CAS")
    if Path(source).is_dir():
        return read_lcas(source)
    return read_frog(source) if source.endswith(FROG_SUFFIXES) else read_drow(source)
