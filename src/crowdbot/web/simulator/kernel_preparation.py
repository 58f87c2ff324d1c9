"""Kernels of the first trial, compiled in processes of their own: a compiler in the server would stop the picture.

Two processes share the work, since the compiler uses one core: one compiles bodies, sensors and the picture, the other
the steps of the crowd and the robot. Each finds in the cache what the other one has compiled before.
"""

from __future__ import annotations

import contextlib
import dataclasses
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
PROGRAMS = tuple(
    f"from crowdbot.web.simulator.kernel_preparation import {name}; {name}()"
    for name in ("compile_run", "compile_view")
)
"""Programs of the processes; the first one compiles what the others have not."""
_ONE = threading.Lock()
"""Held by the session whose process compiles; others wait for the same kernels."""


def prepare_kernels(closed: Callable[[], bool], compiling: Callable[[], None]) -> None:
    """Compile the kernels of the first trial if they are not in the cache, in other processes.

    If a process fails, its kernels are compiled where they are needed, as in other programs.

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
    with contextlib.ExitStack() as stack:
        processes = [
            stack.enter_context(
                subprocess.Popen(  # noqa: S603 (this program)
                    [sys.executable, "-c", program],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                )
            )
            for program in PROGRAMS
        ]
        while processes[0].poll() is None and not closed():
            with contextlib.suppress(subprocess.TimeoutExpired):
                processes[0].wait(LOOK)
        for process in processes:
            process.kill()


def compile_view() -> None:
    """Compile what the bodies, sensors and pictures of the first trial need; ends with the process that waits."""
    _end_with_parent()
    from crowdbot.simulation import Simulation
    from crowdbot.trials import load_trial
    from crowdbot.web.scene import LAYERS, SceneInstant, WalkingBodies, instant_frame, scene_description

    name, values, seed = FIRST
    trial = load_trial(name, values)
    simulation = Simulation(trial, seed)
    simulation.begin()  # the sensors measure
    bodies = WalkingBodies(simulation)
    if bodies.motion is None:  # the sensors see limbs, so the world has bodies itself
        simulation.world.pose_people()
    else:
        bodies.walk(simulation, trial.step)
    instant_frame(SceneInstant.of(simulation, bodies.motion), list(LAYERS))
    scene_description(simulation, bodies.motion)


def compile_run() -> None:
    """Run the beginning of the first trial, first without sensors, which :func:`compile_view` compiles meanwhile.

    It ends with the process that waits.
    """
    _end_with_parent()
    from crowdbot.recording import open_run
    from crowdbot.simulation import EpisodeStatistics
    from crowdbot.trials import load_trial
    from crowdbot.web.scene import LAYERS, SceneInstant, WalkingBodies, instant_frame, scene_description

    from .live_values import live_values

    name, values, seed = FIRST
    trial = load_trial(name, values)
    robots = [dataclasses.replace(robot, sensors=(), default_sensors=False) for robot in trial.robots]
    for part in (dataclasses.replace(trial, robots=tuple(robots)), trial):
        with tempfile.TemporaryDirectory() as folder, open_run(part, seed, Path(folder) / "first.mcap") as run:
            bodies = WalkingBodies(run.simulation) if part is trial else None
            for _ in range(STEPS):
                run.step()
                if bodies is not None:
                    bodies.follow(run.simulation)
                    instant_frame(SceneInstant.of(run.simulation, bodies.motion), list(LAYERS))
                live_values(run.simulation)
            if bodies is not None:
                scene_description(run.simulation, bodies.motion)
            for sink in run.sinks:
                if isinstance(sink, EpisodeStatistics):
                    sink.metrics("interrupted")
    (cache_folder() / MARK).touch()


def _end_with_parent() -> None:
    """End this process when the other end of its input is closed, which the system does for a killed server."""

    def wait() -> None:
        sys.stdin.read()
        os._exit(1)

    threading.Thread(target=wait, name="crowdbot-parent", daemon=True).start()
