"""Mutate recordings and check that each is read, or rejected with a sentence: no trace, crash, hang or stray file.

    python tools/fuzz_readers.py --count 3000 --seed 0

The files are the synthetic recordings of the tests in every format, text and binary. They are read in a child process
with a memory limit: 1 GiB above its size before the first file. A crash or a hang ends the child only; it is reported
and the next file gets a new child. ``--keep DIR`` writes the files that failed.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import random
import resource
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from multiprocessing.connection import Connection
from pathlib import Path

from fuzzing import check_sentence, mutate_bytes, mutate_text

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "data"))

from synthetic_recordings import SYNTHETIC, write_all

from crowdbot.core import CrowdbotError
from crowdbot.data import FORMATS, load

TIME_LIMIT = 20.0
"""Longest time for one file [s]."""
MEMORY_LIMIT = 1 << 30
"""Most memory above that of the child process before the first file [bytes]."""
TEXT = ("petrack", "eth-obsmat", "sgan", "ucy-vsp", "sdd", "trajnetpp", "csv")


def seeds(formats: list[str] | None = None) -> dict[str, bytes]:
    """Return the unchanged files by name, of some formats or all."""
    with tempfile.TemporaryDirectory() as folder:
        files = write_all(Path(folder))
        return {
            name: path.read_bytes()
            for name, path in files.items()
            if formats is None or SYNTHETIC[name].format in formats
        }


def mutants(good: dict[str, bytes], count: int, seed: int) -> Iterator[tuple[str, bytes, dict[str, object]]]:
    """Yield name, content and options of mutated files; some are read as another format."""
    rng = random.Random(seed)  # noqa: S311
    names = list(good)
    for _ in range(count):
        name = rng.choice(names)
        options = dict(SYNTHETIC[name].options)
        data = good[name]
        if SYNTHETIC[name].format in TEXT and rng.random() < 0.85:
            part = data[: rng.choice((len(data), 4000, 400))]
            data = mutate_text(part.decode("utf-8"), rng).encode("utf-8", "surrogatepass")
        else:
            data = mutate_bytes(data, rng)
        if rng.random() < 0.1:
            options["format"] = rng.choice(list(FORMATS))
        if rng.random() < 0.2:
            options["fps"] = rng.choice((25.0, 2.5, 1e-3, 9999.0))
        yield name, data, options


def read(path: Path, options: dict[str, object]) -> str:
    """Return what became of a file: ``read`` or ``rejected``; raise whatever is not a sentence."""
    try:
        tracks = load(path, **options)  # type: ignore[arg-type]
        tracks.summary()
    except CrowdbotError as error:
        check_sentence(str(error))
        if path.name not in str(error):
            raise AssertionError(f"the message names no file: {error}") from None
        return "rejected"
    return "read"


def _child(pipe: Connection, folder: Path) -> None:
    for name, one in SYNTHETIC.items():  # libraries are imported before memory is limited
        if (folder / name).exists():
            load(folder / name, **dict(one.options))  # type: ignore[arg-type]
    size = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (size + MEMORY_LIMIT, size + MEMORY_LIMIT))
    while True:
        path, options = pipe.recv()
        begin = time.perf_counter()
        try:
            outcome, text = read(path, options), ""
        except BaseException as error:
            outcome, text = f"trace: {type(error).__name__}", traceback.format_exc()
        pipe.send((outcome, text, time.perf_counter() - begin))


class Child:
    """A process that reads files; started anew after a crash or a hang."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.pipe, end = multiprocessing.Pipe()
        self.process = multiprocessing.Process(target=_child, args=(end, folder), daemon=True)
        self.process.start()
        end.close()

    def judge(self, path: Path, options: dict[str, object]) -> tuple[str, str, float]:
        """Return outcome, trace and duration [s] of one file."""
        self.pipe.send((path, options))
        try:
            if self.pipe.poll(TIME_LIMIT + (0.0 if self.warm else 60.0)):
                self.warm = True
                outcome, text, seconds = self.pipe.recv()
                return ("hang" if seconds > TIME_LIMIT else outcome), text, seconds
            outcome = "hang"
        except (EOFError, ConnectionError):
            outcome = "crash"
        self.stop()
        return outcome, f"exit status {self.process.exitcode}", TIME_LIMIT

    warm = False

    def stop(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.join()


def fuzz(count: int, seed: int, formats: list[str] | None = None, keep: Path | None = None) -> Counter[str]:
    """Read mutated files and return how often each outcome occurred; failures are printed."""
    good = seeds(formats)
    done: Counter[str] = Counter()
    slowest = 0.0
    with tempfile.TemporaryDirectory() as root:
        base, work = Path(root, "good"), Path(root, "work")
        base.mkdir()
        work.mkdir()
        for name, data in good.items():
            (base / name).write_bytes(data)
        before = os.getcwd()
        os.chdir(work)
        child = Child(base)
        try:
            for number, (name, data, options) in enumerate(mutants(good, count, seed)):
                path = work / name
                path.write_bytes(data)
                outcome, text, seconds = child.judge(path, options)
                stray = sorted(one.name for one in work.iterdir() if one != path)
                outcome = f"wrote {', '.join(stray)}" if stray else outcome
                path.unlink()
                done[outcome] += 1
                slowest = max(slowest, seconds)
                if outcome not in ("read", "rejected"):
                    print(f"--- {number}: {name} {options}: {outcome}\n{text}")
                    if keep is not None:
                        keep.mkdir(parents=True, exist_ok=True)
                        (keep / f"{seed}-{number}-{name}").write_bytes(data)
                    if not child.process.is_alive():
                        child = Child(base)
        finally:
            child.stop()
            os.chdir(before)
    done["slowest_ms"] = round(1e3 * slowest)
    return done


def main() -> int:
    """Run and print the counts; return 1 if a file failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=3000, help="number of files (default 3000)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the mutations (default 0)")
    parser.add_argument("--formats", nargs="+", choices=list(FORMATS), help="formats (default: all)")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="folder for the files that failed")
    options = parser.parse_args()
    done = fuzz(options.count, options.seed, options.formats, options.keep)
    print(dict(sorted(done.items())))
    return int(any(name not in ("read", "rejected", "slowest_ms") for name in done))


if __name__ == "__main__":
    sys.exit(main())
