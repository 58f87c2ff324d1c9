"""Actions and observations of a learning robot."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, kernel
from crowdbot.navigation import DriveLimits, ObservationBatch
from crowdbot.typing import Floats

ACTION_FORMS = ("velocity", "acceleration", "holonomic")


@dataclass(frozen=True)
class ActionForm:
    """Meaning of the two numbers of an action, each from -1 to 1.

    Fields:
        form: ``velocity``: forward speed and turn rate; ``acceleration``: their changes, as shares of the maximum
            accelerations; ``holonomic``: forward and left speed, whose vector is scaled to the maximum speed.

    Raises:
        InputError: the form is unknown.

    >>> ActionForm("velocity").twists(np.array([[1.0, -0.5]]), DriveLimits(0.8, 2.0)).tolist()
    [[0.8, -1.0, 0.0]]
    >>> limits, now = DriveLimits(0.8, 2.0, 1.0, 3.0), np.array([[0.5, 0.0, 0.0]])
    >>> ActionForm("acceleration").twists(np.array([[-1.0, 0.5]]), limits, now, dt=0.1).round(3).tolist()
    [[0.4, 0.15, 0.0]]
    """

    form: str = "velocity"

    def __post_init__(self) -> None:
        if self.form not in ACTION_FORMS:
            raise InputError(f"action = {self.form!r} must be one of {', '.join(ACTION_FORMS)}")

    def check(self, limits: DriveLimits) -> None:
        """Raise an InputError if a drive with these limits cannot do it."""
        if not (math.isfinite(limits.max_speed) and math.isfinite(limits.max_turn_rate)):
            raise InputError("the drive of the robot has no limits; actions are shares of its maximum speeds")
        bounded = math.isfinite(limits.max_acceleration) and math.isfinite(limits.max_turn_acceleration)
        if self.form == "acceleration" and not bounded:
            raise InputError(
                "the drive of the robot has no limits of its accelerations, of which actions are shares; give it"
                " max-acceleration and max-turn-acceleration, or take action = 'velocity'"
            )

    def twists(self, actions: Floats, limits: DriveLimits, twist: Floats | None = None, dt: float = 0.0) -> Floats:
        """Return the commands ``[N, 3]`` forward, turn, left of actions ``[N, 2]``, which are clipped to -1 to 1.

        Args:
            actions: ``[N, 2]``.
            limits: limits of the drive.
            twist: ``[N, 3]`` current twist, to which accelerations are added (default 0).
            dt: time until the next action [s], for accelerations.
        """
        share = np.clip(np.asarray(actions, dtype=np.float64), -1.0, 1.0)
        left = np.zeros(len(share))
        top, turn = limits.max_speed, limits.max_turn_rate
        if self.form == "velocity":
            return np.stack([share[:, 0] * top, share[:, 1] * turn, left], axis=1)
        if self.form == "acceleration":
            now = np.zeros((len(share), 3)) if twist is None else twist
            speed = now[:, 0] + share[:, 0] * (limits.max_acceleration * dt)
            rate = now[:, 1] + share[:, 1] * (limits.max_turn_acceleration * dt)
            return np.stack([np.clip(speed, -top, top), np.clip(rate, -turn, turn), left], axis=1)
        size = np.maximum(1.0, np.hypot(share[:, 0], share[:, 1]))
        return np.stack([share[:, 0] / size * top, left, share[:, 1] / size * top], axis=1)


def occupancy_grids(batch: ObservationBatch, cells: int, cell: float) -> Floats:
    """Return ``[N, cells, cells]`` grids: 1 where the centre of a cell is within half a cell of a person or a wall.

    Row i and column j count from the back right corner of a square around the robot: i forward, j to the left.

    Args:
        batch: what the robot knows in N environments.
        cells: number of cells of a side.
        cell: width of a cell [m].

    >>> from crowdbot.navigation import DriveLimits
    >>> batch = ObservationBatch(pose=np.zeros((1, 3)), goal=np.ones((1, 2)), radius=np.full(1, 0.3),
    ...     limits=DriveLimits(1.0, 2.0), dt=0.1)
    >>> occupancy_grids(batch, 4, 0.5).sum()
    np.float64(0.0)
    """
    result = np.zeros((len(batch), cells, cells))
    people = batch.people
    walls = np.require(batch.walls.segments(), np.float64, ["C", "W"])
    _paint(batch.pose, people.position, people.radius, people.seen, walls, cell, result)
    return result


@kernel
def _paint(
    pose: Floats, position: Floats, radius: Floats, seen: NDArray[np.bool_], walls: Floats, cell: float, out: Floats
) -> None:
    """Mark the cells of discs and of wall segments x, y, x, y."""
    cells = out.shape[1]
    half = 0.5 * cell * cells
    for e in range(len(pose)):
        x, y, heading = pose[e, 0], pose[e, 1], pose[e, 2]
        cos, sin = math.cos(heading), math.sin(heading)
        for a in range(radius.shape[1]):
            if seen[e, a]:
                dx, dy = position[e, a, 0] - x, position[e, a, 1] - y
                px, py = cos * dx + sin * dy, cos * dy - sin * dx
                _mark(px, py, px, py, radius[e, a] + 0.5 * cell, cell, half, out[e])
        for w in range(len(walls)):
            ax, ay, bx, by = walls[w, 0] - x, walls[w, 1] - y, walls[w, 2] - x, walls[w, 3] - y
            px, py, qx, qy = cos * ax + sin * ay, cos * ay - sin * ax, cos * bx + sin * by, cos * by - sin * bx
            _mark(px, py, qx, qy, 0.5 * cell, cell, half, out[e])


@kernel
def _mark(ax: float, ay: float, bx: float, by: float, far: float, cell: float, half: float, grid: Floats) -> None:
    """Mark the cells whose centres are nearer to a segment than ``far``."""
    cells = len(grid)
    if min(ax, bx) - far > half or max(ax, bx) + far < -half or min(ay, by) - far > half or max(ay, by) + far < -half:
        return
    low = max(math.floor((min(ax, bx) - far + half) / cell), 0)
    high = min(math.floor((max(ax, bx) + far + half) / cell) + 1, cells)
    right = max(math.floor((min(ay, by) - far + half) / cell), 0)
    left = min(math.floor((max(ay, by) + far + half) / cell) + 1, cells)
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    for i in range(low, high):
        for j in range(right, left):
            x, y = (i + 0.5) * cell - half, (j + 0.5) * cell - half
            share = 0.0
            if square > 0.0:
                share = min(max(((x - ax) * dx + (y - ay) * dy) / square, 0.0), 1.0)
            nx, ny = ax + share * dx - x, ay + share * dy - y
            if nx * nx + ny * ny < far * far:
                grid[i, j] = 1.0


Arrays = dict[str, NDArray[np.float32]]

OBSERVATION_FORMS = ("people", "scan", "both", "occupancy")
ROBOT_VALUES = (
    "waypoint_distance", "waypoint_cos", "waypoint_sin", "goal_distance", "forward", "turn", "left", "radius",
    "max_speed", "max_turn_rate",
)  # fmt: skip
"""Values of ``robot``: distances [m], direction of the waypoint seen from the robot, twist [m/s], [rad/s], limits."""
PERSON_VALUES = ("x", "y", "vx", "vy", "radius", "clearance", "there")
"""Values of each row of ``people``: position [m] and velocity [m/s] in the frame of the robot, 1 for a person."""
FAR = 1e3
"""Largest value of a distance or speed; larger ones are clipped."""


@dataclass(frozen=True)
class ObservationForm:
    """Parts of an observation.

    Fields:
        form: ``people`` (the nearest people that the robot sees), ``scan`` (ranges of its laser scanner), ``both`` of
            them, or ``occupancy`` (a grid around the robot, of the people that it sees and of the walls).
        max_people: number of rows of people; the nearest come first, free rows are 0.
        cells: number of cells of a side of the grid.
        cell: width of a cell [m].

    Raises:
        InputError: a value is not allowed.

    >>> ObservationForm("people", max_people=3).shapes(beams=0)
    {'robot': (10,), 'people': (3, 7)}
    """

    form: str = "people"
    max_people: int = 10
    cells: int = 32
    cell: float = 0.25

    def __post_init__(self) -> None:
        if self.form not in OBSERVATION_FORMS:
            raise InputError(f"observation = {self.form!r} must be one of {', '.join(OBSERVATION_FORMS)}")
        if not 1 <= self.max_people <= 1000:
            raise InputError(f"max_people = {self.max_people} must be from 1 to 1000")
        if not 1 <= self.cells <= 1000:
            raise InputError(f"cells = {self.cells} must be from 1 to 1000")
        if not (math.isfinite(self.cell) and self.cell > 0.0):
            raise InputError(f"cell = {self.cell} m must be finite and above 0")

    @property
    def with_people(self) -> bool:
        """Whether people are part of it."""
        return self.form in ("people", "both")

    @property
    def with_scan(self) -> bool:
        """Whether a scan is part of it."""
        return self.form in ("scan", "both")

    def shapes(self, beams: int) -> dict[str, tuple[int, ...]]:
        """Return the shape of each part for one environment."""
        result: dict[str, tuple[int, ...]] = {"robot": (len(ROBOT_VALUES),)}
        if self.with_people:
            result["people"] = (self.max_people, len(PERSON_VALUES))
        if self.with_scan:
            result["scan"] = (beams,)
        if self.form == "occupancy":
            result["occupancy"] = (self.cells, self.cells)
        return result

    def arrays(self, batch: ObservationBatch, scan: Floats | None) -> Arrays:
        """Return the parts ``[N, ...]`` as float32.

        Args:
            batch: what the robot knows in N environments.
            scan: ``[N, B]`` ranges [m], for a form with a scan.
        """
        parts: dict[str, Floats] = {"robot": _robot(batch)}
        if self.with_people:
            parts["people"] = _people(batch, self.max_people)
        if scan is not None and self.with_scan:
            parts["scan"] = scan
        if self.form == "occupancy":
            parts["occupancy"] = occupancy_grids(batch, self.cells, self.cell)
        return {name: np.clip(np.nan_to_num(value), -FAR, FAR).astype(np.float32) for name, value in parts.items()}

    def bounds(self, name: str, longest: float) -> tuple[Floats, Floats]:
        """Return the smallest and the largest values of a part, for its last axis or for all of it.

        Args:
            name: name of the part.
            longest: largest range of the scanner [m].

        >>> ObservationForm("scan").bounds("scan", 25.0)
        (array([0.]), array([25.]))
        """
        if name == "scan":
            return np.zeros(1), np.full(1, longest)
        if name == "occupancy":
            return np.zeros(1), np.ones(1)
        if name == "people":
            return np.array([*[-FAR] * 4, 0.0, -FAR, 0.0]), np.array([*[FAR] * 6, 1.0])
        low = np.array([0.0, -1.0, -1.0, 0.0, *[-FAR] * 3, 0.0, 0.0, 0.0])
        return low, np.array([FAR, 1.0, 1.0, *[FAR] * 7])


def _robot(batch: ObservationBatch) -> Floats:
    ahead = batch.waypoint - batch.pose[:, :2]
    bearing = np.arctan2(ahead[:, 1], ahead[:, 0]) - batch.pose[:, 2]
    goal = batch.goal - batch.pose[:, :2]
    count = len(batch)
    limits = (np.full(count, value if math.isfinite(value) else FAR) for value in batch.limits[:2])
    return np.stack(
        [
            np.hypot(*ahead.T),
            np.cos(bearing),
            np.sin(bearing),
            np.hypot(*goal.T),
            *batch.twist.T,
            batch.radius,
            *limits,
        ],
        axis=1,
    )


def _people(batch: ObservationBatch, count: int) -> Floats:
    people, pose = batch.people, batch.pose
    away = np.where(people.seen[..., None], people.position - pose[:, None, :2], np.inf)
    gap = np.hypot(away[..., 0], away[..., 1]) - people.radius - batch.radius[:, None]
    clearance = np.where(people.seen, gap, np.inf)
    order = np.argsort(clearance, axis=1, kind="stable")[:, :count]
    rows = np.arange(len(batch))[:, None]
    there = people.seen[rows, order]
    cos, sin = np.cos(pose[:, 2])[:, None], np.sin(pose[:, 2])[:, None]
    position, velocity = np.where(there[..., None], away[rows, order], 0.0), people.velocity[rows, order]
    values = [
        cos * position[..., 0] + sin * position[..., 1],
        cos * position[..., 1] - sin * position[..., 0],
        cos * velocity[..., 0] + sin * velocity[..., 1],
        cos * velocity[..., 1] - sin * velocity[..., 0],
        people.radius[rows, order],
        np.where(there, clearance[rows, order], 0.0),
        np.ones_like(there, dtype=np.float64),
    ]
    result = np.zeros((len(batch), count, len(PERSON_VALUES)))
    result[:, : order.shape[1]] = np.where(there[..., None], np.stack(values, axis=-1), 0.0)
    return result
