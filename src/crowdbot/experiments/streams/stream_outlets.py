"""StreamOutlets: head and robot poses and events of a session as streams of the Lab Streaming Layer."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Any

from crowdbot.simulation import AvatarOrder, StepRecord
from crowdbot.trials import Trial

from .lab_streaming_layer import load_pylsl

EVENTS_STREAM, HEADS_STREAM, ROBOTS_STREAM = "crowdbot-events", "crowdbot-heads", "crowdbot-robots"
HEAD = {"x": "m", "y": "m", "z": "m", "qw": "1", "qx": "1", "qy": "1", "qz": "1"}
ROBOT = {"x": "m", "y": "m", "heading": "rad"}
TYPE = "MoCap"
NOT_SENT = ("at",)


class StreamOutlets:
    """Sends a session to the local network.

    * ``crowdbot-events``, type ``Markers``: one JSON text for each event of the session (start, answers, begin and end
      of trials) and the beginning of each contact of a robot in the simulation.
    * ``crowdbot-heads``, type ``MoCap``: position [m] and quaternion w, x, y, z of the head of each avatar whose head
      is known, in the frame of the trial; ``AVATAR.x`` and so on. Unknown values are NaN.
    * ``crowdbot-robots``, type ``MoCap``: x, y [m] and heading [rad] of each robot, at each recorded step.

    Samples are stamped when their step is recorded. The streams of a session keep their source id, so that receivers
    connect again when it is resumed. It is a sink of step records.

    Args:
        source: name of the sender, such as that of the experiment; the same name at the same time is one stream.

    Raises:
        MissingExtra: the package ``pylsl`` is not installed.
    """

    def __init__(self, source: str) -> None:
        self._lsl = load_pylsl()
        self._source = source
        self._events = self._outlet(EVENTS_STREAM, "Markers", {"event": ""}, self._lsl.cf_string)
        self._poses: dict[str, tuple[tuple[str, ...], Any]] = {}
        self._touching: frozenset[tuple[int, int]] = frozenset()
        self._heads: dict[str, int] = {}
        self._robots: list[str] = []

    def __enter__(self) -> StreamOutlets:
        """Return the outlets."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the streams."""
        self.close()

    def begin(self, trial: Trial) -> None:
        """Open the streams of poses for the robots and avatars of a trial; equal channels stay open."""
        avatars = [one.name for one in trial.avatars]
        self._heads = {name: k * len(HEAD) for k, name in enumerate(avatars)}
        self._robots, self._touching = [one.name for one in trial.robots], frozenset()
        self._open(HEADS_STREAM, avatars, HEAD)
        self._open(ROBOTS_STREAM, self._robots, ROBOT)

    def tell(self, record: Mapping[str, Any]) -> None:
        """Send an event of the session; its time is the stamp of the sample."""
        values = {name: value for name, value in record.items() if name not in NOT_SENT}
        self._events.push_sample([json.dumps(values, ensure_ascii=False)])

    def take(self, frame: StepRecord) -> None:
        """Send poses and contacts of a step."""
        stamp, agents = self._lsl.local_clock(), {int(one): k for k, one in enumerate(frame.ids.tolist())}
        names = {number: spec.name for number, spec in zip(frame.robot_ids, frame.robots, strict=True)}
        self._tell_contacts(frame, names)
        if frame.due and ROBOTS_STREAM in self._poses:
            values = [float("nan")] * (len(ROBOT) * len(self._robots))
            for number, name in names.items():
                if name in self._robots:
                    at, k = self._robots.index(name) * len(ROBOT), agents[number]
                    place = frame.scene.position[0, k].tolist()
                    values[at : at + len(ROBOT)] = [*place, float(frame.scene.heading[0, k])]
            self._poses[ROBOTS_STREAM][1].push_sample(values, stamp)
        heads = {
            one.avatar: one.head for one in frame.orders if isinstance(one, AvatarOrder) and one.avatar in self._heads
        }
        if any(head is not None for head in heads.values()):
            values = [float("nan")] * (len(HEAD) * len(self._heads))
            for name, head in heads.items():
                if head is not None:
                    values[self._heads[name] : self._heads[name] + len(HEAD)] = list(head)
            self._poses[HEADS_STREAM][1].push_sample(values, stamp)

    def close(self) -> None:
        """End the streams."""
        self._poses, self._events = {}, None

    def _tell_contacts(self, frame: StepRecord, names: Mapping[int, str]) -> None:
        """Send the contacts that begin in a step."""
        now = frozenset((one.robot, one.other) for one in frame.touches)
        for robot, other in sorted(now - self._touching):
            with_whom = names.get(other, "wall" if other < 0 else f"person {other}")
            time = frame.nanoseconds / 1e9
            self.tell({"event": "contact", "time": time, "robot": names.get(robot, str(robot)), "other": with_whom})
        self._touching = now

    def _open(self, stream: str, names: Sequence[str], channels: Mapping[str, str]) -> None:
        labels = tuple(f"{name}.{channel}" for name in names for channel in channels)
        if self._poses.get(stream, ((), None))[0] == labels:
            return
        self._poses.pop(stream, None)
        if labels:
            units = {f"{name}.{channel}": unit for name in names for channel, unit in channels.items()}
            self._poses[stream] = (labels, self._outlet(stream, TYPE, units, self._lsl.cf_double64))

    def _outlet(self, name: str, kind: str, channels: Mapping[str, str], form: int) -> Any:
        rate = self._lsl.IRREGULAR_RATE
        info = self._lsl.StreamInfo(name, kind, len(channels), rate, form, f"{self._source}/{name}")
        info.set_channel_labels(list(channels))
        info.set_channel_units(list(channels.values()))
        return self._lsl.StreamOutlet(info)
