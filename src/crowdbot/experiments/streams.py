"""Clocks of a session, and streams of other programs in and out over the Lab Streaming Layer."""

from __future__ import annotations

import contextlib
import csv
import json
import re
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import CrowdbotError, EpisodeError, InputError, MissingExtra
from crowdbot.simulation import AvatarOrder, StepRecord
from crowdbot.trials import Trial
from crowdbot.typing import Floats


def load_pylsl() -> Any:
    """Return the module ``pylsl``.

    Raises:
        MissingExtra: it is not installed, or without the library ``liblsl``.
    """
    try:
        import pylsl
    except (ImportError, RuntimeError, OSError):  # pylsl raises RuntimeError without liblsl
        raise MissingExtra("the Lab Streaming Layer", "lsl") from None
    return pylsl


STREAMS = "streams"
"""Folder of the streams in the folder of a participant."""
COLUMNS = ("stream_time", "offset", "clock")
"""First columns of the samples: clock of the sender, what to add to it, and the monotonic clock of this computer."""


class RecordedStream(NamedTuple):
    """A recorded stream.

    Fields:
        name, type: as the sender names them.
        labels: names of the C channels.
        units: units of the channels, empty if the sender does not say.
        rate: nominal rate [Hz]; 0 for an irregular one.
        stream_time: ``[T]`` time stamps in the clock of the sender [s].
        offset: ``[T]`` estimated offset: clock of this computer minus that of the sender [s].
        clock: ``[T]`` the time stamps in the monotonic clock of this computer [s].
        values: ``[T, C]``.
    """

    name: str
    type: str
    labels: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    stream_time: Floats
    offset: Floats
    clock: Floats
    values: Floats


def read_streams(folder: Path | str) -> list[RecordedStream]:
    """Return the streams that were recorded in the session of a participant.

    Args:
        folder: folder of the participant.

    Raises:
        EpisodeError: a file is damaged.
    """
    return [_read(path) for path in sorted((Path(folder) / STREAMS).glob("*.json"))]


def _read(path: Path) -> RecordedStream:
    try:
        head: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        labels, units = tuple(map(str, head["labels"])), tuple(map(str, head["units"]))
        text = path.with_suffix(".csv").read_text(encoding="utf-8")
        lines = list(csv.reader(text[: text.rfind("\n") + 1].splitlines()))  # a killed session may end inside a row
        rows = np.array([list(map(float, line)) for line in lines[1:]], dtype=np.float64)
        rows = rows.reshape(-1, len(COLUMNS) + len(labels))
        name, kind, rate = str(head["name"]), str(head["type"]), float(head["rate"])
    except (OSError, ValueError, KeyError, TypeError, csv.Error):
        raise EpisodeError(f"the recorded stream {path} is damaged") from None
    stream_time, offset, clock = rows[:, : len(COLUMNS)].T
    return RecordedStream(name, kind, labels, units, rate, stream_time, offset, clock, rows[:, len(COLUMNS) :])


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
        avatars = [avatar.name for avatar in trial.avatars]
        self._heads = {name: k * len(HEAD) for k, name in enumerate(avatars)}
        self._robots, self._touching = [robot.name for robot in trial.robots], frozenset()
        self._open(HEADS_STREAM, avatars, HEAD)
        self._open(ROBOTS_STREAM, self._robots, ROBOT)

    def tell(self, record: Mapping[str, Any]) -> None:
        """Send an event of the session; its time is the stamp of the sample."""
        values = {name: value for name, value in record.items() if name not in NOT_SENT}
        self._events.push_sample([json.dumps(values, ensure_ascii=False)])

    def take(self, frame: StepRecord) -> None:
        """Send poses and contacts of a step."""
        stamp, agents = self._lsl.local_clock(), {int(item): k for k, item in enumerate(frame.ids.tolist())}
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
            order.avatar: order.head
            for order in frame.orders
            if isinstance(order, AvatarOrder) and order.avatar in self._heads
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
        now = frozenset((touch.robot, touch.other) for touch in frame.touches)
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


INTERVAL = 0.05
"""Time between two reads [s]."""
OFFSET_INTERVAL = 1.0
"""Time between two estimates of the offset of a clock [s]."""
CHUNK = 4096
PROPERTIES = ("name", "type", "source_id")


class StreamRecorder:
    """Records streams in a thread until it is closed.

    Each stream becomes ``streams/NAME.csv`` with the time stamp of each sample in the clock of the sender, the
    estimated offset of that clock, the same instant in the monotonic clock of this computer, and the channels;
    ``streams/NAME.json`` describes it. :func:`read_streams` reads them. A stream that is lost is continued when its
    sender is back.

    Args:
        folder: folder of the participant.
        streams: names of streams, or ``PROPERTY=VALUE`` such as ``type=EEG``, for all streams with it.
        wait: longest time [s] to wait for each of them.

    Raises:
        InputError: there is no such stream, or it carries texts.
        EpisodeError: a file cannot be written.
        MissingExtra: the package ``pylsl`` is not installed.
    """

    def __init__(self, folder: Path, streams: Sequence[str], wait: float = 5.0) -> None:
        self._lsl, self._stop = load_pylsl(), threading.Event()
        self._error: CrowdbotError | None = None
        found = [info for stream in streams for info in self._resolve(stream, wait)]
        unique = {info.uid(): info for info in found}
        self._writers: list[_StreamWriter] = []
        try:
            for info in unique.values():
                self._writers.append(_StreamWriter(self._lsl, info, folder / STREAMS, wait))
        except BaseException:
            self._end()
            raise
        self._thread = threading.Thread(target=self._run, name="crowdbot-streams", daemon=True)
        self._thread.start()

    def __enter__(self) -> StreamRecorder:
        """Return the recorder."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the files."""
        self.close()

    @property
    def counts(self) -> dict[str, int]:
        """Number of recorded samples of each file."""
        return {writer.path.stem: writer.count for writer in self._writers}

    def close(self) -> None:
        """Read what has arrived and close the files.

        Raises:
            EpisodeError: a file could not be written.
        """
        self._stop.set()
        self._thread.join()
        if self._error is not None:
            raise self._error

    def _resolve(self, text: str, wait: float) -> list[Any]:
        name, equals, value = text.partition("=")
        chosen = (name, value) if equals and name in PROPERTIES else ("name", text)
        result: list[Any] = self._lsl.resolve_byprop(*chosen, 1, wait)
        if not result:
            raise InputError(f"there is no stream with the {chosen[0]} {chosen[1]!r} in the Lab Streaming Layer")
        return result

    def _run(self) -> None:
        try:
            while not self._stop.wait(INTERVAL):
                for writer in self._writers:
                    writer.write()
            for writer in self._writers:
                writer.write()
        except OSError as error:
            self._error = EpisodeError(f"cannot write {error.filename or 'a stream'}: {error.strerror}")
        finally:
            self._end()

    def _end(self) -> None:
        for writer in self._writers:
            writer.close()


class _StreamWriter:
    """Reads one stream and writes its files."""

    def __init__(self, lsl: Any, info: Any, folder: Path, wait: float) -> None:
        if info.channel_format() == lsl.cf_string:
            raise InputError(f"the stream {info.name()!r} carries texts; only streams of numbers are recorded")
        self._lsl, self.count = lsl, 0
        self._inlet = lsl.StreamInlet(info)
        try:
            self._inlet.open_stream(wait)
            self._offset, self._next = self._inlet.time_correction(wait), time.monotonic() + OFFSET_INTERVAL
            whole = self._inlet.info(wait)
        except RuntimeError:  # base of the errors of pylsl
            raise InputError(f"the stream {info.name()!r} does not answer within {wait:g} s") from None
        labels = [text or f"channel_{k}" for k, text in enumerate(_texts(whole.get_channel_labels(), info), 1)]
        head = {
            "name": info.name(),
            "type": info.type(),
            "source": info.source_id(),
            "host": info.hostname(),
            "rate": info.nominal_srate(),
            "labels": labels,
            "units": _texts(whole.get_channel_units(), info),
        }
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self.path = _free(folder, re.sub(r"[^\w.-]+", "-", info.name()).strip(".-") or "stream")
            self.path.with_suffix(".json").write_text(json.dumps(head, ensure_ascii=False) + "\n", encoding="utf-8")
            self._file = self.path.open("x", encoding="utf-8", newline="")
            csv.writer(self._file, lineterminator="\n").writerow([*COLUMNS, *labels])
        except OSError as error:
            raise EpisodeError(f"cannot write {folder}: {error.strerror}") from None

    def write(self) -> None:
        """Write the samples that have arrived."""
        if time.monotonic() >= self._next:
            with contextlib.suppress(RuntimeError):  # the sender is away: the latest estimate counts
                self._offset = self._inlet.time_correction(0.2)
            self._next = time.monotonic() + OFFSET_INTERVAL
        own = time.monotonic() - self._lsl.local_clock()
        values, stamps = self._inlet.pull_chunk(timeout=0.0, max_samples=CHUNK)
        while stamps:
            for row, stamp in zip(values, stamps, strict=True):
                clock = stamp + self._offset + own
                self._file.write(f"{stamp:.6f},{self._offset:.9f},{clock:.6f},{','.join(map(repr, row))}\n")
            self.count += len(stamps)
            values, stamps = self._inlet.pull_chunk(timeout=0.0, max_samples=CHUNK)
        self._file.flush()

    def close(self) -> None:
        """Close the file and the stream."""
        self._file.close()
        self._inlet.close_stream()


def _texts(given: list[str | None] | None, info: Any) -> list[str]:
    """Return a text for each channel, empty if the sender gives none."""
    texts = [item or "" for item in given or []]
    return (texts + [""] * info.channel_count())[: info.channel_count()]


def _free(folder: Path, name: str) -> Path:
    """Return a path that does not exist: a resumed session has several parts."""
    paths = (folder / (f"{name}-{k}.csv" if k > 1 else f"{name}.csv") for k in range(1, 10_000))
    return next(path for path in paths if not path.exists())


CLOCK_FILE = "clock.csv"
CLOCK_HEADER = "time,monotonic,utc\n"


class TrialClock(NamedTuple):
    """When the steps of a trial were recorded.

    Fields:
        time: ``[T]`` simulated time [s].
        monotonic: ``[T]`` monotonic clock of the computer [s], as Python's ``time.monotonic``.
        utc: ``[T]`` seconds since 1970.
    """

    time: Floats
    monotonic: Floats
    utc: Floats

    @property
    def offset(self) -> float:
        """UTC minus the monotonic clock [s], median over the steps."""
        return float(np.median(self.utc - self.monotonic))

    def simulation_time(self, monotonic: ArrayLike) -> Floats:
        """Return the simulated times of instants of the monotonic clock [s]; NaN outside of the trial.

        >>> clock = TrialClock(np.array([0.0, 1.0, 2.0]), np.array([50.0, 51.0, 51.5]), np.zeros(3))
        >>> clock.simulation_time([50.5, 51.25, 60.0]).tolist()
        [0.5, 1.5, nan]
        """
        instants = np.asarray(monotonic, dtype=np.float64)
        return np.asarray(np.interp(instants, self.monotonic, self.time, left=np.nan, right=np.nan))


class TrialClockLog:
    """Writes the clocks at each recorded step of a trial to ``clock.csv``; a sink of step records.

    Args:
        folder: folder of the trial.
        monotonic, utc: clocks [s].

    Raises:
        EpisodeError: the file cannot be written.
    """

    def __init__(
        self, folder: Path, monotonic: Callable[[], float] = time.monotonic, utc: Callable[[], float] = time.time
    ) -> None:
        self.path = folder / CLOCK_FILE
        self._monotonic, self._utc = monotonic, utc
        try:
            self._file = self.path.open("w", encoding="utf-8")
            self._file.write(CLOCK_HEADER)
        except OSError as error:
            raise EpisodeError(f"cannot write {self.path}: {error.strerror}") from None

    def take(self, frame: StepRecord) -> None:
        """Write the clocks of a recorded step."""
        if frame.due and not self._file.closed:
            self._file.write(f"{frame.nanoseconds / 1e9:.9f},{self._monotonic():.6f},{self._utc():.6f}\n")

    def close(self) -> None:
        """Close the file; more steps are left out."""
        self._file.close()


def read_trial_clock(folder: Path) -> TrialClock | None:
    """Return the clocks of a trial; None if they were not recorded.

    Raises:
        EpisodeError: the file is damaged.
    """
    path = folder / CLOCK_FILE
    if not path.is_file():
        return None
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    whole = [line for line in lines[1:] if line.endswith("\n")]
    try:
        rows = np.array([[float(cell) for cell in line.split(",")] for line in whole], dtype=np.float64).reshape(-1, 3)
    except ValueError:
        raise EpisodeError(f"{path} is damaged; expected rows of {CLOCK_HEADER.strip()}") from None
    return TrialClock(*rows.T) if len(rows) else None
