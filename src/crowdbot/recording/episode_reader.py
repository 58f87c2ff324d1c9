"""Reader of episode files, with the states of all recorded steps."""

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
from crowdbot.metrics import PersonImpact, TableRobot, people_table
from crowdbot.sensors import Reading
from crowdbot.simulation import Order, RunFailure, ScanRow, read_order, tracks_of
from crowdbot.trials import floor_plan_of_xml
from crowdbot.typing import Floats

from .episode_repair import EpisodeEnd
from .metadata import ADDED_ROBOTS, END_KEYS, ENDING, FORMAT, KEYS, METADATA, from_json
from .recorded_rows import RecordedRows, RobotRow
from .step_records import (
    RecordedContact,
    RecordedSequence,
    RecordedStep,
    RobotState,
    StepReadings,
    read_reading,
    read_scan,
    read_steps,
)

TABLE_CELLS = 1_000_000
"""Number of times and ids ``T * A`` of which the table of people is made at once; some 200 MB."""
ODOM = "/odom"
"""Ending of the frame in which the root link of a robot moves."""


@dataclass(frozen=True, eq=False)
class RecordedEpisode:
    """Content of an episode file, with the field names of :class:`Episode`.

    Fields:
        path: the file.
        metadata: metadata records ``crowdbot`` and ``crowdbot.end`` as text: trial (XML), seed, versions, digest, ...
        complete: whether the file is complete; otherwise the run was killed, and the outcome is ``interrupted``.
        rows: who was present at each time; its memory grows with what was recorded. The arrays with a column for each
            id, such as :attr:`position`, are made of it when they are asked for.
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
        digests: ``[T]`` digest of the episode up to each step, as if interrupted there.
        joints: positions ``[T]`` [rad] or [m] of the joints by robot and name, NaN while the robot is absent.
        fall_poses: poses of people out of balance by id, one mapping for each of the T times.
        tilts: ``[T, R, 3]`` height [m], roll and pitch [rad] of the root links, NaN while the robot is absent.
    """

    path: Path
    metadata: Mapping[str, str]
    complete: bool
    rows: RecordedRows
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
    joints: Mapping[str, Mapping[str, Floats]] = field(default_factory=dict)
    fall_poses: tuple[Mapping[int, FallPose], ...] = ()
    tilts: Floats = field(default_factory=lambda: np.zeros((0, 0, 3)))

    @property
    def times(self) -> Floats:
        """Times ``[T]`` [s]."""
        return self.rows.times

    @functools.cached_property
    def position(self) -> Floats:
        """Positions ``[T, A, 2]`` [m], 0 for absent agents.

        Raises:
            EpisodeError: the array is too large, see :meth:`RecordedRows.dense`.
        """
        return self.rows.dense(self.rows.position)

    @functools.cached_property
    def velocity(self) -> Floats:
        """Velocities ``[T, A, 2]`` [m/s], likewise."""
        return self.rows.dense(self.rows.velocity)

    @functools.cached_property
    def heading(self) -> Floats:
        """Headings ``[T, A]`` [rad], likewise."""
        return self.rows.dense(self.rows.heading)

    @functools.cached_property
    def active(self) -> NDArray[np.bool_]:
        """Who is present ``[T, A]``, likewise."""
        return self.rows.dense(np.ones(len(self.rows.ids), dtype=np.bool_))

    @functools.cached_property
    def reactions(self) -> NDArray[np.int8] | None:
        """Codes of reactions to robots ``[T, A]``, see :class:`Episode`, likewise; None if nobody can react."""
        return None if self.rows.reactions is None else self.rows.dense(self.rows.reactions)

    @functools.cached_property
    def gestures(self) -> NDArray[np.int8] | None:
        """Codes of gestures ``[T, A]``, see :class:`Episode`, likewise; None if nobody can make one."""
        return None if self.rows.gestures is None else self.rows.dense(self.rows.gestures)

    @functools.cached_property
    def ids(self) -> NDArray[np.int64]:
        """Ids ``[A]``: 0 to A - 1."""
        return self.rows.every

    @functools.cached_property
    def radius(self) -> Floats:
        """Radii ``[A]`` [m], 0 of ids that were never present."""
        found = np.zeros(len(self.ids))
        found[self.rows.ids] = self.rows.radius
        return found

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
        return _people_table(self.rows, robots, impacts)

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
        return tracks_of(_TracksView(self), self.name, dt)

    def _repr_svg_(self) -> str:
        """Return a drawing of walls, ground, doors and paths for notebooks."""
        period = self.schedule.period_ns / 1e9
        plan = floor_plan_of_xml(self.metadata["trial"], f"{self.path} (trial)")
        return tracks_of(_TracksView(self), f"{self.name}, seed {self.seed}, {self.outcome}", period).drawing(plan)

    @property
    def schedule(self) -> TickSchedule:
        """Ticks of the recorded steps; without ``period_ns`` in the metadata they are regular."""
        spacing = round(float(self.times[1] - self.times[0]) * 1e9) if len(self.times) > 1 else 0
        try:
            step = int(self.metadata.get("step_ns", spacing or 1))
            return TickSchedule(step, int(self.metadata.get("period_ns", spacing or step)))
        except (ValueError, InputError):
            raise EpisodeError(f"{self.path}: the metadata step_ns and period_ns must be whole numbers [ns]") from None


class _TracksView:
    """What :func:`crowdbot.simulation.tracks_of` reads of an episode; positions are looked up in its rows."""

    def __init__(self, episode: RecordedEpisode) -> None:
        self.schedule, self.times, self.ids = episode.schedule, episode.times, episode.ids
        self.active, self.robots, self.walls = episode.active, episode.robots, episode.walls
        self.position = _PositionsOfRows(episode.rows)


class _PositionsOfRows:
    def __init__(self, rows: RecordedRows) -> None:
        self._rows = rows
        self._keys = np.repeat(np.arange(len(rows.times)), np.diff(rows.starts)) * rows.count + rows.ids

    def __getitem__(self, cells: tuple[NDArray[np.int64], NDArray[np.int64]]) -> Floats:
        """Return the positions ``[N, 2]`` of agents who are present at times: numbers of times and ids ``[N]``."""
        step, agent = cells
        return self._rows.position[np.searchsorted(self._keys, step * self._rows.count + agent)]


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
    machines: list[list[RobotRow]] = []
    commands = np.full((len(due), len(robots), 3), np.nan)
    for k, (moment, _) in enumerate(due):
        present = [(r, robot, str(robot["name"])) for r, robot in enumerate(robots) if robot["name"] in moment.robots]
        machines.append([_robot_row(places[r], robot, moment.robots[name]) for r, robot, name in present])
        for r, _, name in present:  # others are added later, or removed
            commands[k, r] = moment.commands[name]
    reactions, gestures = ([getattr(moment, name) for moment, _ in due] for name in ("reactions", "gestures"))
    rows = RecordedRows.of([people for _, people in due], machines, count, reactions, gestures)
    scans, readings = _places(moment.scans for moment in found), _places(moment.readings for moment in found)
    if "added_robots" in known:
        known = known | {"robots": json.dumps(robots)}
    return RecordedEpisode(
        path,
        known,
        complete,
        rows,
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
        joint_positions([moment for moment, _ in due]),
        tuple(moment.fall_poses for moment, _ in due),
        robot_tilts([moment for moment, _ in due], [robot["name"] for robot in robots]),
    )


def _robot_row(id: int, robot: Mapping[str, Any], state: RobotState) -> RobotRow:
    return RobotRow(id, float(robot["radius"]), state.x, state.y, state.heading, state.vx, state.vy)


def _people_table(
    rows: RecordedRows, robots: Sequence[TableRobot], impacts: Sequence[PersonImpact] | None
) -> dict[str, NDArray[Any]]:
    """Return the table of people, made of as many people at a time as fit in arrays with a column for each of them."""
    machines = np.array(sorted(robot.id for robot in robots), dtype=np.int64)
    people = np.setdiff1d(rows.present(), machines)
    # never one person alone if there are others: NumPy adds a single column in another order
    parts = max(1, min(len(people) // 2, math.ceil(len(people) * len(rows.times) / TABLE_CELLS)))
    tables = []
    for part in np.array_split(people, parts):
        ids = np.union1d(part, machines)
        columns = {number: column for column, number in enumerate(ids.tolist())}
        table = people_table(
            rows.log(ids),
            [robot._replace(id=columns[robot.id]) for robot in robots],
            None if impacts is None else [hit._replace(person=columns[hit.person]) for hit in impacts
                                          if hit.person in columns],
        )  # fmt: skip
        tables.append({**table, "id": ids[table["id"]]})
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


def joint_positions(found: Sequence[RecordedStep]) -> dict[str, dict[str, Floats]]:
    """Return the positions of the joints by robot and name."""
    rows: dict[str, dict[str, Floats]] = {}
    for k, moment in enumerate(found):
        for robot, joints in moment.joints.items():
            columns = rows.setdefault(robot, {})
            for name, (position, _) in joints.items():
                columns.setdefault(name, np.full(len(found), np.nan))[k] = position
    return rows


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
