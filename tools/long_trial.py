"""Run and record a long trial; print its speed, and the memory at quarters: ``python tools/long_trial.py OUT``.

    python tools/long_trial.py OUT [TRIAL] [SECONDS]

TRIAL is docs/gallery/trials/thousand.xml when it is not given: a thousand people for ten minutes. ``crowdbot run
docs/gallery/trials/thousand.xml --out OUT`` is the same with a progress bar.
"""

from __future__ import annotations

import dataclasses
import os
import re
import sys
import time
from pathlib import Path

from crowdbot.recording import record
from crowdbot.trials import load_trial

HOME = Path(__file__).parents[1]


def memory() -> float:
    """Return the memory of this process [MB]."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024


def main(out: str, trial: str = str(HOME / "docs" / "gallery" / "trials" / "thousand.xml"), seconds: str = "") -> None:
    """Run, and print."""
    one = load_trial(trial)
    if seconds:
        one = dataclasses.replace(one, duration=float(seconds))
    record(dataclasses.replace(one, duration=2.0), out=Path(out) / "warm.mcap", force=True)  # kernels are compiled once
    (Path(out) / "warm.mcap").unlink()
    used: list[float] = []

    def quarter(share: float) -> None:
        if share >= 0.25 * (len(used) + 1) - 1e-9:
            used.append(round(memory(), 1))

    load = os.getloadavg()[0]
    begin = time.perf_counter()
    done = record(one, out=out, progress=quarter, force=True)
    took = time.perf_counter() - begin
    size = (Path(out) / "episode.mcap").stat().st_size / 1e6
    print(f"{one.name}: {one.people} people, {done.end:g} s simulated in {took:.1f} s, outcome {done.outcome}")
    print(f"{done.end / took:.1f} times real time, recorded, machine load {load:.1f} on {os.cpu_count()} cores")
    print(f"memory at quarters of the run [MB]: {used}; episode.mcap {size:.1f} MB; digest {done.digest}")


if __name__ == "__main__":
    main(*sys.argv[1:])
