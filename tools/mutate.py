"""Measure how many small changes of the code the tests notice (mutation testing).

    python tools/mutate.py core                            40 mutants of src/crowdbot/core against tests/core
    python tools/mutate.py world calibration --sample 100 --json mutants.json

A mutant is one change of one place: a comparison, an arithmetic operator, a constant, a condition, ``min`` for ``max``,
``True`` for ``False``, or a statement left out. The sample depends only on the seed and the sources. Every mutant is
tested in a copy of the tree, by the tests that call the changed function (``call_recorder.py`` finds them), within a
time limit. Kernels are tested without the compiler, as far as their tests pass that way. With ``--json`` finished
mutants are kept, and the same command continues after an interruption; ``--survivors`` tests the survivors again.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import contextlib
import hashlib
import importlib.util
import json
import os
import random
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from calls import callers, function_body_at, within
from mutants import ROOT, Mutant, mutants_of

PACKAGE = "src/crowdbot"
MEMORY = 8 * 2**30
"""Most memory [byte] that the tests of a mutant may take."""
PATIENCE = 5
"""Most real time of a process, per time of the processor that it may take; other processes slow it down."""
OPTIONS = ["-q", "--assert=plain", "--tb=line", "-p", "no:cacheprovider", "-p", "call_recorder"]


class Tree:
    """A copy of the repository in which one mutant at a time is tested.

    The copy stays where it is between runs, since compiled kernels belong to a place.
    """

    def __init__(self, room: str, tests: list[str], limit: float, number: int = 0) -> None:
        self.room, self.tests, self.limit = room, tests, limit
        self.records: dict[bool, dict[str, dict[str, Any]]] = {}
        self.servers: dict[bool, subprocess.Popen[str]] = {}
        place = hashlib.blake2b(str(ROOT).encode(), digest_size=4).hexdigest()
        self.folder = Path(tempfile.gettempdir()) / f"mutate-{place}-{number}"
        listed = subprocess.run(
            ["git", "ls-files", "-co", "--exclude-standard", "-z"],
            cwd=ROOT, capture_output=True, text=True, check=True,
        )  # fmt: skip
        names = {name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()}
        for path in [path for path in self.folder.rglob("*") if path.is_file()]:
            if path.relative_to(self.folder).as_posix() not in names:
                path.unlink()
        for name in names:
            old, new = ROOT / name, self.folder / name
            if not new.exists() or (new.stat().st_mtime, new.read_bytes()) != (old.stat().st_mtime, old.read_bytes()):
                new.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(old, new)

    def measure(self, compiled: bool, known: dict[str, Any], stems: set[str]) -> None:
        """Record what each unchanged test calls; ``known`` are the records of test files that have not changed.

        Test files that name one of the modules ``stems`` are first; there is a limit to the time of all.
        """
        text = b"".join(path.read_bytes() for path in _sources(self.room))
        sources = hashlib.blake2b(text, digest_size=6).hexdigest()
        self.records[compiled], missing = {}, {}
        for file in sorted(file for name in self.tests for file in _test_files(self.folder / name)):
            name = file.relative_to(self.folder).as_posix()
            key = f"{name}:{hashlib.blake2b(file.read_bytes(), digest_size=6).hexdigest()}:{sources}:{compiled}:names"
            if key in known:
                self.records[compiled] |= known[key]
            else:
                missing[name] = key
        if not missing:
            return
        texts = {name: (self.folder / name).read_text(encoding="utf-8") for name in missing}
        missing = dict(sorted(missing.items(), key=lambda item: not any(stem in texts[item[0]] for stem in stems)))
        with tempfile.NamedTemporaryFile(suffix=".json") as out:
            folder = f"{self.folder}/{PACKAGE}/"
            total = self.limit * (3.0 if compiled else 1.0)
            plan = {"sources": folder, "out": out.name, "seconds": self.limit / 12.0, "total": total}
            status, printed = self._pytest([], list(missing), compiled, plan, 60.0 * self.limit)
            recorded = Path(out.name).read_text(encoding="utf-8")
        if status not in (0, 1) or not recorded:
            raise SystemExit(f"mutate: the unchanged tests cannot be run:\n{printed[-2000:]}")
        fresh = json.loads(recorded)
        for name, key in missing.items():
            known[key] = {test: record for test, record in fresh.items() if test.split("::")[0] == name}
            self.records[compiled] |= known[key]

    def tests_for(self, mutant: Mutant, compiled: bool) -> list[str]:
        """Return the tests that call the changed function, as many as fit into the time limit.

        Of a change outside of functions, these are the tests that call any function of the module. Tests that start
        other processes count as callers, since their calls are not seen.
        """
        name = mutant.path.removeprefix(f"{PACKAGE}/")
        function = function_body_at((self.folder / mutant.path).read_text(encoding="utf-8"), mutant.line)
        passing = {test: record for test, record in self.records[compiled].items() if record["passed"]}
        tests = {test: passing[test] for test in callers(passing, name, function)}
        if not function:
            tests = tests or passing
        tests |= {test: record for test, record in passing.items() if record["starts"]}
        stem = Path(mutant.path).stem

        def rank(test: str) -> tuple[bool, bool, float, str]:
            seconds, file = tests[test]["seconds"], Path(test.split("::", maxsplit=1)[0]).stem
            return tests[test]["starts"], seconds > self.limit / 100.0, stem not in file, file

        seconds = {test: record["seconds"] for test, record in tests.items()}
        return within(sorted(tests, key=rank), seconds, self.limit)

    def survives(self, mutant: Mutant, compiled: bool) -> bool:
        """Return whether the tests pass with a mutant."""
        tests = self.tests_for(mutant, compiled)
        if not tests:
            return True
        path = self.folder / mutant.path
        before, times = path.read_bytes(), path.stat()
        compiled_file = Path(importlib.util.cache_from_source(str(path)))
        compiled_file.unlink(missing_ok=True)
        path.write_bytes(before[: mutant.begin] + mutant.new.encode() + before[mutant.end :])
        files = list(dict.fromkeys(test.split("::")[0] for test in tests))
        seconds = sum(self.records[compiled][test]["seconds"] for test in tests)
        try:
            return self._pytest(["-x"], files, compiled, {"tests": tests}, 30.0 + 4.0 * seconds)[0] == 0
        finally:
            compiled_file.unlink(missing_ok=True)
            path.write_bytes(before)
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))

    def _pytest(
        self, options: list[str], tests: list[str], compiled: bool, plan: dict[str, Any], limit: float
    ) -> tuple[int, str]:
        server = self.servers.get(compiled) or self._start(compiled)
        with tempfile.TemporaryDirectory() as place:
            planned, printed = Path(place, "plan.json"), Path(place, "printed")
            planned.write_text(json.dumps(plan), encoding="utf-8")
            order = {"arguments": [*OPTIONS, *options, *tests], "plan": str(planned), "printed": str(printed),
                     "cpu": int(limit), "memory": MEMORY}  # fmt: skip
            assert server.stdin is not None
            assert server.stdout is not None
            print(json.dumps(order), file=server.stdin, flush=True)
            child = int(server.stdout.readline())
            if not select.select([server.stdout], [], [], PATIENCE * limit)[0]:
                _kill_group(child)
            status = int(server.stdout.readline())
            _kill_group(child)
            return status, printed.read_text(encoding="utf-8", errors="replace")

    def _start(self, compiled: bool) -> subprocess.Popen[str]:
        shared = next((p for p in (ROOT / "shared", ROOT.parent / "shared") if p.is_dir()), ROOT / "shared")
        paths = os.pathsep.join(str(self.folder / name) for name in ("src", "tools"))
        environment = {"CROWDBOT_SHARED": str(shared), "OPENBLAS_NUM_THREADS": "1", **os.environ, "PYTHONPATH": paths}
        environment |= {} if compiled else {"NUMBA_DISABLE_JIT": "1"}
        self.servers[compiled] = subprocess.Popen(
            [sys.executable, "-u", "tools/pytest_server.py"], cwd=self.folder, env=environment, text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True,
        )  # fmt: skip
        return self.servers[compiled]

    def stop(self) -> None:
        """End the servers of tests."""
        for server in self.servers.values():
            _kill_group(server.pid)
            server.wait()
        self.servers.clear()


def _kill_group(group: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(group, signal.SIGKILL)


def _test_files(path: Path) -> list[Path]:
    return [path] if path.is_file() else sorted(path.rglob("test_*.py"))


def _sources(room: str) -> list[Path]:
    place = ROOT / PACKAGE / room
    return [place.with_suffix(".py")] if place.with_suffix(".py").is_file() else sorted(place.rglob("*.py"))


def _tests_of(room: str) -> list[str]:
    """Return the folder of tests of a room, or of the room around it."""
    for name in (room, *(parent.as_posix() for parent in Path(room).parents)):
        if (ROOT / "tests" / name).is_dir() and name != ".":
            return [f"tests/{name}"]
    raise SystemExit(f"mutate: there is no folder tests/{room}; name the tests with --tests")


def _has_kernels(mutant: Mutant) -> bool:
    return "@kernel" in (ROOT / mutant.path).read_text(encoding="utf-8")


class Results:
    """What became of each mutant, and the calls of each test file, kept in files if there is one."""

    def __init__(self, file: Path | None) -> None:
        self.file, self.lock = file, threading.Lock()
        self.rooms: dict[str, dict[str, dict[str, object]]] = {}
        self.calls: dict[str, Any] = {}
        if file is not None and file.exists():
            self.rooms = json.loads(file.read_text(encoding="utf-8"))
        if file is not None and file.with_suffix(".calls").exists():
            self.calls = json.loads(file.with_suffix(".calls").read_text(encoding="utf-8"))

    def add(self, room: str, mutant: Mutant, survived: bool) -> None:
        """Add one result and write the file anew, whole or not at all."""
        with self.lock:
            self.rooms.setdefault(room, {})[mutant.key] = {**asdict(mutant), "survived": survived}
            if self.file is not None:
                _write(self.file, json.dumps(self.rooms, indent=1))

    def save_calls(self) -> None:
        """Write the calls of the tests beside the results."""
        if self.file is not None:
            _write(self.file.with_suffix(".calls"), json.dumps(self.calls))


def _write(file: Path, text: str) -> None:
    fresh = file.with_suffix(".part")
    fresh.write_text(text, encoding="utf-8")
    fresh.replace(file)


def test_room(room: str, options: argparse.Namespace, results: Results) -> list[Mutant]:
    """Test the sample of a room, and return it."""
    every = [mutant for file in _sources(room) for mutant in mutants_of(file)]
    if not every:
        raise SystemExit(f"mutate: {PACKAGE}/{room} has nothing to change")
    chooser = random.Random(f"{options.seed}:{room}")  # noqa: S311
    sample = chooser.sample(every, min(options.sample, len(every)))
    known = results.rooms.get(room, {})
    left = [m for m in sample if m.key not in known or (options.survivors and known[m.key]["survived"])]
    if not left:
        return sample
    trees = [Tree(room, options.tests or _tests_of(room), options.limit, k) for k in range(options.jobs)]
    free, begin = list(trees), time.monotonic()
    try:
        for compiled in sorted({not _has_kernels(mutant) for mutant in left}):
            stems = {Path(mutant.path).stem for mutant in left if _has_kernels(mutant) != compiled}
            trees[0].measure(compiled, results.calls, stems)
            results.save_calls()
            records = trees[0].records[compiled].values()
            bad = sum(not record["passed"] for record in records)
            kind = "with the compiler" if compiled else "without the compiler"
            print(f"{room}: {len(records)} tests {kind}, {bad} left out, {sum(r['seconds'] for r in records):.0f} s",
                  flush=True)  # fmt: skip
            for tree in trees:
                tree.records[compiled] = trees[0].records[compiled]

        def test(mutant: Mutant) -> None:
            tree = free.pop()
            survived = tree.survives(mutant, not _has_kernels(mutant))
            free.append(tree)
            results.add(room, mutant, survived)
            print(f"{time.monotonic() - begin:6.0f} s  {'SURVIVED' if survived else 'caught'}  {mutant}", flush=True)

        pool = concurrent.futures.ThreadPoolExecutor(options.jobs)
        try:
            for done in [pool.submit(test, mutant) for mutant in left]:
                done.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
    finally:
        for tree in trees:
            tree.stop()
    return sample


def print_table(samples: dict[str, list[Mutant]], results: Results) -> None:
    """Print how many mutants of each room were caught, and those that were not."""
    print(f"\n| {'room':<24} | mutants | caught |\n|{'-' * 26}|--------:|-------:|")
    survivors = []
    for room, sample in samples.items():
        known = results.rooms.get(room, {})
        tested = [mutant for mutant in sample if mutant.key in known]
        missed = [mutant for mutant in tested if known[mutant.key]["survived"]]
        share = f"{100.0 * (1.0 - len(missed) / len(tested)):.0f} %" if tested else "-"
        print(f"| {room:<24} | {len(tested):7d} | {share:>6} |")
        survivors += missed
    print("\n".join(["", *(f"survived: {mutant}" for mutant in sorted(survivors, key=str))]))


def main() -> int:
    """Test the rooms that are named, and print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("rooms", nargs="+", metavar="ROOM", help=f"folders or modules below {PACKAGE}")
    parser.add_argument("--sample", type=int, default=40, help="mutants of each room (default: 40)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the sample (default: 0)")
    parser.add_argument("--tests", nargs="+", help="tests to run (default: tests/ROOM)")
    parser.add_argument("--limit", type=float, default=60.0, help="time of the tests of a mutant in s (default: 60)")
    parser.add_argument("--survivors", action="store_true", help="test the survivors in --json again")
    parser.add_argument("--jobs", type=int, default=1, help="mutants tested at the same time (default: 1)")
    parser.add_argument("--json", type=Path, help="file of results, read and continued if it exists")
    options = parser.parse_args()
    results, samples = Results(options.json), {}
    try:
        for room in options.rooms:
            samples[room] = test_room(room.strip("/"), options, results)
    except KeyboardInterrupt:
        print("\nmutate: interrupted")
        done = {room: found for room, found in results.rooms.items() if room in options.rooms}
        print_table({room: [_restored(row) for row in rows.values()] for room, rows in done.items()}, results)
        return 130
    print_table(samples, results)
    return 0


def _restored(row: dict[str, object]) -> Mutant:
    return Mutant(**{name: value for name, value in row.items() if name != "survived"})  # type: ignore[arg-type]


if __name__ == "__main__":
    raise SystemExit(main())
