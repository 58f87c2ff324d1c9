"""Runs commands of crowdbot in a process that is killed at random moments, again and again, and then lets them end.

The process is a copy (fork) of one that has imported everything, so that the kills hit the work and not the imports. A
kill comes after a random share of the time that a whole run needs, or right after a change in the folder, when a file
is half written.
"""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

FEW, MANY = 3, 50
"""Numbers of kills of the sample and of the full test."""


def run_killed(folder: Path, words: Sequence[str], kills: int, seed: int, resume: tuple[str, str] = ("", "")) -> None:
    """Write ``whole`` by one run of a command, and ``killed`` by runs that are killed, into a folder.

    Args:
        folder: folder of both.
        words: words of the command, without ``--out``.
        kills: number of kills.
        seed: seed of their moments.
        resume: a file, and the option that is added if the folder has it.
    """
    options = [str(folder), str(kills), str(seed), *resume, *words]
    done = subprocess.run(
        [sys.executable, __file__, *options], capture_output=True, text=True, check=False, timeout=3000
    )
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout.splitlines()[-1] == f"{kills} kills"


def _start(words: Sequence[str], out: Path, resume: tuple[str, str]) -> int:
    """Return the process of a run that begins, a copy of this one."""
    more = [resume[1]] if resume[0] and (out / resume[0]).is_file() else []
    process = os.fork()
    if process:
        return process
    status = 1
    try:
        from crowdbot.cli import main

        status = main([*words, "--out", str(out), *more])
    finally:
        sys.stderr.flush()
        os._exit(status)


def _is_over(process: int) -> bool:
    """Return whether a process has ended by itself; raise if it failed."""
    found, status = os.waitpid(process, os.WNOHANG)
    if found and status:
        raise SystemExit(f"a run failed with status {status}")
    return bool(found)


def _newest(folder: Path) -> int:
    """Return when something in a folder was added, renamed or removed last."""
    places = [folder, *(item for item in folder.rglob("*") if item.is_dir())] if folder.is_dir() else []
    return max((place.stat().st_mtime_ns for place in places), default=0)


def _kill(process: int, out: Path, moment: float, change: bool) -> bool:
    """Kill a process after a time [s], or after the first change in its folder from then on; False if it ended."""
    begin, before = time.monotonic(), -1
    while not _is_over(process):
        if time.monotonic() - begin >= moment:
            now = _newest(out) if change else 0
            if not change or before not in (-1, now):
                os.kill(process, signal.SIGKILL)
                os.waitpid(process, 0)
                return True
            before = now
        time.sleep(0.0005)
    return False


def main() -> None:
    """Run the command of the arguments."""
    folder, kills, rng = Path(sys.argv[1]), int(sys.argv[2]), random.Random(int(sys.argv[3]))
    resume, words = (sys.argv[4], sys.argv[5]), sys.argv[6:]
    for room in ("evaluation", "falsification", "generation", "simulation", "recording", "gym"):
        __import__(f"crowdbot.{room}")
    begin = time.monotonic()
    os.waitpid(_start(words, folder / "whole", resume), 0)
    span, done = time.monotonic() - begin, 0
    while done < kills:
        if _kill(_start(words, folder / "killed", resume), folder / "killed", rng.uniform(0.0, span), done % 2 == 1):
            done += 1
        else:
            shutil.rmtree(folder / "killed")
    last = _start(words, folder / "killed", resume)
    while not _is_over(last):
        time.sleep(0.01)
    print(f"{done} kills")


if __name__ == "__main__":
    main()
