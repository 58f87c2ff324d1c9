"""Traces of the drive laboratory in files, so that an interrupted measurement continues."""

from __future__ import annotations

import hashlib
import importlib.metadata
import os
import zipfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import crowdbot
from crowdbot.core import explain_write_errors
from crowdbot.world import Robot

from .manoeuvre import Manoeuvre
from .traces import DriveTrace, trace_physics, trace_planar

Run = tuple[Manoeuvre, DriveTrace, DriveTrace]
"""A manoeuvre with its motion in the physics world and in the plane."""
MEASURED = ("world/**/*.py", "core/**/*.py", "benchmark/drives/traces.py")
"""Files of the package whose code decides what a trace holds."""


def drive_runs(robot: Robot, step: float, chosen: Sequence[Manoeuvre]) -> tuple[Run, ...]:
    """Return the motions of a robot in both worlds.

    Args:
        robot: the robot.
        step: time step of the engine [s].
        chosen: the manoeuvres.

    >>> from crowdbot.benchmark import manoeuvres
    >>> robot = Robot.load("differential")
    >>> runs = drive_runs(robot, 0.01, manoeuvres(robot, quick=True)[:1])
    >>> len(runs), bool(abs(runs[0][1].position[-1, 0] - runs[0][2].position[-1, 0]) < 0.02)
    (1, True)
    """
    return tuple(
        (one, trace_physics(robot, one.commands, step, one.friction), trace_planar(robot, one.commands, step))
        for one in chosen
    )


class TraceStore:
    """Motions by robot and time step in the files of a folder.

    A file is used if robot, commands, time step, engine and code of the worlds are the same; otherwise the robot is
    measured again. A file that was written in part is not used.

    Args:
        folder: the folder, which is created; None: nothing is kept.

    Raises:
        OutputError: a file cannot be written.

    >>> import tempfile
    >>> from crowdbot.benchmark import manoeuvres
    >>> robot = Robot.load("differential")
    >>> with tempfile.TemporaryDirectory() as place:
    ...     store = TraceStore(Path(place))
    ...     runs = [store.runs(robot, 0.01, manoeuvres(robot, quick=True)[:1]) for _ in range(2)]
    >>> bool((runs[0][0][1].position == runs[1][0][1].position).all())
    True
    """

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder

    def runs(
        self,
        robot: Robot,
        step: float,
        chosen: Sequence[Manoeuvre],
        measure: Callable[..., tuple[Run, ...]] = drive_runs,
    ) -> tuple[Run, ...]:
        """Return the motions of a robot from its file, or measure and keep them.

        Args:
            robot, step, chosen: see :func:`drive_runs`.
            measure: what measures them.
        """
        if self.folder is None:
            return measure(robot, step, chosen)
        key = _key(robot, step, chosen)
        file = self.folder / f"{robot.name}-{1000.0 * step:g}ms-{key[:8]}.npz"
        found = _read(file, key, chosen)
        if found is None:
            found = measure(robot, step, chosen)
            with explain_write_errors(file):
                self.folder.mkdir(parents=True, exist_ok=True)
                _write(file, key, found)
        return found


def _key(robot: Robot, step: float, chosen: Sequence[Manoeuvre]) -> str:
    digest = hashlib.sha256()
    parts = (
        robot.name,
        robot.drive,
        robot.base,
        robot.wheels,
        robot.latency,
        robot.model.mass,
        robot.rider,
        step,
        chosen,
    )
    digest.update(repr(parts).encode())
    digest.update(importlib.metadata.version("mujoco").encode())
    package = Path(crowdbot.__file__).parent
    for path in sorted(path for pattern in MEASURED for path in package.glob(pattern)):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _read(file: Path, key: str, chosen: Sequence[Manoeuvre]) -> tuple[Run, ...] | None:
    """Return the motions in a file, None if there are none with this key."""
    try:
        with file.open("rb") as stream, np.load(stream, allow_pickle=False) as kept:
            if str(kept["key"]) != key:
                return None
            return tuple((one, _trace(kept, f"a{n}/"), _trace(kept, f"b{n}/")) for n, one in enumerate(chosen))
    except (OSError, KeyError, ValueError, EOFError, zipfile.BadZipFile):
        return None


def _trace(kept: Mapping[str, Any], prefix: str) -> DriveTrace:
    return DriveTrace(*(np.asarray(kept[prefix + name]) for name in DriveTrace._fields))


def _write(file: Path, key: str, runs: Sequence[Run]) -> None:
    arrays: dict[str, Any] = {"key": np.array(key)}
    for number, (_, physics, plane) in enumerate(runs):
        for world, trace in (("a", physics), ("b", plane)):
            arrays |= {f"{world}{number}/{name}": value for name, value in trace._asdict().items()}
    draft = file.with_suffix(".part")
    with draft.open("wb") as stream:
        np.savez_compressed(stream, **arrays)
    os.replace(draft, file)
