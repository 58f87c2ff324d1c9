"""Rates: sensors of robot types whose rates do not fit the time step of a trial."""

from __future__ import annotations

import math
from collections.abc import Sequence

from crowdbot.core import FreeClock, whole_ticks
from crowdbot.trials.cameras.camera_remarks import camera_remarks
from crowdbot.trials.robot import Mount, RobotSpec
from crowdbot.trials.trial import Trial

from .ground_checks import ground_remarks
from .model_ranges import range_remarks
from .stage_size import stage_size_remarks


def fitting(periods: Sequence[float]) -> float:
    """Return a time step [s] of at most 0.1 s that divides all periods [s], 0 if it would be below 0.005 s.

    >>> fitting([0.16, 0.1, 0.02]), fitting([0.1, 0.0123])
    (0.02, 0.0)
    """
    step = math.gcd(*(round(period * 1e9) for period in periods)) / 1e9
    if step < 0.005:
        return 0.0
    while step > 0.1:
        step /= 2.0
    return step


def misfits(robot: RobotSpec, step: float) -> list[Mount]:
    """Return the sensors of a robot's type whose period or delay is not a whole number of time steps [s]."""
    clock, found = FreeClock(step), []
    carried = robot.type_sensors
    for mount in robot.sensors:
        if mount not in carried or math.isnan(mount.sensor.rate):  # a NaN rate is known only when code runs
            continue
        if not all(whole_ticks(clock.step_ns, round(period * 1e9)) for period in _periods(mount)):
            found.append(mount)
    return found


def trial_remarks(trial: Trial) -> list[str]:
    """Return a sentence for every model beyond its range, and for every robot with other sensor rates than its type.

    Stages of implausible size, recordings whose units can hardly be those that are read, robots that cannot pass uneven
    ground or whose motors are too weak for their wheels, and cameras that look at a wall, are told, too.

    Sensors with ``sensor-rates="exact"`` keep the mean rate of their type.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.navigation import Straight
    >>> from crowdbot.trials import RobotGoal
    >>> pepper = RobotSpec(type="pepper", x=0, y=0, goal=RobotGoal(5, 0), navigator=Straight())
    >>> [sentence[-32:] for sentence in trial_remarks(Trial(name="t", duration=1, crowd=ORCA(), robots=[pepper]))]
    ['step="0.01" no period is rounded']
    """
    found = range_remarks(trial)
    clock = FreeClock(trial.step)
    for robot in trial.robots:
        rows: dict[str, list[str]] = {}
        others = misfits(robot, trial.step) if robot.sensor_rates == "nearest" else []
        for mount in others:
            plan, sensor = robot.schedule(mount, clock), mount.sensor
            late = f" and {plan.late * trial.step:g} s late, not {sensor.delay:g} s" if sensor.delay > 0.0 else ""
            row = f"every {plan.ticks.every * trial.step:g} s, not {1.0 / sensor.rate:g} s{late}"
            rows.setdefault(row, []).append(mount.name)
        if others:
            words = "; ".join(f"{' and '.join(names)} {row}" for row, names in rows.items())
            step = fitting([period for mount in others for period in _periods(mount)])
            exact = f'; with step="{step:g}" no period is rounded' if step else _keep_rates(others, clock)
            found.append(
                f"robot {robot.name!r} of type {robot.type!r} rounds the periods of its sensors to the time step of"
                f" {trial.step:g} s: {words}{exact}"
            )
    recorded = [sentence for item in trial.recorded for sentence in item.remarks()]
    robots, rest = _weak_motors(trial), (*ground_remarks(trial), *camera_remarks(trial))
    return [*stage_size_remarks(trial), *found, *recorded, *robots, *rest]


def _weak_motors(trial: Trial) -> list[str]:
    if trial.world != "physics":
        return []
    return [f"robot {robot.name!r}: {why}" for robot in trial.robots for why in robot.body.weak_motors]


def _keep_rates(mounts: Sequence[Mount], clock: FreeClock) -> str:
    """Return the advice to keep the mean rates, if the step allows them."""
    allowed = all(round(1e9 / mount.sensor.rate) >= clock.step_ns for mount in mounts)
    return '; with sensor-rates="exact" the mean rates are exact' if allowed else ""


def _periods(mount: Mount) -> list[float]:
    return [1.0 / mount.sensor.rate, *([mount.sensor.delay] if mount.sensor.delay > 0.0 else [])]
