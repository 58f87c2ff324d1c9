"""Recorder: writes an episode as an MCAP file of ROS 2 messages, with trial, seed and versions."""

from __future__ import annotations

import contextlib
import dataclasses
import errno
import os
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from crowdbot.core import EpisodeError, FreeClock, InputError, lock_output
from crowdbot.sensors import RGBCamera
from crowdbot.simulation import EpisodeStatistics, RunFailure, Simulation, StepRecord
from crowdbot.trials import RobotSpec, Trial, trial_xml
from crowdbot.world import graphics_library

from .attachments import SkippedAttachmentWarning, collect_attachments, skip_message
from .keyframes import MEDIA, KeyframeTrack
from .mcap_writer import McapWriter
from .metadata import ADDED_ROBOTS, DIGEST, ENDING, FORMAT, METADATA, as_json, versions
from .step_messages import StepMessages, is_latched

FOREVER = "{sec: 2147483647, nsec: 4294967295}"
LATCHED = (
    "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
    f"  deadline: {FOREVER}\n  lifespan: {FOREVER}\n"
    f"  liveliness: 1\n  liveliness_lease_duration: {FOREVER}\n  avoid_ros_namespace_conventions: false\n"
)
"""Quality of service of what is written once, for late subscribers in ROS (read by rosbag2)."""
APART = 500_000_000
"""Simulated time between two writes [ns]; the content of the file does not depend on wall time."""


class Recorder:
    """Writes the step records of a run to a file that is readable at any time, also after the process is killed.

    Topics: ``/clock``, ``/tf`` (``map``, odometry frame, robot and moving links), ``/tf_static`` (fixed links and
    sensors, latched), ``/map`` (latched), ``/people``, ``/crowd/markers``, ``/crowdbot/digest``, for each robot
    ``/<robot>/odom``, ``/<robot>/ground_truth/odom``, ``/<robot>/cmd_vel``, ``/<robot>/joint_states``,
    ``/<robot>/robot_description`` (latched) and ``/<robot>/<sensor>`` (message types of sensors:
    :mod:`crowdbot.messages`), ``/crowdbot/contacts`` for contacts of a robot with people or walls, ``/crowdbot/orders``
    for orders from outside, ``/crowdbot/reactions`` if people can react to robots, and ``/crowdbot/gestures`` if they
    can make gestures; in the physics world ``/crowdbot/forces`` and ``/crowdbot/collisions`` too. All time stamps are
    simulated time.

    The file is created, or replaced, at the first recorded step and grows every half second of simulated time. Use it
    as a context manager: without :meth:`complete`, the file is left incomplete; before the first step, no file and no
    new folder remains.

    Args:
        path: the file.
        tally: statistics of the run; they receive each step before the recorder.
        origin: metadata of the episode that the run branched from.
        begin: tick of the first step.
        earlier: trials that it branched from, whose files are stored, too.
        force: whether an existing file may be overwritten.
        simulation: the simulation that is recorded, for a keyframe every 5 s; None: the file has none.

    Raises:
        EpisodeError: the file cannot be written.
        InputError: the trial cannot be written as XML, the file exists and ``force`` is false, or another run is
            writing to it.

    Warns:
        SkippedAttachmentWarning: files that the trial refers to are not stored.
    """

    def __init__(
        self,
        path: Path,
        tally: EpisodeStatistics,
        origin: Sequence[Mapping[str, Any]] = (),
        begin: int = 0,
        earlier: Sequence[Trial] = (),
        force: bool = False,
        simulation: Simulation | None = None,
    ) -> None:
        self.path, self.tally, self.origin, self.begin, self.force = path, tally, origin, begin, force
        self._lock = contextlib.ExitStack()
        self.trial, self.seed = tally.trial, tally.seed
        self.xml = trial_xml(self.trial)
        self.files = collect_attachments([self.trial, *earlier])
        if sentence := skip_message(file for file, _ in self.files):
            warnings.warn(sentence, SkippedAttachmentWarning, stacklevel=2)
        names = dict(zip(tally.robot_ids, [robot.name for robot in self.trial.robots], strict=True))
        self.steps = StepMessages(self.trial, names, simulation, begin)
        self.messages = self.steps.make
        self.keyframes = KeyframeTrack(simulation, tally.digest)
        self.channels: dict[str, int] = {}
        self.made: list[Path] = []
        self.tape: McapWriter | None = None
        self.last = (0, "")
        """Number of steps until the last recorded step, and the digest of an episode that ends there."""
        clock = FreeClock(self.trial.step)
        self._schedule = clock.schedule(self.trial.recording.period)
        self._write_due = begin * clock.step_ns
        self._added: dict[int, dict[str, Any]] = {}

    def __enter__(self) -> Recorder:
        """Create the folder and lock the file."""
        try:
            self._make_folder(self.path.parent)
            if not os.access(self.path.parent, os.W_OK):
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
            self._lock.enter_context(lock_output(self.path, self.force))
        except InputError:
            self._clear()
            raise
        except OSError as error:
            self._clear()
            raise EpisodeError(f"cannot write {self.path}: {error.strerror}; use another file") from None
        self.tape = McapWriter(self.path, "ros2", f"crowdbot {versions()['version']}")
        self.tape.metadata(METADATA, self._metadata())
        for file, place in self.files:
            if file.kept:
                self.tape.attachment(file.name, place.read_bytes())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Keep the written data; remove empty files."""
        if self.tape is not None:
            self.tape.close(finished=False)
        self._lock.close()
        self._clear()

    def take(self, frame: StepRecord) -> None:
        """Write a step."""
        now = frame.nanoseconds
        self._note_added(frame)
        for message in self.steps.messages(frame):
            self._put(message.topic, message.kind, message.cdr, now)
        if frame.due:
            self.last = frame.tick, self.tally.digest.hexdigest("interrupted")
            text = self.messages.text(self.last[1])
            self._put(DIGEST, text.__msgtype__, self.messages.encode_message(text), now)
        assert self.tape is not None
        if (keyframe := self.keyframes.take(frame)) is not None:
            self.tape.attachment(f"keyframe/{frame.tick}", keyframe, MEDIA, now)
        if (frame.due and now >= self._write_due) or self.tape.large:
            self._write_due = now - now % APART + APART
            self._flush()

    def complete(self, outcome: str, steps: int, failure: RunFailure | None = None) -> None:
        """Write the outcome and finish the file; an interrupted run ends at the last recorded step."""
        assert self.tape is not None
        interrupted = outcome == "interrupted"
        ending = {
            "digest": self.last[1] if interrupted else self.tally.digest.hexdigest(outcome),
            "outcome": outcome,
            "steps": str(self.last[0] if interrupted else steps),
            "people": str(self.tally.agents - len(self.trial.robots)),
            "metrics": as_json(self.tally.metrics(outcome)),
        }
        if failure is not None:
            ending |= {"error": failure.message, "error_place": failure.place, "error_time": repr(failure.time)}
        if self.keyframes.reason:
            ending["no_keyframes"] = self.keyframes.reason
        if drawn := self._drawn_by():
            ending["drawn_by"] = drawn
        self.tape.metadata(ENDING, ending)
        self._flush()
        try:
            self.tape.close(finished=True)
        except OSError as error:
            raise EpisodeError(f"cannot write {self.path}: {error.strerror}") from None
        self.tape = None

    def _drawn_by(self) -> str:
        """Return what drew the images of colour cameras: ``software``, a graphics library, or both."""
        sensors = [mount.sensor for robot in self.trial.robots for mount in robot.sensors]
        used = {sensor.renderer for sensor in sensors if isinstance(sensor, RGBCamera)}
        libraries = graphics_library() if "opengl" in used else ()
        return ", ".join([*(["software"] if "software" in used else []), *libraries])

    def _note_added(self, frame: StepRecord) -> None:
        """Write a metadata record when orders have added robots."""
        new = [(k, robot) for k, robot in zip(frame.robot_ids, frame.robots, strict=True) if k not in self.steps.names]
        if not new:
            return
        self._added |= {k: _robot_record(k, robot) for k, robot in new}
        assert self.tape is not None
        self.tape.metadata(ADDED_ROBOTS, {"added_robots": as_json(list(self._added.values()))})

    def _put(self, topic: str, kind: str, data: bytes, nanoseconds: int) -> None:
        assert self.tape is not None
        if topic not in self.channels:
            schema = self.tape.schema(kind, self.messages.definition(kind))
            quality = LATCHED if is_latched(topic) else ""
            self.channels[topic] = self.tape.channel(topic, schema, quality)
        try:
            self.tape.message(self.channels[topic], nanoseconds, data)
        except OSError as error:
            raise EpisodeError(f"cannot write {self.path}: {error.strerror}") from None

    def flush(self) -> None:
        """Write all pending steps, so that the file can be read up to the latest one."""
        self._flush()

    def _flush(self) -> None:
        assert self.tape is not None
        try:
            self.tape.flush()
        except OSError as error:
            raise EpisodeError(f"cannot write {self.path}: {error.strerror}") from None

    def _metadata(self) -> dict[str, str]:
        robots = [_robot_record(*row) for row in zip(self.tally.robot_ids, self.trial.robots, strict=True)]
        schedule = self._schedule
        exact = schedule.period_ns == schedule.every * schedule.step_ns  # readers take the period from the times
        return {
            "format": FORMAT,
            "trial": self.xml,
            "trial_name": self.trial.name,
            "seed": str(self.seed),
            **versions(),
            **({"world": "physics"} if self.trial.world == "physics" else {}),
            **({"balance": "true"} if self.trial.balance else {}),
            "step_ns": str(schedule.step_ns),
            **({} if exact else {"period_ns": str(schedule.period_ns)}),
            "walls": as_json([ring.tolist() for ring in self.trial.stage.rings]),
            "robots": as_json(robots),
            **({"files": as_json([dataclasses.asdict(file) for file, _ in self.files])} if self.files else {}),
            **({"origin": as_json(list(self.origin)), "begin": str(self.begin)} if self.origin else {}),
        }

    def _make_folder(self, folder: Path) -> None:
        missing = [place for place in (folder, *folder.parents) if not place.exists()]
        for place in reversed(missing):
            place.mkdir(exist_ok=True)
            self.made.append(place)

    def _clear(self) -> None:
        for folder in reversed(self.made):
            if not any(folder.iterdir()):
                folder.rmdir()


def _robot_record(robot_id: int, robot: RobotSpec) -> dict[str, Any]:
    """Return what readers of a file need to know about a robot."""
    return {
        "name": robot.name,
        "id": robot_id,
        "radius": robot.radius,
        "goal": list(robot.goal.position),
        "tolerance": robot.goal.tolerance,
        "sensors": [mount.name for mount in robot.sensors],
        **({"ghost": True} if robot.ghost else {}),
        **({"footprint": robot.body.footprint.tolist()} if robot.type else {}),
    }
