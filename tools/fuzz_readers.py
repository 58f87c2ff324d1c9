"""Mutate files and check that each is read, or rejected with a sentence: no trace, crash, hang or stray file.

    python tools/fuzz_readers.py --count 3000                      3000 files of every kind
    python tools/fuzz_readers.py --count 3000 --only maps meshes   of two kinds
    python tools/fuzz_readers.py --count 3000 --state fuzz.json    saves the counts; the same command continues
    python tools/fuzz_readers.py --only maps --seed 4 --replay 17  one file again, with its trace

Every kind of file that crowdbot reads has samples in ``tools/fuzz_kinds.py``. One file of a sample is changed, and the
sample is read in a child process with a memory limit: 1 GiB above its size after all unchanged samples. A crash or a
hang ends the child only. The child reports every file that it opens for writing outside the folder of the sample and
the cache, and every connection. File number N of a kind depends on the seed, the kind and N only. ``--keep DIR`` copies
the samples that failed.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import multiprocessing
import os
import platform
import random
import resource
import shutil
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

from fuzz_kinds import KINDS, OUT
from fuzz_xacro import mutate_xacro
from fuzzing import check_sentence, mutate_arrays, mutate_bytes, mutate_text, mutate_xml

from crowdbot.core import CrowdbotError, cache_root

TIME_LIMIT = 20.0
"""Longest time for one file [s]."""
MEMORY_LIMIT = 1 << 30
"""Most memory above that of the child process after the unchanged samples [bytes]."""
XML = (".xml", ".urdf", ".dae", ".world", ".sdf")
BINARY = (".h5", ".sqlite", ".parquet", ".npz", ".mcap", ".stl", ".ply", ".glb", ".pgm", ".gz", ".bag", ".db3")
GOOD = ("read", "rejected")
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
CHANGES = ("os.mkdir", "os.remove", "os.rmdir", "os.rename", "os.link", "os.symlink", "os.truncate", "os.chmod")
PROGRAMS = ("os.system", "os.exec", "os.posix_spawn", "os.fork", "subprocess.Popen", "socket.connect", "socket.bind")


def mutate(name: str, data: bytes, rng: random.Random) -> bytes:
    """Return the content of a file with changes that suit its format."""
    ending = Path(name).suffix
    try:
        if ending == ".npz" and rng.random() < 0.7:
            return mutate_arrays(data, rng)
        if ending in BINARY or rng.random() < 0.15:
            return mutate_bytes(data, rng)
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        return mutate_bytes(data, rng)
    if ending == ".xacro":
        return mutate_xacro(text, rng).encode("utf-8", "surrogatepass")
    if ending in XML:
        return mutate_xml(text, rng).encode("utf-8", "surrogatepass")
    part = text[: rng.choice((len(text), 4000, 400))]
    return mutate_text(part, rng).encode("utf-8", "surrogatepass")


def write_mutant(kind: str, number: int, seed: int, base: Path, work: Path) -> tuple[str, random.Random]:
    """Copy a sample to the work folder with one file changed; return its name and the rest of the random stream."""
    rng = random.Random(f"{seed} {kind} {number}")  # noqa: S311
    sample = rng.choice(sorted(base.iterdir()))
    shutil.copytree(sample, work, dirs_exist_ok=True)
    names = sorted(path.relative_to(sample).as_posix() for path in sample.rglob("*") if path.is_file())
    name = rng.choice([name for name in names if not name.endswith(KINDS[kind].fixed or ("\0",))])
    (work / name).write_bytes(mutate(name, (sample / name).read_bytes(), rng))
    return name, rng


class Always(random.Random):
    """A random stream that takes every branch of low probability."""

    def random(self) -> float:
        """Return 0."""
        return 0.0


class Watch:
    """Notes what this process writes outside some folders, starts or connects to, by an audit hook."""

    def __init__(self, *allowed: Path) -> None:
        self.allowed = tuple(str(path.resolve()) for path in (*allowed, Path("/dev/null"), Path("/proc/self")))
        self.seen: list[str] = []
        sys.addaudithook(self.hook)

    def hook(self, event: str, args: tuple[Any, ...]) -> None:
        """Note an event."""
        if event == "open":
            path, _, flags = args
            if flags & WRITING and isinstance(path, str | bytes | os.PathLike):
                self.check(event, path)
        elif event in CHANGES:
            for path in args[: 2 if event in ("os.rename", "os.link", "os.symlink") else 1]:
                if isinstance(path, str | bytes | os.PathLike):
                    self.check(event, path)
        elif event in PROGRAMS and not any("hdf5_program.py" in str(part) for part in args):
            self.seen.append(f"{event} {args!r}"[:200])

    def check(self, event: str, path: str | bytes | os.PathLike[str]) -> None:
        """Note a path outside the allowed folders."""
        place = os.path.realpath(os.fsdecode(path))
        if not any(place == item or place.startswith(item + os.sep) for item in self.allowed):
            self.seen.append(f"{event} {place}")


def memory(field: str) -> int:
    """Return a figure of this process in /proc [bytes]."""
    for line in Path("/proc/self/status").read_text(encoding="utf-8").splitlines():
        if line.startswith(field + ":"):
            return 1024 * int(line.split()[1])
    return 0


def _child(pipe: Connection, kind: str, base: Path, work: Path, temporary: Path) -> None:
    warnings.simplefilter("ignore")
    platform.processor()  # starts a program once, as some libraries do at their import
    os.chdir(work)
    log = (base.parent / "stderr").open("w+b")
    os.dup2(log.fileno(), 2)
    for sample in sorted(base.iterdir()):  # libraries are imported and kernels compiled before memory is limited
        good = False
        for rng in (random.Random(0), Always(0), random.Random(1)):  # noqa: S311
            shutil.copytree(sample, work, dirs_exist_ok=True)
            name = next(path.relative_to(sample).as_posix() for path in sorted(sample.rglob("*")) if path.is_file())
            with contextlib.suppress(CrowdbotError):
                KINDS[kind].read(work, name, rng)
                good = True
            empty(work)
        if not good:
            KINDS[kind].read(sample, name, random.Random(0))  # noqa: S311
    watch = Watch(work, temporary, cache_root())
    limit = memory("VmSize") + MEMORY_LIMIT
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    pipe.send("ready")
    while True:
        name, rng = pipe.recv()
        Path("/proc/self/clear_refs").write_text("5", encoding="utf-8")  # resets the highest memory
        size, begin = memory("VmRSS"), time.perf_counter()
        outcome, text = "read", ""
        try:
            KINDS[kind].read(work, name, rng)
        except CrowdbotError as error:
            outcome = "rejected"
            try:
                check_sentence(str(error))
            except AssertionError as wrong:
                outcome, text = "no sentence", str(wrong)
        except BaseException as error:
            outcome, text = f"trace: {type(error).__name__}", traceback.format_exc()
        seconds = time.perf_counter() - begin
        log.seek(0)
        said = log.read().decode("utf-8", "replace")
        log.truncate(0)
        if "Traceback" in said:
            outcome, text = "trace in a log", said
        if watch.seen:
            outcome, text = "wrote outside", "\n".join(watch.seen)
            watch.seen.clear()
        pipe.send((outcome, text, seconds, max(0, memory("VmHWM") - size)))


def empty(folder: Path) -> None:
    """Remove everything in a folder."""
    for path in folder.iterdir():
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()


class Child:
    """A process that reads samples of one kind; started anew after a crash or a hang."""

    def __init__(self, kind: str, base: Path, work: Path, temporary: Path) -> None:
        self.pipe, end = multiprocessing.Pipe()
        target = multiprocessing.get_context("fork").Process
        self.process = target(target=_child, args=(end, kind, base, work, temporary), daemon=True)
        self.process.start()
        end.close()
        with contextlib.suppress(EOFError):
            if self.pipe.poll(600.0) and self.pipe.recv() == "ready":
                return
        raise RuntimeError(f"the unchanged samples of {kind} cannot be read: {(base.parent / 'stderr').read_text()}")

    def judge(self, name: str, rng: random.Random) -> tuple[str, str, float, int]:
        """Return outcome, trace, duration [s] and added memory [bytes] of a sample."""
        self.pipe.send((name, rng))
        try:
            if self.pipe.poll(TIME_LIMIT):
                return self.pipe.recv()
            outcome = "hang"
        except (EOFError, ConnectionError):
            outcome = "crash"
        self.stop()
        return outcome, f"exit status {self.process.exitcode}", TIME_LIMIT, 0

    def stop(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.join()


class Fuzzer:
    """Mutates samples of one kind and counts outcomes.

    Fields:
        done: counts of outcomes; ``next``: number of the next file; ``slowest_ms`` and ``memory_mib``: maxima.
    """

    def __init__(self, kind: str, seed: int, folder: Path, done: dict[str, int], keep: Path | None = None) -> None:
        self.kind, self.seed, self.keep = kind, seed, keep
        self.done: Counter[str] = Counter(done)
        self.base, self.work, self.temporary = (folder / kind / name for name in ("good", "work", "tmp"))
        for path in (self.base, self.work, self.temporary):
            path.mkdir(parents=True)
        KINDS[kind].make(self.base)
        os.environ["TMPDIR"] = tempfile.tempdir = str(self.temporary)

    def run(self, numbers: range) -> int:
        """Read the files of these numbers and return how many failed."""
        failed = 0
        child = Child(self.kind, self.base, self.work, self.temporary)
        try:
            for number in numbers:
                name, rng = write_mutant(self.kind, number, self.seed, self.base, self.work)
                before = self.files()
                outcome, text, seconds, added = child.judge(name, rng)
                stray = sorted(self.files() - before) + sorted(path.name for path in self.temporary.iterdir())
                if stray and outcome in GOOD:
                    outcome, text = "stray files", ", ".join(stray)
                self.done[outcome] += 1
                self.done["next"] = number + 1
                self.done["slowest_ms"] = max(self.done["slowest_ms"], round(1e3 * seconds))
                self.done["memory_mib"] = max(self.done["memory_mib"], added >> 20)
                if outcome not in GOOD:
                    failed += 1
                    print(f"--- {self.kind} {number}: {name}: {outcome}\n{text}", flush=True)
                    if self.keep is not None:
                        shutil.copytree(self.work, self.keep / f"{self.kind}-{self.seed}-{number}", dirs_exist_ok=True)
                if not child.process.is_alive():
                    child = Child(self.kind, self.base, self.work, self.temporary)
                empty(self.work)
                empty(self.temporary)
        finally:
            child.stop()
        return failed

    def files(self) -> set[str]:
        """Return the names of the files in the work folder but those that readers may write."""
        paths = (path.relative_to(self.work) for path in self.work.rglob("*"))
        return {str(path) for path in paths if path.parts[0] != OUT and "__pycache__" not in path.parts}


def table(counts: dict[str, dict[str, int]]) -> str:
    """Return the counts as a table."""
    lines = [f"{'kind':12s} {'files':>7s} {'read':>7s} {'rejected':>9s} {'failed':>7s} {'slowest':>9s} {'memory':>9s}"]
    total: Counter[str] = Counter()
    for kind, done in counts.items():
        row = Counter({name: done.get(name, 0) for name in GOOD})
        row["files"] = sum(n for name, n in done.items() if name not in ("next", "slowest_ms", "memory_mib"))
        row["failed"] = row["files"] - row["read"] - row["rejected"]
        total.update(row)
        slow, most = done.get("slowest_ms", 0), done.get("memory_mib", 0)
        lines.append(_row(kind, row) + f" {slow / 1e3:7.1f} s {most:5d} MiB")
    return "\n".join([*lines, _row("all", total)])


def _row(name: str, row: Counter[str]) -> str:
    return f"{name:12s} {row['files']:7d} {row['read']:7d} {row['rejected']:9d} {row['failed']:7d}"


def fuzz(kinds: list[str], numbers: range, seed: int, state: Path | None = None, keep: Path | None = None) -> int:
    """Read mutated files of some kinds, print a table, and return how many failed.

    Args:
        kinds: names of :data:`fuzz_kinds.KINDS`.
        numbers: numbers of the files of every kind; what the state has done already is left out.
        seed: seed of the mutations.
        state: file with the counts so far, updated every 50 files.
        keep: folder for samples that failed.
    """
    counts: dict[str, dict[str, int]] = {}
    if state is not None and state.exists():
        known = json.loads(state.read_text(encoding="utf-8"))
        if known["seed"] != seed:
            raise SystemExit(f"{state} is of seed {known['seed']}, not {seed}")
        counts = known["counts"]
    failed, before = 0, os.getcwd()
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as root:
        try:
            for kind in kinds:
                first = max(numbers.start, counts.get(kind, {}).get("next", 0))
                if first >= numbers.stop:
                    continue
                fuzzer = Fuzzer(kind, seed, Path(root).resolve(), counts.get(kind, {}), keep)
                for start in range(first, numbers.stop, 50):
                    failed += fuzzer.run(range(start, min(start + 50, numbers.stop)))
                    counts[kind] = dict(fuzzer.done)
                    print(f"{kind}: {fuzzer.done['next']} of {numbers.stop}", file=sys.stderr, flush=True)
                    if state is not None:
                        state.write_text(json.dumps({"seed": seed, "counts": counts}, indent=1), encoding="utf-8")
        finally:
            os.chdir(before)
            tempfile.tempdir = None
    print(table(counts))
    return failed


def main() -> int:
    """Run and print the counts; return 1 if a file failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="number of files of every kind (default 200)")
    parser.add_argument("--only", nargs="+", choices=list(KINDS), metavar="KIND", help=f"of {', '.join(KINDS)}")
    parser.add_argument("--seed", type=int, default=0, help="seed of the mutations (default 0)")
    parser.add_argument("--replay", type=int, metavar="N", help="only file number N")
    parser.add_argument("--state", type=Path, metavar="FILE", help="JSON file of the counts, to continue from")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="folder for the samples that failed")
    options = parser.parse_args()
    numbers = range(options.count) if options.replay is None else range(options.replay, options.replay + 1)
    keep = None if options.keep is None else options.keep.resolve()
    return int(fuzz(options.only or list(KINDS), numbers, options.seed, options.state, keep) > 0)


if __name__ == "__main__":
    sys.exit(main())
