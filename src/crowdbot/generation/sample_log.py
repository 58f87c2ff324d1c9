"""Samples of an episode: readings and labels, with the occlusion of people."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Pose, SpatialPose, Walls, kernel
from crowdbot.sensors import Reading, RgbImage, TrackedPeople, spatial_pose
from crowdbot.simulation import StepBatch, StepRecord
from crowdbot.typing import Bools, Floats, Ints

SIGHT_LINES = 16
"""Number of sight lines over the width of a person."""


def occluded_shares(
    origin: Floats, position: Floats, radius: Floats, active: Bools, own: int, walls: tuple[Floats, Floats]
) -> Floats:
    """Return which share of the width of each agent other agents and walls hide from a sensor, ``[N, A]``.

    Agents are discs and walls are lines without height. Sixteen sight lines lead from the sensor to points of
    the diameter across the view; one that another disc or a wall cuts is hidden. NaN for absent agents, for the robot
    itself and for agents that contain the sensor.

    Args:
        origin: ``[N, 2]`` position of the sensor [m].
        position: ``[N, A, 2]`` [m].
        radius: ``[N, A]`` [m].
        active: ``[N, A]`` present agents.
        own: column of the robot that has the sensor, which hides nothing; -1 for none.
        walls: start and end of the edges of walls, ``[M, 2]`` each [m].

    >>> place, size = np.array([[[2.0, 0.0], [4.0, 0.0], [0.0, 3.0]]]), np.full((1, 3), 0.25)
    >>> occluded_shares(np.zeros((1, 2)), place, size, np.ones((1, 3), bool), -1, (np.zeros((0, 2)),) * 2).tolist()
    [[0.0, 1.0, 0.0]]
    """
    shares = np.empty(active.shape)
    arrays = (origin, position, radius, walls[0], walls[1])
    origin, position, radius, start, end = (np.ascontiguousarray(array, dtype=np.float64) for array in arrays)
    _fill_shares(origin, position, radius, np.ascontiguousarray(active), own, start, end, shares)
    return shares


@kernel
def _fill_shares(
    origin: Floats, position: Floats, radius: Floats, active: Bools, own: int, start: Floats, end: Floats,
    shares: Floats,
) -> None:  # fmt: skip
    for n in range(len(active)):
        for a in range(active.shape[1]):
            shares[n, a] = math.nan
            x, y, size = position[n, a, 0] - origin[n, 0], position[n, a, 1] - origin[n, 1], radius[n, a]
            away = math.sqrt(x * x + y * y)
            if not active[n, a] or a == own or away <= size:
                continue
            cos, sin, cut = x / away, y / away, 0
            for b in range(active.shape[1]):
                if active[n, b] and b not in (a, own):
                    x, y = position[n, b, 0] - origin[n, 0], position[n, b, 1] - origin[n, 1]
                    cut |= _cut_by_disc(away, size, cos * x + sin * y, cos * y - sin * x, radius[n, b])
            for m in range(len(start)):
                x, y = start[m, 0] - origin[n, 0], start[m, 1] - origin[n, 1]
                u, v = end[m, 0] - origin[n, 0], end[m, 1] - origin[n, 1]
                cut |= _cut_by_line(
                    away, size, cos * x + sin * y, cos * y - sin * x, cos * u + sin * v, cos * v - sin * u
                )
            hidden = 0
            for k in range(SIGHT_LINES):
                hidden += (cut >> k) & 1
            shares[n, a] = hidden / SIGHT_LINES


@kernel(inline=True)
def _cut_by_disc(away: float, size: float, x: float, y: float, radius: float) -> int:
    """Return the sight lines to a person at (away, 0) that a disc at x, y cuts, as bits."""
    if x < -radius or x > away + radius or abs(y) > size + radius:
        return 0
    cut = 0
    for k in range(SIGHT_LINES):
        side = size * ((2.0 * k + 1.0) / SIGHT_LINES - 1.0)
        along = min(1.0, max(0.0, (x * away + y * side) / (away * away + side * side)))
        dx, dy = x - along * away, y - along * side
        if dx * dx + dy * dy < radius * radius:
            cut |= 1 << k
    return cut


@kernel(inline=True)
def _cut_by_line(away: float, size: float, x: float, y: float, u: float, v: float) -> int:
    """Return the sight lines to a person at (away, 0) that a wall from x, y to u, v cuts, as bits."""
    if max(x, u) < 0.0 or min(x, u) > away or min(y, v) > size or max(y, v) < -size:
        return 0
    cut = 0
    for k in range(SIGHT_LINES):
        side = size * ((2.0 * k + 1.0) / SIGHT_LINES - 1.0)
        across = away * (v - y) - side * (u - x)
        if across == 0.0:
            continue
        along, over = (x * (v - y) - y * (u - x)) / across, (x * side - y * away) / across
        if 0.0 < along < 1.0 and 0.0 <= over <= 1.0:
            cut |= 1 << k
    return cut


Table = dict[str, NDArray[Any]]
"""Arrays by name with the same first axis, the samples; names that begin with ``shared.`` have no such axis."""


class _Agents(NamedTuple):
    """Agents of N environments at one instant."""

    episode: Ints
    nanoseconds: Ints
    ids: Ints
    active: NDArray[np.bool_]
    position: Floats
    radius: Floats

    def rows(self, index: Ints) -> _Agents:
        """Return some environments."""
        return _Agents(
            self.episode[index], self.nanoseconds[index], self.ids[index], self.active[index], self.position[index],
            self.radius[index],
        )  # fmt: skip


class SampleLog:
    """Consumes the records of a run and keeps them as arrays; a sink of single records and of batches.

    Args:
        walls: walls of the scene; set the attribute when they move.
        robots: column of each robot among the agents, by name.
    """

    def __init__(self, walls: Walls, robots: Mapping[str, int]) -> None:
        self.walls, self._robots = walls, robots
        self._states: list[Table] = []
        self._readings: dict[str, list[Table]] = {}
        self.kinds: dict[str, str] = {}

    def take(self, frame: StepRecord) -> None:
        """Keep a step record."""
        scene = frame.scene
        agents = _Agents(
            np.array([frame.environment]), np.array([frame.nanoseconds]), frame.ids[None], scene.active.copy(),
            scene.position.copy(), scene.radius.copy(),
        )  # fmt: skip
        if frame.due:
            self._keep_state(agents, scene.velocity, scene.heading, frame.twists[None], frame.commands[None])
        columns = {int(id_): k for k, id_ in enumerate(frame.ids)}
        for robot, mount, reading in frame.readings:
            self._keep_reading(robot.name, mount.name, agents, _by_column(reading, columns))

    def take_batch(self, batch: StepBatch) -> None:
        """Keep the records of a step of many environments."""
        columns = np.arange(batch.ids.shape[1])
        present = batch.active & (columns < batch.slots[:, None])
        agents = _Agents(batch.environments, batch.nanoseconds, batch.ids, present, batch.position, batch.radius)
        due = np.flatnonzero(batch.due)
        if len(due):
            chosen = agents.rows(due)
            self._keep_state(chosen, batch.velocity[due], batch.heading[due], batch.twists[due], batch.commands[due])
        for robot, mount, told, rows in batch.readings:
            mine = np.flatnonzero(rows >= 0)
            if not len(mine):
                continue
            reading = told.reading if len(mine) == len(rows) else told.reading.select(mine)
            self._keep_reading(robot.name, mount.name, agents.rows(rows[mine]), reading)

    def tables(self) -> dict[str, Table]:
        """Return the tables: ``agents`` and one for each sensor, with rows ordered by episode and time."""
        found = {"agents": _join(self._states)}
        found |= {name: _join(parts) for name, parts in sorted(self._readings.items())}
        return {name: table for name, table in found.items() if table}

    def _keep_state(self, agents: _Agents, velocity: Floats, heading: Floats, twists: Floats, commands: Floats) -> None:
        self._states.append(
            {
                "episode": agents.episode.astype(np.int32),
                "nanoseconds": agents.nanoseconds,
                "ids": np.where(agents.active, agents.ids, -1).astype(np.int32),
                "position": _absent(agents.position, agents.active),
                "velocity": _absent(velocity, agents.active),
                "heading": _absent(heading, agents.active),
                "radius": _absent(agents.radius, agents.active),
                "robot_twist": twists.astype(np.float32),
                "robot_command": commands.astype(np.float32),
            }
        )

    def _keep_reading(self, robot: str, sensor: str, agents: _Agents, reading: Reading) -> None:
        name, count = f"{robot}/{sensor}", len(agents.episode)
        self.kinds[name] = type(reading).__name__
        when = np.round(np.broadcast_to(np.asarray(reading.time), (count,)) * 1e9).astype(np.int64)
        pose = spatial_pose(reading.pose)
        table: Table = {
            "episode": agents.episode.astype(np.int32),
            "nanoseconds": when,
            "pose_position": pose.position.astype(np.float32),
            "pose_rotation": pose.rotation.astype(np.float32),
        }
        table |= _fields(reading)
        hit = getattr(reading, "hit", None)
        if hit is not None:
            table |= self._labels(self._robots.get(robot, -1), agents, hit, pose, when)
            if isinstance(reading, RgbImage):
                table["boxes"] = pixel_boxes(np.asarray(hit), agents.ids.shape[1])
            table["hit"] = _ids_of(hit, agents.ids)
        elif isinstance(reading, TrackedPeople):
            table["ids"] = np.where(agents.active, agents.ids, -1).astype(np.int32)
        self._readings.setdefault(name, []).append(table)

    def _labels(self, own: int, agents: _Agents, hit: Any, pose: SpatialPose, when: Ints) -> Table:
        """Return who is visible: ids, number of beams or pixels, and occluded share, ``[N, A]`` each."""
        edges = (self.walls.start, self.walls.end)
        hidden = occluded_shares(pose.position[:, :2], agents.position, agents.radius, agents.active, own, edges)
        hidden[when != agents.nanoseconds] = np.nan  # a delayed reading shows people where they were
        return {
            "ids": np.where(agents.active, agents.ids, -1).astype(np.int32),
            "returns": count_hits(np.asarray(hit), agents.ids.shape[1]),
            "occluded": hidden.astype(np.float32),
        }


def count_hits(hit: Ints, agents: int) -> NDArray[np.int32]:
    """Return how many values of each row of ``hit`` ``[N, ...]`` belong to each agent, ``[N, A]``.

    >>> count_hits(np.array([[0, 0, -1, 2], [-2, 1, 1, 1]]), 3).tolist()
    [[2, 0, 1], [0, 3, 0]]
    """
    flat = hit.reshape(len(hit), -1)
    row, column = np.nonzero((flat >= 0) & (flat < agents))
    counts = np.bincount(row * agents + flat[row, column], minlength=len(flat) * agents)
    return counts.reshape(len(flat), agents).astype(np.int32)


def pixel_boxes(hit: Ints, agents: int) -> NDArray[np.int32]:
    """Return the box of the visible pixels of each agent: left, top, width, height, ``[N, A, 4]``; 0 without pixels.

    >>> pixel_boxes(np.array([[[-1, 0, 0], [-1, 0, -1]]]), 1).tolist()
    [[[1, 0, 2, 2]]]
    """
    boxes = np.zeros((len(hit), agents, 4), dtype=np.int32)
    for n, image in enumerate(hit):
        for agent in np.unique(image[(image >= 0) & (image < agents)]).tolist():
            rows, columns = np.nonzero(image == agent)
            left, top = columns.min(), rows.min()
            boxes[n, agent] = left, top, columns.max() - left + 1, rows.max() - top + 1
    return boxes


def _fields(reading: Reading) -> Table:
    """Return the arrays of a reading by name; poses become two arrays, numbers single precision."""
    table: Table = {}
    for field in dataclasses.fields(reading):
        value = getattr(reading, field.name)
        if field.name in ("time", "pose", "hit", "part", "lens") or value is None:
            continue
        if isinstance(value, Pose | SpatialPose):
            table[f"{field.name}_position"] = value.position.astype(np.float32)
            direction = value.heading if isinstance(value, Pose) else value.rotation
            table[f"{field.name}_heading"] = np.asarray(direction, dtype=np.float32)
            continue
        array = np.asarray(value)
        name = f"shared.{field.name}" if field.name in type(reading).shared_fields else field.name
        precision = np.float16 if field.name == "cos_incidence" else np.float32
        table[name] = array.astype(precision) if array.dtype == np.float64 else array
    return table


def _absent(values: Floats, active: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Return values with NaN for absent agents."""
    mask = active if values.ndim == 2 else active[..., None]
    return np.where(mask, values, np.nan).astype(np.float32)


def _ids_of(hit: Any, ids: Ints) -> NDArray[np.int32]:
    """Return hits as ids of people instead of columns; negative codes stay."""
    flat = np.asarray(hit).reshape(len(ids), -1)
    found = np.where(flat >= 0, np.take_along_axis(ids, np.clip(flat, 0, ids.shape[1] - 1), axis=1), flat)
    return found.reshape(np.shape(hit)).astype(np.int16 if ids.max(initial=0) < 32768 else np.int32)


def _by_column(reading: Reading, columns: Mapping[int, int]) -> Reading:
    """Return a reading of a step record with columns of agents instead of ids."""
    if isinstance(reading, TrackedPeople):
        order = list(columns)
        names = ("present", "position", "velocity", "radius", "heading")
        return dataclasses.replace(reading, **{name: getattr(reading, name)[:, order] for name in names})
    hit = getattr(reading, "hit", None)
    if hit is None or all(item == k for item, k in columns.items()):
        return reading
    places = np.full(1 + max([*columns, int(np.max(hit, initial=0))]), -1)
    places[list(columns)] = list(columns.values())
    return dataclasses.replace(reading, hit=np.where(hit >= 0, places[np.maximum(hit, 0)], hit))  # type: ignore[call-arg]


def _join(parts: Sequence[Table]) -> Table:
    """Return the rows of all parts, ordered by episode and time; people columns are filled up."""
    if not parts:
        return {}
    episode, time = (np.concatenate([part[name] for part in parts]) for name in ("episode", "nanoseconds"))
    places = np.empty(len(episode), dtype=np.int64)
    places[np.lexsort((time, episode))] = np.arange(len(episode))
    table: Table = {}
    for name, first in parts[0].items():
        table[name] = first if name.startswith("shared.") else _place([part[name] for part in parts], places, name)
    return table


def _place(arrays: Sequence[NDArray[Any]], places: Ints, name: str) -> NDArray[Any]:
    """Return the rows of all arrays at their places; each is copied once, since the arrays of scans are large."""
    first, kind = arrays[0], np.result_type(*arrays)
    tail = (max(array.shape[1] for array in arrays), *first.shape[2:]) if first.ndim > 1 else ()
    filler = -1 if name == "ids" else np.nan if kind.kind == "f" else 0
    same = all(array.shape[1:] == tail for array in arrays)
    place = np.empty((len(places), *tail), dtype=kind) if same else np.full((len(places), *tail), filler, dtype=kind)
    begin = 0
    for array in arrays:
        here = places[begin : begin + len(array)]
        if same:
            place[here] = array
        else:
            place[here, : array.shape[1]] = array
        begin += len(array)
    return place
