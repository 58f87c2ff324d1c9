"""``crowdbot track`` on recorded scans with annotated people: files of DROW and FROG, folders of L-CAS, bags."""

from __future__ import annotations

import argparse
import itertools
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import print_json, print_table

from .reading_logs import check_plain_runs
from .results_folder import write_results
from .tracker_choice import chosen_detectors, chosen_trackers

if TYPE_CHECKING:
    from crowdbot.evaluation import AnnotatedScan
    from crowdbot.perception import Tracks


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

    if options.by or options.predictor or options.plot:
        raise InputError("--by, --predictor and --plot are for trials and episodes, not for recorded scans")
    check_plain_runs(options, "recorded scans are one run")
    if options.out is not None and len(_bags(options.source)) > 1:
        raise InputError(f"--out: {options.source} has several bags, whose tracks would mix; give one bag")
    clouds = any(Path(options.source).glob("*.pcd"))
    options.detector = options.detector or ["cloud-clusters" if clouds else "lidar-clusters"]
    detectors, trackers = chosen_detectors(options), chosen_trackers(options)
    odometry = ScanOdometry() if options.match_scans else None
    tracks: dict[str, list[Tracks]] = {f"{name}, {label}": [] for name in detectors for label in trackers}
    note = None if options.out is None else lambda label, row: tracks[label].append(row)
    scores = score_positions(read_annotated(options), detectors, trackers, options.reach, odometry, note)
    name, first = Path(options.source).name, next(iter(scores.values()))
    is_scored = not math.isnan(first.false_rate)
    summary: dict[str, Any] = {"source": name, "people": first.people,
        "scores": {key: score._asdict() for key, score in scores.items()} if is_scored else {}}  # fmt: skip
    files = []
    if options.out is not None:
        summary["tracks"] = {label: len({who for row in rows for who in row.ids}) for label, rows in tracks.items()}
        files = write_results(options.out, {(label, None): rows for label, rows in tracks.items()}, summary)
    if options.json:
        print_json(summary)
        return 0
    if not is_scored:
        for label, count in summary["tracks"].items():
            print(f"{name}: {len(tracks[label])} scans without labelled people, {count} tracks of {label}; no scores")
        return _print_files(files)
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
    return _print_files(files)


def _print_files(files: Iterable[Path]) -> int:
    for file in files:
        print(file)
    return 0


def read_annotated(options: argparse.Namespace) -> Iterable[AnnotatedScan]:
    """Return the recorded scans of the source, a file or a folder, of at most ``--duration``."""
    rows = _read_scans(options)
    return rows if options.duration is None else _first_seconds(rows, options.duration)


def _read_bag(bag: Path, options: argparse.Namespace) -> list[AnnotatedScan]:
    from crowdbot.evaluation import read_scan_bag

    return read_scan_bag(bag, options.sensor, options.nobody, labelled=options.out is None)


def _first_seconds(rows: Iterable[AnnotatedScan], duration: float) -> Iterator[AnnotatedScan]:
    import numpy as np

    end = math.inf
    for k, row in enumerate(rows):
        time = float(np.max(row.scan.time))
        end = end if k else time + duration
        if time >= end:
            return
        yield row


def _read_scans(options: argparse.Namespace) -> Iterable[AnnotatedScan]:
    from crowdbot.core import InputError
    from crowdbot.evaluation import read_drow, read_frog, read_lcas

    source = options.source
    if bags := _bags(source):
        return itertools.chain.from_iterable(_read_bag(bag, options) for bag in bags)
    if options.nobody or options.sensor:
        raise InputError("--nobody and --sensor are not for files of DROW and FROG and folders of L-CAS")
    if Path(source).is_dir():
        return read_lcas(source)
    return read_frog(source) if source.endswith(FROG_SUFFIXES) else read_drow(source)
