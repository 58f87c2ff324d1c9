"""Reader of episode files, with arrays over the recorded steps."""

from __future__ import annotations

import contextlib
import functools
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import EpisodeError, InputError, TickSchedule
from crowdbot.data import MCAP_MAGIC, McapReader, Trajectories
from crowdbot.humans import FallPose
from crowdbot.messages import ContactEventRecord, ContactForceRecord, FallRecord
from crowdbot.metrics import AgentStates, PersonImpact, TableRobot, people_table
from crowdbot.sensors import Reading
from crowdbot.simulation import Order, RunFailure, ScanRow, log_of, read_order, tracks_of
from crowdbot.trials import floor_plan_of_xml
from crowdbot.typing import Floats
from crowdbot.world import REACTIONS

from .episode_repair import EpisodeEnd
from .metadata import ADDED_ROBOTS, END_KEYS, ENDING, FORMAT, KEYS, METADATA, from_json
from .step_records import (
    RecordedContact,
    RecordedSequence,
    RecordedStep,
    StepReadings,
    read_reading,
    read_scan,
    read_steps,
)

ODOM = "/odom"
"""Ending of the frame in which the root link of a robot moves."""


@dataclass(frozen=True, eq=False)
class RecordedEpisode:
    """Content of an episode file, with the field names of :class:`Episode`.

    Fields:
        path: the file.
        metadata: metadata records ``crowdbot`` and ``crowdbot.end`` as text: trial (XML), seed, versions, digest, ...
        complete: whether the file is complete; otherwise the run was killed, and the outcome is ``interrupted``.
        times: times ``[T]`` [s].
        position, velocity: ``[T, A, 2]`` [m], [m/s]; 0 for absent agents.
        heading: ``[T, A]`` [rad].
        radius: ``[A]`` [m].
        active: ``[T, A]``.
        ids: ``[A]``.
        robots: indices of the robots.
        commands: ``[T, R, 3]`` forward [m/s], turn [rad/s], left [m/s].
        readings: all readings by ``robot/sensor``, each read from the file when it is asked for; a damaged one raises
            :class:`~crowdbot.core.EpisodeError` then. Values of 32-bit message fields have that precision
            (:mod:`crowdbot.messages.reading_codecs`).
        scans_by_topic: scans of planar laser scanners, by ``robot/sensor``, likewise.
        walls: rings ``[N, 2]`` [m].
        metrics: metrics by name.
        contacts: contacts of robots in all time steps.
        forces, collisions, falls: contact forces, contact events and falls of people of the physics world.
        orders: time [s] and content of the orders from outside.
        reactions: ``[T, A]`` codes of reactions to robots, see :class:`Episode`; None if nobody can react.
        digests: ``[T]`` digest of the episode up to each step, as if interrupted there.
        joints: positions ``[T]`` [rad] or [m] of the joints by robot and name, NaN while the robot is absent.
        fall_poses: poses of people out of balance by id, one mapping for each of the T times.
        tilts: ``[T, R, 3]`` height [m], roll and pitch [rad] of the root links, NaN while the robot is absent.
    """

    path: Path
    metadata: Mapping[str, str]
    complete: bool
    times: Floats
    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats
    active: NDArray[np.bool_]
    ids: NDArray[np.int64]
    robots: tuple[int, ...]
    commands: Floats
    scans_by_topic: Mapping[str, RecordedSequence[ScanRow]]
    walls: tuple[Floats, ...]
    metrics: Mapping[str, float]
    contacts: tuple[RecordedContact, ...]
    digests: tuple[str, ...]
    readings: Mapping[str, RecordedSequence[Reading]] = field(default_factory=dict)
    forces: tuple[ContactForceRecord, ...] = ()
    collisions: tuple[ContactEventRecord, ...] = ()
    falls: tuple[FallRecord, ...] = ()
    orders: tuple[tuple[float, Order], ...] = ()
    reactions: NDArray[np.int8] | None = None
    joints: Mapping[str, Mapping[str, Floats]] = field(default_factory=dict)
    fall_poses: tuple[Mapping[int, FallPose], ...] = ()
    tilts: Floats = field(default_factory=lambda: np.zeros((0, 0, 3)))

    @property
    def xml(self) -> str:
        """The trial as XML."""
        return self.metadata["trial"]

    @property
    def name(self) -> str:
        """Name of the trial."""
        return self.metadata["trial_name"]

    @property
    def seed(self) -> int:
        """Seed of the run."""
        return int(self.metadata["seed"])

    @property
    def steps(self) -> int:
        """Number of time steps."""
        return int(self.metadata["steps"])

    @property
    def outcome(self) -> str:
        """Outcome of the run."""
        return self.metadata["outcome"]

    @property
    def failure(self) -> RunFailure | None:
        """The exception that ended the run, for the outcome ``error``."""
        return recorded_failure(self.metadata)

    @property
    def digest(self) -> str:
        """Digest of the run; up to the last recorded step if the run was killed."""
        return self.metadata["digest"]

    @property
    def version(self) -> str:
        """Version of crowdbot that recorded the episode."""
        return self.metadata["version"]

    @property
    def software(self) -> str:
        """Software that made the episode, such as ``crowdbot 0.1.0``."""
        return f"crowdbot {self.version}"

    @property
    def scans(self) -> Sequence[ScanRow]:
        """Scans of the first laser scanner of the first robot."""
        return next(iter(self.scans_by_topic.values()), ())

    @functools.cached_property
    def people(self) -> dict[str, NDArray[Any]]:
        """One row for each person, see :attr:`crowdbot.simulation.Episode.people`."""
        known = self._robot_records
        robots = [
            TableRobot(k, str(item["name"]), bool(item.get("ghost")))
            for k, item in zip(self.robots, known, strict=True)
        ]
        names, impacts = {robot.name for robot in robots}, None
        if self.metadata.get("world") == "physics":
            hits = [
                collision
                for collision in self.collisions
                if collision.first in names and collision.region and collision.second.isdecimal()
            ]
            impacts = [PersonImpact(int(hit.second), hit.peak_force, hit.severity) for hit in hits]
        return people_table(log_of(self), robots, impacts)

    @property
    def footprints(self) -> tuple[Floats | None, ...]:
        """Outline ``[N, 2]`` [m] of each robot in its own frame; None for a disc."""
        shapes = [robot_record.get("footprint") for robot_record in self._robot_records]
        return tuple(None if shape is None else np.array(shape, dtype=np.float64) for shape in shapes)

    @property
    def _robot_records(self) -> list[dict[str, Any]]:
        return list(json.loads(self.metadata["robots"]))

    def tracks(self, dt: float = 0.4) -> Trajectories:
        """Return people and robots every ``dt`` [s] as trajectories, see :meth:`Episode.tracks`."""
        return tracks_of(self, self.name, dt)

    def _repr_svg_(self) -> str:
        """Return a drawing of walls, ground, doors and paths for notebooks."""
        period = self.schedule.period_ns / 1e9
        plan = floor_plan_of_xml(self.metadata["trial"], f"{self.path} (trial)")
        return tracks_of(self, f"{self.name}, seed {self.seed}, {self.outcome}", period).drawing(plan)

    @property
    def schedule(self) -> TickSchedule:
        """Ticks of the recorded steps; without ``period_ns`` in the metadata they are regular."""
        spacing = round(float(self.times[1] - self.times[0]) * 1e9) if len(self.times) > 1 else 0
        try:
            step = int(self.metadata.get("step_ns", spacing or 1))
            return TickSchedule(step, int(self.metadata.get("period_ns", spacing or step)))
        except (ValueError, InputError):
            raise EpisodeError(f"{self.path}: the metadata step_ns and period_ns must be whole numbers [ns]") from None


def read_episode(path: Path | str) -> RecordedEpisode:
    """Read an episode file, also of a killed or running simulation.

    Raises:
        EpisodeError: the file is missing, damaged, or not an episode of crowdbot.

    >>> import tempfile
    >>> from crowdbot.recording import run
    >>> from crowdbot.trials import load_trial
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     episode = run(load_trial("frontal", duration=1.0), out=folder)
    ...     recorded = read_episode(f"{folder}/episode.mcap")
    >>> recorded.digest == episode.digest
    True
    """
    path = Path(path)
    with _opened(path) as stream:
        tape = McapReader(stream)
        with _sentences(path):
            found = list(read_steps(tape, path))
        known = _known(path, tape.metadata)
    with _sentences(path, f"has an invalid metadata record {METADATA!r}"):
        return _assembled(path, known, found)


def read_metadata(path: Path | str) -> dict[str, str]:
    """Return the metadata of an episode file without reading its messages; see :attr:`RecordedEpisode.metadata`.

    Values known only at the end (outcome, digest, ...) are missing if the run was killed.

    Raises:
        EpisodeError: see :func:`read_episode`.
    """
    path = Path(path)
    with _opened(path) as stream, _sentences(path):
        tape = McapReader(stream)
        for _ in tape.records():
            pass
    return _known(path, tape.metadata)


def iterate_steps(path: Path | str) -> Iterator[RecordedStep]:
    """Yield the recorded steps in constant memory.

    Raises:
        EpisodeError: see :func:`read_episode`.
    """
    path = Path(path)
    with _opened(path) as stream, _sentences(path):
        tape = McapReader(stream)
        yield from read_steps(tape, path)
    _known(path, tape.metadata)


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[BinaryIO]:
    if not path.exists():
        raise EpisodeError(f"there is no episode file {path}")
    if not path.is_file():
        raise EpisodeError(f"{path} is a folder; give the episode.mcap in it")
    try:
        stream = path.open("rb")
    except OSError as error:
        raise EpisodeError(f"cannot read {path}: {error.strerror}") from None
    with stream:
        head = stream.read(len(MCAP_MAGIC))
        if not head:
            raise EpisodeError(f"{path} is empty")
        if head != MCAP_MAGIC:
            raise EpisodeError(f"{path} is not an MCAP file: it starts with {head!r}")
        stream.seek(0)
        yield stream


@contextlib.contextmanager
def _sentences(path: Path, what: str = "is damaged") -> Iterator[None]:
    """Convert read errors into one sentence; damaged files cause many kinds of exceptions."""
    try:
        yield
    except (EpisodeError, OSError):
        raise
    except Exception as error:
        raise EpisodeError(f"{path} {what}: {type(error).__name__}: {str(error)[:80] or 'no details'}") from error


def _known(path: Path, records: Mapping[str, dict[str, str]]) -> dict[str, str]:
    known = {**records.get(METADATA, {}), **records.get(ADDED_ROBOTS, {}), **records.get(ENDING, {})}
    if any(key not in known for key in KEYS):
        raise EpisodeError(
            f"{path} is an MCAP file but not an episode of crowdbot: it has no metadata record {METADATA!r}"
        )
    if known["format"] != FORMAT:
        raise EpisodeError(
            f"{path} has the episode format {known['format']!r} of crowdbot {known['version']}; this version reads"
            f" {FORMAT!r}: record it again"
        )
    return known


def recorded_failure(known: Mapping[str, str]) -> RunFailure | None:
    """Return the exception in the metadata of an episode, if any."""
    if "error" not in known:
        return None
    return RunFailure(known["error"], known.get("error_place", "unknown"), float(known.get("error_time", "nan")))


def _places(found: Iterable[StepReadings[Any]]) -> dict[str, list[Any]]:
    """Return the places of readings by ``robot/sensor``."""
    rows: dict[str, list[Any]] = {}
    for one in found:
        for name, place in one.places.items():
            rows.setdefault(name, []).append(place)
    return rows


def _assembled(path: Path, known: dict[str, str], found: Sequence[RecordedStep]) -> RecordedEpisode:
    due = [(moment, moment.people) for moment in found if moment.people is not None]
    complete = all(key in known for key in END_KEYS)
    if not due and not complete:
        raise EpisodeError(f"{path} has no recorded steps: the run was killed before the first one")
    robots = json.loads(known["robots"])
    start = len(robots)
    robots += json.loads(known.get("added_robots", "[]"))
    places = [int(robot["id"]) for robot in robots]
    if complete:
        count = int(known["people"]) + start
    else:
        ending = EpisodeEnd(known)
        for moment in found:
            ending.take(moment)
        known = known | ending.metadata()
        count = max([ending.count, *(1 + place for place in places)])
    arrays = _Arrays.of(len(due), count)
    commands = np.full((len(due), len(robots), 3), np.nan)
    for k, (moment, people) in enumerate(due):
        arrays.put(k, people)
        for r, robot in enumerate(robots):
            if robot["name"] not in moment.robots:  # added later, or removed
                continue
            arrays.put_robot(k, places[r], float(robot["radius"]), moment.robots[robot["name"]])
            commands[k, r] = moment.commands[robot["name"]]
    scans, readings = _places(moment.scans for moment in found), _places(moment.readings for moment in found)
    times = np.array([moment.time for moment, _ in due])
    if "added_robots" in known:
        known = known | {"robots": json.dumps(robots)}
    return RecordedEpisode(
        path,
        known,
        complete,
        times,
        arrays.position,
        arrays.velocity,
        arrays.heading,
        arrays.radius,
        arrays.active,
        np.arange(count, dtype=np.int64),
        tuple(places),
        commands,
        {name: RecordedSequence(rows, read_scan) for name, rows in scans.items()},
        tuple(np.array(ring, dtype=np.float64) for ring in json.loads(known["walls"])),
        from_json(known["metrics"]),
        tuple(contact for moment in found for contact in moment.contacts),
        tuple(moment.digest for moment, _ in due),
        {name: RecordedSequence(rows, read_reading) for name, rows in readings.items()},
        tuple(force for moment in found for force in moment.forces),
        tuple(collision for moment in found for collision in moment.collisions),
        tuple(fall for moment in found for fall in moment.falls),
        tuple((moment.time, read_order(text)) for moment in found for text in moment.orders),
        reaction_arrays([moment for moment, _ in due], count),
        joint_positions([moment for moment, _ in due]),
        tuple(moment.fall_poses for moment, _ in due),
        robot_tilts([moment for moment, _ in due], [robot["name"] for robot in robots]),
    )


@dataclass
class _Arrays:
    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats
    active: NDArray[np.bool_]

    @classmethod
    def of(cls, count: int, agents: int) -> _Arrays:
        """Return empty arrays."""
        shape = (count, agents)
        return cls(
            np.zeros((*shape, 2)), np.zeros((*shape, 2)), np.zeros(shape), np.zeros(agents), np.zeros(shape, dtype=bool)
        )

    def put(self, k: int, people: AgentStates) -> None:
        """Add people at a step."""
        if np.any(people.ids < 0):
            raise ValueError(f"a person has the id {people.ids.min()}")
        self.position[k, people.ids], self.velocity[k, people.ids] = people.position, people.velocity
        self.heading[k, people.ids], self.radius[people.ids] = people.heading, people.radius
        self.active[k, people.ids] = True

    def put_robot(self, k: int, place: int, radius: float, state: Any) -> None:
        """Add a robot at a step."""
        self.position[k, place], self.velocity[k, place] = (state.x, state.y), (state.vx, state.vy)
        self.heading[k, place], self.radius[place], self.active[k, place] = state.heading, radius, True


def joint_positions(found: Sequence[RecordedStep]) -> dict[str, dict[str, Floats]]:
    """Return the positions of the joints by robot and name."""
    rows: dict[str, dict[str, Floats]] = {}
    for k, moment in enumerate(found):
        for robot, joints in moment.joints.items():
            columns = rows.setdefault(robot, {})
            for name, (position, _) in joints.items():
                columns.setdefault(name, np.full(len(found), np.nan))[k] = position
    return rows


def reaction_arrays(found: Sequence[RecordedStep], count: int) -> NDArray[np.int8] | None:
    """Return the codes of the reactions to robots ``[T, A]``; None if nobody can react."""
    if not found or any(moment.reactions is None for moment in found):
        return None
    codes = np.zeros((len(found), count), dtype=np.int8)
    for k, moment in enumerate(found):
        for kind, people in (moment.reactions or {}).items():
            codes[k, people] = REACTIONS.index(kind)
    return codes


def robot_tilts(found: Sequence[RecordedStep], names: Sequence[str]) -> Floats:
    """Return the height [m], roll and pitch [rad] of the root links of R robots ``[T, R, 3]``, from ``/tf``.

    The root of a robot moves in its odometry frame, which is level. NaN while a robot is absent.

    Args:
        found: the recorded steps.
        names: names of the robots.
    """
    rows = np.full((len(found), len(names), 3), np.nan)
    numbers = {name + ODOM: r for r, name in enumerate(names)}
    for k, moment in enumerate(found):
        for parent, _, values in moment.transforms:
            if parent not in numbers:
                continue
            z, turn = values[2], np.array(values[3:])
            size = float(np.sqrt(turn @ turn))
            if not (0.5 < size < 2.0 and math.isfinite(z)):
                raise ValueError(f"the frame {parent!r} has an impossible transform")
            w, i, j, q = (turn / size).tolist()
            roll = math.atan2(2.0 * (w * i + j * q), 1.0 - 2.0 * (i * i + j * j))
            rows[k, numbers[parent]] = z, roll, math.asin(min(1.0, max(-1.0, 2.0 * (w * j - q * i))))
    return rows
