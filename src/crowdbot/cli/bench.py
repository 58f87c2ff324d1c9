"""``crowdbot bench``: measure speed on this machine."""

from __future__ import annotations

import argparse
from pathlib import Path

from .output import add_json, number, print_json, print_table, progress


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("names", metavar="NAME", nargs="*", help="measurements (default: all)")
    parser.add_argument("--repeats", type=int, default=7, help="timed repetitions after a warm-up (default: 7)")
    parser.add_argument(
        "--data", type=Path, metavar="PATH", help="recording for scheme-frame (default: a simulated crowd)"
    )
    parser.add_argument(
        "--out", type=Path, metavar="FILE.json", help="output file for the measurements (default: none)"
    )
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Measure and print the rows."""
    import json

    from crowdbot.benchmark import measure
    from crowdbot.core import explain_write_errors

    with progress(options.json) as report:
        rows = measure(options.names, repeats=options.repeats, progress=report, recording=options.data)
    table = [row.as_dict() for row in rows]
    if options.out is not None:
        with explain_write_errors(options.out):
            options.out.write_text(json.dumps(table, indent=2) + "\n", encoding="utf-8")
    if options.json:
        print_json({"rows": table})
        return 0
    cells = [(r.name, number(r.median, 4 if r.median < 1 else 1), r.unit, r.against, number(r.ratio, 2)) for r in rows]
    print_table("speed", ("name", "median", "unit", "against", "ratio"), cells, caption=rows[0].environment)
    return 0
