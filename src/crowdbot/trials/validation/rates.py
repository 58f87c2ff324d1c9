"""Remarks on trials: rates of sensors, sizes of stages, ranges of crowd models, and cameras that show walls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from crowdbot.core import FreeClock, kebab_case, whole_ticks
from crowdbot.models import ModelRange
from crowdbot.trials.camera import Camera, floor_points, hidden_floor
from crowdbot.trials.crowd import Crowds
from crowdbot.trials.randomized_model import RandomizedModel
from crowdbot.trials.robot import Mount, RobotSpec
from crowdbot.trials.stage import Stage
from crowdbot.trials.trial import Trial

from .ground_checks import ground_remarks

STEP_TOLERANCE = 1e-9


def range_remarks(trial: Trial) -> list[str]:
    """Return a sentence for every limit of a crowd model that a trial exceeds.

    The density is the number of people at the start over the walkable area; trials without walkable area have none.

    >>> from crowdbot.models import CollisionFreeSpeed
    >>> range_remarks(Trial(name="t", duration=1, crowd=CollisionFreeSpeed(), step=0.05, substeps=5))
    []
    """
    crowd = trial.crowd.models if isinstance(trial.crowd, Crowds) else (trial.crowd,)
    models = [model.model if isinstance(model, RandomizedModel) else model for model in crowd]
    ranges = dict.fromkeys((kebab_case(type(model).__name__), model.valid_range) for model in models)
    density, step = start_density(trial), trial.step / trial.substeps
    result = []
    for model, bounds in ranges:
        if bounds is None:
            continue
        if density > bounds.max_density:
            result.append(
                f"crowd model {model} is used at {density:.2g} people/m2, beyond its range of"
                f" {bounds.max_density:g}: {bounds.why} ({bounds.density_source})"
            )
        if step > bounds.max_step + STEP_TOLERANCE:
            result.append(
                f"crowd model {model} is used with a time step of {step:g} s, beyond its range of"
                f' {bounds.max_step:g} s ({bounds.step_source}); write substeps="{_substeps(trial, bounds)}"'
            )
    return result


def start_density(trial: Trial) -> float:
    """Return the people at the start per walkable area [1/m2], 0 if the stage has no walkable area."""
    stage = trial.stage
    if not stage.bounded:
        return 0.0
    ground = stage.shapes[1].area
    return float((len(trial.agents) + sum(spawner.count for spawner in trial.spawners)) / ground)


def _substeps(trial: Trial, bounds: ModelRange) -> int:
    return next(n for n in range(1, 10_001) if trial.step / n <= bounds.max_step + STEP_TOLERANCE or n == 10_000)


SMALLEST_EXTENT = 2.0
LARGEST_EXTENT = 2000.0
"""Plausible extents of a stage, the longer side of the box around it [m]."""

SMALL = (
    "coordinates are in metres, and these may be degrees or kilometres, or metres that were read as millimetres (for a"
    " drawing, import it with --unit m)"
)
LARGE = "coordinates are in metres, and these may be millimetres, or pixels of an image"
LARGE_MAP = "the resolution of its map is in metres per pixel"


def stage_size_remarks(trial: Trial) -> list[str]:
    """Return a sentence if the stage is implausibly small or large.

    Without a walkable area, walls that are small may be obstacles on open ground: nothing is said if somebody starts
    outside the box around them.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Stage
    >>> small = Stage(walkable="0,0 0.02,0 0.02,0.008 0,0.008")
    >>> stage_size_remarks(Trial(name="t", duration=1, crowd=ORCA(), stage=small))[0][:53]
    'the walkable area is 0.02 m x 0.008 m, below 2 m in e'
    """
    stage = trial.stage
    if stage.bounded:
        what, bounds = "the walkable area", np.array(stage.shapes[1].bounds)
    else:
        rings = stage.rings[: len(stage.rings) - len(stage.props)]
        if not rings:
            return []
        corners = np.concatenate(rings)
        what, bounds = "the box around the walls", np.array([*corners.min(axis=0), *corners.max(axis=0)])
    size = bounds[2:] - bounds[:2]
    words = f"{what} is {size_text(*size)}"
    if size.max() > LARGEST_EXTENT:
        cause = LARGE_MAP if stage.map and not stage.bounded else LARGE
        return [f"{words}, above {LARGEST_EXTENT:g} m: {cause}"]
    if size.max() < SMALLEST_EXTENT and (stage.bounded or not _starts_outside(trial, bounds)):
        return [f"{words}, below {SMALLEST_EXTENT:g} m in each direction: {SMALL}"]
    return []


def size_text(width: float, height: float) -> str:
    """Return a size in words, with three digits.

    >>> size_text(20_000.0, 0.12345)
    '20000 m x 0.123 m'
    """
    return " x ".join(f"{float(f'{side:.3g}'):g} m" for side in (width, height))


def _starts_outside(trial: Trial, bounds: NDArray[Any]) -> bool:
    """Return whether a person or a robot starts outside a box, or may do so."""
    spots = [point for spawner in trial.spawners for point in spawner.zone]
    spots += [point for source in trial.sources for point in source.zone]
    spots += [(agent.x, agent.y) for agent in trial.agents]
    spots += [(robot.x, robot.y) for robot in trial.robots]
    places = np.array(spots, dtype=np.float64).reshape(-1, 2)
    return bool(trial.recorded) or bool(np.any((places < bounds[:2]) | (places > bounds[2:])))


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


IN_WALL = 0.02
"""A camera nearer to a wall [m] is in it; walls without an area are as thick."""
MARGIN = 10.0
"""Floor around the walls and the camera [m] that counts, too."""
HIDDEN = 0.98
"""Share of the floor in an image that walls hide before the camera is told to be behind a wall."""


def camera_remarks(trial: Trial, name: str = "") -> list[str]:
    """Return a sentence for every fixed camera that is in a wall, or whose view of the floor is hidden by walls.

    Args:
        trial: the trial.
        name: only the camera with this name (default: all cameras).

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Camera, Stage, Trial, Wall
    >>> stage = Stage(walls=[Wall([(0, -9), (0, 9)])])
    >>> behind = Camera(name="c", x=-0.2, z=1.6)
    >>> camera_remarks(Trial(name="t", duration=1, crowd=ORCA(), stage=stage, cameras=[behind]))
    ["camera 'c' looks at a wall: walls hide 100 % of the floor in its image"]
    """
    fixed = [camera for camera in trial.cameras if not camera.robot and name in ("", camera.name)]
    return [remark for camera in fixed if (remark := _remark(trial.stage, camera))]


def _remark(stage: Stage, camera: Camera) -> str:
    walls = stage.as_walls(props=False).segments().reshape(-1, 2, 2)
    if not len(walls):
        return ""
    place = np.array([camera.x, camera.y])
    if 0.0 <= camera.z <= stage.wall_height and _in_wall(stage, walls, place):
        return f"camera {camera.name!r} is in a wall at {camera.x:g},{camera.y:g}; it shows the inside of the wall"
    low, high = walls.min(axis=(0, 1)), walls.max(axis=(0, 1))
    floor = floor_points(stage, np.minimum(low, place - MARGIN), np.maximum(high, place + MARGIN))
    floor = floor[_in_frame(camera, floor)]
    if not len(floor):
        return ""
    hidden = float(hidden_floor(stage, floor, np.array([[camera.x, camera.y, camera.z]])).mean())
    if hidden < HIDDEN:
        return ""
    return f"camera {camera.name!r} looks at a wall: walls hide {100.0 * hidden:.0f} % of the floor in its image"


def _in_wall(stage: Stage, walls: NDArray[np.float64], place: NDArray[np.float64]) -> bool:
    point = shapely.points(place)
    near = shapely.distance(shapely.linestrings(walls), point).min() < IN_WALL
    return bool(near) or bool(stage.block_around(point))


def _in_frame(camera: Camera, floor: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return ``[N]`` whether floor points ``[N, 2]`` [m] are in the image, walls left aside."""
    flat, fall = math.cos(camera.pitch), math.sin(camera.pitch)
    cos, sin = math.cos(camera.heading), math.sin(camera.heading)
    off = np.column_stack([floor - (camera.x, camera.y), np.full(len(floor), -camera.z)])
    ahead = off @ (flat * cos, flat * sin, -fall)
    right, up = off @ (sin, -cos, 0.0), off @ (fall * cos, fall * sin, flat)
    edge = math.tan(0.5 * camera.field_of_view)
    inside = (np.abs(right) <= edge * ahead) & (np.abs(up) <= edge * camera.height / camera.width * ahead)
    return np.asarray(inside & (ahead > 0.0))
