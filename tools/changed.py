"""Run the tests that call what changed: ``python tools/changed.py [--base COMMIT]``.

Changes are those since the commit at which this branch left ``main``, with those that are not committed. The tests are
those of changed test files, those that call a changed function by the records of ``--record``, the doctests of changed
modules, and tests/house. They are chosen shortest first up to ``--budget`` seconds, and the output says how many are
left out. Test files without a record run whole if they are those of a changed room. This is no replacement of ``make
test``: a changed file of data, or a call in another process, may concern tests that do not run.

``--record [PATH ...]`` runs the tests of the gate once with a recorder, which takes twice their time, and keeps in
``.pytest_cache/calls`` which functions each calls. It records only test files that have changed, or that call a changed
module; the same command continues after an interruption.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from calls import callers, idle_lines, mentions, place_at, places, within

ROOT = Path(__file__).parents[1]
PACKAGE = "src/crowdbot"
RECORDS = ".pytest_cache/calls"
CHUNK = 8
"""Test files that are recorded in one process."""
LONGEST = 120.0
"""Time on the processor after which a test is recorded no longer [s]."""
SLOWDOWN = 2.0
"""Recorded time per time without the recorder, measured with tests/metrics."""
NO_TESTS = 5  # exit status of pytest
Records = dict[str, dict[str, Any]]


@dataclass
class Choice:
    """The tests to run.

    Attributes:
        first: test files that run whole, before all others.
        tests: chosen tests in the order of the run.
        files: test files that run whole, behind them.
        modules: modules whose examples run.
        notes: what the output says.
    """

    first: list[str] = field(default_factory=list)
    tests: list[str] = field(default_factory=list)
    files: list[str] = field(default_factory=list)
    modules: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def git(*words: str) -> str:
    """Return the output of git."""
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"changed: git {' '.join(words)}: {done.stderr.strip()}")
    return done.stdout


def branch_point(base: str) -> str:
    """Return the commit to compare with: that at which this branch left ``base``."""
    return git("merge-base", "HEAD", base).strip()


def changed_lines(base: str) -> dict[str, set[int]]:
    """Return the changed lines by file, as numbers of the working tree; a file that is gone has none."""
    result = lines_of_diff(git("diff", "--unified=0", "--no-color", "--no-ext-diff", "--no-renames", base))
    for name in git("ls-files", "--others", "--exclude-standard", "-z").split("\0"):
        if name and (ROOT / name).is_file():
            result[name] = set(range(1, 1 + (ROOT / name).read_bytes().count(b"\n") + 1))
    return result


def lines_of_diff(text: str) -> dict[str, set[int]]:
    """Return the changed lines by file of a diff without context; a removal counts for the lines around it."""
    result: dict[str, set[int]] = {}
    name = ""
    for line in text.splitlines():
        if head := re.match(r'diff --git "?a/(.*?)"? "?b/', line):
            name = head[1]
            result[name] = set()
        elif hunk := re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", line):
            first, count = int(hunk[1]), int(hunk[2] or 1)
            result[name] |= set(range(first, first + count)) if count else {max(first, 1), first + 1}
    return result


def record_file(test_file: str) -> Path:
    """Return the file of the record of a test file."""
    return ROOT / RECORDS / (test_file.replace("/", ".") + ".json")


def digest(path: Path) -> str:
    """Return a short digest of a file, empty if there is none."""
    return hashlib.blake2b(path.read_bytes(), digest_size=8).hexdigest() if path.is_file() else ""


def load_record(test_file: str) -> tuple[dict[str, str], Records] | None:
    """Return the digests of the recorded sources and the records of the tests of a file, or None without a record."""
    path = record_file(test_file)
    if not path.is_file():
        return None
    kept = json.loads(path.read_text(encoding="utf-8"))
    names = kept["functions"]
    tests = {t: {**record, "calls": {names[k] for k in record["calls"]}} for t, record in kept["tests"].items()}
    return kept["sources"], tests


def store_record(test_file: str, tests: Records) -> None:
    """Keep the records of the tests of a file, with the digests of the sources that they depend on."""
    names = sorted({call for record in tests.values() for call in record["calls"]})
    numbers = {name: k for k, name in enumerate(names)}
    rows = {t: {**record, "calls": sorted(numbers[call] for call in record["calls"])} for t, record in tests.items()}
    modules = sorted({f"{PACKAGE}/{name.split(':')[0]}" for name in names})
    sources = {name: digest(ROOT / name) for name in [test_file, *modules]}
    path = record_file(test_file)
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_suffix(".part")
    fresh.write_text(json.dumps({"sources": sources, "functions": names, "tests": rows}), encoding="utf-8")
    fresh.replace(path)


def is_current(test_file: str) -> bool:
    """Return whether a test file has a record, and it and the modules that it calls are as they were."""
    record = load_record(test_file)
    return record is not None and all(digest(ROOT / name) == known for name, known in record[0].items())


def test_files(*paths: str) -> list[str]:
    """Return the test files in folders."""
    found = [[ROOT / path] if (ROOT / path).is_file() else sorted((ROOT / path).rglob("test_*.py")) for path in paths]
    return [file.relative_to(ROOT).as_posix() for files in found for file in files]


def run_pytest(plan: dict[str, Any], words: list[str]) -> int:
    """Run pytest with a plan of the recorder and return its exit status."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "plan.json")
        file.write_text(json.dumps(plan), encoding="utf-8")
        paths = [str(ROOT / "src"), str(ROOT / "tools"), *filter(None, [os.environ.get("PYTHONPATH")])]
        environment = {**os.environ, "CALL_RECORDER": str(file), "PYTHONPATH": os.pathsep.join(paths)}
        command = [sys.executable, "-m", "pytest", "-p", "call_recorder", *words]
        return subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode


def record(paths: list[str]) -> int:
    """Record the test files whose record is missing or old; return 1 if one could not be recorded."""
    files = test_files(*paths)
    old = [file for file in files if not is_current(file)]
    print(f"changed: {len(files)} test files, {len(files) - len(old)} have a record that is up to date", flush=True)
    missing = []
    for k in range(0, len(old), CHUNK):
        chunk = old[k : k + CHUNK]
        print(f"changed: recording {k + 1} to {k + len(chunk)} of {len(old)}: {chunk[0]} ...", flush=True)
        with tempfile.NamedTemporaryFile(suffix=".json") as out:
            plan = {"sources": f"{ROOT}/{PACKAGE}/", "out": out.name, "seconds": LONGEST, "total": 1e9}
            run_pytest(plan, ["-q", "--tb=no", "-p", "no:cacheprovider", "-n", "0", *chunk])
            text = Path(out.name).read_text(encoding="utf-8")
        records: Records = json.loads(text) if text else {}
        for file in chunk:
            tests = {test: one for test, one in records.items() if test.split("::")[0] == file and "calls" in one}
            if text:
                store_record(file, tests)
            else:
                missing.append(file)
    for file in missing:
        print(f"changed: {file} is not recorded, its run did not come to its end")
    return int(bool(missing))


def callers_in(path: str, lines: set[int], records: Records, notes: list[str]) -> set[str]:
    """Return the tests that call the changed functions of a module.

    For a change outside of functions, in a class without recorded calls, or in a function that no test calls, these are
    the tests that call anything in the module.
    """
    name = path.removeprefix(f"{PACKAGE}/")
    if not (ROOT / path).is_file():
        return set(callers(records, name, ""))
    text = (ROOT / path).read_text(encoding="utf-8")
    try:
        left = lines - idle_lines(text)
        found_places = {place_at(text, line) for line in sorted(left) if line <= len(text.splitlines())}
        every = places(text)
    except SyntaxError as error:
        raise SystemExit(f"changed: {path} is no Python, line {error.lineno}: {error.msg}") from None
    found: set[str] = set()
    for place in found_places:
        calls = {(name, place.name)} if place else {(name, "")}
        if place and place.is_class:
            calls = {(name, item.name) for item in every if item.name.startswith(f"{place.name}.")}
        elif place and place.hidden:
            calls |= mentions(ROOT / PACKAGE, name, place)
        tests = {test for file, function in calls for test in callers(records, file, function)}
        if not tests and place:
            tests = set(callers(records, name, ""))
            notes.append(f"{name}:{place.name} is in no record; {len(tests)} tests call something in its file")
        found |= tests
    return found


def rooms_of(paths: list[str]) -> list[str]:
    """Return the folders of tests of changed modules."""
    names = {Path(path).relative_to(PACKAGE).parts[0] for path in paths}
    return [f"tests/{name}" for name in sorted(names) if (ROOT / "tests" / name).is_dir()]


def users_of_helper(path: str) -> list[str]:
    """Return the test files that import a helper of tests; of a conftest, those in its folder, but not all tests."""
    folder = Path(path).parent.as_posix()
    if Path(path).name == "conftest.py":
        return [] if folder == "tests" else test_files(folder)
    word = re.compile(rf"\b(?:import|from)\s+{re.escape(Path(path).stem)}\b")
    return [file for file in test_files("tests" if folder == "tests" else folder) if word.search(_text(file))]


def _text(file: str) -> str:
    return (ROOT / file).read_text(encoding="utf-8")


def choose(changes: dict[str, set[int]], budget: float) -> Choice:
    """Return the tests for changed lines."""
    choice = Choice()
    known = {file: load_record(file) for file in test_files("tests")}
    records: Records = {test: one for found in known.values() if found for test, one in found[1].items()}
    sources = [path for path in changes if path.startswith(f"{PACKAGE}/") and path.endswith(".py")]
    own = [path for path in changes if path in known]
    for path in changes:
        if path.startswith("tests/") and path.endswith(".py") and path not in known and (ROOT / path).is_file():
            own += [file for file in users_of_helper(path) if file not in own]
    tests = {t for path in sources for t in callers_in(path, changes[path], records, choice.notes)}
    folders = tuple(f"{folder}/" for folder in rooms_of(sources))
    tests |= {t for t, item in records.items() if item["starts"] and t.startswith(folders)} if folders else set()
    tests |= {t for t in records if t.startswith("tests/house/")}
    tests = {test for test in tests if test.split("::")[0] in known and test.split("::")[0] not in own}
    bare = [file for file, found in known.items() if found is None and file not in own]
    whole = [file for file in bare if file.startswith((*folders, "tests/house/"))]
    choice.modules = [path for path in sources if (ROOT / path).is_file() and ">>>" in _text(path)]
    seconds = {test: max(float(records[test]["seconds"]) / SLOWDOWN, 0.002) for test in tests}
    spent = sum(item["seconds"] / SLOWDOWN for path in own for item in (known[path] or ({}, {}))[1].values())
    ordered = sorted(tests, key=lambda test: (seconds[test], test))
    chosen = within(ordered, seconds, budget - spent) if spent < budget else []
    totals: dict[str, float] = {}
    for test in chosen:
        totals[test.split("::")[0]] = totals.get(test.split("::")[0], 0.0) + seconds[test]
    choice.tests = sorted(chosen, key=lambda test: (totals[test.split("::")[0]], test.split("::")[0]))
    choice.first, choice.files = own, whole
    choice.notes[:0] = [
        f"{len(sources)} modules and {len(own)} test files are concerned by the changes",
        f"{len(chosen)} tests are chosen by their records ({sum(seconds[t] for t in chosen):.0f} s), "
        f"{len(tests) - len(chosen)} more are left out by the budget of {budget:g} s",
    ]
    if bare:
        choice.notes.append(
            f"{len(bare)} test files have no record (make record-calls), so it is not known what they call; "
            f"{len(whole)} of them, those of {', '.join([*rooms_of(sources), 'tests/house'])}, run whole"
        )
    if "tests/conftest.py" in changes:
        choice.notes.append("tests/conftest.py concerns all tests; none of them run for it")
    covered = {*sources, *known, *(p for p in changes if p.startswith("tests/") and p.endswith(".py"))}
    if others := sorted(path for path in changes if path not in covered and path != "CHANGELOG.md"):
        choice.notes.append(f"of {len(others)} other files no tests are known: {', '.join(others[:5])}"
                            + (" ..." if len(others) > 5 else ""))  # fmt: skip
    return choice


def main(words: list[str] | None = None) -> int:
    """Record, or run the tests of the changes; return the exit status of pytest."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--base", default="main", help="branch or commit to compare with (default: main)")
    parser.add_argument("--budget", type=float, default=100.0, help="time of the chosen tests in s (default: 100)")
    parser.add_argument("--list", action="store_true", help="print the tests, run none")
    parser.add_argument("--record", nargs="*", metavar="PATH", help="record test files or folders (default: tests)")
    options = parser.parse_args(words)
    try:
        if options.record is not None:
            absent = [path for path in options.record if not (ROOT / path).exists()]
            if absent:
                parser.error(f"there is no {', '.join(absent)}")
            return record(options.record or ["tests"])
        choice = choose(changed_lines(branch_point(options.base)), options.budget)
        print("\n".join(f"changed: {note}" for note in choice.notes), flush=True)
        if options.list:
            print("\n".join([*choice.first, *choice.tests, *choice.modules, *choice.files]))
            return 0
        order = [*choice.first, *choice.tests, *choice.modules, *choice.files]
        files = list(dict.fromkeys(name.split("::")[0] for name in order))
        plan = {"tests": order, "until": 1.2 * options.budget}
        words = ["-p", "no:cacheprovider", "-n", "0", "--doctest-modules", *files]
        status = run_pytest(plan, words) if files else 0
    except KeyboardInterrupt:
        print("\nchanged: interrupted")
        return 130
    return 0 if status == NO_TESTS else status


if __name__ == "__main__":
    sys.exit(main())
