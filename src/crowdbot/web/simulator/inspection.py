"""State of a person or robot, for the inspector."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from crowdbot.core import builtin_name
from crowdbot.models import CrowdModel, Mixture
from crowdbot.navigation import Navigator
from crowdbot.simulation import RobotControl, Simulation
from crowdbot.web.scene import SceneInstant
from crowdbot.world import Drive, slot_of, worlds_of


def inspect_agent(simulation: Simulation, agent: int) -> dict[str, Any]:
    """Return kind, id, rows [name, value, unit], goal and paths of the parameters of a person or robot.

    Raises:
        InputError: nobody with this id is present.

    >>> from crowdbot.trials import load_trial
    >>> inspect_agent(Simulation(load_trial("frontal")), 1)["kind"]
    'robot'
    """
    slot = slot_of(simulation.world, agent)
    scene = simulation.world.environment_scene(0)
    x, y = scene.position[0, slot].tolist()
    goal = scene.goal[0, slot].tolist()
    control = next((robot for robot in simulation.robots if robot.agent == slot), None)
    if control is not None:
        goal = control.goal[0].tolist()
    rows: list[list[Any]] = [
        ["position", f"{x:.2f}, {y:.2f}", "m"],
        ["speed", round(float(np.hypot(*scene.velocity[0, slot])), 3), "m/s"],
        ["heading", round(math.degrees(float(scene.heading[0, slot])), 1), "deg"],
        ["goal", f"{goal[0]:.2f}, {goal[1]:.2f}", "m"],
        ["distance to the goal", round(math.dist((x, y), goal), 2), "m"],
    ]
    rows += _robot_rows(control) if control is not None else _person_rows(simulation, slot)
    name = control.robot.name if control is not None else _avatar(simulation, slot)
    prefix = _prefix(simulation, control) if control is not None else _crowd_prefix(simulation, slot)
    return {
        "kind": "robot" if control is not None else "person", "id": agent, "name": name, "x": x, "y": y,
        "goal": goal, "rows": rows, "values": prefix,
    }  # fmt: skip


def people_rows(simulation: Simulation, recorded: SceneInstant | None = None) -> list[dict[str, Any]]:
    """Return id, kind, name and place of everybody who is present, for choosing without a mouse.

    Args:
        simulation: the simulation.
        recorded: a recorded instant, instead of that of the simulation.
    """
    result = []
    scene = simulation.world.environment_scene(0) if recorded is None else recorded.scene
    ids = simulation.world.ids[0] if recorded is None else recorded.ids
    robots = {robot.agent: robot.robot.name for robot in simulation.robots}
    for slot in np.flatnonzero(scene.active[0]).tolist():
        x, y = scene.position[0, slot].round(2).tolist()
        kind, name = ("robot", robots[slot]) if slot in robots else ("person", _avatar(simulation, slot))
        result.append({"id": int(ids[slot]), "kind": kind, "name": name, "x": x, "y": y})
    return result


def _robot_rows(control: RobotControl) -> list[list[Any]]:
    robot = control.robot
    forward, turn, left = control.command[0].tolist()
    return [
        ["type", robot.type or "cylinder", ""],
        ["navigator", builtin_name(type(robot.navigator), Navigator), ""],
        ["drive", builtin_name(type(robot.drive), Drive), ""],
        ["command", f"{forward:.2f} m/s, {turn:.2f} rad/s, {left:.2f} m/s", ""],
        ["arrived", "yes" if control.arrived[0] else "no", ""],
        ["sensors", ", ".join(mount.name for mount in robot.sensors) or "none", ""],
        ["radius", round(float(robot.radius), 3), "m"],
    ]


def _person_rows(simulation: Simulation, slot: int) -> list[list[Any]]:
    scene = simulation.world.environment_scene(0)
    person_rows: list[list[Any]] = [
        ["preferred speed", round(float(scene.preferred_speed[0, slot]), 3), "m/s"],
        ["radius", round(float(scene.radius[0, slot]), 3), "m"],
        ["model", _model_name(simulation, slot), ""],
    ]
    if simulation.trial.balance:
        pose = worlds_of(simulation.world)[0].fall_poses_of(0).get(slot)
        state = "upright" if pose is None else "out of balance"
        person_rows.append(["balance", "falls, lies or gets up" if pose is not None and pose.down else state, ""])
    if scene.group[0, slot] >= 0:
        person_rows.append(["group", int(scene.group[0, slot]), ""])
    return person_rows


def _model_name(simulation: Simulation, slot: int) -> str:
    world: Any = simulation.world
    model = world.model
    if isinstance(model, Mixture):
        model = model.models[_crowd_number(model, simulation, slot)]
    return builtin_name(type(model), CrowdModel)


def _crowd_number(model: Any, simulation: Simulation, slot: int) -> int:
    return int(np.broadcast_to(np.asarray(model.which), simulation.world.scene.shape)[0, slot])


def _avatar(simulation: Simulation, slot: int) -> str:
    trial = simulation.trial
    recorded = sum(len(item.walks(trial.duration)) for item in trial.recorded)
    k = slot - (trial.people - recorded - len(trial.avatars))
    return trial.avatars[k].name if 0 <= k < len(trial.avatars) else ""


def _prefix(simulation: Simulation, control: RobotControl) -> str:
    several = len(simulation.trial.robots) > 1
    return f"robot[{control.robot.name}]" if several else "robot"


def _crowd_prefix(simulation: Simulation, slot: int) -> str:
    names = getattr(simulation.trial.crowd, "names", ())
    if len(names) < 2:
        return "crowd"
    world: Any = simulation.world
    return f"crowd[{names[_crowd_number(world.model, simulation, slot)]}]"
