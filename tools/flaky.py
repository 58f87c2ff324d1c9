"""Find tests whose outcome differs from run to run: ``python tools/flaky.py [PATH ...]``.

The tests of the gate run three times in a random order (also of sets), once more beside two processes that only
compute, and once more with no compiled kernel in the cache. Each run prints its seed. At the end come the tests that
did not have the same outcome in all runs, with commands that repeat the run, and the exit status is 1 if there is one.
A test that failed in all runs is no such test, but is counted. A run of everything takes as long as five times the gate
in one process; Ctrl-C ends the work, and what is known by then is reported. ``--tier live`` takes the live tests.

With ``--workers`` the tests run in several processes, which is faster, but then a seed does not give the same order.
"""

from __future__ import annotations

import argparse
import contextlib
import multiprocessing
import os
import random
import shlex
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from shuffle import outcomes

ROOT = Path(__file__).parents[1]
ENDS = (0, 1, 5)
"""Exit statuses of pytest after a run that came to its end; 5 means that there was no test."""
INTERRUPTED = 130
TIERS = {"gate": "not live and not sweep and not soak", "live": "live and not sweep and not soak"}
LOOPS = 2


@dataclass(frozen=True)
class Run:
    """One run of the tests: its name, its seed, and what is unusual about it."""

    name: str
    seed: int
    busy: bool = False
    cold: bool = False


@dataclass
class Result:
    """What a run told: outcomes by test, and the exit status of pytest."""

    run: Run
    found: dict[str, str] = field(default_factory=dict)
    status: int = 0

    @property
    def ended(self) -> bool:
        """Whether the run came to its end."""
        return self.status in ENDS

    def text(self) -> str:
        """Return the numbers of the run in one line."""
        counts = ", ".join(f"{number} {name}" for name, number in sorted(Counter(self.found.values()).items()))
        return f"{counts or 'no tests'}{'' if self.ended else f'; it ended early, exit status {self.status}'}"


def plan_runs(number: int, seed: int, without: Sequence[str] = ()) -> list[Run]:
    """Return the runs: random orders, one beside busy loops, one with an empty cache of kernels."""
    seeds = random.Random(seed)  # noqa: S311
    draw = [seeds.randrange(10**6) for _ in range(number + 2)]
    runs = [Run(f"order {k + 1}", draw[k]) for k in range(number)]
    runs += [Run("busy", draw[-2], busy=True)] if "busy" not in without else []
    runs += [Run("cold", draw[-1], cold=True)] if "cold" not in without else []
    return runs


def compute_on(parent: int) -> None:
    """Keep a processor busy as long as a process lives."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    while os.getppid() == parent:
        sum(range(10**6))


@contextlib.contextmanager
def busy_loops(number: int) -> Iterator[None]:
    """Keep some processors busy as long as the block lasts."""
    context = multiprocessing.get_context("spawn")
    loops = [context.Process(target=compute_on, args=(os.getpid(),), daemon=True) for _ in range(number)]
    try:
        for loop in loops:
            loop.start()
        yield
    finally:
        for loop in loops:
            if loop.pid is not None:
                loop.terminate()
                loop.join()


def command_of(paths: Sequence[str], tier: str, workers: str) -> list[str]:
    """Return the words of pytest behind the interpreter."""
    return ["-m", "pytest", "-p", "shuffle", "-p", "no:cacheprovider", "-m", TIERS[tier], "-n", workers, *paths]


def repeat_command(run: Run, paths: Sequence[str], tier: str, workers: str) -> str:
    """Return the command that runs the tests in the same order again."""
    cache = "CROWDBOT_CACHE=$(mktemp -d) " if run.cold else ""
    loops = f" beside {LOOPS} busy loops" if run.busy else ""
    words = shlex.join(command_of(paths, tier, workers))
    return f"{cache}SHUFFLE={run.seed} PYTHONHASHSEED={run.seed} PYTHONPATH=tools python {words}" + (
        f"   #{loops}" if loops else ""
    )


def perform(run: Run, words: Sequence[str]) -> Result:
    """Run the tests once, with their outcomes in a file, and return them, also of a run that is interrupted."""
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        lines = folder / "outcomes"
        lines.touch()
        paths = [str(ROOT / "src"), str(ROOT / "tools"), *filter(None, [os.environ.get("PYTHONPATH")])]
        environment = {**os.environ, "SHUFFLE": str(run.seed), "SHUFFLE_OUT": str(lines)}
        environment |= {"PYTHONPATH": os.pathsep.join(paths), "PYTHONHASHSEED": str(run.seed)}
        if run.cold:
            environment["CROWDBOT_CACHE"] = str(folder / "cache")
        if run.busy:
            stack.enter_context(busy_loops(LOOPS))
        try:
            status = subprocess.run([sys.executable, *words], cwd=ROOT, env=environment, check=False).returncode
        except KeyboardInterrupt:
            status = INTERRUPTED
        return Result(run, outcomes(lines.read_text(encoding="utf-8")), status)


def differences(results: Sequence[Result]) -> dict[str, dict[str, str]]:
    """Return the tests whose outcome differs, with their outcomes by run.

    A test that is absent from a run counts only if the run came to its end: an order may not decide which tests exist.
    A test that had begun when a run died counts; when somebody interrupted the run, it does not.
    """
    result: dict[str, dict[str, str]] = {}
    for test in sorted({test for result in results for test in result.found}):
        row = {result.run.name: result.found.get(test, "absent" if result.ended else "") for result in results}
        interrupted = {result.run.name for result in results if result.status == INTERRUPTED}
        row = {run: out for run, out in row.items() if out and not (out == "begun" and run in interrupted)}
        if len(set(row.values())) > 1:
            result[test] = row
    return result


def report(results: Sequence[Result], paths: Sequence[str], tier: str, workers: str) -> int:
    """Print the tests that differ and how to repeat the runs; return how many there are."""
    found = differences(results)
    print(f"\nflaky: {len(results)} runs")
    for result in results:
        print(f"flaky: {result.run.name:<8} seed {result.run.seed:<6} {result.text()}")
    for test, row in found.items():
        print(f"flaky: {test}: " + ", ".join(f"{outcome} in {run}" for run, outcome in row.items()))
    suspects = {run for row in found.values() for run, outcome in row.items() if outcome != "passed"}
    for result in results:
        if result.run.name in suspects:
            print(f"flaky: to repeat {result.run.name}: {repeat_command(result.run, paths, tier, workers)}")
    steady = {test for result in results for test, outcome in result.found.items() if outcome in ("failed", "error")}
    if always := sorted(steady - found.keys()):
        print(f"flaky: {len(always)} tests failed in every run, such as {always[0]}")
    print(f"flaky: {len(found)} tests did not have the same outcome in all runs")
    return len(found)


def main(words: list[str] | None = None) -> int:
    """Run, compare, report; return 1 if the outcome of a test differs, or a run did not come to its end."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("paths", nargs="*", metavar="PATH", default=["tests"], help="files or folders (default: tests)")
    parser.add_argument("--runs", type=int, default=3, help="runs in random order (default: 3)")
    parser.add_argument("--seed", type=int, help="seed of the seeds (default: by the time)")
    parser.add_argument("--without", nargs="+", choices=("busy", "cold"), default=(), help="runs to leave out")
    parser.add_argument("--tier", choices=TIERS, default="gate", help="tests to run (default: gate)")
    parser.add_argument("--workers", default="0", help="processes, as -n of pytest (default: 0, this gives the order)")
    options = parser.parse_args(words)
    if absent := [path for path in options.paths if not (ROOT / path.split("::")[0]).exists()]:
        parser.error(f"there is no {', '.join(absent)}")
    if options.runs < 0:
        parser.error(f"--runs is {options.runs}, it must be 0 or more")
    seed = int(time.time()) % 10**6 if options.seed is None else options.seed
    runs = plan_runs(options.runs, seed, options.without)
    if len(runs) < 2:
        parser.error("there is nothing to compare: --runs and --without leave fewer than two runs")
    print(f"flaky: {len(runs)} runs, --seed {seed}", flush=True)
    results: list[Result] = []
    for run in runs:
        print(f"\nflaky: run {run.name}, SHUFFLE={run.seed}", flush=True)
        results.append(perform(run, command_of(options.paths, options.tier, options.workers)))
        if results[-1].status == INTERRUPTED:
            break
    found = report(results, options.paths, options.tier, options.workers)
    if len(results) < len(runs) or any(result.status == INTERRUPTED for result in results):
        print("flaky: interrupted")
        return INTERRUPTED
    return int(found > 0 or not all(result.ended for result in results))


if __name__ == "__main__":
    sys.exit(main())
