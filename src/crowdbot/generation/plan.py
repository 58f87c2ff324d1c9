"""Plan of generated data, and named recipes."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from crowdbot.core import CrowdbotError, InputError, did_you_mean
from crowdbot.recording import files_digest
from crowdbot.sensors import PRESETS, DepthCamera, Lidar2D, Lidar3D, RGBCamera, Sensor, preset
from crowdbot.trials import Mount, Trial, check_trial, expand_sweeps, trial_xml

FORMATS = ("npz", "parquet", "webdataset", "mcap")
"""Formats of shards."""
MOST_SEEDS = 64
"""Largest number of runs in a shard, which run together."""
MOST_SHARDS = 1_000_000


@dataclass(frozen=True)
class ShardJob:
    """Some seeds of one trial, written as one shard.

    Fields:
        name: name of the shard, the first part of its files.
        trial: name of the trial.
        xml: text of the trial, with all sensors.
        folder: folder of the trial, or None.
        seeds: seeds of the runs.
        kind: format of the shard.
        compressed: whether files are compressed.
        images: whether colour images with boxes and masks are written as well, for COCO.
        out: folder of the shard.
        trust: whether code from outside the folder of the trial may be loaded.
        kitti: whether images, boxes and point clouds are written in the folders of KITTI.
        files: hash of the files of the trial, see :func:`crowdbot.recording.files_digest`.
    """

    name: str
    trial: str
    xml: str
    folder: Path | None
    seeds: tuple[int, ...]
    kind: str
    compressed: bool
    images: bool
    out: Path
    trust: bool
    kitti: bool = False
    files: str = ""


@dataclass(frozen=True)
class GenerationPlan:
    """Trials times seeds, with additional sensors on the first robot.

    Args:
        trials: trials; those with sweeps count as all their variants.
        seeds: seeds of the runs of every trial.
        sensors: sensor presets, such as ``scan=hokuyo-utm-30lx@10`` with the name of the sensor and its rate [Hz]; a
            rate that is not given is at most one reading in each step.
        kind: format, one of :data:`FORMATS`.
        coco: whether colour images are written as PNG with annotations in the format of COCO.
        kitti: whether images, boxes and point clouds are written in the folders of KITTI.
        compressed: whether files are compressed; arrays of scans shrink to about a third at a tenth of the speed.
        shard_bytes: approximate size of a shard [bytes].
        noisy: whether presets have their noise.
        trust: whether code from outside the folder of a trial may be loaded.

    Raises:
        InputError: a value is not allowed, a trial has no robot, or there is nothing to measure.
        TrialError: a trial is impossible.

    >>> from crowdbot.trials import load_trial
    >>> plan = GenerationPlan([load_trial("frontal")], range(3), sensors=["sick-tim571"])
    >>> [job.name for job in plan.jobs(Path("out"))]
    ['frontal-000000']
    """

    trials: Sequence[Trial]
    seeds: Sequence[int] = range(10)
    sensors: Sequence[str] = ()
    kind: str = "npz"
    coco: bool = False
    compressed: bool = False
    shard_bytes: int = 400_000_000
    noisy: bool = False
    trust: bool = True
    kitti: bool = False
    variants: tuple[Trial, ...] = dataclasses.field(init=False)

    def __post_init__(self) -> None:
        if self.kind not in FORMATS:
            raise InputError(
                f"format {self.kind!r} must be one of {', '.join(FORMATS)}{did_you_mean(self.kind, FORMATS)}"
            )
        for name, values in (("trials", self.trials), ("seeds", self.seeds)):
            if not len(values):
                raise InputError(f"generated data needs {name}; the list is empty")
        if len(set(self.seeds)) < len(self.seeds):
            raise InputError("seeds: a seed is there twice")
        if self.shard_bytes < 1_000_000:
            raise InputError(f"shard_bytes = {self.shard_bytes} must be at least 1000000")
        mounts = [_mount(text, self.noisy) for text in self.sensors]
        variants = [
            _with_sensors(variant, mounts, self.coco, self.kitti)
            for trial in self.trials
            for variant in expand_sweeps(trial, trust=self.trust)
        ]
        for variant in variants:
            check_trial(variant, int(self.seeds[0]))
        object.__setattr__(self, "variants", tuple(variants))

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each variant in the data; a number is added where two have the same."""
        names = [variant.name for variant in self.variants]
        again = {name for name in names if names.count(name) > 1}
        return tuple(f"{name}-{k + 1}" if name in again else name for k, name in enumerate(names))

    def jobs(self, out: Path) -> list[ShardJob]:
        """Return the shards; they depend on the plan only."""
        shard_jobs = []
        for name, variant in zip(self.names, self.variants, strict=True):
            count, files = self.seeds_per_shard(variant), files_digest(variant)
            for number, begin in enumerate(range(0, len(self.seeds), count)):
                seeds = tuple(int(seed) for seed in self.seeds[begin : begin + count])
                shard_jobs.append(
                    ShardJob(
                        f"{_file_name(name)}-{number:06d}", name, trial_xml(variant), variant.folder, seeds, self.kind,
                        self.compressed, self.coco, out, self.trust, self.kitti, files,
                    )
                )  # fmt: skip
        if len(shard_jobs) > MOST_SHARDS:
            raise InputError(f"the data would have {len(shard_jobs)} shards, at most {MOST_SHARDS} are allowed")
        return shard_jobs

    def seeds_per_shard(self, variant: Trial) -> int:
        """Return how many runs of a variant a shard holds."""
        run = sum(
            variant.duration * reading_rate(mount.sensor, variant) * _reading_bytes(mount.sensor)
            for robot in variant.robots
            for mount in robot.sensors
        )
        agents = variant.people + len(variant.robots)
        run += variant.duration / variant.recording.period * agents * 64.0
        return int(max(1, min(MOST_SEEDS, self.shard_bytes // max(1.0, run))))


def reading_rate(sensor: Sensor, trial: Trial) -> float:
    """Return the readings per second of a sensor in a trial, at most one in each step [Hz]."""
    return min(float(sensor.rate), 1.0 / trial.step)


def _reading_bytes(sensor: Sensor) -> int:
    if isinstance(sensor, Lidar2D):
        return 6 * sensor.rays
    if isinstance(sensor, Lidar3D):
        return 6 * sensor.columns * len(sensor.elevations)
    if isinstance(sensor, DepthCamera):
        return 6 * sensor.width * sensor.height
    if isinstance(sensor, RGBCamera):
        return 5 * sensor.width * sensor.height
    return 200


def _mount(text: str, noisy: bool) -> tuple[Mount, bool]:
    """Return the sensor of a text ``NAME=PRESET@RATE``, and whether it says the rate."""
    label, equals, rest = text.strip().rpartition("=")
    name, at, rate = rest.partition("@")
    try:
        sensor: Any = preset(name, noisy=noisy)
        if at:
            sensor = dataclasses.replace(sensor, rate=float(rate))
    except ValueError as error:
        problem = f"the rate is {rate!r}, it must be a number" if at and name in PRESETS else str(error)
        raise InputError(f"sensor {text!r}: {problem}") from None
    return Mount(name=label if equals else name.replace("-", "_"), sensor=sensor), bool(at)


def _in_steps(mount: Mount, exact: bool, step: float) -> Mount:
    """Return the sensor with at most one reading in each step, unless its rate was chosen."""
    if exact or mount.sensor.rate * step <= 1.0:
        return mount
    return dataclasses.replace(mount, sensor=dataclasses.replace(mount.sensor, rate=1.0 / step))


def _with_sensors(trial: Trial, sensors: Sequence[tuple[Mount, bool]], coco: bool, kitti: bool) -> Trial:
    if not trial.robots:
        raise InputError(f"trial {trial.name!r} has no robot that could carry a sensor")
    first = trial.robots[0]
    mounts = [_in_steps(mount, exact, trial.step) for mount, exact in sensors]
    names = {mount.name for mount in mounts}
    kept = tuple(mount for mount in first.sensors if mount.name not in names)
    try:
        robots = (dataclasses.replace(first, sensors=(*kept, *mounts)), *trial.robots[1:])
        robots = tuple(with_masks(robot) for robot in robots)
        made = dataclasses.replace(trial, robots=robots)
    except CrowdbotError as error:
        raise InputError(f"trial {trial.name!r} with sensors {', '.join(sorted(names))}: {error}") from None
    found = [mount.sensor for robot in robots for mount in robot.sensors]
    if not found:
        raise InputError(f"trial {trial.name!r}: its robot has no sensor; add one with --sensors, such as sick-tim571")
    if coco and not any(isinstance(sensor, RGBCamera) for sensor in found):
        raise InputError(f"trial {trial.name!r}: images for COCO need a colour camera, and its robot has none")
    if kitti and not any(isinstance(sensor, RGBCamera | Lidar3D) for sensor in found):
        raise InputError(
            f"trial {trial.name!r}: KITTI needs a colour camera or a 3-D scanner, and its robot has neither"
        )
    return made


def with_masks(robot: Any) -> Any:
    """Return the robot whose colour cameras have labels: masks, boxes and keypoints."""
    sensors = tuple(
        dataclasses.replace(mount, sensor=dataclasses.replace(mount.sensor, segmentation=True, labels=True))
        if isinstance(mount.sensor, RGBCamera)
        else mount
        for mount in robot.sensors
    )
    return dataclasses.replace(robot, sensors=sensors)


def _file_name(name: str) -> str:
    return "".join(letter if letter.isalnum() or letter in "-_" else "-" for letter in name)


@dataclass(frozen=True)
class Recipe:
    """A named set of trials, sensors and seeds.

    Fields:
        name: name of the recipe.
        about: one sentence.
        trials: names of built-in trials, each with the values of its parameters.
        sensors: sensor presets that the robot carries in addition to its own.
        seeds: number of seeds.
        source: where the set of data is described.
    """

    name: str
    about: str
    trials: tuple[tuple[str, Mapping[str, str]], ...]
    sensors: tuple[str, ...]
    seeds: int
    source: str = ""


REPORT = "CrowdBot deliverable D4.2, section 3.7: data for perception, with and against the flow of people"
_DENSITIES = tuple({"density": text} for text in ("0.1", "0.3", "0.6"))

RECIPES: Mapping[str, Recipe] = MappingProxyType(
    {
        item.name: item
        for item in (
            Recipe(
                "flow",
                "A robot goes with and against a flow of people at three densities, with a planar scanner.",
                tuple((name, values) for name in ("one-way-with", "one-way-against") for values in _DENSITIES),
                ("sick-tim571",),
                10,
                REPORT,
            ),
            Recipe(
                "corridor-clouds",
                "A robot crosses a two-way flow of people with a 3-D scanner.",
                (("crossing-flows", {}),),
                ("velodyne-vlp-16",),
                5,
            ),
        )
    }
)
"""Built-in recipes, by name."""
