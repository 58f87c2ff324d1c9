"""StepMessages: the ROS 2 messages of step records, for the recorder and for every bridge."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from crowdbot.core import FreeClock
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
from crowdbot.trials import Trial
from crowdbot.world import people_by_reaction

from .metadata import CONTACTS, ORDERS, REACTION_TOPIC, as_json
from .robot_messages import RobotMessages


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
    ['/clock', '/robot/robot_description', '/tf_static', '/tf']
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
