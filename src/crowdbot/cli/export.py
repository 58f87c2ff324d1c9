"""``crowdbot export EPISODE.mcap --to FILE``: write an episode as a table, a page that plays it, or labelled images."""

from __future__ import annotations

import argparse
from pathlib import Path

from .output import add_json, print_json, progress


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("episode", metavar="EPISODE.mcap", type=Path, help="recorded episode")
    parser.add_argument(
        "--to",
        type=Path,
        required=True,
        metavar="FILE",
        help="output file, .parquet or .csv; .html is one page that plays the episode in a browser; with --labels a"
        " folder",
    )
    parser.add_argument("--force", action="store_true", help="overwrite an existing file")
    parser.add_argument(
        "--table",
        default="people",
        metavar="NAME",
        help="people (including robots), persons (one row for each person), robots, joints, transforms, contacts,"
        " forces, collisions, falls; of sensors: scans, points, ranges, images (depth), pictures (colour, with a folder"
        " of PNG files), inertial, odometry, bumpers, tracked (default: people)",
    )
    parser.add_argument(
        "--period", type=float, metavar="S", help="time between two frames of a page in s (default: as recorded)"
    )
    parser.add_argument(
        "--images", action="store_true", help="let a page hold the recorded images of cameras (default: it holds none)"
    )
    parser.add_argument(
        "--labels",
        choices=("coco", "kitti"),
        help="write images and point clouds with boxes, masks and keypoints of people in this format to a folder",
    )
    parser.add_argument(
        "--folder",
        type=Path,
        metavar="DIR",
        help="folder of the trial files, for a page or labels (default: the folder of the episode)",
    )
    parser.add_argument(
        "--trust", action="store_true", help="allow code outside the folder of the trial, for a page or labels"
    )
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Write the table, the page or the labels."""
    from crowdbot.core import InputError
    from crowdbot.recording import export, folder_of

    if options.labels is not None:
        return _write_labels(options)
    if options.to.suffix.lower() == ".html":
        return _write_page(options)
    if options.period is not None or options.trust or options.folder is not None or options.images:
        raise InputError(
            "--period, --images, --folder and --trust are for a page or labels; give --to FILE.html, or --labels"
        )
    rows = export(options.episode, options.to, options.table, options.force)
    has_images = rows > 0 and options.table == "pictures"
    images = {"images": str(folder_of(options.to))} if has_images else {}
    if options.json:
        summary = {"episode": str(options.episode), "table": options.table, "file": str(options.to), "rows": rows}
        print_json(summary | images)
    else:
        more = f", images in {images['images']}" if images else ""
        if not rows:
            more = f": the episode holds no {options.table}"
        print(f"{options.to}: {rows} rows{more}")
    return 0


def _write_labels(options: argparse.Namespace) -> int:
    """Run the episode again, and write its labels."""
    from crowdbot.core import InputError
    from crowdbot.generation import export_labels

    if options.table != "people" or options.period is not None or options.images:
        raise InputError("--table, --period and --images are not for labels; leave them out")
    with progress(options.json) as report:
        found = export_labels(
            options.episode, options.to, options.labels, options.force, options.trust,
            lambda share: report(f"label {options.episode.name}", share), options.folder,
        )  # fmt: skip
    if options.json:
        print_json({"episode": str(options.episode), **found._asdict(), "folder": str(found.folder)})
    else:
        print(f"{found.folder}: {found.images} images and {found.scans} scans in {found.files} files")
    return 0


def _write_page(options: argparse.Namespace) -> int:
    """Write the page that plays the episode."""
    from crowdbot.core import InputError
    from crowdbot.web import write_player

    if options.table != "people":
        raise InputError("--table is for a table; a page holds everything")
    with progress(options.json) as report:
        page = write_player(
            options.episode, options.to, period=options.period, force=options.force, trust=options.trust,
            folder=options.folder, images=options.images,
            progress=lambda share: report(f"play {options.episode.name}", share),
        )  # fmt: skip
    if options.json:
        summary = {"file": str(page.path), "frames": page.frames, "seconds": page.seconds, "bytes": page.size}
        print_json({"episode": str(options.episode), **summary})
    else:
        print(f"{page.path}: {page.frames} frames, {page.seconds:g} s, {page.size / 1e6:.1f} MB")
    return 0
