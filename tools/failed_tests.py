"""Name the tests that failed in the last ``make test`` and ``make live``: ``python tools/failed_tests.py``."""

from __future__ import annotations

import json
from pathlib import Path

ROOT = Path(__file__).parents[1]
CACHES = {tier: f".pytest_cache/{tier}" for tier in ("doctests", "gate", "live", "repeat")}
"""Cache folders of pytest by tier; ``doctests`` are part of the gate, ``repeat`` is the second run of a live test."""
REPORT = ROOT / "live.json"
MOST = 100


def failed_tests(tier: str) -> list[str]:
    """Return the tests that failed in the last run of a tier, as pytest names them."""
    path = ROOT / CACHES[tier] / "v" / "cache" / "lastfailed"
    return sorted(json.loads(path.read_text(encoding="utf-8"))) if path.is_file() else []


def failed_twice() -> list[str]:
    """Return the live tests that failed again when they were repeated alone."""
    if not REPORT.is_file():
        return failed_tests("live")
    return [item["test"] for item in json.loads(REPORT.read_text(encoding="utf-8"))["repeats"] if not item["passed"]]


def main() -> None:
    """Print one line for each test."""
    failed = [("make test", test) for tier in ("doctests", "gate") for test in failed_tests(tier)]
    failed += [("make live", test) for test in failed_twice()]
    for command, test in failed[:MOST]:
        print(f"{command}: {test} failed")
    if len(failed) > MOST:
        print(f"and {len(failed) - MOST} more")
    if not failed:
        print("no test failed: the error is in an earlier line")


if __name__ == "__main__":
    main()
