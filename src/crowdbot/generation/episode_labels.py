"""Labels of a recorded episode in the formats of COCO and KITTI: its trial runs again with labels."""

from __future__ import annotations

import dataclasses
import json
import os
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import InputError, explain_write_errors
from crowdbot.recording import open_rerun, read_episode
from crowdbot.sensors import RGBCamera, Sensor
from crowdbot.simulation import Simulation, SimulationRun

from .image_formats import join_annotations, write_images, write_kitti
from .plan import with_masks
from .sample_log import SampleLog, Table

LABELLED = {"coco": "colour camera", "kitti": "colour camera or 3-D laser scanner"}
"""Sensors that labels of a format need."""
LABEL_FORMATS = tuple(LABELLED)


class LabelFiles(NamedTuple):
    """What was written: the folder, and the numbers of images, scans and files."""

    folder: Path
    images: int
    scans: int
    files: int


def export_labels(
    episode: str | Path,
    to: str | Path,
    kind: str,
    force: bool = False,
    trust: bool = False,
    progress: Callable[[float], object] | None = None,
    folder: Path | None = None,
) -> LabelFiles:
    """Write images, point clouds and labels of an episode to a folder.

    The trial of the episode runs again with its seed and its orders, with masks, boxes and keypoints in all colour
    cameras: the recording itself has no labels.

    Args:
        episode: the episode, which is not a branch.
        to: the folder to make.
        kind: ``coco``: PNG files, and ``coco.json`` with boxes, masks and keypoints; ``kitti``: the folders
            ``image_2``, ``label_2``, ``calib``, ``velodyne`` and ``labels`` of each sensor.
        force: whether an existing folder is replaced.
        trust: whether code outside the folder of the trial may run.
        progress: called with the completed share, 0 to 1.
        folder: folder of the trial files (default: the folder of the episode).

    Raises:
        InputError: the folder exists, the format is unknown, or the robots have no sensor with such labels.
        EpisodeError: the episode cannot be read or run again.
    """
    target = Path(to)
    if kind not in LABEL_FORMATS:
        raise InputError(f"there is no format {kind!r} of labels; choose {' or '.join(LABEL_FORMATS)}")
    if target.exists() and not (force and target.is_dir()):
        raise InputError(f"{target} already exists; give a new folder, or --force to replace it")
    tables = _labelled(Path(episode), kind, folder, trust, progress)
    draft = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        with explain_write_errors(target):
            draft.mkdir(parents=True)
            files = _written(tables, draft, kind, Path(episode).name)
            if not files:
                raise InputError(f"{episode}: its robots have no {LABELLED[kind]} that measured anything")
            if target.exists():
                shutil.rmtree(target)
            draft.replace(target)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    images = sum(len(table["rgb"]) for table in tables.values() if "rgb" in table)
    return LabelFiles(target, images, sum(file.suffix == ".bin" for file in files), len(files))


def _labelled(
    episode: Path, kind: str, folder: Path | None, trust: bool, progress: Callable[[float], object] | None
) -> Mapping[str, Table]:
    """Return the tables of all sensors of an episode.

    Raises:
        InputError: no robot has a sensor that such labels need; nothing runs then.
    """
    steps = read_episode(episode).steps
    with open_rerun(episode, folder=folder, trust=trust) as rerun:
        trial = dataclasses.replace(rerun.trial, robots=tuple(with_masks(robot) for robot in rerun.trial.robots))
        if not any(_has_labels(mount.sensor, kind) for robot in trial.robots for mount in robot.sensors):
            raise InputError(f"{episode}: its robots have no {LABELLED[kind]}; such labels need one")
        simulation = Simulation(trial, rerun.seed)
        rerun.prepare(simulation)
        columns = {robot.robot.name: robot.agent for robot in simulation.robots}
        log = SampleLog(simulation.world.scene.walls, columns)
        run = SimulationRun(simulation, [log], sources=rerun.sources, ticks=steps)
        while run.outcome is None:
            log.walls = simulation.world.scene.walls
            run.step()
            if progress is not None:
                progress(simulation.tick / max(1, steps))
        return log.tables()


def _has_labels(sensor: Sensor, kind: str) -> bool:
    """Whether a sensor can give labels: only colour cameras give images, and any sensor in space can give points."""
    return isinstance(sensor, RGBCamera) or (kind == "kitti" and sensor.spatial)


def _written(tables: Mapping[str, Table], folder: Path, kind: str, name: str) -> list[Path]:
    if kind == "kitti":
        return write_kitti(tables, folder)
    files = write_images(tables, folder / "images")
    if files:
        joined = join_annotations(files[-1:], {"description": f"labels of {name}"})
        files[-1].unlink()
        files[-1] = folder / "coco.json"
        files[-1].write_text(json.dumps(joined), encoding="utf-8")
    return files
