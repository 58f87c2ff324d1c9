"""``crowdbot export EPISODE.mcap --to FILE``: write an episode as a table, Parquet or CSV."""

from __future__ import annotations

import argparse
from pathlib import Path

from .output import add_json, print_json


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("episode", metavar="EPISODE.mcap", type=Path, help="recorded episode")
    parser.add_argument("--to", type=Path, required=True, metavar="FILE", help="output file, .parquet or .csv")
    parser.add_argument("--force", action="store_true", help="overwrite an existing file")
    parser.add_argument(
        "--table",
        default="people",
        metavar="NAME",
        help="people (including robots), persons (one row for each person), robots, joints, transforms, contacts,"
        " forces, collisions; of sensors: scans, points, ranges, images (depth), pictures (colour, with a folder of PNG"
        " files), inertial, odometry, bumpers, tracked (default: people)",
    )
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Write the table."""
    from crowdbot.recording import export, folder_of

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
