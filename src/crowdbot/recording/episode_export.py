"""Export of episodes as tables and images."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np

from crowdbot.core import EpisodeError, InputError, did_you_mean, lock_output
from crowdbot.humans import FallPose
from crowdbot.messages import ContactEventRecord, ContactForceRecord, FallRecord
from crowdbot.sensors import (
    BumperReading,
    DepthImage,
    ImuReading,
    Odometry,
    PointCloud,
    RangeReading,
    Reading,
    RgbImage,
    TrackedPeople,
    spatial_pose,
)

from .episode_reader import iterate_steps, read_episode, read_metadata
from .metadata import TWIST
from .step_records import RecordedStep

Columns = dict[str, Any]
PLACE = ("x", "y", "z", "heading")


def _points(reading: Any) -> Columns:
    there = np.isfinite(reading.ranges[0])
    ends = reading.points(in_world=True)[0][there]
    ring = np.broadcast_to(np.arange(len(reading.elevation))[:, None], there.shape)
    return {
        **{f"point_{axis}": ends[:, k] for k, axis in enumerate("xyz")},
        "range": reading.ranges[0][there],
        "intensity": reading.cos_incidence[0][there],
        "ring": ring[there],
        "hit": reading.hit[0][there],
    }


def _ranges(reading: Any) -> Columns:
    return {"range": reading.ranges, "hit": reading.hit}


def _images(reading: Any) -> Columns:
    near = np.where(np.isfinite(reading.depth[0]), reading.depth[0], np.inf).min()
    seen = np.unique(reading.hit[0][reading.hit[0] >= 0])
    return {
        "width": np.array([reading.lens.width]),
        "height": np.array([reading.lens.height]),
        "nearest": np.array([near]),
        "seen": np.array([" ".join(map(str, seen.tolist()))], dtype=object),
    }


def _pictures(reading: Any) -> Columns:
    seen = np.zeros(0, np.int64) if reading.hit is None else np.unique(reading.hit[0][reading.hit[0] >= 0])
    lens = {name: np.array([getattr(reading.lens, name)]) for name in ("width", "height", "fx", "fy", "cx", "cy")}
    return lens | {"seen": np.array([" ".join(map(str, seen.tolist()))], dtype=object)}


def _inertial(reading: Any) -> Columns:
    force = {f"acceleration_{axis}": reading.acceleration[:, k] for k, axis in enumerate("xyz")}
    return force | {f"turn_rate_{axis}": reading.turn_rate[:, k] for k, axis in enumerate("xyz")}


def _odometry(reading: Any) -> Columns:
    estimate = reading.estimate
    return {
        "estimate_x": estimate.position[:, 0],
        "estimate_y": estimate.position[:, 1],
        "estimate_heading": estimate.heading,
        **{word: reading.twist[:, k] for k, word in enumerate(TWIST)},
    }


def _bumpers(reading: Any) -> Columns:
    pressed = np.flatnonzero(reading.pressed[0])
    return {"sector": pressed, "depth": reading.depth[0, pressed], "hit": reading.hit[0, pressed]}


def _tracked(reading: Any) -> Columns:
    who = np.flatnonzero(reading.present[0])
    return {
        "id": who,
        "ahead": reading.position[0, who, 0],
        "left": reading.position[0, who, 1],
        "ahead_speed": reading.velocity[0, who, 0],
        "left_speed": reading.velocity[0, who, 1],
        "person_heading": reading.heading[0, who],
        "radius": reading.radius[0, who],
    }


WHOLE = ("ring", "hit", "width", "height", "sector", "id")
TEXT = ("seen",)
READING_COLUMNS: dict[str, tuple[type[Reading], Callable[[Any], Columns], tuple[str, ...]]] = {
    "points": (PointCloud, _points, ("point_x", "point_y", "point_z", "range", "intensity", "ring", "hit")),
    "ranges": (RangeReading, _ranges, ("range", "hit")),
    "images": (DepthImage, _images, ("width", "height", "nearest", "seen")),
    "pictures": (RgbImage, _pictures, ("width", "height", "fx", "fy", "cx", "cy", "seen")),
    "inertial": (
        ImuReading,
        _inertial,
        (*(f"acceleration_{axis}" for axis in "xyz"), *(f"turn_rate_{axis}" for axis in "xyz")),
    ),
    "odometry": (
        Odometry,
        _odometry,
        ("estimate_x", "estimate_y", "estimate_heading", *TWIST),
    ),
    "bumpers": (BumperReading, _bumpers, ("sector", "depth", "hit")),
    "tracked": (
        TrackedPeople,
        _tracked,
        ("id", "ahead", "left", "ahead_speed", "left_speed", "person_heading", "radius"),
    ),
}


def _kind(name: str) -> Any:
    return object if name in TEXT else np.int64 if name in WHOLE else np.float64


def _table(kind: type[Reading], rows: Callable[[Any], Columns], names: tuple[str, ...]) -> Callable[..., Columns]:
    """Return a function that creates the rows of a step from all readings of a class."""

    def columns(moment: RecordedStep, bodies: Mapping[str, tuple[int, float]]) -> Columns:
        found: dict[str, list[Any]] = {name: [] for name in ("time", "sensor", *PLACE, *names)}
        for topic, reading in moment.readings.of(kind):
            values = rows(reading)
            count = len(values[names[0]])
            pose = spatial_pose(reading.pose)
            where = (*pose.position[0].tolist(), float(pose.heading[0]))
            found["time"].append(np.full(count, reading.time))
            found["sensor"].append(np.array([topic] * count, dtype=object))
            for word, value in zip(PLACE, where, strict=True):
                found[word].append(np.full(count, value))
            for name in names:
                found[name].append(values[name])
        kinds = {"sensor": object}
        return {
            name: np.concatenate([np.zeros(0, kinds.get(name, _kind(name))), *parts]).astype(
                kinds.get(name, _kind(name))
            )
            for name, parts in found.items()
        }

    return columns


READING_TABLES: dict[str, Callable[..., Columns]] = {name: _table(*row) for name, row in READING_COLUMNS.items()}
"""Functions that create the columns of a step, by table name."""


def folder_of(table: Path) -> Path:
    """Return the folder of the images of a table.

    >>> folder_of(Path("out/pictures.csv")).name
    'pictures-images'
    """
    return table.with_name(f"{table.stem}-images")


class ImageExport:
    """Writes images to a temporary folder while their table is written.

    Args:
        table: file of the table.
    """

    def __init__(self, table: Path) -> None:
        self.folder = folder_of(table)
        self.draft = table.with_name(f".{table.name}.{os.getpid()}.images")

    def columns(self, moment: RecordedStep, bodies: Mapping[str, tuple[int, float]]) -> dict[str, Any]:
        """Write the images of a step and return the rows of the table with their files."""
        rows = READING_TABLES["pictures"](moment, bodies)
        files = [self._written(topic, reading) for topic, reading in moment.readings.of(RgbImage)]
        return {**rows, "file": np.array(files, dtype=object)}

    def finish(self) -> None:
        """Move the images to their folder; other files in it are kept."""
        if self.draft.is_dir():
            self.folder.mkdir(exist_ok=True)
            for file in sorted(self.draft.iterdir()):
                file.replace(self.folder / file.name)

    def drop(self) -> None:
        """Remove unfinished images."""
        shutil.rmtree(self.draft, ignore_errors=True)

    def _written(self, topic: str, picture: RgbImage) -> str:
        """Write an image named by sensor and time [ns], and return its path relative to the table."""
        from PIL import Image

        name = f"{re.sub(r'[^A-Za-z0-9_]+', '-', topic)}-{round(float(picture.time) * 1e9):013d}.png"
        self.draft.mkdir(parents=True, exist_ok=True)
        Image.fromarray(picture.rgb[0]).save(self.draft / name, format="PNG")
        return f"{self.folder.name}/{name}"


PERSONS = "persons"
"""Name of the table with one row for each person."""
ROWS = 100_000
"""Rows per write."""
_UNKNOWN = (np.nan, np.nan, np.nan)


def export(path: Path | str, to: Path | str, table: str = "people", force: bool = False) -> int:
    """Write a table of an episode file as ``.parquet`` or ``.csv``, by file extension.

    Tables, with the time [s] and one row per step for each

    * ``people``: person or robot: id, robot (its name or empty), x, y [m], vx, vy [m/s], heading [rad] and
      radius [m];
    * ``robots``: robot: name, x, y, heading, twist linear_x [m/s], angular_z [rad/s] and linear_y [m/s], and command
      (command_linear_x, ...; NaN if the file has none for this step);
    * ``scans``: beam: sensor, its x, y, heading in the world, angle [rad], range [m], and hit: id of the person or
      robot, -1 nothing, -2 a wall;
    * ``joints``: joint: robot, joint, position [rad or m] and velocity;
    * ``transforms``: transform of ``/tf`` and ``/tf_static``: parent, child, x, y, z [m], qw, qx, qy, qz;
    * ``contacts``: contact: robot, other, clearance [m];
    * ``forces`` and ``collisions``, of the physics world: the two bodies, the body part, force [N], ...;
    * ``falls``: fall of a person: direction, cause, speeds at which the body hits the floor [m/s], HIC15;
    * readings of other sensors, with the sensor and its x, y, z [m] and heading [rad] in the world: ``points`` of
      clouds (end of each beam in the world, range, intensity, ring, hit), ``ranges`` of ultrasound and infrared,
      ``inertial``, ``odometry``, ``bumpers`` (each pressed sector), ``tracked`` (each tracked person);
    * ``pictures`` of colour cameras: size, fx, fy, cx, cy of the lens [pixels], visible ids if the camera reports them,
      and the PNG file of the image, in the folder ``NAME-images`` beside the table ``NAME``;
    * ``images`` of depth cameras: size, smallest depth [m] and visible ids; pixels of depth and labels are only in the
      episode file.

    ``persons`` has one row for each person of the whole episode (:data:`crowdbot.metrics.PEOPLE_COLUMNS`).

    Returns:
        The number of rows.

    Raises:
        InputError: the table or the file name extension is unknown, or ``to`` exists and ``force`` is false.
        EpisodeError: the episode cannot be read, or the table not written.
    """
    path, to = Path(path), Path(to)
    known = (*TABLES, PERSONS)
    if table not in known:
        raise InputError(f"there is no table {table!r}{did_you_mean(table, known)}; tables are {', '.join(known)}")
    if to.suffix not in (".parquet", ".csv"):
        raise InputError(f"{to} has the extension {to.suffix or 'none'!r}; use .parquet or .csv")
    pictures = ImageExport(to)
    batches = _batches(path, table, pictures)
    draft = to.with_name(f".{to.name}.{os.getpid()}.part")
    try:
        to.parent.mkdir(parents=True, exist_ok=True)
        with lock_output(to, force):
            try:
                count = _write(batches, draft, to.suffix)
                pictures.finish()
                os.replace(draft, to)
            finally:
                draft.unlink(missing_ok=True)
                pictures.drop()
    except OSError as error:
        raise EpisodeError(f"cannot write {to}: {error.strerror}") from None
    return count


def _batches(path: Path, table: str, pictures: ImageExport) -> Iterator[Columns]:
    bodies = _bodies(path)
    if table == PERSONS:
        return iter([read_episode(path).people])
    make = pictures.columns if table == "pictures" else TABLES[table]
    return (make(moment, bodies) for moment in iterate_steps(path))


def _bodies(path: Path) -> dict[str, tuple[int, float]]:
    import json

    try:
        robots = json.loads(read_metadata(path)["robots"])
        return {robot["name"]: (int(robot["id"]), float(robot["radius"])) for robot in robots}
    except (ValueError, KeyError, TypeError) as error:
        raise EpisodeError(f"{path} has an invalid list of robots: {error}") from None


def _write(batches: Iterator[Columns], draft: Path, suffix: str) -> int:
    import pyarrow as pa
    import pyarrow.csv
    import pyarrow.parquet

    writer: Any = None
    count = 0
    try:
        for columns in _gathered(batches):
            rows = pa.table(columns)
            if writer is None:
                kind = pyarrow.parquet.ParquetWriter if suffix == ".parquet" else pyarrow.csv.CSVWriter
                writer = kind(str(draft), rows.schema)
            writer.write_table(rows)
            count += len(rows)
    finally:
        if writer is not None:
            writer.close()
    return count


def _gathered(batches: Iterator[Columns]) -> Iterator[Columns]:
    """Yield batches of columns of several steps; at least one, even without rows."""
    held: list[Columns] = []
    rows, told = 0, False
    for batch in batches:
        size = len(next(iter(batch.values())))
        if size or not (held or told):
            held.append(batch)
            rows += size
        if rows >= ROWS:
            yield _together(held)
            held, rows, told = [], 0, True
    if held:
        yield _together(held)


def _together(batches: list[Columns]) -> Columns:
    return {name: np.concatenate([np.asarray(batch[name]) for batch in batches]) for name in batches[0]}


def _people(moment: RecordedStep, bodies: dict[str, tuple[int, float]]) -> Columns:
    names = {number: name for name, (number, _) in bodies.items()}
    if moment.people is None:
        return _people(_nobody(moment), bodies)
    now = moment.everyone(bodies)
    return {
        "time": np.full(len(now.ids), moment.time),
        "id": now.ids,
        "robot": np.array([names.get(who, "") if names else "" for who in now.ids.tolist()], dtype=object),
        "x": now.position[:, 0],
        "y": now.position[:, 1],
        "vx": now.velocity[:, 0],
        "vy": now.velocity[:, 1],
        "heading": now.heading,
        "radius": now.radius,
    }


def _nobody(moment: RecordedStep) -> RecordedStep:
    from crowdbot.metrics import AgentStates

    none = np.zeros((0, 2))
    return RecordedStep(
        moment.nanoseconds, AgentStates(moment.time, np.zeros(0, np.int64), none, none, none[:, 0], none[:, 0])
    )


def _robots(moment: RecordedStep, bodies: dict[str, tuple[int, float]]) -> Columns:
    there = [name for name in bodies if name in moment.robots]
    states = [moment.robots[name] for name in there]
    commands = [moment.commands.get(name, _UNKNOWN) for name in there]
    return {
        "time": np.full(len(there), moment.time),
        "robot": np.array(there, dtype=object),
        **{name: np.array([getattr(state, name) for state in states], float) for name in ("x", "y", "heading")},
        **{word: np.array([state.twist[k] for state in states], float) for k, word in enumerate(TWIST)},
        **{f"command_{word}": np.array([command[k] for command in commands], float) for k, word in enumerate(TWIST)},
    }


def _scans(moment: RecordedStep, bodies: dict[str, tuple[int, float]]) -> Columns:
    rows = [(name, scan, len(scan.ranges)) for name, scan in moment.scans.items()]

    def joined(parts: list[Any], kind: Any) -> Any:
        return np.concatenate([np.zeros(0, kind), *parts]).astype(kind)

    return {
        "time": np.full(sum(beams for *_, beams in rows), moment.time),
        "sensor": np.array([name for name, _, beams in rows for _ in range(beams)], dtype=object),
        **{
            word: joined([np.full(beams, scan.pose[k]) for _, scan, beams in rows], float)
            for k, word in enumerate(("x", "y", "heading"))
        },
        "angle": joined([scan.angles for _, scan, _ in rows], float),
        "range": joined([scan.ranges for _, scan, _ in rows], float),
        "hit": joined([scan.hit for _, scan, _ in rows], np.int64),
    }


def _joints(moment: RecordedStep, bodies: dict[str, tuple[int, float]]) -> Columns:
    rows = [(robot, name, *values) for robot, joints in moment.joints.items() for name, values in joints.items()]
    return {
        "time": np.full(len(rows), moment.time),
        "robot": np.array([row[0] for row in rows], dtype=object),
        "joint": np.array([row[1] for row in rows], dtype=object),
        "position": np.array([row[2] for row in rows], float),
        "velocity": np.array([row[3] for row in rows], float),
    }


def _transforms(moment: RecordedStep, bodies: dict[str, tuple[int, float]]) -> Columns:
    rows = moment.transforms
    return {
        "time": np.full(len(rows), moment.time),
        "parent": np.array([row[0] for row in rows], dtype=object),
        "child": np.array([row[1] for row in rows], dtype=object),
        **{
            name: np.array([row[2][k] for row in rows], float)
            for k, name in enumerate(("x", "y", "z", "qw", "qx", "qy", "qz"))
        },
    }


def _contacts(moment: RecordedStep, bodies: dict[str, tuple[int, float]]) -> Columns:
    rows = moment.contacts
    return {
        "time": np.array([row.time for row in rows], float),
        "robot": np.array([row.robot for row in rows], dtype=object),
        "other": np.array([row.other for row in rows], dtype=object),
        "clearance": np.array([row.clearance for row in rows], float),
    }


def _named(kind: type[Any], rows: list[Any], wide: tuple[str, ...] = ()) -> Columns:
    """Return a column for each field of rows, and three for vector fields."""
    columns: Columns = {}
    hints = get_type_hints(kind)
    for name in kind._fields:
        values = [getattr(row, name) for row in rows]
        if name in wide:
            table = np.array(values, dtype=np.float64).reshape(-1, 3)
            columns |= {f"{name}_{axis}": table[:, k] for k, axis in enumerate("xyz")}
        else:
            columns[name] = np.array(values, dtype=object if hints[name] is str else np.float64)
    return columns


def _forces(moment: RecordedStep, bodies: dict[str, tuple[int, float]]) -> Columns:
    return _named(ContactForceRecord, moment.forces, ("vector", "point"))


def _collisions(moment: RecordedStep, bodies: dict[str, tuple[int, float]]) -> Columns:
    times = {"time": np.full(len(moment.collisions), moment.time)}
    return times | _named(ContactEventRecord, moment.collisions)


def _falls(moment: RecordedStep, bodies: dict[str, tuple[int, float]]) -> Columns:
    return {"time": np.full(len(moment.falls), moment.time)} | _named(FallRecord, moment.falls)


def _fall_poses(moment: RecordedStep, bodies: dict[str, tuple[int, float]]) -> Columns:
    rows = moment.fall_poses
    times: Columns = {"time": np.full(len(rows), moment.time), "person": np.array([*rows], dtype=np.int64)}
    kinds = dict.fromkeys(("struck", "down", "rising"), np.bool_)
    return times | {
        name: np.array([getattr(pose, name) for pose in rows.values()], dtype=kinds.get(name, np.float64))
        for name in FallPose._fields
    }


TABLES: dict[str, Callable[[RecordedStep, dict[str, tuple[int, float]]], Columns]] = {
    "people": _people,
    "robots": _robots,
    "scans": _scans,
    "joints": _joints,
    "transforms": _transforms,
    "contacts": _contacts,
    "forces": _forces,
    "collisions": _collisions,
    "falls": _falls,
    "fall-poses": _fall_poses,
    **READING_TABLES,
}
