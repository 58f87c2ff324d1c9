"""The same task in navground and ir-sim, optional packages."""

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


class NavgroundPeer:
    """Makes worlds of navground; all agents are omnidirectional and use its ORCA.

    Raises:
        MissingExtra: navground is not installed.
    """

    name = "navground"
    packages = ("navground",)
    differences = "compiled worlds one after another; all agents ORCA in every step; contacts; no records"

    def __init__(self) -> None:
        self._core = import_optional("navground.core", "the comparison with navground", "peers")
        self._sim = import_optional("navground.sim", "the comparison with navground", "peers")

    def advance_work(self, task: CrossingTask, worlds: int, steps: int) -> TimedWork:
        """Return the work of the first steps of some worlds."""

        def work(state: list[tuple[Any, Any, Any]]) -> None:
            for world, lidar, sensing in state:
                if lidar is None:
                    world.run(steps, task.dt)
                    continue
                robot = world.agents[-1]
                for _ in range(steps):
                    world.update(task.dt)
                    lidar.update(robot, world, sensing)

        return TimedWork(worlds * steps, lambda: [self._make(task, k) for k in range(worlds)], work)

    def reset_work(self, task: CrossingTask, worlds: int) -> TimedWork:
        """Return the work to make new worlds in Python."""
        return TimedWork(worlds, lambda: None, lambda state: [self._make(task, k) for k in range(worlds)])

    def episode_work(self, task: CrossingTask, episodes: int) -> TimedWork:
        """Return the work of episodes until the robot is at its goal or in contact, or the time is over."""

        def work(state: object) -> None:
            for k in range(episodes):
                self._run_episode(task, k)

        return TimedWork(episodes, lambda: None, work)

    def _run_episode(self, task: CrossingTask, number: int) -> None:
        world, lidar, sensing = self._make(task, number)
        robot, period = world.agents[-1], round(task.control_period / task.dt)
        for k in range(round(task.duration / task.dt)):
            world.update(task.dt)
            if lidar is not None and k % period == 0:
                lidar.update(robot, world, sensing)
            if robot.idle or robot.last_collision_time >= 0.0:
                break

    def _make(self, task: CrossingTask, number: int) -> tuple[Any, Any, Any]:
        """Return a world, and the scanner of the robot with the memory for its readings."""
        world, k = self._sim.World(), number % len(task.position)
        last = task.position.shape[1] - 1
        for a, (start, goal) in enumerate(zip(task.position[k].tolist(), task.goal[k].tolist(), strict=True)):
            period = task.control_period if a == last else 0.0
            world.add_agent(self._make_agent(task, start, goal, period))
        if not task.beams:
            return world, None, None
        lidar = self._sim.state_estimations.LidarStateEstimation(
            range=RANGE, start_angle=-math.pi, field_of_view=2.0 * math.pi, resolution=task.beams, name="scan"
        )
        sensing = self._core.SensingState()
        lidar.prepare(world.agents[-1], world)
        lidar.prepare_state(sensing)
        return world, lidar, sensing

    def _make_agent(self, task: CrossingTask, start: list[float], goal: list[float], period: float) -> Any:
        sim, core = self._sim, self._core
        kinematics = core.kinematics.OmnidirectionalKinematics(max_speed=task.speed, max_angular_speed=1.5)
        behavior = core.behaviors.ORCABehavior(kinematics, task.radius)
        behavior.optimal_speed, behavior.safety_margin = task.speed, 0.0
        behavior.horizon, behavior.max_number_of_neighbors = task.neighbor_distance, task.max_neighbors
        behavior.time_horizon = behavior.static_time_horizon = task.horizon
        agent = sim.Agent(
            task.radius,
            behavior,
            kinematics,
            sim.tasks.WaypointsTask(waypoints=[goal], loop=False, tolerance=task.tolerance),
            [sim.state_estimations.BoundedStateEstimation(range=task.neighbor_distance)],
            period,
        )
        agent.position = start
        return agent
