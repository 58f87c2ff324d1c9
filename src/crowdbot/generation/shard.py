"""Shards of generated data, in the formats npz, Parquet and WebDataset."""

from __future__ import annotations

import hashlib
import io
import json
import math
import tarfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CrowdbotError, MissingExtra, explain_write_errors
from crowdbot.recording import record
from crowdbot.simulation import Simulation, SimulationRun, catch_interrupt
from crowdbot.trials import Trial, parse_trial

from .image_formats import write_images, write_kitti
from .plan import ShardJob
from .sample_log import SampleLog, Table


def write_npz(
    tables: Mapping[str, Mapping[str, NDArray[Any]]], path: Path, compressed: bool, seeds: Sequence[int]
) -> list[Path]:
    """Write the tables of a shard as ``PATH.npz`` and return the file.

    The arrays are named ``table/field``; ``seeds`` has the seed of each episode.
    """
    arrays = {f"{name}/{key}": array for name, table in tables.items() for key, array in table.items()}
    arrays["seeds"] = np.asarray(seeds, dtype=np.int64)
    file = path.with_name(f"{path.name}.npz")
    with file.open("wb") as stream:
        (np.savez_compressed if compressed else np.savez)(stream, **arrays)  # type: ignore[arg-type]
    return [file]


def write_parquet(
    tables: Mapping[str, Mapping[str, NDArray[Any]]], path: Path, compressed: bool, seeds: Sequence[int]
) -> list[Path]:
    """Write the tables of a shard as ``PATH.TABLE.parquet`` and return the files.

    An array is a list of fixed length in each row; its shape is in the metadata of the column, as are the arrays that
    all rows share. The column ``seed`` has the seed of the run.
    """
    import pyarrow as pa
    from pyarrow import parquet

    files = []
    for name, table in tables.items():
        columns, fields = [], []
        shared = {key[len("shared.") :]: array for key, array in table.items() if key.startswith("shared.")}
        own = {key: array for key, array in table.items() if not key.startswith("shared.")}
        for key, array in {"seed": np.asarray(seeds, dtype=np.int64)[table["episode"]], **own}.items():
            values, shape = pa.array(np.ascontiguousarray(array).reshape(-1)), array.shape[1:]
            column = pa.FixedSizeListArray.from_arrays(values, int(np.prod(shape))) if shape else values
            columns.append(column)
            fields.append(pa.field(key, column.type, metadata={"shape": ",".join(map(str, shape))}))
        notes = {key: ",".join(map(repr, array.astype(float).ravel().tolist())) for key, array in shared.items()}
        file = path.with_name(f"{path.name}.{name.replace('/', '.')}.parquet")
        content = pa.table(columns, schema=pa.schema(fields, metadata=notes))
        parquet.write_table(content, file, compression="zstd" if compressed else "none", use_dictionary=False)
        files.append(file)
    return files


Columns = Mapping[str, NDArray[Any]]


def write_webdataset(tables: Mapping[str, Columns], path: Path, compressed: bool, seeds: Sequence[int]) -> list[Path]:
    """Write the samples of a shard as ``PATH.tar`` (``.tar.gz`` if compressed) and return the file.

    A sample is an instant of a run at which a sensor measured: ``KEY.json`` has the agents and labels, and each array
    of a sensor is ``KEY.ROBOT-SENSOR.FIELD.npy``; colour images are ``.png``.
    """
    file = path.with_name(f"{path.name}.tar{'.gz' if compressed else ''}")
    rows: dict[tuple[int, int], dict[str, int]] = {}
    for name, table in tables.items():
        for row, when in enumerate(zip(table["episode"].tolist(), table["nanoseconds"].tolist(), strict=True)):
            rows.setdefault(when, {})[name] = row
    with file.open("wb") as raw, _stream(raw, compressed) as stream, tarfile.open(fileobj=stream, mode="w") as tar:
        for episode, nanoseconds in sorted(rows):
            found = rows[episode, nanoseconds]
            if set(found) != {"agents"}:
                facts = {"seed": int(seeds[episode]), "episode": episode, "nanoseconds": nanoseconds}
                _write_sample(tar, f"{path.name}-{episode:03d}-{nanoseconds:013d}", facts, tables, found)
    return [file]


def _write_sample(
    tar: tarfile.TarFile, key: str, facts: dict[str, Any], tables: Mapping[str, Columns], rows: Mapping[str, int]
) -> None:
    """Write the files of one sample: a row of some tables."""
    for name, row in rows.items():
        label = name.replace("/", "-")
        facts[label] = {}
        for column, array in tables[name].items():
            if column in ("episode", "nanoseconds") or column.startswith("shared."):
                continue
            if name != "agents" and _is_data(column, array[row]):
                _add(tar, *_file(f"{key}.{label}.{column}", column, array[row]))
            else:
                facts[label][column] = _plain(array[row])
    _add(tar, f"{key}.json", json.dumps(facts, allow_nan=False).encode())


def _stream(raw: Any, compressed: bool) -> Any:
    if not compressed:
        return raw
    import gzip

    return gzip.GzipFile(filename="", mode="wb", fileobj=raw, mtime=0)


def _is_data(field: str, value: NDArray[Any]) -> bool:
    labels = ("ids", "returns", "occluded", "boxes", "pose_position", "pose_rotation")
    return value.ndim > 0 and field not in labels


def _file(name: str, field: str, value: NDArray[Any]) -> tuple[str, bytes]:
    content = io.BytesIO()
    if field == "rgb":
        from PIL import Image

        Image.fromarray(value).save(content, format="PNG")
        return f"{name}.png", content.getvalue()
    np.save(content, value)
    return f"{name}.npy", content.getvalue()


def _plain(value: Any) -> Any:
    """Return an array as lists; values that are not finite are None."""
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _add(tar: tarfile.TarFile, name: str, content: bytes) -> None:
    entry = tarfile.TarInfo(name)
    entry.size, entry.mtime, entry.mode = len(content), 0, 0o644
    tar.addfile(entry, io.BytesIO(content))


WRITERS = {"npz": write_npz, "parquet": write_parquet, "webdataset": write_webdataset}


@dataclass(frozen=True)
class Shard:
    """The files of some runs of one trial.

    Fields:
        name: name of the shard.
        trial: name of the trial.
        seeds: seeds of the runs, in the order of ``episode`` in the tables.
        outcomes: outcome of each run; ``impossible`` if people cannot be placed with the seed.
        seconds: simulated time of all runs [s].
        rows: number of rows of each table.
        files: size [bytes] and SHA-256 of each file, by path relative to the folder of the data.
        arrays: type and shape of one sample of each array, by table and name.
    """

    name: str
    trial: str
    seeds: tuple[int, ...]
    outcomes: tuple[str, ...]
    seconds: float
    rows: Mapping[str, int]
    files: Mapping[str, tuple[int, str]]
    arrays: Mapping[str, str] = field(default_factory=dict)


def make_shard(job: ShardJob) -> Shard:
    """Run a job and write its files; they depend on the job only.

    Raises:
        KeyboardInterrupt: Ctrl-C has ended the runs.
        MissingExtra: a sensor needs a package that is not installed.
    """
    trial = parse_trial(job.xml, folder=job.folder, trust=job.trust)
    if job.kind == "mcap":
        return _record_episodes(job, trial)
    possible = _possible(trial, job.seeds)
    outcomes, seconds, tables = _simulate(trial, [seed for seed in job.seeds if seed in possible])
    told = iter(outcomes)
    ends = tuple(next(told) if seed in possible else "impossible" for seed in job.seeds)
    seeds = tuple(seed for seed in job.seeds if seed in possible)
    with explain_write_errors(job.out):
        job.out.mkdir(parents=True, exist_ok=True)
        files = WRITERS[job.kind](tables, job.out / job.name, job.compressed, seeds)
        if job.images:
            files += write_images(tables, job.out / "images" / job.name)
        if job.kitti:
            files += write_kitti(tables, job.out / "kitti" / job.name)
    rows = {name: len(table["episode"]) for name, table in tables.items()}
    return Shard(job.name, job.trial, job.seeds, ends, seconds, rows, _hashes(files, job.out), _arrays(tables))


def _simulate(trial: Trial, seeds: list[int]) -> tuple[list[str], float, dict[str, Table]]:
    """Return outcomes, simulated time [s] and tables of all runs."""
    if not seeds:
        return [], 0.0, {}
    with catch_interrupt() as stop:
        simulation = Simulation(trial, seeds)
        columns = {robot.robot.name: robot.agent for robot in simulation.robots}
        log = SampleLog(simulation.world.scene.walls, columns)
        run = SimulationRun(simulation, [log], stop=stop)
        while run.outcome is None:
            if 2 * run.ends.count(None) <= run.simulation.count:
                run.drop_inactive()
            log.walls = run.simulation.world.scene.walls
            run.step()
    ends = [end for end in run.ends if end is not None]
    if any(end.outcome == "interrupted" for end in ends):
        raise KeyboardInterrupt
    return [end.outcome for end in ends], sum(end.steps for end in ends) * trial.step, log.tables()


def _possible(trial: Trial, seeds: tuple[int, ...]) -> set[int]:
    """Return the seeds with which people can be placed."""
    try:
        Simulation(trial, seeds)
        return set(seeds)
    except MissingExtra:
        raise
    except CrowdbotError:
        pass
    possible = set()
    for seed in seeds:
        try:
            Simulation(trial, seed)
        except CrowdbotError:
            continue
        possible.add(seed)
    return possible


def _record_episodes(job: ShardJob, trial: Trial) -> Shard:
    """Record each run as an episode file, with all that a recording holds."""
    outcomes, files, seconds = [], [], 0.0
    for seed in job.seeds:
        file = job.out / f"{job.name}-seed-{seed}.mcap"
        if seed not in _possible(trial, (seed,)):
            outcomes.append("impossible")
            continue
        summary = record(trial, seed, file, force=True)
        if summary.outcome == "interrupted":
            raise KeyboardInterrupt
        outcomes.append(summary.outcome)
        seconds += summary.steps * trial.step
        files.append(file)
    rows = {"episodes": len(files)}
    return Shard(job.name, job.trial, job.seeds, tuple(outcomes), seconds, rows, _hashes(files, job.out))


def _hashes(files: list[Path], folder: Path) -> dict[str, tuple[int, str]]:
    hashes = {}
    for file in files:
        with file.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
        hashes[file.relative_to(folder).as_posix()] = (file.stat().st_size, digest)
    return hashes


def _arrays(tables: Mapping[str, Table]) -> dict[str, str]:
    return {
        f"{name}/{key}": f"{array.dtype} {list(array.shape if key.startswith('shared.') else array.shape[1:])}"
        for name, table in tables.items()
        for key, array in table.items()
    }


def write_shard(shard: Shard, path: Path) -> None:
    """Write the description of a shard as JSON."""
    path.write_text(json.dumps(asdict(shard)), encoding="utf-8")


def read_shard(path: Path) -> Shard:
    """Read the description of a shard, and check that its files are still there.

    Raises:
        ValueError: the description is damaged, or a file is missing or has another size.
    """
    values: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    values |= {"seeds": tuple(values["seeds"]), "outcomes": tuple(values["outcomes"])}
    values["files"] = {name: (int(size), str(digest)) for name, (size, digest) in values["files"].items()}
    shard = Shard(**values)
    for name, (size, _) in shard.files.items():
        file = path.parent.parent / name
        if not file.is_file() or file.stat().st_size != size:
            raise ValueError(f"{name} is missing or has another size")
    return shard
