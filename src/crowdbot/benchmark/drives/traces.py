"""Motion of a robot alone in an empty hall, in the plane and in the physics world, and its files."""

from __future__ import annotations

import hashlib
import importlib.metadata
import itertools
import math
import os
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import crowdbot
from crowdbot.core import InputError, Pose, Scene, Twist, explain_write_errors
from crowdbot.humans import People, names
from crowdbot.models import ORCA
from crowdbot.typing import Floats
from crowdbot.world import (
    AckermannDrive,
    CommandDelay,
    Drive,
    Omnidirectional,
    Pending,
    PhysicsStage,
    PhysicsWorld,
    Robot,
    Twists,
)

SAMPLE = 0.02
"""Time [s] between two samples of a trace, in which the command is constant."""


class DriveTrace(NamedTuple):
    """Motion after each sample of :data:`SAMPLE` seconds.

    Fields:
        position: ``[N, 2]`` [m]; the robot starts at the origin.
        heading: ``[N]`` [rad] without jumps, 0 at the start.
        twist: ``[N, 3]`` forward, left [m/s] and turn rate [rad/s].
        tilt: ``[N]`` angle from the vertical [rad].
    """

    position: Floats
    heading: Floats
    twist: Floats
    tilt: Floats


def trace_planar(robot: Robot, commands: Sequence[Twist], step: float) -> DriveTrace:
    """Return the motion in the plane: exactly the drive, with the latency of the robot.

    Args:
        robot: the robot.
        commands: command of each sample.
        step: time step [s]; a sample is a whole number of steps.

    Raises:
        InputError: a sample is not a whole number of steps.

    >>> from crowdbot.world import Robot
    >>> trace = trace_planar(Robot.load("differential"), [Twist(1.0, 0.0)] * 100, 0.01)
    >>> round(float(trace.twist[-1, 0]), 3), round(float(trace.position[-1, 0]), 3)
    (1.0, 1.505)
    """
    pose, twist = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1)
    delay, now = CommandDelay(robot.latency), Twist()
    pending: tuple[Pending, ...] = ()
    heading, rows = 0.0, []
    for command in commands:
        for _ in range(_steps(step)):
            pending, current = delay.step(pending, now, command, step)
            now = current.at(0) if isinstance(current, Twists) else current
            old = float(pose.heading[0])
            pose, twist = robot.drive.step(pose, twist, now, step)
            heading += _turned(old, float(pose.heading[0]))
        rows.append((*pose.position[0], heading, twist.forward[0], twist.left[0], twist.turn[0], 0.0))
    return _trace(rows)


def trace_physics(robot: Robot, commands: Sequence[Twist], step: float, friction: float = 1.0) -> DriveTrace:
    """Return the motion in a :class:`PhysicsWorld` without people, walls and props.

    Args:
        robot: the robot; a rider that is no single body is the heaviest person.
        commands: command of each sample.
        step: time step of the engine [s]; a sample is a whole number of steps.
        friction: friction coefficient of the floor.

    Raises:
        InputError: a sample is not a whole number of steps.
        MissingExtra: mujoco is not installed.

    >>> from crowdbot.world import Robot
    >>> trace = trace_physics(Robot.load("differential"), [Twist(1.0, 0.0)] * 100, 0.01)
    >>> round(float(trace.twist[-1, 0]), 2)
    1.0
    """
    _steps(step)
    scene = Scene.of([[0.0, 0.0]], heading=[0.0], external=[True], radius=[robot.radius])
    stage = PhysicsStage(friction=friction)
    riders, people = _rider(robot)
    world = PhysicsWorld(
        scene, ORCA(), {0: robot}, dt=SAMPLE, physics_dt=step, stage=stage, riders=riders, people=people
    )
    heading, old, rows = 0.0, 0.0, []
    for command in commands:
        world.step({0: command})
        body, twist = world.robot_body(0), world.twists[0]
        pose = body.pose
        heading, old = heading + _turned(old, float(pose.heading[0])), float(pose.heading[0])
        rows.append((*pose.position[0], heading, twist.forward[0], twist.left[0], twist.turn[0], body.tilt))
    return _trace(rows)


def _rider(robot: Robot) -> tuple[tuple[int, ...], People | None]:
    """Return the robots with a rider and the bodies of riders."""
    if not robot.rider:
        return (), None
    people = People.of([robot.rider] if robot.rider in names() else list(names()))
    return (0,), People.of([people.persons[int(people.mass.argmax())].name])


def _steps(step: float) -> int:
    count = round(SAMPLE / step) if step > 0.0 else 0
    if count < 1 or abs(count * step - SAMPLE) > 1e-9:
        raise InputError(f"time step {step} s: {SAMPLE} s must be a whole number of steps")
    return count


def _turned(old: float, new: float) -> float:
    return (new - old + math.pi) % (2.0 * math.pi) - math.pi


def _trace(rows: Sequence[Sequence[float]]) -> DriveTrace:
    table = np.array(rows, dtype=np.float64).reshape(-1, 7)
    return DriveTrace(table[:, :2], table[:, 2], table[:, 3:6], table[:, 6])


HOLD = 2.0
"""Time [s] for which a speed of the grid is held after it is reached in the plane, and for standing after the stop."""


@dataclass(frozen=True)
class Manoeuvre:
    """Commands over time.

    Fields:
        name: ``grid``, ``straight``, ``sine``, ``ramp``, ``weave`` or ``slip``.
        commands: command of each sample.
        held: number of samples until the order to stop; all if there is none.
        friction: friction coefficient of the floor.
    """

    name: str
    commands: tuple[Twist, ...]
    held: int
    friction: float = 1.0


def speed_grid(drive: Drive, quick: bool = False) -> list[Twist]:
    """Return the speeds of the grid: shares of the largest speed and turn rate, without rest.

    Omnidirectional drives also go sideways and diagonally. Cars do not turn on the spot.

    >>> from crowdbot.world import DifferentialDrive
    >>> len(speed_grid(DifferentialDrive())), len(speed_grid(DifferentialDrive(), quick=True))
    (24, 3)
    """
    top, most = float(getattr(drive, "max_speed", 1.0)), float(getattr(drive, "max_turn_rate", 1.0))
    if quick:
        shares = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    else:
        levels = (-1.0, -0.5, 0.0, 0.5, 1.0)
        shares = [(v, w) for v, w in itertools.product(levels, levels) if v or w]
    found = [Twist(v * top, w * most) for v, w in shares if v or not isinstance(drive, AckermannDrive)]
    if isinstance(drive, Omnidirectional):
        found += [Twist(0.0, 0.0, left=top), Twist(0.5 * top, 0.5 * most, left=-0.5 * top)]
    return found


def manoeuvres(robot: Robot, quick: bool = False) -> list[Manoeuvre]:
    """Return the manoeuvres of a robot.

    Each speed of the grid is a step from rest, held, and a stop. ``straight`` is full speed for a while; ``ramp`` a
    slow increase of speed; ``sine`` a turn rate like a sine at half speed; ``weave`` sudden swerves at full speed;
    ``slip`` the same as ``weave`` on a floor with a tenth of the friction.

    >>> from crowdbot.world import Robot
    >>> [one.name for one in manoeuvres(Robot.load("differential"), quick=True)]
    ['grid', 'grid', 'grid', 'straight', 'ramp', 'sine', 'weave', 'slip']
    """
    drive = robot.drive
    top, most = float(getattr(drive, "max_speed", 1.0)), float(getattr(drive, "max_turn_rate", 1.0))
    reach = _reach(drive)
    result = [_held("grid", twist, reach + robot.latency + HOLD, reach + HOLD) for twist in speed_grid(drive, quick)]
    long = 2.0 if quick else 10.0
    result.append(_held("straight", Twist(top, 0.0), long, reach + HOLD))
    result.append(_timed("ramp", long, lambda t: Twist(top * t / long, 0.0)))
    result.append(_timed("sine", long, lambda t: Twist(0.5 * top, 0.5 * most * math.sin(0.5 * math.pi * t))))
    swerves = _timed("weave", long, lambda t: Twist(top, most * (0.5 if int(t) % 2 else -0.5)))
    result.append(swerves)
    result.append(Manoeuvre("slip", swerves.commands, swerves.held, 0.1))
    return result


def _reach(drive: Drive) -> float:
    """Return the time [s] in which any speed of a drive is reached from rest."""
    push, spin = getattr(drive, "max_acceleration", math.inf), getattr(drive, "max_turn_acceleration", math.inf)
    lag = 5.0 * getattr(drive, "time_constant", 0.0)
    bend = getattr(drive, "max_steering", 0.0) / getattr(drive, "max_steering_rate", 1.0)
    top, most = getattr(drive, "max_speed", 0.0), getattr(drive, "max_turn_rate", 0.0)
    return float(max(top / push, most / spin, bend) + lag)


def _held(name: str, twist: Twist, held: float, still: float) -> Manoeuvre:
    count = round(held / SAMPLE)
    return Manoeuvre(name, (*[twist] * count, *[Twist()] * round(still / SAMPLE)), count)


def _timed(name: str, duration: float, at: Callable[[float], Twist]) -> Manoeuvre:
    count = round(duration / SAMPLE)
    return Manoeuvre(name, tuple(at(k * SAMPLE) for k in range(count)), count)


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
        (item, trace_physics(robot, item.commands, step, item.friction), trace_planar(robot, item.commands, step))
        for item in chosen
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
        result = _read(file, key, chosen)
        if result is None:
            result = measure(robot, step, chosen)
            with explain_write_errors(file):
                self.folder.mkdir(parents=True, exist_ok=True)
                _write(file, key, result)
        return result


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
            return tuple(
                (item, _read_trace(kept, f"a{n}/"), _read_trace(kept, f"b{n}/")) for n, item in enumerate(chosen)
            )
    except (OSError, KeyError, ValueError, EOFError, zipfile.BadZipFile):
        return None


def _read_trace(kept: Mapping[str, Any], prefix: str) -> DriveTrace:
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
