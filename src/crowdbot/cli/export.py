"""``crowdbot export EPISODE.mcap --to FILE``: write an episode as a table, Parquet or CSV, or as a page that plays it."""

from __future__ import annotations

import argparse
from pathlib import Path

from crowdbot.core import InputError

from .output import add_json, print_json, progress


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("episode", metavar="EPISODE.mcap", type=Path, help="recorded episode")
    parser.add_argument("--to", type=Path, required=True, metavar="FILE", help="output file, .parquet or .csv; .html is one page that plays the episode in a browser")
    parser.add_argument("--force", action="store_true", help="overwrite an existing file")
    parser.add_argument(
        "--table",
        default="people",
        metavar="NAME",
        help="people (including robots), persons (one row for each person), robots, joints, transforms, contacts,"
        " forces, collisions; of sensors: scans, points, ranges, images (depth), pictures (colour, with a folder of PNG"
        " files), inertial, odometry, bumpers, tracked (default: people)",
    )
    parser.add_argument(
        "--period", type=float, metavar="S", help="time between two frames of a page in s (default: as recorded)"
    )
    parser.add_argument("--trust", action="store_true", help="allow code outside the folder of the trial, for a page")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Write the table or the page."""
    from crowdbot.recording import export, folder_of

    if options.to.suffix.lower() == ".html":
        return _write_page(options)
    if options.period is not None or options.trust:
        raise InputError("--period and --trust are for a page; give --to FILE.html")
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


def _write_page(options: argparse.Namespace) -> int:
    """Write the page that plays the episode."""
    from crowdbot.web.scene import write_player

    if options.table != "people":
        raise InputError("--table is for a table; a page holds everything")
    with progress(options.json) as report:
        page = write_player(
            options.episode, options.to, period=options.period, force=options.force, trust=options.trust,
            progress=lambda share: report(f"play {options.episode.name}", share),
        )  # fmt: skip
    if options.json:
        summary = {"file": str(page.path), "frames": page.frames, "seconds": page.seconds, "bytes": page.size}
        print_json({"episode": str(options.episode), **summary})
    else:
        print(f"{page.path}: {page.frames} frames, {page.seconds:g} s, {page.size / 1e6:.1f} MB")
    return 0
