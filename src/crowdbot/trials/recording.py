"""Recorder: an episode as one MCAP file of ROS 2 messages that also holds the trial, the seed and the versions."""

from __future__ import annotations

import os
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

from mcap.writer import CompressionType, Writer

from crowdbot.core import EpisodeError
from crowdbot.sensors import Scan

from .episode import Episode
from .episode_file import FORMAT, MAP, METADATA, as_json, versions
from .markers import markers
from .messages import Messages
from .simulation import Frame
from .trial import Trial

__all__ = ["Recorder"]


class Recorder:
    """Writes what a run tells it to a file that appears when it is complete.

    Topics: ``/clock``, ``/tf`` (``map`` to each robot and its sensors), ``/people``, ``/crowd/markers``, and for each
    robot ``/<robot>/odom``, ``/<robot>/cmd_vel`` and ``/<robot>/<sensor>``. Every stamp is simulated time.

    Use as a context: when it ends without :meth:`complete`, nothing is left behind, not even folders it made.

    Args:
        path: of the file.
        trial, seed: what runs.

    Raises:
        InputError: the trial cannot be written as XML.
        EpisodeError: the file cannot be written.
    """

    def __init__(self, path: Path, trial: Trial, seed: int) -> None:
        self.path = path
        self.trial, self.seed = trial, seed
        self.draft = path.with_name(f".{path.name}.{os.getpid()}.part")
        self.xml = trial.xml()
        self.messages = Messages()
        self.channels: dict[str, int] = {}
        self.schemas: dict[str, int] = {}
        self.made: list[Path] = []
        self.stream: BinaryIO | None = None
        self.writer: Any = None
        self._markers_every = round(trial.recording.markers * 1e9)
        self._markers_due = 0
        self._static = [
            (f"{robot.name}/base_link", f"{robot.name}/{mount.name}", mount.x, mount.y, mount.heading)
            for robot in trial.robots
            for mount in robot.sensors
        ]

    def __enter__(self) -> Recorder:
        """Make the folder and the unfinished file."""
        try:
            self._make_folder(self.path.parent)
            self.stream = self.draft.open("wb")
        except OSError as error:
            self._clear()
            raise EpisodeError(f"{self.path} cannot be written: {error.strerror}; give another place") from None
        self.writer = Writer(self.stream, compression=CompressionType.ZSTD, enable_data_crcs=True)
        self.writer.start(profile="ros2", library=f"crowdbot {versions()['version']}")
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Remove what is unfinished."""
        if self.stream is not None:
            self._clear()

    def take(self, frame: Frame) -> None:
        """Write an instant."""
        first = self.trial.people
        now, make = frame.nanoseconds, self.messages
        self._write("/clock", make.clock(now), now)
        if self.trial.robots:
            self._write("/tf", make.transforms(now, [*self._poses(frame, first), *self._static]), now)
        for robot, mount, reading in frame.readings:
            topic = f"{robot.name}/{mount.name}"
            if isinstance(reading, Scan):
                scan = make.scan(now, topic, mount.sensor, reading.angles, reading.ranges[0], reading.hit[0])
                self._write(f"/{topic}", scan, now)
            else:
                raise EpisodeError(
                    f"sensor {topic!r} gives a {type(reading).__name__}, which has no ROS message yet; run without out"
                )
        if frame.due:
            self._scene(frame, first)

    def complete(self, episode: Episode) -> None:
        """Write the metadata, finish the file and let it appear."""
        assert self.stream is not None
        try:
            self.writer.add_metadata(METADATA, self._metadata(episode))
            self.writer.finish()
            self.stream.flush()
            os.fsync(self.stream.fileno())
            self.stream.close()
            os.replace(self.draft, self.path)
        except OSError as error:
            raise EpisodeError(f"{self.path} cannot be written: {error.strerror}") from None
        self.stream = None

    def _scene(self, frame: Frame, first: int) -> None:
        now, make, scene = frame.nanoseconds, self.messages, frame.scene
        self._write("/people", make.people(now, scene, frame.ids), now)
        for k, (_, _, x, y, heading) in enumerate(self._poses(frame, first)):
            name = self.trial.robots[k].name
            self._write(f"/{name}/odom", make.odometry(now, name, x, y, heading, frame.twists[k]), now)
            self._write(f"/{name}/cmd_vel", make.twist(*frame.commands[k]), now)
        if now >= self._markers_due:
            self._markers_due = now - now % self._markers_every + self._markers_every
            self._write("/crowd/markers", markers(make, now, scene, frame.ids, self.trial.robots), now)

    def _poses(self, frame: Frame, first: int) -> list[tuple[str, str, float, float, float]]:
        scene = frame.scene
        return [
            (
                MAP,
                f"{robot.name}/base_link",
                float(scene.position[0, first + k, 0]),
                float(scene.position[0, first + k, 1]),
                float(scene.heading[0, first + k]),
            )
            for k, robot in enumerate(self.trial.robots)
        ]

    def _write(self, topic: str, message: Any, nanoseconds: int) -> None:
        kind = message.__msgtype__
        if topic not in self.channels:
            if kind not in self.schemas:
                text = self.messages.definition(kind).encode()
                self.schemas[kind] = self.writer.register_schema(kind, "ros2msg", text)
            self.channels[topic] = self.writer.register_channel(
                topic, "cdr", self.schemas[kind], metadata={"offered_qos_profiles": ""}
            )
        try:
            self.writer.add_message(
                self.channels[topic], nanoseconds, self.messages.encoded(message), publish_time=nanoseconds
            )
        except OSError as error:
            raise EpisodeError(f"{self.path} cannot be written: {error.strerror}") from None

    def _metadata(self, episode: Episode) -> dict[str, str]:
        robots = [
            {
                "name": robot.name,
                "id": int(episode.ids[episode.robots[k]]),
                "radius": robot.radius,
                "goal": list(robot.goal.position),
                "tolerance": robot.goal.tolerance,
                "sensors": [mount.name for mount in robot.sensors],
            }
            for k, robot in enumerate(self.trial.robots)
        ]
        return {
            "format": FORMAT,
            "trial": self.xml,
            "trial_name": self.trial.name,
            "seed": str(self.seed),
            **versions(),
            "digest": episode.digest,
            "outcome": episode.outcome,
            "steps": str(episode.steps),
            "people": str(len(episode.ids) - len(robots)),
            "metrics": as_json(episode.metrics),
            "walls": as_json([ring.tolist() for ring in episode.walls]),
            "robots": as_json(robots),
        }

    def _make_folder(self, folder: Path) -> None:
        missing = [place for place in (folder, *folder.parents) if not place.exists()]
        for place in reversed(missing):
            place.mkdir(exist_ok=True)
            self.made.append(place)

    def _clear(self) -> None:
        if self.stream is not None:
            self.stream.close()
            self.stream = None
            self.draft.unlink(missing_ok=True)
        for folder in reversed(self.made):
            if not any(folder.iterdir()):
                folder.rmdir()
