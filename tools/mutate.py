"""Measure how many small changes of the code the tests notice (mutation testing).

    python tools/mutate.py core                            40 mutants of src/crowdbot/core against tests/core
    python tools/mutate.py world calibration --sample 100 --json mutants.json

A mutant is one change of one place: a comparison, an arithmetic operator, a constant, a condition, ``min`` for ``max``,
``True`` for ``False``, or a statement left out. The sample depends only on the seed and the sources. Every mutant is
tested in a copy of the tree, with a time limit. Kernels are tested without the compiler, as far as their tests pass
that way. With ``--json`` finished mutants are kept, and the same command continues after an interruption.
"""

from __future__ import annotations

import argparse
import ast
import concurrent.futures
import hashlib
import itertools
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "src/crowdbot"
MEMORY = 8 * 2**30
"""Most memory [byte] that the tests of a mutant may take."""

SWAPS: dict[type[ast.AST], type[ast.AST]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult, ast.Pow: ast.Mult, ast.And: ast.Or, ast.Or: ast.And, ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}  # fmt: skip
OPPOSITES: dict[type[ast.AST], type[ast.AST]] = {ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Gt: ast.LtE, ast.GtE: ast.Lt}
NAMES = {"min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum", "any": "all", "all": "any",
         "argmin": "argmax", "argmax": "argmin", "sin": "cos", "cos": "sin", "floor": "ceil",
         "ceil": "floor"}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One change: the text from ``begin`` to ``end`` of a file becomes ``new``."""

    path: str
    line: int
    begin: int
    end: int
    old: str
    new: str
    source: str

    @property
    def key(self) -> str:
        """A name that is the same as long as the file is the same."""
        return f"{self.path}:{self.source}:{self.begin}:{self.end}:{self.new}"

    def __str__(self) -> str:
        old, new = (" ".join(text.split()) for text in (self.old, self.new))
        return f"{self.path}:{self.line}: {old[:60]} -> {new[:60]}"


def mutants_of(path: Path) -> list[Mutant]:
    """Return every mutant of a file, in the order of its text."""
    text = path.read_text(encoding="utf-8")
    data, name = text.encode(), path.relative_to(ROOT).as_posix()
    source = hashlib.blake2b(data, digest_size=6).hexdigest()
    starts = [0, *itertools.accumulate(len(line) for line in data.splitlines(keepends=True))]
    found = {}
    for node, new in _changes(ast.parse(text)):
        begin = starts[node.lineno - 1] + node.col_offset
        end = starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0)
        mutant = Mutant(name, node.lineno, begin, end, data[begin:end].decode(), new, source)
        if new != mutant.old:
            found[mutant.key] = mutant
    return sorted(found.values(), key=lambda mutant: (mutant.begin, mutant.end, mutant.new))


def _changes(tree: ast.AST) -> Iterator[tuple[ast.expr | ast.stmt, str]]:
    """Yield each place that can be changed, with its new text; not docstrings, annotations, decorators or f-strings."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for node in value if isinstance(value, list) else [value]:
            if isinstance(node, ast.expr | ast.stmt):
                yield from ((node, text) for text in _texts(node))
            if isinstance(node, ast.If | ast.IfExp) and not isinstance(node.test, ast.Compare | ast.UnaryOp):
                yield node.test, f"(not ({ast.unparse(node.test)}))"
            if isinstance(node, ast.AST) and not _is_left_out(node):
                yield from _changes(node)


def _is_left_out(node: ast.AST) -> bool:
    if isinstance(node, ast.JoinedStr | ast.Import | ast.ImportFrom):
        return True
    if isinstance(node, ast.If):
        return ast.unparse(node.test) == "TYPE_CHECKING"
    targets = node.targets if isinstance(node, ast.Assign) else []
    return any(isinstance(target, ast.Name) and target.id == "__all__" for target in targets)


def _texts(node: ast.expr | ast.stmt) -> Iterator[str]:
    """Yield the texts that may stand in the place of a node."""
    if isinstance(node, ast.Compare):
        for k, op in enumerate(node.ops):
            for other in {SWAPS[type(op)], OPPOSITES.get(type(op), SWAPS[type(op)])}:
                ops = [*node.ops[:k], other(), *node.ops[k + 1 :]]
                yield f"({ast.unparse(ast.Compare(node.left, ops, node.comparators))})"  # type: ignore[arg-type]
    elif isinstance(node, ast.BinOp) and type(node.op) in SWAPS:
        if not isinstance(node.left, ast.Constant | ast.JoinedStr) or not isinstance(
            getattr(node.left, "value", 0), str
        ):
            yield f"({ast.unparse(ast.BinOp(node.left, SWAPS[type(node.op)](), node.right))})"  # type: ignore[arg-type]
    elif isinstance(node, ast.BoolOp):
        yield f"({ast.unparse(ast.BoolOp(SWAPS[type(node.op)](), node.values))})"  # type: ignore[arg-type]
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
        yield f"({ast.unparse(node.operand)})"
    elif isinstance(node, ast.Constant):
        yield from _constants(node.value)
    elif isinstance(node, ast.Name) and node.id in NAMES and isinstance(node.ctx, ast.Load):
        yield NAMES[node.id]
    elif isinstance(node, ast.Attribute) and node.attr in NAMES and isinstance(node.ctx, ast.Load):
        yield f"{ast.unparse(node.value)}.{NAMES[node.attr]}"
    elif isinstance(node, ast.stmt):
        yield from _statements(node)


def _constants(value: object) -> Iterator[str]:
    if isinstance(value, bool):
        yield str(not value)
    elif isinstance(value, int | float):
        yield from {repr(value + 1), repr(value - 1), repr(type(value)(0))} - {repr(value)} - {"inf", "-inf", "nan"}


def _statements(node: ast.stmt) -> Iterator[str]:
    is_call = isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
    is_store = isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Subscript | ast.Attribute)
    if is_call or is_store or isinstance(node, ast.AugAssign | ast.Raise | ast.Delete):
        yield "pass"
    elif isinstance(node, ast.Continue):
        yield "break"


class Tree:
    """A copy of the repository in which one mutant at a time is tested."""

    def __init__(self, tests: list[str], limit: float) -> None:
        self.tests, self.limit = tests, limit
        self.folder = Path(tempfile.mkdtemp(prefix="mutate-"))
        self.left_out: dict[bool, list[str]] = {}
        self.process: subprocess.Popen[str] | None = None
        listed = subprocess.run(
            ["git", "ls-files", "-co", "--exclude-standard", "-z"],
            cwd=ROOT, capture_output=True, text=True, check=True,
        )  # fmt: skip
        for name in filter(None, listed.stdout.split("\0")):
            if (ROOT / name).is_file():
                (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, self.folder / name)

    def measure(self, compiled: bool) -> float:
        """Run the unchanged tests; leave out those that fail, and return how long the others take [s]."""
        self.left_out[compiled] = []
        _, printed, _ = self._pytest(["--tb=no", "-rfE"], self.tests, compiled, self.limit * 20)
        failed = re.findall(r"^(?:FAILED|ERROR) (\S+(?: \S+)*?)(?: - .*)?$", printed, re.MULTILINE)
        broken = [name for name in failed if "::" not in name]
        if broken:
            raise SystemExit(f"mutate: these tests cannot be loaded: {', '.join(broken)}")
        self.left_out[compiled] = [f"--deselect={name}" for name in failed]
        status, printed, seconds = self._pytest(["--tb=no"], self.tests, compiled, self.limit * 20)
        if status != 0:
            raise SystemExit(f"mutate: the unchanged tests do not pass:\n{printed[-2000:]}")
        return seconds

    def survives(self, mutant: Mutant, compiled: bool) -> bool:
        """Return whether all tests pass with a mutant."""
        path = self.folder / mutant.path
        before = path.read_bytes()
        path.write_bytes(before[: mutant.begin] + mutant.new.encode() + before[mutant.end :])
        stem = Path(mutant.path).stem
        files = sorted(file for name in self.tests for file in _test_files(self.folder / name))
        files.sort(key=lambda file: (stem not in file.stem, file.stem.removeprefix("test_") not in stem))
        try:
            names = [file.relative_to(self.folder).as_posix() for file in files]
            return self._pytest(["-x", "--tb=no"], names, compiled, self.limit)[0] == 0
        finally:
            path.write_bytes(before)

    def _pytest(self, options: list[str], tests: list[str], compiled: bool, limit: float) -> tuple[int, str, float]:
        begin, left_out = time.monotonic(), self.left_out.get(compiled, [])
        shared = next((p for p in (ROOT / "shared", ROOT.parent / "shared") if p.is_dir()), ROOT / "shared")
        environment = {"CROWDBOT_SHARED": str(shared), **os.environ, "PYTHONPATH": str(self.folder / "src"),
                       "PYTHONDONTWRITEBYTECODE": "1"}  # fmt: skip
        environment |= {} if compiled else {"NUMBA_DISABLE_JIT": "1"}
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *options, *left_out, *tests]
        with tempfile.TemporaryFile("w+") as printed:
            self.process = subprocess.Popen(
                command, cwd=self.folder, env=environment, stdout=printed, stderr=subprocess.STDOUT, text=True,
                start_new_session=True,
            )  # fmt: skip
            if sys.platform == "linux":
                resource.prlimit(self.process.pid, resource.RLIMIT_DATA, (MEMORY, MEMORY))
            try:
                status = self.process.wait(limit)
            except subprocess.TimeoutExpired:
                self.stop()
                status = -1
            printed.seek(0)
            return status, printed.read(), time.monotonic() - begin

    def stop(self) -> None:
        """End the tests that run."""
        if self.process is not None and self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()

    def remove(self) -> None:
        """Remove the copy."""
        self.stop()
        shutil.rmtree(self.folder, ignore_errors=True)


def _test_files(path: Path) -> list[Path]:
    return [path] if path.is_file() else sorted(path.rglob("test_*.py"))


def _tests_of(room: str) -> list[str]:
    """Return the folder of tests of a room, or of the room around it."""
    for name in (room, *(parent.as_posix() for parent in Path(room).parents)):
        if (ROOT / "tests" / name).is_dir() and name != ".":
            return [f"tests/{name}"]
    raise SystemExit(f"mutate: there is no folder tests/{room}; name the tests with --tests")


def _has_kernels(mutant: Mutant) -> bool:
    return "@kernel" in (ROOT / mutant.path).read_text(encoding="utf-8")


class Results:
    """What became of each mutant, kept in a file if there is one."""

    def __init__(self, file: Path | None) -> None:
        self.file, self.lock = file, threading.Lock()
        self.rooms: dict[str, dict[str, dict[str, object]]] = {}
        if file is not None and file.exists():
            self.rooms = json.loads(file.read_text(encoding="utf-8"))

    def add(self, room: str, mutant: Mutant, survived: bool) -> None:
        """Add one result and write the file anew, whole or not at all."""
        with self.lock:
            self.rooms.setdefault(room, {})[mutant.key] = {**asdict(mutant), "survived": survived}
            if self.file is not None:
                fresh = self.file.with_suffix(".part")
                fresh.write_text(json.dumps(self.rooms, indent=1), encoding="utf-8")
                fresh.replace(self.file)


def test_room(room: str, options: argparse.Namespace, results: Results) -> list[Mutant]:
    """Test the sample of a room, and return it."""
    place = ROOT / PACKAGE / room
    files = [place.with_suffix(".py")] if place.with_suffix(".py").is_file() else sorted(place.rglob("*.py"))
    every = [mutant for file in files for mutant in mutants_of(file)]
    if not every:
        raise SystemExit(f"mutate: {PACKAGE}/{room} has nothing to change")
    chooser = random.Random(f"{options.seed}:{room}")  # noqa: S311
    sample = chooser.sample(every, min(options.sample, len(every)))
    left = [mutant for mutant in sample if mutant.key not in results.rooms.get(room, {})]
    if not left:
        return sample
    trees = [Tree(options.tests or _tests_of(room), options.limit) for _ in range(options.jobs)]
    free, begin = list(trees), time.monotonic()
    try:
        for compiled in sorted({not _has_kernels(mutant) for mutant in left}):
            seconds = trees[0].measure(compiled)
            kind = "with the compiler" if compiled else "without the compiler"
            print(f"{room}: tests {kind} take {seconds:.0f} s, {len(trees[0].left_out[compiled])} left out", flush=True)
            for tree in trees:
                tree.left_out[compiled] = trees[0].left_out[compiled]
                tree.limit = max(tree.limit, 4.0 * seconds)

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
            tree.remove()
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
    parser.add_argument("--limit", type=float, default=60.0, help="least time limit of a mutant in s (default: 60)")
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
