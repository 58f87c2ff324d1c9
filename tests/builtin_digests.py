"""Runs of the built-in trials and their digests.

``python tests/builtin_digests.py`` writes the runs that ``simulation/builtin_digests.json`` lacks, and drops those of
trials that are gone. If a change of results is intended, delete the file first, and name the change in the commit.

The last bit of a result depends on the vector instructions that NumPy and its linear algebra use, so each run has a
digest for processors with AVX-512 and one for those without. The second one is written in another process, in which
both do without AVX-512.
"""

from __future__ import annotations

import dataclasses
import json
import os
import platform
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy._core import _multiarray_umath as umath  # the only place that tells the features in use

from crowdbot.recording import run
from crowdbot.simulation import Episode
from crowdbot.trials import builtin_trials, load_trial

FILE = Path(__file__).parent / "simulation" / "builtin_digests.json"
FORMS = ("planar/0/2", "physics/0/1", "planar/0/20")
"""World, seed and maximum simulated time [s]."""
STATE_TIMES = {"planar": 2.0, "physics": 0.5}
"""Time of the compared state by world [s]: early, since crowds are chaotic."""
PACKAGES = ("numpy", "scipy", "shapely", "numba", "llvmlite", "mujoco")
LEVELS = {"x86-64-v4": "X86_V4", "x86-64-v3": "X86_V3"}
"""NumPy's name of each level of the processor that it has code for, best first."""


def level() -> str:
    """Return the level of the processor that NumPy uses; empty for other processors."""
    return next((name for name, feature in LEVELS.items() if umath.__cpu_features__.get(feature)), "")


def level_environment(name: str) -> dict[str, str]:
    """Return the environment of a process in which NumPy uses no more than this level."""
    if name == level():
        return dict(os.environ)
    beyond = umath.__cpu_dispatch__[umath.__cpu_dispatch__.index(LEVELS[name]) + 1 :]
    return {**os.environ, "NPY_DISABLE_CPU_FEATURES": " ".join(beyond), "OPENBLAS_CORETYPE": "Haswell"}


def machine() -> dict[str, str]:
    """Return what the last bit of a result depends on, beside the level: operating system, versions of libraries."""
    return {
        "system": platform.system(),
        "machine": platform.machine(),
        "libc": " ".join(platform.libc_ver()),
        "python": ".".join(platform.python_version_tuple()[:2]),
        **{name: version(name) for name in PACKAGES},
    }


def differences(recorded: dict[str, str]) -> list[str]:
    """Return why digests of another machine need not be those of this one; empty if they are equal at equal levels."""
    here = machine()
    found = [f"{name} {here[name]} instead of {recorded[name]}" for name in here if here[name] != recorded[name]]
    return found if level() else [*found, f"NumPy has no code for {' or '.join(LEVELS)}"]


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
    """Write the digests that the file lacks for the level of this process, and drop those of trials that are gone."""
    whole = json.loads(file.read_text("utf-8")) if file.exists() else {"machine": machine(), "runs": {}}
    keys = [f"{name}/{form}" for form in FORMS for name in sorted(builtin_trials())]
    missing = [key for key in keys if level() not in whole["runs"].get(key, {}).get("digest", {})]
    if missing and (reasons := differences(whole["machine"])):
        raise SystemExit(
            f"{len(missing)} runs are missing, and the others are of another machine: {', '.join(reasons)}; "
            f"delete {file} to write all runs"
        )
    if gone := whole["runs"].keys() - keys:
        whole["runs"] = {key: row for key, row in whole["runs"].items() if key not in gone}
        _store(whole, file)
    for key in missing:
        row = entry(key)
        if row["outcome"] == "interrupted":
            raise KeyboardInterrupt
        old = whole["runs"].setdefault(key, row | {"digest": {}})
        if abs(np.subtract(row["state"], old["state"])).max() > 1e-6:
            raise SystemExit(f"{key} is another run on {level()}: {row['state']}, not {old['state']}")
        old["digest"] = dict(sorted({**old["digest"], level(): row["digest"]}.items(), reverse=True))
        print(f"{key} {level()} {row['digest']}", flush=True)
        _store(whole, file)


def _store(whole: dict[str, Any], file: Path) -> None:
    rows = ",\n".join(f"  {json.dumps(name)}: {json.dumps(row)}" for name, row in sorted(whole["runs"].items()))
    head = f' "machine": {json.dumps(whole["machine"])},\n "runs": '
    file.write_text("{\n" + head + "{\n" + rows + "\n }\n}\n", encoding="utf-8")


def main() -> None:
    """Write the digests of this level of processor, and those of the lower ones in other processes."""
    write()
    levels = list(LEVELS)
    for name in levels[levels.index(level()) + 1 :] if level() else ():
        subprocess.run([sys.executable, __file__], env=level_environment(name), check=True)
    if level() != levels[0] and "NPY_DISABLE_CPU_FEATURES" not in os.environ:
        print(f"this processor cannot write digests of {levels[0]}; new runs need them, too")


if __name__ == "__main__":
    main()
