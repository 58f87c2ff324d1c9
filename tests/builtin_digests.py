"""Runs of the built-in trials and their digests.

``python tests/builtin_digests.py`` writes the runs that ``simulation/builtin_digests.json`` lacks. If a change of
results is intended, delete the file first, and name the change in the commit.
"""

from __future__ import annotations

import dataclasses
import json
import platform
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

import llvmlite.binding
import numpy as np

from crowdbot.recording import run
from crowdbot.simulation import Episode
from crowdbot.trials import builtin_trials, load_trial

FILE = Path(__file__).parent / "simulation" / "builtin_digests.json"
FORMS = ("planar/0/2", "physics/0/1", "planar/0/20")
"""World, seed and maximum simulated time [s]."""
STATE_TIMES = {"planar": 2.0, "physics": 0.5}
"""Time of the compared state by world [s]: early, since crowds are chaotic."""
PACKAGES = ("numpy", "scipy", "shapely", "numba", "llvmlite", "mujoco")


def machine() -> dict[str, str]:
    """Return what the last bit of a result depends on: processor, operating system, versions of libraries."""
    return {
        "system": platform.system(),
        "machine": platform.machine(),
        "processor": llvmlite.binding.get_host_cpu_name(),
        "libc": " ".join(platform.libc_ver()),
        "python": ".".join(platform.python_version_tuple()[:2]),
        **{name: version(name) for name in PACKAGES},
    }


def entry(key: str) -> dict[str, Any]:
    """Run ``name/world/seed/seconds`` and return its digest, outcome, number of steps and early state."""
    name, world, seed, seconds = key.split("/")
    trial = load_trial(name)
    trial = dataclasses.replace(trial, world=world, duration=min(trial.duration, float(seconds)))
    episode = run(trial, seed=int(seed))
    state = early_state(episode, STATE_TIMES[world])
    return {"digest": episode.digest, "outcome": episode.outcome, "steps": episode.steps, "state": state}


def early_state(episode: Episode, latest: float) -> list[float]:
    """Return number, mean x [m], mean y [m] and mean speed [m/s] of the agents at the last instant up to ``latest``."""
    k = int(np.searchsorted(episode.times, latest + 1e-9)) - 1
    active = episode.active[k]
    speed = np.hypot(*episode.velocity[k, active].T)
    return [float(active.sum()), *episode.position[k, active].mean(axis=0).tolist(), float(speed.mean())]


def write(file: Path = FILE) -> None:
    """Write all runs that the file lacks."""
    here = machine()
    found = json.loads(file.read_text("utf-8")) if file.exists() else {"machine": here, "runs": {}}
    if found["machine"] != here:
        raise SystemExit(f"{file} was written on another machine, {found['machine']}; delete it to write all runs")
    for key in (f"{name}/{form}" for form in FORMS for name in sorted(builtin_trials())):
        if key in found["runs"]:
            continue
        begin = time.monotonic()
        row = entry(key)
        if row["outcome"] == "interrupted":
            raise KeyboardInterrupt
        found["runs"][key] = row
        print(f"{key} {found['runs'][key]['digest']} {time.monotonic() - begin:.1f} s", flush=True)
        rows = ",\n".join(f"  {json.dumps(name)}: {json.dumps(row)}" for name, row in sorted(found["runs"].items()))
        head = f' "machine": {json.dumps(found["machine"])},\n "runs": '
        file.write_text("{\n" + head + "{\n" + rows + "\n }\n}\n", encoding="utf-8")


if __name__ == "__main__":
    write()
