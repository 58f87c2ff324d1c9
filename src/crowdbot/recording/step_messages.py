"""StepMessages: the ROS 2 messages of step records, for the recorder and for every bridge."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from crowdbot.core import FreeClock, Scene
from crowdbot.messages import (
    FALL_POSES,
    MeasuredReading,
    Messages,
    contact_messages,
    encode_reading,
    fall_pose_message,
    markers,
)
from crowdbot.messages import MARKERS as MARKER_KIND
from crowdbot.simulation import WALL, Simulation, StepRecord, write_order
from crowdbot.trials import Stage, Trial
from crowdbot.typing import Bools, Floats
from crowdbot.world import people_by_gesture, people_by_reaction

from .metadata import CONTACTS, GESTURE_TOPIC, ORDERS, REACTION_TOPIC, as_json
from .robot_messages import STATIC, RobotMessages

MAP_TOPIC = "/map"
CELL, MOST_CELLS = 0.05, 1_000_000
"""Size of a cell of the map [m], and the largest number of cells; a larger stage gets larger cells."""
BLOCKS = (64, 16, 4, 1)
"""Cells on a side of the blocks of the map; a block far away from solids is free as a whole."""
MARGIN = 1.0
"""Free space [m] around walls, people and robots."""
OCCUPIED = 100


def is_latched(topic: str) -> bool:
    """Whether a topic has its messages once, for late subscribers too.

    >>> is_latched("/map"), is_latched("/robot/robot_description"), is_latched("/tf")
    (True, True, False)
    """
    return topic in (MAP_TOPIC, STATIC) or topic.endswith("/robot_description")


def map_message(make: Messages, stage: Stage, scene: Scene) -> Any:
    """Return ``nav_msgs/OccupancyGrid``: 100 in and on solids and outside the walkable area, 0 elsewhere.

    A cell is occupied if a solid is nearer to its centre than half of its diagonal.

    Args:
        make: creates the message.
        stage: the stage, with walls, obstacles and props.
        scene: people and robots at the start, which lie on the map.

    >>> from crowdbot.trials import load_trial
    >>> simulation = Simulation(load_trial("bottleneck"), 0)
    >>> grid = map_message(Messages(), simulation.trial.stage, simulation.world.scene)
    >>> grid.info.resolution, int(grid.data.max()), grid.data.size == grid.info.width * grid.info.height
    (0.05, 100, True)
    """
    low, high = _bounds(stage, scene)
    cell = CELL
    while math.prod(np.ceil((high - low) / cell)) > MOST_CELLS:
        cell *= 2.0
    width, height = (int(count) for count in np.ceil((high - low) / cell))
    info = make.make(
        "nav_msgs/msg/MapMetaData",
        map_load_time=make.stamp(0),
        resolution=cell,
        width=width,
        height=height,
        origin=make.pose(float(low[0]), float(low[1]), 0.0),
    )
    data = np.where(_occupied(stage, low, cell, (height, width)), OCCUPIED, 0).astype(np.int8).ravel()
    return make.make("nav_msgs/msg/OccupancyGrid", header=make.header(0), info=info, data=data)


def _occupied(stage: Stage, low: Floats, cell: float, shape: tuple[int, int]) -> Bools:
    """Return the occupied cells ``[height, width]``; blocks that are free or solid as a whole are not divided."""
    occupied = np.zeros(shape, dtype=np.bool_)
    chosen = np.ones([-(-count // BLOCKS[0]) for count in shape], dtype=np.bool_)
    for size, finer in zip(BLOCKS, (*BLOCKS[1:], 1), strict=True):
        rows, columns = np.nonzero(chosen)
        places = np.stack([columns, rows], axis=1)
        reach = cell * math.sqrt(0.5) * (size + (size > 1))  # of the cells in a block, and of their own
        near = stage.clearance(low + cell * size * (places + 0.5)) <= reach
        solid = near.copy()
        if size > 1:
            solid[near] = stage.fills(*(low + cell * size * (places[near] + end) for end in (0, 1)))
        chosen[rows, columns] = solid
        occupied |= _divided(chosen, size, shape)
        chosen[rows, columns] = near & ~solid
        chosen = _divided(chosen, size // finer, [-(-count // finer) for count in shape])
    return occupied


def _divided(cells: Bools, times: int, shape: Sequence[int]) -> Bools:
    return np.repeat(np.repeat(cells, times, axis=0), times, axis=1)[: shape[0], : shape[1]]


def _bounds(stage: Stage, scene: Scene) -> tuple[Floats, Floats]:
    """Return the corners [m] of the map, on whole cells."""
    places = [np.asarray(ring, dtype=np.float64) for ring in stage.rings]
    there = scene.active[0]
    places += [scene.position[0, there], scene.goal[0, there], np.zeros((1, 2))]
    points = np.concatenate([rows[np.isfinite(rows).all(axis=1)] for rows in places])
    low = np.floor((points.min(axis=0) - MARGIN) / CELL) * CELL
    return low, points.max(axis=0) + MARGIN


def _everything(topic: str) -> bool:
    return True


@dataclass(eq=False)
class StepMessage:
    """A message of a step on a topic, encoded or decoded when it is needed.

    Fields:
        topic: name of the topic.
        kind: type of the message, such as ``sensor_msgs/msg/LaserScan``.
        nanoseconds: simulated time [ns].
        make: creates and encodes messages.
        content: the message, or its CDR bytes.
    """

    topic: str
    kind: str
    nanoseconds: int
    make: Messages = field(repr=False)
    content: Any = field(repr=False)

    @functools.cached_property
    def message(self) -> Any:
        """The message with its fields."""
        return self.make.decode_message(self.content, self.kind) if isinstance(self.content, bytes) else self.content

    @functools.cached_property
    def cdr(self) -> bytes:
        """The CDR bytes of the message, with their header."""
        return self.content if isinstance(self.content, bytes) else self.make.encode_message(self.content)


class StepMessages:
    """Converts step records to messages; what is recorded is what bridges send.

    Args:
        trial: the trial.
        names: names of the robots by id.
        simulation: the simulation of the records, for joints; None: robots are in their postures.
        begin: tick of the first step.
        labelled: whether readings say which agent each beam met, as recordings do.

    >>> from crowdbot.trials import load_trial
    >>> trial = load_trial("frontal", duration=1.0)
    >>> simulation = Simulation(trial, 0)
    >>> simulation.begin()
    >>> steps = StepMessages(trial, {}, simulation)
    >>> [one.topic for one in steps.messages(simulation.record())][:4]
    ['/clock', '/map', '/robot/robot_description', '/tf_static']
    """

    def __init__(
        self,
        trial: Trial,
        names: Mapping[int, str],
        simulation: Simulation | None = None,
        begin: int = 0,
        labelled: bool = True,
    ) -> None:
        self.make = Messages()
        self.robots = RobotMessages(self.make, simulation)
        self.names, self._labelled = dict(names), labelled
        self._stage: Stage | None = trial.stage
        """The stage until the map is sent."""
        clock = FreeClock(trial.step)
        self._markers = clock.schedule(trial.recording.markers)
        self._next_markers = self._markers.index(self._markers.next_due(begin))

    def messages(self, frame: StepRecord, wants: Callable[[str], bool] = _everything) -> Iterator[StepMessage]:
        """Yield the messages of a step in their order in a file.

        Args:
            frame: the step record.
            wants: whether messages of a topic are needed; others are not made.
        """
        now, make = frame.nanoseconds, self.make
        self.names |= {k: robot.name for k, robot in zip(frame.robot_ids, frame.robots, strict=True)}
        for topic, message in self._of_step(frame, wants):
            if wants(topic):
                yield StepMessage(topic, message.__msgtype__, now, make, message)
        if frame.due:
            yield from self._of_scene(frame, wants)

    def endings(self, frame: StepRecord, wants: Callable[[str], bool] = _everything) -> Iterator[StepMessage]:
        """Yield the messages of a record that :meth:`crowdbot.simulation.Simulation.record` has only at its end.

        These are the orders that were applied, and contact events that have ended.
        """
        now, make = frame.nanoseconds, self.make
        rows = [(ORDERS, make.text(write_order(order))) for order in frame.orders]
        ended = dataclasses.replace(frame, forces=())
        for topic, message in (*rows, *contact_messages(make, now, ended, self.names)):
            if wants(topic):
                yield self._message(topic, message, now)

    def _of_step(self, frame: StepRecord, wants: Callable[[str], bool]) -> Iterator[tuple[str, Any]]:
        now, make = frame.nanoseconds, self.make
        yield "/clock", make.clock(now)
        if self._stage is not None and wants(MAP_TOPIC):
            yield MAP_TOPIC, map_message(make, self._stage, frame.scene)
            self._stage = None
        yield from self.robots.latched(frame)
        for message in self.robots.transforms(frame):
            yield "/tf", message
        for robot, mount, reading in frame.readings:
            told = MeasuredReading(reading, mount.sensor, robot.name, f"{robot.name}/{mount.name}", self._labelled)
            if wants(f"/{told.topic}/"):
                for ending, message in encode_reading(make, told):
                    yield f"/{told.topic}{ending}", message
        if frame.touches:
            yield CONTACTS, make.contacts(now, self._touches(frame))
        for order in frame.orders:
            yield ORDERS, make.text(write_order(order))
        yield from contact_messages(make, now, frame, self.names)

    def _of_scene(self, frame: StepRecord, wants: Callable[[str], bool]) -> Iterator[StepMessage]:
        now, make, scene = frame.nanoseconds, self.make, frame.scene
        if wants("/people"):
            people = make.people(now, scene, frame.ids)
            yield StepMessage("/people", "people_msgs/msg/People", now, make, people)
        if frame.fall_poses and wants(FALL_POSES):
            poses = {int(frame.ids[agent]): pose for agent, pose in frame.fall_poses.items()}
            yield self._message(FALL_POSES, fall_pose_message(make, now, poses), now)
        if wants(REACTION_TOPIC) and (reactions := people_by_reaction(scene, frame.ids)) is not None:
            yield self._message(REACTION_TOPIC, make.text(as_json(reactions)), now)
        if wants(GESTURE_TOPIC) and (gestures := people_by_gesture(scene, frame.ids)) is not None:
            yield self._message(GESTURE_TOPIC, make.text(as_json(gestures)), now)
        for topic, message in self.robots.scene(frame):
            if wants(topic):
                yield self._message(topic, message, now)
        if (latest := self._markers.index(frame.tick)) >= self._next_markers:
            self._next_markers = latest + 1
            if wants("/crowd/markers"):
                goals = [(robot.goal.x, robot.goal.y, robot.goal.tolerance) for robot in frame.robots]
                shapes = markers(now, scene, frame.ids, goals)
                yield StepMessage("/crowd/markers", MARKER_KIND, now, make, shapes)

    def _message(self, topic: str, message: Any, now: int) -> StepMessage:
        return StepMessage(topic, message.__msgtype__, now, self.make, message)

    def _touches(self, frame: StepRecord) -> list[tuple[str, str, float]]:
        names = self.names | {WALL: "wall"}
        return [
            (names[touch.robot], names.get(touch.other, str(touch.other)), touch.clearance) for touch in frame.touches
        ]
