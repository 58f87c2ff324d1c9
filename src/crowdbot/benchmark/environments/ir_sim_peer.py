"""The same task in ir-sim, an optional package."""

from __future__ import annotations

import contextlib
import io
import json
import math
import tempfile
from pathlib import Path
from typing import Any

from crowdbot.core import import_optional

from .crossing import RANGE, CrossingTask
from .work_rate import TimedWork


class IrSimPeer:
    """Makes environments of ir-sim without a window.

    Raises:
        MissingExtra: ir-sim or its ORCA, pyrvo, is not installed.
    """

    name = "ir-sim"
    packages = ("ir-sim", "pyrvo")
    differences = (
        "one environment in Python; people ORCA (compiled) that do not see the robot; the robot goes straight to its"
        " goal; contacts of the robot; a scan in every step if there is a scanner; no records"
    )

    def __init__(self) -> None:
        with contextlib.redirect_stdout(io.StringIO()):  # it prints which window systems it does not find
            self._irsim = import_optional("irsim", "the comparison with ir-sim", "peers")
        import_optional("pyrvo", "the comparison with ir-sim", "peers")

    def advance_work(self, task: CrossingTask, worlds: int, steps: int) -> TimedWork:
        """Return the work of the first steps of one environment; ``worlds`` is not used, since it is slow."""

        def work(environment: Any) -> None:
            for _ in range(steps):
                environment.step()

        return TimedWork(steps, lambda: self._make(task, 0), work)

    def reset_work(self, task: CrossingTask, worlds: int) -> TimedWork:
        """Return the work to reset one environment, which keeps its starts."""

        def work(environment: Any) -> None:
            for _ in range(worlds):
                environment.reset()

        return TimedWork(worlds, lambda: self._make(task, 0), work)

    def episode_work(self, task: CrossingTask, episodes: int) -> TimedWork:
        """Return the work of episodes until the robot is at its goal or in contact, or the time is over."""

        def work(state: object) -> None:
            for k in range(episodes):
                environment = self._make(task, k)
                for _ in range(round(task.duration / task.dt)):
                    environment.step()
                    if environment.robot.arrive or environment.robot.collision:
                        break

        return TimedWork(episodes, lambda: None, work)

    def _make(self, task: CrossingTask, number: int) -> Any:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "crossing.yaml")
            file.write_text(json.dumps(_description(task, number % len(task.position))), encoding="utf-8")
            return self._irsim.make(str(file), display=False, disable_all_plot=True, log_level="ERROR")


def _description(task: CrossingTask, k: int) -> dict[str, Any]:
    """Return an environment of ir-sim as its YAML file describes it."""
    starts, goals = task.position[k].tolist(), task.goal[k].tolist()
    body = {
        "kinematics": {"name": "omni"},
        "shape": {"name": "circle", "radius": task.radius},
        "vel_max": [task.speed, task.speed],
        "vel_min": [-task.speed, -task.speed],
        "goal_threshold": task.tolerance,
    }
    people = body | {
        "number": len(starts) - 1,
        "distribution": {"name": "manual"},
        "state": [[*start, 0.0] for start in starts[:-1]],
        "goal": [[*goal, 0.0] for goal in goals[:-1]],
        "group_behavior": {
            "name": "orca",
            "neighborDist": task.neighbor_distance,
            "maxNeighbors": task.max_neighbors,
            "timeHorizon": task.horizon,
            "timeHorizonObst": task.horizon,
            "safe_radius": 0.0,
        },
    }
    robot = body | {"state": [*starts[-1], 0.0], "goal": [*goals[-1], 0.0], "behavior": {"name": "dash"}}
    if task.beams:
        scanner = {"type": "lidar2d", "range_min": 0.05, "range_max": RANGE, "number": task.beams}
        robot["sensors"] = [scanner | {"angle_range": 2.0 * math.pi}]
    world = {"height": 60, "width": 60, "offset": [-30, -30], "step_time": task.dt, "sample_time": task.dt}
    world["collision_mode"] = "unobstructed_obstacles"  # contacts of the robot only, as in our simulation
    return {"world": world, "robot": [robot], "obstacle": [people]}
