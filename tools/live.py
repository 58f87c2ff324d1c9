"""Run the live tests and repeat each failed one once, alone: ``python tools/live.py [PATH ...]``.

A live test needs a real clock, a browser, another program, a port or a kill, so a busy machine can disturb it. A test
that fails, and passes when it is repeated alone, is reported and does not fail the run; one that fails twice does.
The file ``live.json`` holds every repeat with its result, for the commit and the date of the run.
"""

from __future__ import annotations

import argparse
import datetime
import json
import subprocess
import sys
from collections.abc import Sequence

from failed_tests import CACHES, REPORT, ROOT, failed_tests

sys.path.insert(0, str(ROOT / "tests"))

from gate_guard import may_hold_live_tests

MARKERS = "live and not sweep and not soak"
PASSED, FAILED = 0, 1  # exit statuses of pytest; the others say that it did not run to its end


def run_tests(cache: str, words: Sequence[str]) -> int:
    """Run live tests with a cache folder of their own and return the exit status of pytest."""
    options = ["-m", MARKERS, "--durations=30", "--cache-clear", "-o", f"cache_dir={CACHES[cache]}"]
    return subprocess.run([sys.executable, "-m", "pytest", *options, *words], cwd=ROOT, check=False).returncode


def live_files(paths: Sequence[str]) -> list[str]:
    """Return the paths, folders replaced by their test files that may hold live tests.

    A worker that imports these files alone starts in a third of the time. The gate collects all files, and fails if it
    finds a live test in another one.
    """
    files = []
    for path in paths:
        folder = ROOT / path
        tests = sorted(folder.rglob("test_*.py")) if folder.is_dir() else None
        files += (
            [path] if tests is None else [str(file.relative_to(ROOT)) for file in tests if may_hold_live_tests(file)]
        )
    return files


def commit() -> str:
    """Return the commit of the checkout, empty outside of one."""
    command = ["git", "rev-parse", "HEAD"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()


def main() -> int:
    """Run, repeat, report; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("paths", nargs="*", default=["tests"], help="files, folders or tests (default: tests)")
    parser.add_argument("--workers", default="auto", help="processes, as -n of pytest (default: auto, at most 4)")
    options = parser.parse_args()
    files = live_files(options.paths)
    if not files:
        parser.error(f"no test file in {', '.join(options.paths)} holds live tests")
    REPORT.unlink(missing_ok=True)
    status = run_tests("live", ["-n", options.workers, "--maxprocesses", "4", "--dist", "loadfile", *files])
    if status not in (PASSED, FAILED):
        return status
    repeats = []
    for test in failed_tests("live") if status else ():
        print(f"live: {test} failed; it is repeated alone", flush=True)
        repeats.append({"test": test, "passed": run_tests("repeat", ["-n", "0", test]) == PASSED})
    report = {"commit": commit(), "date": datetime.date.today().isoformat(), "repeats": repeats}
    REPORT.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    for repeat in repeats:
        print(f"live: {repeat['test']} failed once and {'passed' if repeat['passed'] else 'failed'} alone")
    print(f"live: {len(repeats)} tests were repeated, see {REPORT.name}")
    return int(not all(repeat["passed"] for repeat in repeats))


if __name__ == "__main__":
    sys.exit(main())
