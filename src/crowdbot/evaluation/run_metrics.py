"""Metrics of logs for simulated episodes, and the paired runs that some of them need."""

from __future__ import annotations

import dataclasses
import math
import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.metrics import (
    LOG_FAMILIES,
    AgentLog,
    BodyRegion,
    RobotLog,
    crowd_effect,
    empty_scene_ratios,
    fall_metrics,
    gate_metrics,
    impact_region_metrics,
    log_metrics,
    metric_table,
)
from crowdbot.navigation import PathPlanner
from crowdbot.simulation import WALL, Episode
from crowdbot.trials import Trial
from crowdbot.typing import Floats
from crowdbot.world import BODY_REGION_LIMITS

from .own_metric import is_own_metric, load_metric, metric_name

PAIRED_FAMILIES = ("empty-scene", "crowd-disturbance")
"""Families of metrics that need further runs with the same seed."""
SHIFT = 0.001
"""Shift of the start of the robot [m] for the chaos floor."""
TOUCH = re.compile(r"collision|^severity|^contact_")
"""Metrics of contacts, which a ghost does not have."""
BODY_KINDS = {"wall": "wall", "prop": "object", "robot": "robot"}
"""Kinds of bodies of the physics world, with the word of the metrics."""
REGIONS = {name: BodyRegion(*limits) for name, limits in BODY_REGION_LIMITS.items()}
DECISION_METRICS = ("decision_time", "decision_time_p99", "missed_deadlines")
"""Metrics of real time, which differ between equal runs."""


def episode_log(episode: Episode) -> RobotLog:
    """Return the log of the first robot of an episode.

    >>> from crowdbot.simulation import simulate
    >>> from crowdbot.trials import load_trial
    >>> episode_log(simulate(load_trial("frontal", duration=2.0), 0)).path.round(1).tolist()
    [[-4.5, 0.0], [4.5, 0.0]]
    """
    trial, robot = episode.trial, episode.trial.robots[0]
    ghosts = [own for own, spec in zip(episode.robots, trial.robots, strict=True) if spec.ghost]
    goal = np.asarray(robot.goal.position, dtype=np.float64)
    own = episode.robots[0]
    start = episode.position[np.argmax(episode.active[:, own]), own]
    return RobotLog.of(
        _agent_log(episode),
        own,
        goal,
        robot.goal.tolerance,
        others=episode.robots[1:],
        ignore=[ghost for ghost in ghosts if ghost != own],
        outcome=episode.outcome if len(trial.robots) == 1 else None,
        walls=trial.stage.as_walls().segments(),
        path=shortest_path(trial, start, goal),
        max_speed=float(getattr(robot.drive, "max_speed", math.nan)),
        mass=float(robot.mass),
        height=float(robot.height),
        regions=REGIONS,
        gestures=episode.gestures,
        outlines={k: spec.body.outline for k, spec in zip(episode.robots, trial.robots, strict=True)},
    )


def shortest_path(trial: Trial, start: Floats, goal: Floats) -> Floats | None:
    """Return the shortest path ``[K, 2]`` [m] of the first robot around walls; None if there is none."""
    try:
        robot = trial.robots[0]
        planner = PathPlanner.for_stage(trial.stage.as_walls(), robot.radius, half_width=robot.body.half_width)
        return np.concatenate([start[None], planner.waypoints(start, goal)])
    except InputError:
        return None


def episode_metrics(
    episode: Episode, families: Sequence[str] | None = None, paired: dict[str, Episode] | None = None
) -> dict[str, float]:
    """Return the metrics of the first robot of an episode, from its log.

    Args:
        episode: the episode.
        families: names of families, and addresses of own metrics (default: all families that need one run).
        paired: further runs with the same seed, by the names of :func:`paired_variants`.

    Raises:
        InputError: there is no such family.

    >>> from crowdbot.simulation import simulate
    >>> from crowdbot.trials import load_trial
    >>> episode_metrics(simulate(load_trial("frontal", duration=2.0), 0), ["task"])["person_collision"]
    0.0
    """
    names = [*LOG_FAMILIES] if families is None else list(families)
    log = episode_log(episode)
    found = log_metrics(log, [name for name in names if name not in PAIRED_FAMILIES and not is_own_metric(name)])
    if "task" in names:
        found |= _touched(episode)
    if episode.trial.robots[0].ghost:
        found = {name: value for name, value in found.items() if not TOUCH.search(name)}
    if episode.trial.world == "physics" and "severity" in names:
        own = [
            collision
            for collision in episode.collisions
            if tuple(collision.first) == ("robot", episode.robots[0]) and collision.second.kind == "person"
        ]
        found |= impact_region_metrics(own, REGIONS, float(episode.trial.robots[0].mass))
        if episode.trial.balance:
            caused = [fall for fall in episode.falls if (fall.cause, fall.causer) == ("robot", episode.robots[0])]
            found |= fall_metrics(episode.falls, caused)
    others = paired or {}
    for address in filter(is_own_metric, names):
        found[metric_name(address)] = load_metric(address).value(log)
    if "empty" in others:
        found |= empty_scene_ratios(log, episode_log(others["empty"]))
    if "ghost" in others:
        shifted = others.get("shifted")
        run, ghost = _agent_log(episode), _agent_log(others["ghost"])
        found |= crowd_effect(run, ghost, episode.robots[0], None if shifted is None else _agent_log(shifted))
        found |= gate_metrics(log, run, ghost, episode.robots[0])
    return found


def paired_variants(trial: Trial, families: Sequence[str]) -> dict[str, Trial]:
    """Return the trials of further runs that families of metrics need: ``empty``, ``ghost``, ``shifted``."""
    found = {}
    if "empty-scene" in families:
        found["empty"] = _empty_variant(trial)
    if "crowd-disturbance" in families:
        found |= {"ghost": _ghost_variant(trial), "shifted": _shifted_variant(trial)}
    return found


def families_of(names: Sequence[str]) -> tuple[str, ...]:
    """Return the families with paired runs that statistics need.

    Args:
        names: names of metrics, such as ``crowd_disturbance``, or of families.

    >>> families_of(["success", "crowd_disturbance"])
    ('crowd-disturbance',)
    """
    table = metric_table()
    found = {table[name].family if name in table else name for name in names}
    return tuple(family for family in PAIRED_FAMILIES if family in found)


def check_families(names: Sequence[str]) -> None:
    """Check names of families.

    Raises:
        InputError: there is no such family.
    """
    known = [*LOG_FAMILIES, *PAIRED_FAMILIES]
    for name in names:
        if is_own_metric(name):
            load_metric(name)
        elif name not in known:
            raise InputError(f"no family of metrics {name!r}{did_you_mean(name, known)}; known are {', '.join(known)}")


def _touched(episode: Episode) -> dict[str, float]:
    """Return what the first robot has touched in any time step, by the bodies of the world.

    The log knows only discs at its records: it misses a foot that is run over in the physics world.
    """
    own, robots = int(episode.ids[episode.robots[0]]), {int(episode.ids[k]) for k in episode.robots}
    pairs = [(item.robot, item.other) for _, item in episode.contacts]
    touched = {second if first == own else first for first, second in pairs if own in (first, second)}
    found = {
        "person_collision": float(any(item not in robots and item != WALL for item in touched)),
        "robot_collision": float(any(item in robots for item in touched)),
        "wall_collision": float(WALL in touched),
    }
    if episode.trial.world == "physics":
        body = ("robot", own)
        events = [
            (collision.first, collision.second)
            for collision in episode.collisions
            if body in (collision.first, collision.second)
        ]
        counts = Counter((second if first == body else first).kind for first, second in events)
        found |= {f"{kind}_collisions": float(counts[word]) for word, kind in BODY_KINDS.items()}
        found["object_collision"] = float(counts["prop"] > 0)
        found["wall_collision"] = float(counts["wall"] > 0 or (WALL in touched and not counts["prop"]))
    return found


def _agent_log(episode: Episode) -> AgentLog:
    radius = np.broadcast_to(episode.radius, episode.active.shape)
    return AgentLog(episode.times, episode.position, episode.velocity, episode.heading, radius, episode.active)


def _empty_variant(trial: Trial) -> Trial:
    """Return the trial without people.

    >>> from crowdbot.trials import load_trial
    >>> _empty_variant(load_trial("circle-crossing")).people
    0
    """
    return dataclasses.replace(trial, agents=(), spawners=(), sources=(), recorded=(), avatars=())


def _ghost_variant(trial: Trial) -> Trial:
    """Return the trial with the first robot as a ghost: placed as before, but unseen and untouchable.

    >>> from crowdbot.trials import load_trial
    >>> _ghost_variant(load_trial("frontal")).robots[0].ghost
    True
    """
    first, *rest = trial.robots
    return dataclasses.replace(trial, robots=(dataclasses.replace(first, ghost=True), *rest))


def _shifted_variant(trial: Trial) -> Trial:
    """Return the trial with the first robot 1 mm to the left of its start.

    >>> from crowdbot.trials import load_trial
    >>> _shifted_variant(load_trial("frontal")).robots[0].y
    0.001
    """
    first, *rest = trial.robots
    x, y = first.x - SHIFT * math.sin(first.heading), first.y + SHIFT * math.cos(first.heading)
    return dataclasses.replace(trial, robots=(dataclasses.replace(first, x=x, y=y), *rest))


def decision_metrics(episode: Episode) -> dict[str, float]:
    """Return the compute times and missed deadlines of the first robot; empty if its decisions are not measured.

    Measured are the decisions of a robot with a ``deadline``, of robot software that is connected over a bridge, and of
    a navigator in a process of its own. The definitions are those of the family ``decisions`` of
    :func:`crowdbot.metrics.metric_families`.

    >>> from crowdbot.simulation import simulate
    >>> from crowdbot.trials import load_trial
    >>> decision_metrics(simulate(load_trial("frontal", duration=1.0), 0))
    {}
    """
    if not episode.trial.robots:
        return {}
    robot = episode.trial.robots[0]
    times = np.array(episode.decision_times.get(robot.name, ()), dtype=np.float64)
    if not len(times):
        return {}
    missed = math.nan if robot.deadline is None else float(np.mean(times > robot.deadline))
    values = float(np.median(times)), float(np.percentile(times, 99)), missed
    return dict(zip(DECISION_METRICS, values, strict=True))
