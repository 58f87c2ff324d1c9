"""``crowdbot validate``: compare crowd models with experiments and write a page of results."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from .output import add_json, note, print_json, print_table, progress

if TYPE_CHECKING:
    from crowdbot.models import CrowdModel


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--models", metavar="A,B", help="crowd models, by name or file.py:Name (default: all)")
    parser.add_argument(
        "--data", type=Path, metavar="DIR", help="folder of reference recordings (default: published curves only)"
    )
    parser.add_argument(
        "--out", type=Path, default=Path("validate"), metavar="DIR", help="output folder (default: validate)"
    )
    parser.add_argument("--quick", action="store_true", help="short runs with few people, to test the installation")
    parser.add_argument(
        "--contacts",
        action="store_true",
        help="only contacts of people in built-in trials and the time for 40 m, as contacts.md",
    )
    parser.add_argument(
        "--starts", type=int, default=20, metavar="N", help="starts of each test, or runs of each trial (default: 20)"
    )
    parser.add_argument("--stored", action="store_true", help="write the page from stored results, without new runs")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Run the checks, write the page and print the table."""
    from crowdbot.core import InputError, explain_write_errors
    from crowdbot.validation import CHECKS, select_models, validate, write_page

    models, skipped = select_models([name for name in (options.models or "").split(",") if name])
    if options.starts < 1:
        raise InputError(f"--starts {options.starts} must be at least 1")
    if options.contacts:
        return _contacts(options, models)
    kept = options.out / "validation"
    try:
        with progress(options.json) as report, explain_write_errors(options.out):
            done = validate(
                models, kept, options.data, options.quick, report, skipped, options.starts, not options.stored
            )
    except KeyboardInterrupt:
        note(f"results are stored in {kept}; run the same command again to resume")
        raise
    with explain_write_errors(options.out):
        page = write_page(done, options.out, _command(options))
    if options.json:
        print_json({**done.as_dict(), "page": str(page)})
        return 0
    rows = []
    for model, checks in done.outcomes.items():
        ran = [c for c in CHECKS if c.name in checks]
        wrong = [c.title for c in ran if not checks[c.name].verdict.passed]
        starts = max((checks[c.name].starts for c in ran), default=0)
        rows.append((model, f"{len(ran) - len(wrong)} of {len(CHECKS)}", f"{starts}", ", ".join(wrong) or "-"))
    print_table("validation", ("model", "passed", "starts", "failed criteria"), rows)
    for model, why in skipped.items():
        print(f"not run   {model}: {why}")
    print(f"page      {page}")
    return 0


def _contacts(options: argparse.Namespace, models: Mapping[str, CrowdModel]) -> int:
    """Measure contacts, write the page and print the table."""
    from crowdbot.core import explain_write_errors
    from crowdbot.validation import CONTACT_REASONS, CONTACT_SECONDS, OTHER_VALUES, compare_contacts, write_contact_page

    models = models if options.models else {**models, **OTHER_VALUES}
    file = options.out / "validation" / "contacts.json"
    seconds = 4.0 if options.quick else CONTACT_SECONDS
    with progress(options.json) as report, explain_write_errors(options.out):
        rows = compare_contacts(
            models, file, lambda part: report("contacts", part), starts=options.starts, seconds=seconds
        )
        command = f"crowdbot validate --contacts --starts {options.starts} --out docs/results"
        page = write_contact_page(rows, options.out / "contacts.md", command, CONTACT_REASONS)
    if options.json:
        print_json({"models": rows, "page": str(page)})
        return 0
    failed = {name: [key for key, item in row.items() if not item["passed"]] for name, row in rows.items()}
    table = [(name, ", ".join(keys) or "-") for name, keys in failed.items()]
    print_table("contacts", ("model", "limits exceeded in"), table)
    print(f"page      {page}")
    return 0


def _command(options: argparse.Namespace) -> str:
    """Return the command that generates the page, without local paths."""
    words = ["crowdbot validate"]
    if options.models:
        words.append(f"--models {options.models}")
    if options.data:
        words.append("--data RECORDINGS")
    if options.starts != 20:
        words.append(f"--starts {options.starts}")
    return " ".join([*words, "--out docs/results", *(["--quick"] if options.quick else [])])
