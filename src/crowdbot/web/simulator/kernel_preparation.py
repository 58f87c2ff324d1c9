"""Kernels of the first trial, compiled in a process of its own: a compiler in the server would stop the picture."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path

from crowdbot.core import cache_folder

from .first_trial import FIRST

MARK = "app-first-trial"
"""File in the folder of the kernels; written when those of the first trial are there."""
STEPS = 8
LOOK = 0.1
"""Real time [s] between two looks at the process."""
PROGRAM = "from crowdbot.web.simulator.kernel_preparation import compile_kernels; compile_kernels()"
_ONE = threading.Lock()
"""Held by the session whose process compiles; others wait for the same kernels."""


def prepare_kernels(closed: Callable[[], bool], compiling: Callable[[], None]) -> None:
    """Compile the kernels of the first trial if they are not in the cache, in another process.

    If that process fails, the kernels are compiled where they are needed, as in other programs.

    Args:
        closed: whether nobody needs them any more.
        compiling: called if they are compiled now.
    """
    mark = cache_folder() / MARK
    if mark.exists():
        return
    compiling()
    while not _ONE.acquire(timeout=LOOK):
        if closed():
            return
    try:
        if not mark.exists():
            _compile_apart(closed)
    finally:
        _ONE.release()


def _compile_apart(closed: Callable[[], bool]) -> None:
    process = subprocess.Popen(  # noqa: S603 (this program)
        [sys.executable, "-c", PROGRAM],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    with process:
        while process.poll() is None:
            if closed():
                process.kill()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(LOOK)


def compile_kernels() -> None:
    """Run the beginning of the first trial with its picture, values and metrics; ends with the process that waits."""
    threading.Thread(target=_end_with_parent, name="crowdbot-parent", daemon=True).start()
    from crowdbot.recording import open_run
    from crowdbot.simulation import EpisodeStatistics
    from crowdbot.trials import load_trial
    from crowdbot.web.scene import LAYERS, SceneInstant, WalkingBodies, instant_frame, scene_description

    from .live_values import live_values

    name, values, seed = FIRST
    trial = load_trial(name, values)
    with tempfile.TemporaryDirectory() as folder, open_run(trial, seed, Path(folder) / "first.mcap") as run:
        bodies = WalkingBodies(run.simulation)
        for _ in range(STEPS):
            run.step()
            bodies.follow(run.simulation)
            instant_frame(SceneInstant.of(run.simulation, bodies.motion), list(LAYERS))
            live_values(run.simulation)
        scene_description(run.simulation, bodies.motion)
        for sink in run.sinks:
            if isinstance(sink, EpisodeStatistics):
                sink.metrics("interrupted")
    (cache_folder() / MARK).touch()


def _end_with_parent() -> None:
    """End this process when the other end of its input is closed, which the system does for a killed server."""
    sys.stdin.read()
    os._exit(1)
