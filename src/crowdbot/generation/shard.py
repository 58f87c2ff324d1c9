"""Shard: the files of some runs, made by a job, with their counts and hashes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from crowdbot.core import CrowdbotError, MissingExtra, explain_write_errors
from crowdbot.recording import record
from crowdbot.simulation import Simulation, SimulationRun, catch_interrupt
from crowdbot.trials import Trial, parse_trial

from .formats.coco import write_images
from .formats.kitti import write_kitti
from .formats.npz import write_npz
from .formats.parquet import write_parquet
from .formats.webdataset import write_webdataset
from .plan import ShardJob
from .sample_log import SampleLog, Table

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
    found = set()
    for seed in seeds:
        try:
            Simulation(trial, seed)
        except CrowdbotError:
            continue
        found.add(seed)
    return found


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
    found = {}
    for file in files:
        with file.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
        found[file.relative_to(folder).as_posix()] = (file.stat().st_size, digest)
    return found


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
