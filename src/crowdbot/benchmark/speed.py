"""Speed: what ``crowdbot bench`` measures.

Medians of repeats after a warm-up, with the environment printed; ratios are to something timed in the same run or to
real time.
"""

from __future__ import annotations

import os
import platform
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError, Scene, UnknownName, stream

__all__ = ["MEASUREMENTS", "Row", "measure"]

DENSITY = 0.5
"""People per square metre in the crowds that are timed."""
DT = 0.1


@dataclass(frozen=True)
class Row:
    """One measured speed and its ratio to something measured or known in the same run."""

    name: str
    median: float
    unit: str
    against: str
    ratio: float
    environment: str

    def as_dict(self) -> dict[str, Any]:
        """Return the row as ``crowdbot bench --json`` prints it."""
        return asdict(self)


@dataclass(frozen=True)
class Measurement:
    """A piece of work to time: ``work()`` does ``amount`` units; the ratio is to ``reference`` units a second.

    When ``other`` is given it does the same amount of work in another way and its speed is the reference.
    """

    unit: str
    amount: float
    work: Callable[[], object]
    against: str
    reference: float = 0.0
    other: Callable[[], object] | None = None


def measure(
    names: Sequence[str] = (), repeats: int = 7, progress: Callable[[str, float], None] | None = None
) -> list[Row]:
    """Time the named measurements (all when none is named).

    Raises:
        UnknownName: a name is not in :data:`MEASUREMENTS`.
        InputError: ``repeats`` is below 1.
    """
    if repeats < 1:
        raise InputError(f"repeats {repeats} is below 1")
    unknown = next((name for name in names if name not in MEASUREMENTS), None)
    if unknown is not None:
        raise UnknownName("measurement", unknown, MEASUREMENTS)
    report = progress or (lambda what, share: None)
    rows = []
    for name in names or list(MEASUREMENTS):
        report(name, 0.0)
        rows.append(_row(name, MEASUREMENTS[name](), repeats, report))
    return rows


def _row(name: str, task: Measurement, repeats: int, report: Callable[[str, float], None]) -> Row:
    task.work()
    if task.other is not None:
        task.other()
    mine: list[float] = []
    theirs: list[float] = []
    for repeat in range(repeats):  # in turns, so that a change of the machine's load meets both
        mine.append(_seconds(task.work))
        if task.other is not None:
            theirs.append(_seconds(task.other))
        report(name, (repeat + 1) / repeats)
    speed = task.amount / statistics.median(mine)
    reference = task.amount / statistics.median(theirs) if theirs else task.reference
    return Row(name, speed, task.unit, task.against, speed / reference, environment())


def _seconds(work: Callable[[], object]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def environment() -> str:
    """Return the machine and the versions in one line."""
    import numba

    from crowdbot import __version__

    return (
        f"{_processor()}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()},"
        f" numpy {np.__version__}, numba {numba.__version__}, crowdbot {__version__}"
    )


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


def crowd(agents: int, environments: int = 1, seed: int = 0) -> Scene:
    """Return people on a jittered grid at 0.5 per square metre with goals at random, walking at 1.3 m/s."""
    random = stream(seed, "speed")
    side = (agents / DENSITY) ** 0.5
    count = int(np.ceil(agents**0.5))
    grid = (np.stack(np.meshgrid(np.arange(count), np.arange(count)), axis=-1).reshape(-1, 2)[:agents] + 0.5) / count
    place = side * grid + random.uniform(-0.2, 0.2, (environments, agents, 2))
    goal = random.uniform(0.0, side, (environments, agents, 2))
    away = goal - place
    return Scene.of(place, 1.3 * away / np.linalg.norm(away, axis=-1, keepdims=True), goal=goal, max_speed=1.8)


def _model(name: str, agents: int) -> Callable[[], Measurement]:
    def task() -> Measurement:
        from crowdbot import models

        model, scene = getattr(models, name)(), crowd(agents)
        real = f"real time ({agents} people, step {DT} s)"
        return Measurement("agent-steps/s", agents, lambda: model.step(scene, DT), real, agents / DT)

    return task


def _batch() -> Measurement:
    from crowdbot.models import ORCA

    model, many = ORCA(), crowd(32, environments=256)
    single = [
        Scene.of(many.position[e], many.velocity[e], goal=many.goal[e], max_speed=1.8) for e in range(many.shape[0])
    ]
    amount = many.shape[0] * many.shape[1]
    against = "the same 256 scenes of 32 people one after the other"
    return Measurement(
        "agent-steps/s",
        amount,
        lambda: model.step(many, DT),
        against,
        other=lambda: [model.step(s, DT) for s in single],
    )


def _lidar() -> Measurement:
    from crowdbot.core import Pose
    from crowdbot.sensors import Lidar2D

    sensor, scene = Lidar2D(rays=720), crowd(50).replace(walls=crowd(1).walls)
    pose = Pose.of((5.0, 5.0), 0.0)
    return Measurement("scans/s", 20, lambda: [sensor.measure(scene, pose) for _ in range(20)], "a 10 Hz sensor", 10.0)


def _predictor(name: str) -> Callable[[], Measurement]:
    def task() -> Measurement:
        from crowdbot import prediction
        from crowdbot.trials import load_trial

        predictor = getattr(prediction, name)()
        past, _ = load_trial("crossing-flows").run().tracks(0.4).windows(8, 12)
        return Measurement(
            "windows/s", len(past), lambda: predictor.predict(past, 12), "2.5 windows/s of a live stream", 2.5
        )

    return task


def _trial() -> Measurement:
    from crowdbot.trials import load_trial

    trial = load_trial("crossing-flows")
    seconds = float(trial.run().times[-1])
    return Measurement("simulated s/s", seconds, trial.run, "real time", 1.0)


MEASUREMENTS: dict[str, Callable[[], Measurement]] = {
    "orca-1000": _model("ORCA", 1000),
    "orca-10000": _model("ORCA", 10_000),
    "social-force-1000": _model("SocialForce", 1000),
    "orca-batch": _batch,
    "lidar-720": _lidar,
    "predict-constant-velocity": _predictor("ConstantVelocity"),
    "predict-kalman": _predictor("Kalman"),
    "predict-simulated": _predictor("Simulated"),
    "trial": _trial,
}
"""Name -> how to set the measurement up."""
